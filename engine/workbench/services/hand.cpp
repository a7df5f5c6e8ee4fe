#include "engine/workbench/services/hand.h"

#include <algorithm>
#include <cmath>

#include "engine/annotation/work/work_offsets.h"
#include "engine/workbench/edits/puck_moves.h"

namespace shvr::ui {

namespace {

constexpr double MAX_PUCK_STEP_S = 0.1;    ///< limits motion per step, so that a hung frame does not move the view far
constexpr double TAPS_PER_SECOND = 5.0;    ///< rate at which a held button repeats its action, like a held key
constexpr double MAX_BUTTON_STEP_S = 0.5;  ///< limits repeats per step, so that a hung frame causes no burst

std::filesystem::path free_trace_path(const std::filesystem::path& stem)
{
    for (int number = 1;; ++number) {
        std::filesystem::path path = sentence(stem.string(), "-stylus-", number, ".trace");
        if (!std::filesystem::exists(path)) return path;
    }
}

}  // namespace

Hand::Hand(Desk& desk, PreferenceKeeper& keeper, Others others)
    : Service(desk), keeper_(keeper), others_(std::move(others))
{}

void Hand::advance()
{
    attempt(touching_, [this] { follow_touch(); });
}

void Hand::act(const LetGo& action)
{
    if (hand_.is_let_go == action.on) return;
    hand_.is_let_go = action.on;
    if (action.on) act(GrabVolume{false});
    say(action.on ? "Let go: no force until you switch that off" : "Force on: it returns within a second");
    if (document_->touch.servo()) document_->touch.advance(touch_settings());
}

TouchSettings Hand::touch_settings() const
{
    const Document& document = *document_;
    TouchSettings settings{
        .guide = guide_settings(document.session, document.probe_radius(),
                                document.session.probe.guided ? document.felt_limits() : FeltLimits{}),
        .camera = document.camera,
        .view_height = pixel_size(document.camera, {1, 1}, glm::distance(document.camera.eye, document.camera.target)),
        .scale = document.session.interaction.workspace_scale,
        // While the volume moves with the stylus, the felt voxels lag behind it, so forces are switched off.
        .lets_go = hand_.is_let_go || grab_.has_value(),
        .source = document.source,
        .offsets = &document.annotator.document().density,
        .mask = &document.annotator.document().mask,
        .voxels = document.annotator.revision()};
    settings.guide.assists = settings.guide.assists && options_.has_servo;
    return settings;
}

void Hand::follow_touch()
{
    follow_devices();
    Touch& touch = document_->touch;
    touch.use(device_, hand_.is_puck && keeper_.preferences().puck == PuckMoves::view);
    touch.advance(touch_settings());
    std::optional<glm::dvec3>& cross = document_->session.view.slices.cross;
    if (!touch.is_mouse() && cross) {  // slices follow a stylus
        cross.reset();
        document_->screen.go_through({});
    }
    follow_buttons(touch.buttons());
    follow_grab();
    follow_puck();
    if (touch.recorder() && !touch.recorder()->end().empty()) finish_recording();
    note_hand();
}

void Hand::note_hand()
{
    const Touch& touch = document_->touch;
    hand_.moves_probe = !touch.is_mouse();
    hand_.is_realtime = touch.is_realtime();
    hand_.is_grabbing = grab_.has_value();
    hand_.tap = touch.tap();
    hand_.recorded_s = touch.recorder() ? std::optional(touch.recorder()->seconds()) : std::nullopt;
    if (device_ && *device_->trouble()) hand_.trouble = device_->trouble();
}

void Hand::act(const GrabVolume& action)
{
    if (action.on == grab_.has_value()) return;
    if (!action.on) {
        grab_.reset();
        return say("The volume stays where it is");
    }
    const Touch& touch = document_->touch;
    if (touch.is_mouse() || !touch.servo())
        fail("no stylus moves the probe; expected one that takes hold of the volume");
    const DeviceState& device = touch.last_state().device;
    grab_ = Grab{.camera = document_->camera, .position_m = device.position_m, .rotation = device.rotation};
    say("The volume moves with the stylus");
}

/// Eq. 4.9 of the thesis.
void Hand::follow_grab()
{
    const Touch& touch = document_->touch;
    if (!grab_) return;
    if (touch.is_mouse() || !touch.servo() || (touch.last_state().step.flags & FORCE_NO_DEVICE))
        return act(GrabVolume{false});
    const DeviceState& device = touch.last_state().device;
    const TouchSettings settings = touch_settings();
    const double units_per_m = settings.scale * settings.view_height / WORKSPACE_M;
    others_.look_from(camera_of_grab(*grab_, device.position_m, device.rotation, units_per_m));
}

/// Moves the view at the speed that the puck reports. A puck that reports nothing is at rest, with a speed of 0.
void Hand::follow_puck()
{
    const double now = options_.now_s();
    const double seconds = std::min(now - std::exchange(puck_at_s_, now), MAX_PUCK_STEP_S);
    const ServoState* const puck = document_->touch.puck();
    if (!puck || puck->ticks == 0 || (puck->step.flags & FORCE_NO_DEVICE)) return;
    for (const Action& move : moves_of_puck(puck->device, seconds)) apply(move);
}

/// Treats the buttons of a stylus as keys without modifiers; "Stylus1" is the name of the first button.
void Hand::follow_buttons(uint32_t buttons)
{
    const double now = options_.now_s(), elapsed = std::min(now - std::exchange(buttons_at_s_, now), MAX_BUTTON_STEP_S);
    for (uint32_t button = 0; button < MAX_BUTTONS; ++button) {
        const uint32_t bit = 1u << button;
        const bool is_down = buttons & bit, was_down = buttons_ & bit;
        if (!is_down && !was_down) continue;
        const Chord chord{.key = sentence("Stylus", button + 1)};
        if (is_down && !was_down && !keeper_.awaits_key().empty()) {
            apply(BindKeys{keeper_.awaits_key(), text_of(chord)});
            continue;
        }
        if (const Action* const bound = keeper_.keymap().action_for(chord); bound && is_down && !was_down)
            apply(Action(*bound));  // a copy: it may change the keys
        const Shortcut* const shortcut = keeper_.keymap().shortcut_for(chord);
        if (!shortcut) continue;
        const bool lasts = shortcut->mode == Shortcut::Mode::while_held;
        if (is_down && was_down && shortcut->mode == Shortcut::Mode::hold)
            apply(shortcut->action(desk_.model(), TAPS_PER_SECOND * elapsed));
        else if (is_down != was_down && (is_down || lasts))
            apply(shortcut->action(desk_.model(), is_down ? 1.0 : 0.0));
    }
    buttons_ = buttons;
}

// ---- Recordings -----------------------------------------------------------------------------------------------------

void Hand::act(const RecordStylus& action)
{
    if (!options_.has_servo) fail("no device runs here; expected the window");
    if (document_->touch.recorder()) fail("the stylus is being recorded already; expected that to be ended first");
    if (document_->touch.puck()) fail("the device moves the view; expected one that moves the probe");
    hand_.recording = action.path.empty() ? free_trace_path(others_.stem()) : action.path;
    document_->touch.begin_recording(hand_.recording);
    note_hand();
    say("Recording the stylus");
}

void Hand::act(const StopRecording&)
{
    if (!document_->touch.recorder()) fail("nothing is being recorded; expected a recording to end");
    finish_recording();
}

/// A saver writes the file.
void Hand::finish_recording()
{
    const StylusRecorder& recorder = *document_->touch.recorder();
    const std::filesystem::path path = recorder.path();
    const std::string end = recorder.end();
    auto trace = std::make_shared<Trace>(document_->touch.end_recording());
    note_hand();
    savers_.start("writing " + short_name(path), [this, path, trace, end](ProgressReporter&) -> Jobs::Completion {
        write_trace(path, *trace);
        const double seconds = double(trace->ticks.size()) / trace->rate_hz;
        return [this, path, seconds, end] {
            say(sentence("Recorded ", std::round(10.0 * seconds) / 10.0, " s of the stylus: ", path.string(),
                         end.empty() ? "" : "; it ended, since ", end),
                end.empty() ? Weight::done : Weight::warning);
        };
    });
}

void Hand::act(const FollowStylus& action)
{
    const Document& document = *document_;
    if (document.annotator.stroke_is_running()) fail("a stroke is being painted; expected it to have ended");
    const std::shared_ptr<const VolumeSource> source =
        with_offsets(document.source, document.annotator.document().density);
    jobs_.start(
        "following " + short_name(action.path),
        [this, action, source,
         guide = guide_settings(document.session, document.probe_radius(), document.felt_limits()),
         mask = document.annotator.document().mask, of = desk_.openings](ProgressReporter&) -> Jobs::Completion {
            auto points = std::make_shared<std::vector<StylusPoint>>(
                play_stylus(read_trace(action.path), guide, action.by_hand, source, mask));
            return [this, points, of, action] {
                if (document_ && desk_.openings == of) follow_points(*points, action.node_every_voxels);
            };
        });
}

/// Moves the probe along the points; while the first button is down, paints or, with the trace tool, adds nodes.
void Hand::follow_points(const std::vector<StylusPoint>& points, double node_every)
{
    constexpr double APART_VOXELS = 0.5;
    const glm::dvec3 spacing = document_->volume().spacing;
    const FeelSettings feel = document_->session.probe.touch;
    const bool is_tracing = document_->session.probe.tool == Tool::trace;
    const double apart = (is_tracing ? node_every : APART_VOXELS) * spacing.x;
    PaintOp stroke = document_->stroke();
    std::optional<glm::dvec3> last;
    const auto end_stroke = [&] {
        if (!stroke.path.empty()) others_.paint(stroke);
        stroke.path.clear();
        last.reset();
    };
    size_t placed = 0;
    for (const StylusPoint& point : points) {
        if (!point.is_pressed) {
            end_stroke();
            continue;
        }
        const glm::dvec3 at = feel.at_proxy ? point.middle : point.probe;
        if (last && glm::distance(*last, at) < apart) continue;
        last = at;
        ++placed;
        if (!is_tracing) {
            stroke.path.push_back(at / spacing);
            continue;
        }
        NodeOp node{.at = at / spacing, .radius_voxels = {}, .group = {}};
        if (feel.overlap_radius && point.in_contact)
            if (const auto radius = radius_from_overlap(point.relevant_share, document_->probe_radius()))
                node.radius_voxels = *radius / spacing.x;
        others_.trace(node);
    }
    end_stroke();
    if (!points.empty()) others_.move_probe(points.back().probe, true);
    say(sentence("Followed ", points.size(), " steps of the stylus: ", placed,
                 is_tracing ? " nodes" : " points of strokes"));
}

TouchedModel Hand::model() const
{
    if (!document_) return {};
    return {.servo = document_->touch.servo(), .hand = &hand_, .relevance_age_ms = document_->touch.relevance_age_ms()};
}

}  // namespace shvr::ui
