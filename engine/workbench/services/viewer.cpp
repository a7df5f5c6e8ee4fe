#include "engine/workbench/services/viewer.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "engine/look/camera_motion.h"
#include "engine/look/cut_corners.h"
#include "engine/session/looks/key_look.h"
#include "engine/session/words/number_words.h"
#include "engine/workbench/actions/action_rows.h"
#include "engine/workbench/desk/declined.h"
#include "engine/workbench/edits/edit.h"
#include "engine/workbench/edits/trace_ops.h"
#include "engine/workbench/sight/plane_handles.h"
#include "engine/workbench/sight/words.h"

namespace shvr::ui {

namespace {

/// Returns the first unused name among "view 1", "view 2", ...
std::string free_camera_name(const Session& session)
{
    for (int number = 1;; ++number)
        if (std::string name = sentence("view ", number); !session.cameras.contains(name)) return name;
}

/// Returns the height of the view at the target's depth.
double height_of(const Camera& camera)
{
    return pixel_size(camera, {1, 1}, glm::distance(camera.eye, camera.target));
}

}  // namespace

Viewer::Viewer(Desk& desk, Others others) : Service(desk), others_(std::move(others)) {}

void Viewer::advance()
{
    attempt(looking_, [this] { follow_look(); });
}

void Viewer::look_from(const Camera& camera)
{
    document_->camera = camera;
    camera_moved_ = true;
    others_.note_to_keep();
}

/// The point that the view turns about.
glm::dvec3 Viewer::pivot() const
{
    switch (document_->session.interaction.pivot) {
        case Pivot::target: break;
        case Pivot::probe: return document_->touch.probe();
        case Pivot::picked: return document_->picked_pivot.value_or(document_->camera.target);
    }
    return document_->camera.target;
}

void Viewer::act(const PivotAt& action)
{
    const std::optional<glm::dvec3> point = seen_at(pane(action.pane), action.pixel);
    if (!point) decline("Nothing is seen there, so the pivot stays where it was");
    document_->picked_pivot = point;
    Session after = document_->session;
    after.interaction.pivot = Pivot::picked;
    others_.take_session(std::move(after));
    say("The view now turns about the small cross");
}

void Viewer::act(const Orbit& action)
{
    look_from(orbited(document_->camera, pivot(), action.right_degrees, action.up_degrees));
}

void Viewer::act(const Roll& action)
{
    look_from(rolled(document_->camera, action.degrees));
}

void Viewer::act(const Move& action)
{
    look_from(moved(document_->camera, action.heights * height_of(document_->camera)));
}

void Viewer::act(const Zoom& action)
{
    const Pane seen = pane(action.pane);
    if (!seen.shot.is_slice) return look_from(zoomed(document_->camera, seen.pixels(), action.pixel, action.factor));
    show_slices(slices_zoomed(document_->session.view.slices, seen, action.pixel, action.factor, document_->volume(),
                              document_->probe_voxel()));
}

/// Sets which slices to show. Like the camera, their position is saved, but its changes do not count as unsaved work.
void Viewer::show_slices(SliceSettings slices)
{
    document_->session.view.slices = slices;
    look_again();
    others_.note_to_keep();
}

/// If the point that the slices go through has left their view, moves the view there, whatever moved the point.
void Viewer::follow_slices()
{
    constexpr double STIR_VOXELS = 0.05;  // so that a stylus's jitter does not pull back slices that the user moved
    if (!options_.slices_follow) return;
    Document& document = *document_;
    const glm::dvec3 voxel = cross_of(document.session.view.slices, document.probe_voxel());
    if (glm::distance(voxel, followed_voxel_) <= STIR_VOXELS) return;
    followed_voxel_ = voxel;
    if (document.session.view.arrangement != Arrangement::slices || pixels_.x == 0) return;
    const std::vector<Pane> panes = panes_of(document.session.view, document.camera, pixels_, document.volume(), voxel);
    const std::optional<size_t> held = pointer_ ? std::optional(pointer_->pane) : std::nullopt;
    const SliceSettings next = slices_following(document.session.view.slices, panes, held, document.volume(), voxel);
    if (next == document.session.view.slices) return;
    const Set following = edited(document.session, [&](Session& s) { s.view.slices = next; });
    show_slices(next);
    if (log_) log_(line_of(following));  // slice pixels in later log lines refer to this position
}

void Viewer::follow_look()
{
    Document& document = *document_;
    follow_slices();
    if (pixels_.x > 0 && pixels_.y > 0) {
        if (look_is_stale_)
            document.screen.look(document.session, document.camera, pixels_, document.probe_voxel());
        else if (camera_moved_)
            document.screen.look_from(document.camera, document.probe_voxel());
        look_is_stale_ = camera_moved_ = false;
    }
    // Strokes and the servo request the bricks that they need. If neither runs, request the bricks near the probe.
    if (!document.touch.servo() && !document.annotator.stroke_is_running())
        renderer_.volume().prefer(document.voxels_around_probe());
    document.screen.show_probe(document.probe_look());
    document.screen.advance();
}

/// Returns the pane for the current camera and probe; the screen's own pane may be older within a frame.
Pane Viewer::pane(size_t index) const
{
    const std::vector<Pane> panes = panes_of(document_->session.view, document_->camera, pixels_,
                                             renderer_.scene().info(), document_->probe_voxel());
    if (pixels_.x == 0 || index >= panes.size()) fail("the window no longer has this pane");
    return panes[index];
}

std::optional<glm::dvec3> Viewer::seen_at(const Pane& seen, const glm::dvec2& pixel) const
{
    const glm::uvec2 pixels = seen.pixels();
    const Camera& camera = seen.shot.camera;
    if (seen.shot.is_slice) return unproject(camera, pixels, pixel, 0.5 * (camera.near_distance + camera.far_distance));
    const glm::uvec2 at = glm::uvec2(glm::clamp(pixel, glm::dvec2(0.0), glm::dvec2(pixels - 1u)));
    const auto found = renderer_.pick(document_->session.look(), camera, pixels, at, document_->probe_look());
    return found ? std::optional(found->point) : std::nullopt;
}

std::optional<glm::dvec3> Viewer::seen_near(const Pane& seen, const glm::dvec2& pixel, double depth, double reach) const
{
    if (seen.shot.is_slice) return seen_at(seen, pixel);
    Pane between = seen;
    Camera& camera = between.shot.camera;
    camera.near_distance = std::max(camera.near_distance, depth - reach);
    camera.far_distance = camera.far_distance > 0.0 ? std::min(camera.far_distance, depth + reach) : depth + reach;
    if (camera.far_distance <= camera.near_distance) return std::nullopt;
    return seen_at(between, pixel);
}

void Viewer::act(const Resize& action)
{
    if (std::exchange(pixels_, action.pixels) != action.pixels) look_again();
}

void Viewer::act(const DragInMap& action)
{
    const Pane map = pane(action.pane);
    if (map.shot.is_slice)
        return show_slices(slices_moved(document_->session.view.slices, map, action.pixels, document_->volume(),
                                        document_->probe_voxel()));
    const CameraAxes axes = axes_of(map.shot.camera);
    const glm::dvec2 way = action.pixels * pixel_size(map.shot.camera, map.pixels(), 1.0);
    const glm::dvec3 moved = axes.right * way.x - axes.up * way.y;
    Camera camera = document_->camera;
    camera.eye += moved;
    camera.target += moved;
    look_from(camera);
}

void Viewer::act(const LookFrom& action)
{
    const Camera camera = camera_named(document_->session, action.camera, document_->volume());
    if (action.with_look) {
        if (!document_->session.key_looks.contains(action.camera))
            fail("no look is kept with the view '", action.camera, "'; expected one that was kept for a movie");
        others_.take_session(with_key_look(document_->session, action.camera));
    }
    look_from(camera);
    say(sentence("Looking from ", action.camera, action.with_look ? ", with its look" : ""));
}

void Viewer::act(const KeepCamera& action)
{
    const std::string name = action.name.empty() ? free_camera_name(document_->session) : action.name;
    Session& session = document_->session;
    session.cameras[name] = document_->camera;
    if (action.with_look)
        session.key_looks[name] = key_look_of(session);
    else
        session.key_looks.erase(name);
    others_.note_edit();
    say(sentence("This view is kept as ", name,
                 action.with_look ? ", with its look; File > Movie... goes from view to view" : ""));
}

void Viewer::act(const ForgetCamera& action)
{
    if (document_->session.cameras.erase(action.name) == 0)
        fail("no view is kept as '", action.name, "'; expected one of the session's cameras");
    document_->session.key_looks.erase(action.name);
    if (document_->session.camera_name == action.name) document_->session.camera_name.clear();
    others_.note_edit();
    say("The view " + action.name + " is no longer kept");
}

void Viewer::act(const RenameCamera& action)
{
    std::map<std::string, CameraSpec>& cameras = document_->session.cameras;
    if (!cameras.contains(action.name))
        fail("no view is kept as '", action.name, "'; expected one of the session's cameras");
    if (action.to.empty() || cameras.contains(action.to))
        fail("'", action.to, "' is no free name for a view; expected one that no view has");
    auto renamed = cameras.extract(action.name);
    renamed.key() = action.to;
    cameras.insert(std::move(renamed));
    std::map<std::string, KeyLook>& looks = document_->session.key_looks;
    looks.erase(action.to);  // of a view that no longer exists
    if (auto look = looks.extract(action.name)) {
        look.key() = action.to;
        looks.insert(std::move(look));
    }
    if (document_->session.camera_name == action.name) document_->session.camera_name = action.to;
    others_.note_edit();
    say("The view " + action.name + " is now called " + action.to);
}

void Viewer::act(const GoTo& action)
{
    Camera camera = document_->camera;
    const glm::dvec3 way = action.voxel * document_->volume().spacing - camera.target;
    camera.eye += way;
    camera.target += way;
    look_from(camera);
    say("Looking at " + place_in_words(action.voxel, document_->volume()));
}

void Viewer::act(const PlaceClips& action)
{
    if (action.far > 0.0 && action.near >= action.far)
        fail("the near clip plane is ", number_in_words(action.near),
             " from the eye; expected less than the far one's ", number_in_words(action.far));
    Camera camera = document_->camera;
    camera.near_distance = action.near;
    camera.far_distance = action.far;
    look_from(camera);
    const auto named = [&](double distance) {
        return distance > 0.0 ? length_in_words(distance, document_->volume().unit) : std::string("none");
    };
    say(sentence("Clip planes, from the eye: near ", named(action.near), ", far ", named(action.far)));
}

void Viewer::act(const MoveCut& action)
{
    Session after = document_->session;
    CutBox& cut = after.cut;
    const glm::dvec3 size(document_->volume().size);
    cut.upper = glm::min(cut.upper, size);
    double& plane = action.upper ? cut.upper[action.axis] : cut.lower[action.axis];
    const double low = action.upper ? cut.lower[action.axis] : 0.0;
    const double high = action.upper ? size[action.axis] : cut.upper[action.axis];
    plane = std::clamp(plane + action.share * size[action.axis], low, high);
    others_.take_session(std::move(after));
    const VolumeInfo& volume = document_->volume();
    say(sentence(action.upper ? "Far " : "Near ", "xyz"[action.axis], " cutting plane at voxel ", std::lround(plane),
                 volume.unit == "voxel"
                     ? ""
                     : sentence(" (", length_in_words(plane * volume.spacing[action.axis], volume.unit), ")")));
}

void Viewer::act(const MoveClip& action)
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
                 length_in_words(action.far ? camera.far_distance : camera.near_distance, document_->volume().unit),
                 " from the eye"));
}

