// Actions that change the view and the look. Each reports its result in the status bar.

#include <algorithm>
#include <cmath>

#include "ui/app.h"

namespace shvr::ui {

namespace {

std::string name_of(StereoOutput output)
{
    switch (output) {
        case StereoOutput::side_by_side: return "side by side";
        case StereoOutput::top_bottom: return "one above the other";
        case StereoOutput::anaglyph: return "for red and cyan glasses";
    }
    return {};
}

/// The point that the view turns about: the middle of what is shown.
glm::dvec3 pivot_of(const Document& document)
{
    return document.camera.target;
}

/// The height of the view at the target's depth.
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
    document_->camera = zoomed(document_->camera, pane(action.pane).pixels(), action.pixel, action.factor);
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
    const glm::dvec2 way = action.pixels * pixel_size(map.shot.camera, map.pixels(), 1.0);
    const glm::dvec3 moved = axes.right * way.x - axes.up * way.y;
    document_->camera.eye += moved;
    document_->camera.target += moved;
    look_from_elsewhere();
}

void App::apply(const SetView& action)
{
    const bool is_other = action.view.arrangement != document_->session.view.arrangement;
    document_->session.view = action.view;
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
    say("All cutting planes are removed");
}

// ---- Looks ------------------------------------------------------------------------------------------------------

void App::apply(const SetTransferFunction& action)
{
    document_->session.transfer_function = action.function;
    look_again();
}

void App::apply(const SetGroup& action)
{
    document_->session.groups[action.group] = action.settings;
    renderer_->scene().show_surfaces(document_->surfaces, document_->annotator.document().trace,
                                     document_->session.groups);
    look_again();
}

void App::apply(const SetBlend& action)
{
    document_->session.blend = action.blend;
    say(sentence("Distance blending: size ", action.blend.size, ", rate ", action.blend.rate));
    look_again();
}

void App::apply(const SetLight& action)
{
    if (action.light.shaded != document_->session.light.shaded) say(action.light.shaded ? "Shading on" : "Shading off");
    document_->session.light = action.light;
    look_again();
}

void App::apply(const SetPreintegration& action)
{
    document_->session.render.preintegration = action.on;
    say(action.on ? "Narrow peaks on: none is missed between samples" : "Narrow peaks off: samples may miss them");
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
    say(document_->session.light.occlusion.strength > 0.0 ? "Ambient occlusion is being updated"
                                                          : "Ambient occlusion is off: its strength is 0");
}

}  // namespace shvr::ui
