// Actions of the probe and its brush.

#include <algorithm>
#include <cmath>
#include <numbers>

#include "ui/workbench/sight/words.h"
#include "ui/workbench/workbench.h"

namespace shvr::ui {

namespace {

constexpr double TAPS_PER_SECOND = 5.0;  ///< of a held button, as of a held key
constexpr double LONGEST_TURN_S = 0.5;   ///< after a hung turn it must not throw the view far away

double depth_of(const Camera& camera, const glm::dvec3& point)
{
    return glm::dot(point - camera.eye, axes_of(camera).forward);
}

/// At the depth of the probe, or just before the eye.
glm::dvec3 in_plane_of(const glm::dvec3& probe, const Pane& seen, const glm::dvec2& pixel)
{
    const Camera& camera = seen.shot.camera;
    const double shallowest = 1e-3 * glm::distance(camera.eye, camera.target);
    return unproject(camera, seen.pixels(), pixel, std::max(depth_of(camera, probe), shallowest));
}

/// Of what the brush reaches at a place.
bool is_hardly_any(const StrokeResult& result, const glm::dvec3& spacing)
{
    constexpr double HARDLY = 0.05;
    const double radius = result.stroke.radius_voxels * spacing.x;
    const double share_of_box = result.stroke.region == RegionShape::ball ? std::numbers::pi / 6.0 : 1.0;
    const double reached = share_of_box * 8.0 * radius * radius * radius / (spacing.x * spacing.y * spacing.z);
    return double(result.voxels() + result.kept_painted) < HARDLY * reached;
}

}  // namespace

/// A stroke that is open paints nothing on the way to where the hand is next.
void Workbench::lift()
{
    if (document_->annotator.stroke_is_open()) document_->annotator.lift_stroke();
}

void Workbench::act(const ProbeTo& action)
{
    const glm::dvec3 point = in_plane_of(document_->touch.probe(), pane(action.pane), action.pixel);
    if (action.jumps) lift();
    move_probe(point, false);
}

std::optional<glm::dvec3> Workbench::seen_at(const Pane& seen, const glm::dvec2& pixel) const
{
    const glm::uvec2 pixels = seen.pixels();
    const Camera& camera = seen.shot.camera;
    if (seen.shot.is_slice) return unproject(camera, pixels, pixel, 0.5 * (camera.near_distance + camera.far_distance));
    const glm::uvec2 at = glm::uvec2(glm::clamp(pixel, glm::dvec2(0.0), glm::dvec2(pixels - 1u)));
    const auto found = renderer_.pick(document_->session.look(), camera, pixels, at, document_->probe_look());
    return found ? std::optional(found->point) : std::nullopt;
}

std::optional<glm::dvec3> Workbench::seen_near(const Pane& seen, const glm::dvec2& pixel, double depth,
                                               double reach) const
{
    if (seen.shot.is_slice) return seen_at(seen, pixel);
    Pane between = seen;
    Camera& camera = between.shot.camera;
    camera.near_distance = std::max(camera.near_distance, depth - reach);
    camera.far_distance = camera.far_distance > 0.0 ? std::min(camera.far_distance, depth + reach) : depth + reach;
    if (camera.far_distance <= camera.near_distance) return std::nullopt;
    return seen_at(between, pixel);
}

void Workbench::act(const ProbeOnto& action)
{
    const Pane seen = pane(action.pane);
    const std::optional<glm::dvec3> point = seen_at(seen, action.pixel);
    if (!point) return say("Nothing is seen there: the probe stays where it is");
    move_probe(*point, true);
    const Document& document = *document_;
    if (document.annotator.stroke_is_running() && !document.touch.servo())
        log_instead({PlaceProbe{document.probe_voxel()}});  // what is seen may still be painted over
    std::string said = "Probe at " + place_in_words(document.probe_voxel(), document.volume());
    if (!seen.shot.is_slice)
        said += sentence(", ",
                         length_in_words(depth_below_surface(seen.shot.camera, document.session.cut, document.volume(),
                                                             document.touch.probe()),
                                         document.volume().unit),
                         " deep");
    say(std::move(said));
}

void Workbench::act(const ProbeAlong& action)
{
    const Pane seen = pane(action.pane);
    const glm::dvec3 probe = document_->touch.probe(), level = in_plane_of(probe, seen, action.pixel);
    const bool is_stroke = document_->annotator.stroke_is_open() && !action.jumps;
    const std::optional<glm::dvec3> point = is_stroke
                                                ? seen_near(seen, action.pixel, depth_of(seen.shot.camera, level),
                                                            document_->probe_radius() + glm::distance(level, probe))
                                                : seen_at(seen, action.pixel);
    if (action.jumps) lift();
    move_probe(point.value_or(level), false);
    if (!document_->touch.servo()) log_instead({PlaceProbe{document_->probe_voxel(), action.jumps}});
}

void Workbench::act(const PushProbe& action)
{
    const CameraAxes axes = axes_of(pane(action.pane).shot.camera);
    const auto step = [&](const glm::dvec3& way, double voxels) {
        return way * (voxels * glm::length(way * document_->volume().spacing));
    };
    move_probe(document_->touch.probe() + step(axes.forward, action.voxels) + step(axes.right, action.right) +
                   step(axes.up, action.up),
               false);
}

void Workbench::act(const PlaceProbe& action)
{
    if (action.jumps) lift();
    move_probe(action.voxel * document_->volume().spacing, true);
}

/// A stroke that is open goes there with it.
void Workbench::move_probe(const glm::dvec3& point, bool jumps)
{
    if (jumps)
        document_->touch.place(point);
    else
        document_->touch.wish(point);
    note_to_keep();
    extend_stroke();
}

void Workbench::act(const ScaleProbe& action)
{
    double& radius = document_->session.probe.brush.radius_voxels;
    radius = std::clamp(radius * action.factor, SMALLEST_RADIUS_VOXELS, LARGEST_RADIUS_VOXELS);
    note_edit();
    say(sentence("Probe radius ", std::round(10.0 * radius) / 10.0, " voxels"));
}

// ---- Painting -------------------------------------------------------------------------------------------------------

void Workbench::act(const Paint& action)
{
    Annotator& annotator = document_->annotator;
    if (document_->session.probe.tool == Tool::trace) {
        if (action.on) add_node_here();
        return;
    }
    if (action.on && !annotator.stroke_is_open()) {
        if (settings_to_record_ || document_->drags_node) await_strokes();  // in the history they come before
        if (document_->drags_node) act(DragNode{false});
        const Previewer& previewer = document_->previewer;
        if (previewer.shown() && previewer.is_current()) previewed_at_stroke_ = previewer.shown()->voxels;
        check_radius(document_->brush().radius_voxels, document_->volume().spacing, document_->volume().size);
        record_settings();
        annotator.begin_stroke(document_->stroke());
        stroke_end_voxel_ = document_->tool_voxel();
        annotator.extend_stroke(stroke_end_voxel_);
    } else if (!action.on && annotator.stroke_is_open()) {
        extend_stroke();
        annotator.end_stroke();
    }
}

void Workbench::act(const PaintOp& op)
{
    if (document_->annotator.stroke_is_running()) fail("a stroke is being painted; expected it to have ended");
    record_settings();
    document_->annotator.paint(in_session(op, document_->session));
    stroke_ended();
}

void Workbench::extend_stroke()
{
    if (!document_->annotator.stroke_is_open() || document_->tool_voxel() == stroke_end_voxel_) return;
    stroke_end_voxel_ = document_->tool_voxel();
    document_->annotator.extend_stroke(stroke_end_voxel_);
    if (log_ && document_->touch.servo()) log_(line_of(PlaceProbe{stroke_end_voxel_}));
}

void Workbench::stroke_ended()
{
    const StrokeResult& result = document_->annotator.last_stroke();
    const bool is_as_meant = result.taken_from.empty() && result.kept_by_locks() == 0;
    std::string said =
        sentence_of(result, [&](uint8_t group) { return group_of(document_->session.groups, group).name; });
    const bool found_nothing =
        is_as_meant && result.voxels() == 0 && result.kept_painted == 0 && !result.stroke.erases();
    if (is_as_meant && !result.stroke.erases() && is_hardly_any(result, document_->volume().spacing))
        said += how_to_reach_this();
    if (result.voxels() == 0) {
        steps_at_empty_stroke_ = document_->annotator.history().undoable();
    } else {
        steps_at_empty_stroke_.reset();
        document_->painted_at = document_->touch.probe();
    }
    say(said, is_as_meant && !found_nothing ? Weight::done : Weight::warning);
}

/// Where what is under the probe is below the paint threshold: what it is, and the key that changes that.
std::string Workbench::how_to_reach_this() const
{
    const Model now = model();
    const Reading& here = now.reading;
    if (!here.is_inside || !here.intensity || *here.intensity + here.offset >= now.paint_threshold()) return {};
    return "; here is " + value_in_words(here) + with_key(", and ", "threshold_here", " sets the threshold from it");
}

/// Requests the preview while it is shown and no stroke is running: a stroke shows its own effect.
void Workbench::follow_preview()
{
    Document& document = *document_;
    const bool is_wanted = document.session.probe.preview && document.session.probe.tool != Tool::trace &&
                           !document.annotator.stroke_is_running();
    document.previewer.want(is_wanted ? std::optional(document.dab()) : std::nullopt);
    try {
        document.previewer.advance();
    } catch (const Error& error) {
        const bool is_of_budget = dynamic_cast<const gpu::BudgetError*>(&error) != nullptr;
        if (dynamic_cast<const gpu::DeviceLost*>(&error) != nullptr) throw;
        if (dynamic_cast<const gpu::MemoryError*>(&error) != nullptr && !is_of_budget) throw;  // there may be some soon
        // Else it is a brush that is too large, a file that cannot be read.
        document.session.probe.preview = false;
        note_edit();
        document.previewer.want(std::nullopt);
        say(error.what(), Weight::error);
    }
}

/// Buttons of a stylus are keys without modifiers: Stylus1 is the first.
void Workbench::follow_buttons(uint32_t buttons)
{
    const double now = options_.now_s(), elapsed = std::min(now - std::exchange(buttons_at_s_, now), LONGEST_TURN_S);
    for (uint32_t button = 0; button < MAX_BUTTONS; ++button) {
        const uint32_t bit = 1u << button;
        const bool is_down = buttons & bit, was_down = buttons_ & bit;
        if (!is_down && !was_down) continue;
        const Chord chord{.key = sentence("Stylus", button + 1)};
        if (is_down && !was_down && !awaits_key_.empty()) {
            apply(BindKeys{awaits_key_, text_of(chord)});
            continue;
        }
        for (const Shortcut* const shortcut : keymap_.shortcuts_for(chord)) {
            const bool lasts = shortcut->mode == Shortcut::Mode::while_held;
            if (is_down && was_down && shortcut->mode == Shortcut::Mode::hold)
                apply(shortcut->action(model(), TAPS_PER_SECOND * elapsed));
            else if (is_down != was_down && (is_down || lasts))
                apply(shortcut->action(model(), is_down ? 1.0 : 0.0));
        }
    }
    buttons_ = buttons;
}

}  // namespace shvr::ui
