// What each action does. Every one ends as a sentence in the status bar where a person would want to read it.

#include <algorithm>
#include <cmath>

#include "engine/base/image_file.h"
#include "engine/scene/trace_look.h"
#include "ui/app.h"

namespace shvr::ui {

namespace {

const char* name_of(Brush brush)
{
    return brush == Brush::fill ? "fill" : brush == Brush::flood ? "flood fill" : "speckle fill";
}

std::string name_of(StereoOutput output)
{
    switch (output) {
        case StereoOutput::side_by_side: return "side by side";
        case StereoOutput::top_bottom: return "one above the other";
        case StereoOutput::anaglyph: return "for red and cyan glasses";
    }
    return {};
}

glm::uvec2 size_of(const Pane& pane)
{
    return pane.box.end - pane.box.begin;
}

/// What the view turns about: the middle of what is looked at.
glm::dvec3 pivot_of(const Document& document)
{
    return document.camera.target;
}

/// The height of what is seen at the target's depth.
double height_of(const Camera& camera)
{
    return pixel_size(camera, {1, 1}, glm::distance(camera.eye, camera.target));
}

}  // namespace

// ---- Looking --------------------------------------------------------------------------------------------------------

void App::apply(const Orbit& action)
{
    document_->camera = orbited(document_->camera, pivot_of(*document_), action.right_degrees, action.up_degrees);
    look_from_elsewhere();
}

void App::apply(const Roll& action)
{
    document_->camera = rolled(document_->camera, action.degrees);
    look_from_elsewhere();
}

void App::apply(const Move& action)
{
    document_->camera = moved(document_->camera, action.heights * height_of(document_->camera));
    look_from_elsewhere();
}

void App::apply(const Zoom& action)
{
    document_->camera = zoomed(document_->camera, size_of(pane(action.pane)), action.pixel, action.factor);
    look_from_elsewhere();
}

const Pane& App::pane(size_t index) const
{
    const std::vector<Screen::Part>& parts = document_->screen.parts();
    if (index >= parts.size()) fail("the window has no such part any more");
    return parts[index].pane;
}

void App::apply(const DragInMap& action)
{
    const Pane& map = pane(action.pane);
    const CameraAxes axes = axes_of(map.shot.camera);
    const glm::dvec2 way = action.pixels * pixel_size(map.shot.camera, size_of(map), 1.0);
    const glm::dvec3 moved = axes.right * way.x - axes.up * way.y;
    document_->camera.eye += moved;
    document_->camera.target += moved;
    look_from_elsewhere();
}

void App::apply(const SetView& action)
{
    const bool is_other = action.view.arrangement != document_->session.view.arrangement;
    document_->session.view = action.view;
    document_->is_saved = false;
    if (is_other) {
        switch (action.view.arrangement) {
            case Arrangement::single: say("Full screen"); break;
            case Arrangement::stereo: say("Two eyes: " + name_of(action.view.stereo.output)); break;
            case Arrangement::overview: say("Overview: drag in a map to move the camera"); break;
            case Arrangement::slices: say("Slices through the probe: the wheel moves a slice"); break;
        }
    }
    look_again();
}

void App::apply(const LookFrom& action)
{
    document_->camera = camera_named(document_->session, action.camera, document_->volume());
    look_from_elsewhere();
    say("Looking from " + action.camera);
}

void App::apply(const MoveCut& action)
{
    CutBox& cut = document_->session.cut;
    const glm::dvec3 size(document_->volume().size);
    cut.upper = glm::min(cut.upper, size);
    double& plane = action.upper ? cut.upper[action.axis] : cut.lower[action.axis];
    const double low = action.upper ? cut.lower[action.axis] : 0.0;
    const double high = action.upper ? size[action.axis] : cut.upper[action.axis];
    plane = std::clamp(plane + action.share * size[action.axis], low, high);
    look_again();
    say(sentence(action.upper ? "Far" : "Near", " cutting plane of ", "xyz"[action.axis], " at voxel ",
                 std::lround(plane)));
}

void App::apply(const MoveClip& action)
{
    Camera& camera = document_->camera;
    const double reach = glm::distance(camera.eye, camera.target);
    const double diagonal = glm::length(glm::dvec3(document_->volume().size) * document_->volume().spacing);
    if (!action.far) {
        camera.near_distance = std::max(0.0, camera.near_distance + action.share * reach);
    } else {
        const double from = camera.far_distance > 0.0 ? camera.far_distance : reach + 0.5 * diagonal;
        camera.far_distance = std::max(from + action.share * reach, 0.01 * reach);
    }
    look_again();
    say(sentence(action.far ? "Far" : "Near", " clip plane at ",
                 action.far ? camera.far_distance : camera.near_distance, " ", document_->volume().unit,
                 " from the eye"));
}

void App::apply(const ResetCuts&)
{
    document_->session.cut = {};
    document_->camera.near_distance = document_->camera.far_distance = 0.0;
    look_again();
    say("The whole volume is drawn");
}

// ---- What things look like ------------------------------------------------------------------------------------------

void App::apply(const SetTransferFunction& action)
{
    document_->session.transfer_function = action.function;
    document_->is_saved = false;
    look_again();
}

void App::apply(const SetGroup& action)
{
    document_->session.groups[action.group] = action.settings;
    document_->is_saved = false;
    show_surfaces(*renderer_, document_->surfaces, document_->annotator.document().trace, document_->session.groups);
    look_again();
}

void App::apply(const SetBlend& action)
{
    document_->session.blend = action.blend;
    document_->is_saved = false;
    say(sentence("Distance blending: size ", action.blend.size, ", rate ", action.blend.rate));
    look_again();
}

void App::apply(const SetLight& action)
{
    if (action.light.shaded != document_->session.light.shaded) say(action.light.shaded ? "Shading on" : "Shading off");
    document_->session.light = action.light;
    document_->is_saved = false;
    look_again();
}

void App::apply(const SetOcclusion& action)
{
    document_->session.light.occlusion = action.occlusion;
    look_again();
}

void App::apply(const UpdateOcclusion&)
{
    document_->screen.update_occlusion();
    say(document_->session.light.occlusion.strength > 0.0 ? "Ambient occlusion is renewed"
                                                          : "Ambient occlusion is off: its strength is 0");
}

// ---- The probe ------------------------------------------------------------------------------------------------------

void App::apply(const ProbeTo& action)
{
    const Pane& seen = pane(action.pane);
    const Camera& camera = seen.shot.camera;
    const double depth = glm::dot(document_->touch.probe() - camera.eye, axes_of(camera).forward);
    const double shallowest = 1e-3 * glm::distance(camera.eye, camera.target);
    document_->touch.wish(unproject(camera, size_of(seen), action.pixel, std::max(depth, shallowest)));
}

void App::apply(const ProbeOnto& action)
{
    const Pane& seen = pane(action.pane);
    const glm::uvec2 pixels = size_of(seen);
    std::optional<glm::dvec3> point;
    if (seen.shot.is_slice) {
        const Camera& camera = seen.shot.camera;
        point = unproject(camera, pixels, action.pixel, 0.5 * (camera.near_distance + camera.far_distance));
    } else {
        const glm::uvec2 pixel = glm::uvec2(glm::clamp(action.pixel, glm::dvec2(0.0), glm::dvec2(pixels - 1u)));
        point = renderer_->pick(document_->session, seen.shot.camera, pixels, pixel);
    }
    if (!point) return say("Nothing is seen there that is half opaque; the probe stays where it is");
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
    document_->brush.radius_voxels = std::clamp(document_->brush.radius_voxels * action.factor, 0.5, 60.0);
    say(sentence("Probe radius ", std::round(10.0 * document_->brush.radius_voxels) / 10.0, " voxels"));
}

void App::apply(const SetBrush& action)
{
    const uint8_t group = document_->brush.group;
    const bool is_other = action.brush.brush != document_->brush.brush;
    document_->brush = action.brush;
    document_->brush.group = group;
    if (is_other) say(sentence("Brush: ", name_of(action.brush.brush)));
}

void App::apply(const ShowShell& action)
{
    ProbeSettings& probe = document_->session.probe;
    if (action.on != probe.shell)
        say(action.on ? "Iso-surface at the paint threshold around the probe" : "No iso-surface around the probe");
    probe.shell = action.on;
    probe.shell_opacity = action.opacity;
}

void App::apply(const ChooseGroup& action)
{
    document_->brush.group = action.group;
    say(action.group == 0
            ? std::string("Eraser: painting takes voxels out of their group")
            : sentence("Group ", int(action.group), ": ", group_of(document_->session.groups, action.group).name));
}

void App::apply(const SetHapticThreshold& action)
{
    document_->haptic_threshold = action.intensity;
}

void App::apply(const Assist& action)
{
    document_->assistance = action.on;
    say(action.on ? "Assistance on: the probe is drawn to what is at or above the haptic threshold" : "Assistance off");
}

void App::apply(const SetProxyLaw& action)
{
    document_->law = action.law;
    say(action.law == ProxyLaw::potential ? "Assistance: smooth" : "Assistance: as in the thesis");
}

// ---- The work -------------------------------------------------------------------------------------------------------

void App::apply(const Paint& action)
{
    Annotator& annotator = document_->annotator;
    if (action.on && !annotator.stroke_is_running()) {
        check_radius(document_->brush.radius_voxels, document_->volume().spacing, document_->volume().size);
        annotator.begin_stroke(document_->brush);
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

void App::apply(const Undo&)
{
    const Command* command = document_->annotator.undo();
    if (!command) return say("Nothing is left to undo");
    document_->screen.changed(document_->annotator.reach_of(*command));
    say("Undone: " + command->label);
}

void App::apply(const Redo&)
{
    const Command* command = document_->annotator.redo();
    if (!command) return say("Nothing is left to redo");
    document_->screen.changed(document_->annotator.reach_of(*command));
    say("Redone: " + command->label);
}

void App::apply(const Save&)
{
    save();
}

std::filesystem::path App::free_screenshot_path() const
{
    const std::filesystem::path stem = std::filesystem::path(document_->session_path).replace_extension();
    for (int number = 1;; ++number) {
        std::filesystem::path path = sentence(stem.string(), "-view-", number, ".png");
        if (!std::filesystem::exists(path)) return path;
    }
}

void App::apply(const Screenshot& action)
{
    if (!action.is_large) {
        wants_screenshot_ = true;
        return say("The screenshot is taken as soon as the picture is sharp");
    }
    Session session = document_->saved_session();
    session.render.size = viewport_.pixels() * session.interaction.screenshot_scale;
    RenderOptions options;
    options.part_pixels = 96;  // what a hand that comes back waits for
    large_screenshot_ = std::make_unique<PictureJob>(*renderer_, session, document_->camera, options);
    say(sentence("A screenshot of ", session.render.size.x, " x ", session.render.size.y,
                 " pixels is made while nothing else is to be drawn"));
}

void App::apply(const SetInteraction& action)
{
    document_->session.interaction = action.interaction;
    document_->is_saved = false;
    look_again();
}

/// A part of it, whenever the screen has all it wants. Paint would be in some parts and not in others.
void App::advance_large_screenshot()
{
    if (document_->annotator.stroke_is_running()) {
        large_screenshot_.reset();
        return say("The large screenshot is given up: painting goes first");
    }
    if (something_moves() || !document_->screen.complete() || screenshot_.valid()) return;
    try {
        if (!large_screenshot_->is_done()) {
            large_screenshot_->step();
            status_ = sentence("Large screenshot: ", int(100.0 * large_screenshot_->progress()), " %");
            return;
        }
        write_screenshot(to_image8(large_screenshot_->take().image));
    } catch (const Error& error) {
        say(error.what());
    }
    large_screenshot_.reset();
}

/// Packing the file takes long, and goes to another thread.
void App::write_screenshot(Image8 image)
{
    screenshot_ = std::async(std::launch::async, [image = std::move(image), path = free_screenshot_path()] {
        try {
            write_png(path, image);
            return "Screenshot: " + path.string();
        } catch (const Error& error) {
            return std::string(error.what());
        }
    });
}

void App::finish_screenshot()
{
    if (!document_->screen.complete() || screenshot_.valid()) return;
    wants_screenshot_ = false;
    write_screenshot(document_->screen.read_back());
}

void App::apply(const Open& action)
{
    if (document_ && !document_->work_is_saved()) save();
    open(action.path, {});
}

void App::save()
{
    Annotator& annotator = document_->annotator;
    if (annotator.stroke_is_open()) annotator.end_stroke();
    while (annotator.stroke_is_running()) annotator.advance();  // what is on its way belongs to it
    document_->save();
    say("Saved " + document_->session.mask_path.string() + " and " + document_->session_path.string());
}

void App::apply(const ShowHelp& action)
{
    shows_help_ = action.on;
}

void App::apply(const Quit&)
{
    window_.close();
}

}  // namespace shvr::ui