void Viewer::act(const CutObliquely& action)
{
    Session after = document_->session;
    CutBox& cut = after.cut;
    switch (action.change) {
        case PlaneChange::add:
            cut = cut_facing(cut, document_->camera, document_->volume());
            after.view.plane_handles = true;
            break;
        case PlaneChange::flip:
            if (!cut.plane_normal) fail("there is no oblique cutting plane to flip");
            cut.plane_normal = -*cut.plane_normal;
            break;
        case PlaneChange::remove:
            if (!cut.plane_normal) fail("there is no oblique cutting plane to remove");
            cut.plane_normal.reset();
            cut.plane_point.reset();
            break;
    }
    others_.take_session(std::move(after));
    say(action.change == PlaneChange::add ? "Cut through the middle, facing you: drag the handles to move and tilt it"
        : action.change == PlaneChange::flip ? "The oblique plane cuts the other side away"
                                             : "The oblique cutting plane is removed");
}

void Viewer::act(const ResetCuts&)
{
    Session after = document_->session;
    after.cut = {};
    others_.take_session(std::move(after));
    document_->camera.near_distance = document_->camera.far_distance = 0.0;
    look_again();
    say("All cutting planes are removed");
}

void Viewer::act(const FitView& action)
{
    const bool has_panes = !document_->screen.parts().empty();
    if (has_panes && pane(action.pane).shot.is_slice) {
        SliceSettings whole = document_->session.view.slices;
        whole.zoom = 1.0;
        whole.center.reset();
        show_slices(whole);
        return say("The slices show the whole volume");
    }
    const VolumeInfo& volume = document_->volume();
    const glm::dvec3 size(volume.size);
    const CutBox& cut = document_->session.cut;
    glm::dvec3 lower = glm::clamp(cut.lower, glm::dvec3(0.0), size), upper = glm::clamp(cut.upper, lower, size);
    if (const auto box = box_left(cut, volume)) std::tie(lower, upper) = *box;
    const glm::uvec2 pixels = has_panes ? pane(0).pixels() : pixels_;
    look_from(fitted(document_->camera, pixels, lower * volume.spacing, upper * volume.spacing));
    const bool is_cut = lower != glm::dvec3(0.0) || upper != size || cut.plane_normal;
    const bool is_clipped = document_->camera.near_distance > 0.0 || document_->camera.far_distance > 0.0;
    say(sentence(is_cut ? "The uncut part of the volume is in view" : "The whole volume is in view",
                 is_clipped ? ", except where the clip planes hide it" : ""));
}

