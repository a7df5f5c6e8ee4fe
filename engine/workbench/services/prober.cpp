#include "engine/workbench/services/prober.h"

#include <algorithm>
#include <cmath>

#include "engine/session/words/number_words.h"
#include "engine/workbench/sight/words.h"

namespace shvr::ui {

namespace {

double depth_of(const Camera& camera, const glm::dvec3& point)
{
    return glm::dot(point - camera.eye, axes_of(camera).forward);
}

/// Returns the point under a pixel, at the probe's depth or, if the probe is behind the eye, just in front of the eye;
/// in slices that do not go through the probe, in the slice.
glm::dvec3 in_plane_of(const Document& document, const Pane& seen, const glm::dvec2& pixel)
{
    const Camera& camera = seen.shot.camera;
    if (seen.shot.is_slice && document.session.view.slices.cross)
        return unproject(camera, seen.pixels(), pixel, 0.5 * (camera.near_distance + camera.far_distance));
    const glm::dvec3 probe = document.touch.probe();
    const double shallowest = 1e-3 * glm::distance(camera.eye, camera.target);
    return unproject(camera, seen.pixels(), pixel, std::max(depth_of(camera, probe), shallowest));
}

}  // namespace

Prober::Prober(Desk& desk, Others others) : Service(desk), others_(std::move(others)) {}

/// Interrupts the stroke in progress, so that the path between the probe and its next position is not painted.
void Prober::lift()
{
    if (document_->annotator.stroke_is_open()) document_->annotator.lift_stroke();
}

/// Before the probe moves: lets the slices stay where they are, or follow it again. They follow a stylus, which has no
/// other way to lead them.
void Prober::hold_slices(bool hovers)
{
    std::optional<glm::dvec3>& cross = document_->session.view.slices.cross;
    const bool is_sliced = document_->session.view.arrangement == Arrangement::slices;
    if (hovers && (cross || !is_sliced || !document_->touch.is_mouse())) return;
    if (!hovers && !cross) return;
    cross = hovers ? std::optional(document_->probe_voxel()) : std::nullopt;
    document_->screen.go_through(cross);
}

void Prober::act(const ProbeTo& action)
{
    const glm::dvec3 point = in_plane_of(*document_, others_.pane(action.pane), action.pixel);
    if (action.jumps) lift();
    move_probe(point, false, action.hovers);
}

void Prober::act(const ProbeOnto& action)
{
    const Pane seen = others_.pane(action.pane);
    const std::optional<glm::dvec3> point = others_.seen_at(seen, action.pixel);
    if (!point) return say("Nothing is seen there: the probe stays where it is");
    move_probe(*point, true);
    const Document& document = *document_;
    if (document.annotator.stroke_is_running() && !document.touch.servo())
        log_instead({PlaceProbe{document.probe_voxel()}});  // paint may still change the visible surface
    std::string said = "Probe at " + place_in_words(document.probe_voxel(), document.volume());
    if (!seen.shot.is_slice)
        said += sentence(", ",
                         length_in_words(depth_below_surface(seen.shot.camera, document.session.cut, document.volume(),
                                                             document.touch.probe()),
                                         document.volume().unit),
                         " deep");
    say(std::move(said));
}

void Prober::act(const ProbeAlong& action)
{
    const Pane seen = others_.pane(action.pane);
    const glm::dvec3 probe = document_->touch.probe(), level = in_plane_of(*document_, seen, action.pixel);
    const bool is_stroke = document_->annotator.stroke_is_open() && !action.jumps;
    const std::optional<glm::dvec3> point =
        is_stroke ? others_.seen_near(seen, action.pixel, depth_of(seen.shot.camera, level),
                                      document_->probe_radius() + glm::distance(level, probe))
                  : others_.seen_at(seen, action.pixel);
    if (action.jumps) lift();
    move_probe(point.value_or(level), false, action.hovers);
    if (!document_->touch.servo()) log_instead({PlaceProbe{document_->probe_voxel(), action.jumps, action.hovers}});
}

void Prober::act(const PushProbe& action)
{
    const CameraAxes axes = axes_of(others_.pane(action.pane).shot.camera);
    const auto step = [&](const glm::dvec3& way, double voxels) {
        return way * (voxels * glm::length(way * document_->volume().spacing));
    };
    const glm::dvec3 way =
        step(axes.forward, action.voxels) + step(axes.right, action.right) + step(axes.up, action.up);
    std::optional<glm::dvec3>& cross = document_->session.view.slices.cross;
    if (cross) document_->screen.go_through(*cross += way / document_->volume().spacing);
    lead_probe(document_->touch.probe() + way, false);
}

void Prober::act(const PlaceProbe& action)
{
    if (action.jumps) lift();
    move_probe(action.voxel * document_->volume().spacing, true, action.hovers);
}

/// Moves the probe. A stroke in progress extends to the new position.
void Prober::move_probe(const glm::dvec3& point, bool jumps, bool hovers)
{
    hold_slices(hovers);
    lead_probe(point, jumps);
}

void Prober::lead_probe(const glm::dvec3& point, bool jumps)
{
    if (jumps)
        document_->touch.place(point);
    else
        document_->touch.wish(point);
    others_.note_to_keep();
    others_.extend_stroke();
}

void Prober::act(const ScaleProbe& action)
{
    double& radius = document_->session.probe.brush.radius_voxels;
    radius = std::clamp(radius * action.factor, MIN_RADIUS_VOXELS, MAX_RADIUS_VOXELS);
    others_.note_edit();
    const VolumeInfo& volume = document_->volume();
    const double shown = std::round(10.0 * radius) / 10.0;
    say(sentence(
        "Probe radius ", number_in_words(shown), shown == 1.0 ? " voxel" : " voxels",
        volume.unit == "voxel" ? "" : sentence(" (", length_in_words(radius * volume.spacing.x, volume.unit), ")")));
}

ProbeModel Prober::model() const
{
    if (!document_) return {};
    const ToolPlace tool = document_->tool_place();
    return {.probe_voxel = document_->probe_voxel(),
            .tool_voxel = tool.point / document_->volume().spacing,
            .tool_node = tool.node,
            .tool_internode = tool.internode};
}

}  // namespace shvr::ui
