// Actions of the probe and its brush.

#include <algorithm>
#include <cmath>

#include "ui/app.h"

namespace shvr::ui {

void App::apply(const ProbeTo& action)
{
    const Pane& seen = pane(action.pane);
    const Camera& camera = seen.shot.camera;
    const double depth = glm::dot(document_->touch.probe() - camera.eye, axes_of(camera).forward);
    const double shallowest = 1e-3 * glm::distance(camera.eye, camera.target);
    document_->touch.wish(unproject(camera, seen.pixels(), action.pixel, std::max(depth, shallowest)));
}

void App::apply(const ProbeOnto& action)
{
    const Pane& seen = pane(action.pane);
    const glm::uvec2 pixels = seen.pixels();
    std::optional<glm::dvec3> point;
    if (seen.shot.is_slice) {
        const Camera& camera = seen.shot.camera;
        point = unproject(camera, pixels, action.pixel, 0.5 * (camera.near_distance + camera.far_distance));
    } else {
        const glm::uvec2 pixel = glm::uvec2(glm::clamp(action.pixel, glm::dvec2(0.0), glm::dvec2(pixels - 1u)));
        point = renderer_->pick(document_->session.look(), seen.shot.camera, pixels, pixel, document_->probe_look());
    }
    if (!point) return say("Nothing opaque enough there: the probe stays where it is");
    document_->touch.place(*point);
    const glm::dvec3 voxel = document_->probe_voxel();
    say(sentence("Probe at voxel ", std::floor(voxel.x), ", ", std::floor(voxel.y), ", ", std::floor(voxel.z)));
}

void App::apply(const PushProbe& action)
{
    const glm::dvec3 forward = axes_of(pane(action.pane).shot.camera).forward;
    const double voxel = glm::length(forward * document_->volume().spacing);
    document_->touch.wish(document_->touch.probe() + forward * (action.voxels * voxel));
}

void App::apply(const ScaleProbe& action)
{
    double& radius = document_->session.probe.brush.radius_voxels;
    radius = std::clamp(radius * action.factor, SMALLEST_RADIUS_VOXELS, LARGEST_RADIUS_VOXELS);
    say(sentence("Probe radius ", std::round(10.0 * radius) / 10.0, " voxels"));
}

void App::apply(const SetBrush& action)
{
    BrushSettings& brush = document_->session.probe.brush;
    const uint8_t group = brush.group;
    const bool is_other = action.brush.brush != brush.brush;
    brush = action.brush;
    brush.group = group;
    if (is_other) say(sentence("Brush: ", row_of(action.brush.brush).name));
}

void App::apply(const ShowShell& action)
{
    ProbeSettings& probe = document_->session.probe;
    if (action.on != probe.shell)
        say(action.on ? "Iso-surface around the probe on, at the paint threshold" : "Iso-surface around the probe off");
    probe.shell = action.on;
    probe.shell_opacity = action.opacity;
}

void App::apply(const ShowPreview& action)
{
    document_->session.probe.preview = action.on;
    say(action.on ? "Preview of the brush on: what it would change is shown" : "Preview of the brush off");
}

void App::apply(const ChooseGroup& action)
{
    document_->session.probe.brush.group = action.group;
    say(action.group == 0
            ? std::string("Eraser: painting removes voxels from their group")
            : sentence("Group ", int(action.group), ": ", group_of(document_->session.groups, action.group).name));
}

void App::apply(const SetHapticThreshold& action)
{
    document_->session.probe.haptic_threshold = action.intensity;
}

void App::apply(const Assist& action)
{
    document_->assistance = action.on;
    say(action.on ? "Guidance on: the probe is pulled to what is at or above the haptic threshold" : "Guidance off");
}

void App::apply(const SetProxyLaw& action)
{
    document_->law = action.law;
    say(action.law == ProxyLaw::potential ? "Guidance: smooth" : "Guidance: as in the thesis");
}

// ---- Painting -------------------------------------------------------------------------------------------------------

void App::apply(const SetTool& action)
{
    if (document_->annotator.stroke_is_open()) apply(Paint{false});
    if (document_->drags_node) apply(DragNode{false});
    document_->tool = action.tool;
    say(action.tool == Tool::paint ? "Painting: hold the right mouse button or F"
                                   : "Tracing: the right mouse button or N adds a node at the probe");
}

void App::apply(const Paint& action)
{
    Annotator& annotator = document_->annotator;
    if (document_->tool == Tool::trace) {
        if (action.on) apply(Trace{NodeOp{.at = document_->probe_voxel(), .radius_voxels = {}, .group = {}}});
        return;
    }
    if (action.on && !annotator.stroke_is_running()) {
        const Previewer& previewer = document_->previewer;
        if (previewer.shown() && previewer.is_current()) report_.previewed(previewer.shown()->voxels);
        check_radius(document_->brush().radius_voxels, document_->volume().spacing, document_->volume().size);
        annotator.begin_stroke(document_->stroke());
        annotator.extend_stroke(document_->probe_voxel());
    } else if (!action.on && annotator.stroke_is_running()) {
        extend_stroke();
        annotator.end_stroke();
    }
}

void App::extend_stroke()
{
    if (document_->annotator.stroke_is_open()) document_->annotator.extend_stroke(document_->probe_voxel());
}

void App::stroke_ended()
{
    say(sentence_of(document_->annotator.last_stroke(),
                    [&](uint8_t group) { return group_of(document_->session.groups, group).name; }));
}

/// Requests the preview while it is shown and no stroke is running: a stroke shows its own effect.
void App::show_preview()
{
    Document& document = *document_;
    const bool is_wanted =
        document.session.probe.preview && document.tool == Tool::paint && !document.annotator.stroke_is_running();
    document.previewer.want(is_wanted ? std::optional(document.dab()) : std::nullopt);
    try {
        document.previewer.advance();
    } catch (const Error& error) {  // a brush that is too large, a file that cannot be read
        document.session.probe.preview = false;
        note_edit();
        document.previewer.want(std::nullopt);
        say(error.what());
    }
}

}  // namespace shvr::ui