void Viewer::act(const ResetView&)
{
    const Session& session = document_->session;
    // The camera "window" stores the view of the last closed window, which is no default view: use the usual one.
    const std::string name = session.camera_name == "window" ? std::string() : session.camera_name;
    look_from(camera_named(session, name, document_->volume()));
    say("The view is reset");
}

void Viewer::act(const LookAtSelection&)
{
    const TraceGraph& trace = document_->annotator.document().trace;
    const std::optional<glm::dvec3> middle = middle_of_selection(trace);
    if (!middle) fail("Nothing is selected");
    look_from(looking_at(document_->camera, *middle));
    say("Looking at the selection");
}

void Viewer::act(const UpdateOcclusion&)
{
    document_->screen.update_occlusion();
    say(document_->session.light.occlusion.strength > 0.0 ? "Ambient occlusion is being updated"
                                                          : "Ambient occlusion is off: its strength is 0");
}

void Viewer::show_cut_box()
{
    constexpr double CUT_GLOW_S = 1.5;
    cut_shown_until_s_ = options_.now_s() + CUT_GLOW_S;
}

ViewModel Viewer::model() const
{
    if (!document_) return {.panes = desk_.nothing.panes};
    return {.panes = document_->screen.parts(),
            .screen = &document_->screen,
            .pointer = pointer_,
            .picked_pivot = document_->picked_pivot,
            .view_is_complete = document_->screen.complete(),
            .view_is_limited = renderer_.volume().state() == DeviceVolume::State::limited};
}

}  // namespace shvr::ui
