// The hand: which device it holds, what its moves do to view and probe, recordings of it.

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/annotation/work/work_offsets.h"
#include "ui/workbench/trace_ops.h"
#include "ui/workbench/workbench.h"

namespace shvr::ui {

namespace {

constexpr double LOOK_EVERY_S = 2.0;
constexpr double LONGEST_PUCK_TURN_S = 0.1;  ///< after a hung turn it must not throw the view far away

std::filesystem::path free_trace_path(const std::filesystem::path& stem)
{
    for (int number = 1;; ++number) {
        std::filesystem::path path = sentence(stem.string(), "-stylus-", number, ".trace");
        if (!std::filesystem::exists(path)) return path;
    }
}

const DeviceListing* row_with_id(const std::vector<DeviceListing>& devices, const std::string& id)
{
    const auto found = std::ranges::find(devices, id, &DeviceListing::id);
    return found == devices.end() ? nullptr : &*found;
}

}  // namespace

// ---- Devices --------------------------------------------------------------------------------------------------------

void Workbench::use_device(std::shared_ptr<HapticDevice> device, const std::string& name)
{
    is_given_device_ = true;
    DeviceListing row;
    row.id = "given";
    row.name = name;
    take_device(std::move(device), row);
}

void Workbench::take_device(std::shared_ptr<HapticDevice> device, const DeviceListing& row)
{
    device_ = std::move(device);
    hand_.in_use = row.id;
    hand_.name = row.name;
    hand_.serial = row.serial;
    hand_.connection = row.connection;
    hand_.trouble.clear();
    hand_.is_puck = device_->caps().rate_control;
    if (!document_) return;
    document_->touch.use(device_, hand_.is_puck && preferences_.puck == PuckMoves::view);
    note_hand();
}

void Workbench::leave_device()
{
    if (document_) document_->touch.use(nullptr);
    grab_.reset();
    device_.reset();
    HandView hand;
    hand.devices = std::move(hand_.devices);
    hand.has_looked = hand_.has_looked;
    hand.is_let_go = hand_.is_let_go;
    hand.recording = hand_.recording;
    hand_ = std::move(hand);
}

/// The one that a person has chosen, or the first that can be used; null: none, or the mouse.
const DeviceListing* Workbench::wanted_device() const
{
    const ChosenDevice& chosen = preferences_.device;
    for (const DeviceListing& row : hand_.devices) {
        if (row.kind == DeviceKind::mouse) continue;
        const bool is_it = chosen.name.empty() ? row.why_unusable.empty() && !refused_.contains(row.id)
                                               : row.name == chosen.name && row.serial == chosen.serial;
        if (is_it) return &row;
    }
    return nullptr;
}

void Workbench::choose_device()
{
    if (is_given_device_ || !hand_.opening.empty()) return;
    if (device_ && !row_with_id(hand_.devices, hand_.in_use)) {
        say(name_in_words(hand_.name, hand_.serial) + " is gone; the mouse moves the probe", Weight::warning);
        leave_device();
    }
    const DeviceListing* const wanted = wanted_device();
    if (device_ || !wanted || refused_.contains(wanted->id)) return;
    if (!wanted->why_unusable.empty()) {
        refused_.insert(wanted->id);
        hand_.trouble = sentence(wanted->name, ": ", wanted->why_unusable);
        return say(hand_.trouble, Weight::warning);
    }
    hand_.opening = wanted->id;
    watch_->open(wanted->id);
}

/// What is plugged in while the program runs is found, and what is pulled out is left.
void Workbench::follow_devices()
{
    if (!options_.has_servo || options_.is_script) return;
    if (!watch_) {
        DeviceSource source = options_.devices.list ? options_.devices : devices_of_machine(options_.allow_force);
        watch_ = std::make_unique<DeviceWatch>(std::move(source));
    }
    const double now = options_.now_s();
    if (now >= look_again_s_ && !watch_->is_busy()) {
        look_again_s_ = now + LOOK_EVERY_S;
        watch_->look();
    }
    DeviceWatch::News news = watch_->take();
    hand_.is_looking = watch_->is_busy() && !hand_.has_looked;
    if (!news.failure.empty() && news.failure != hand_.trouble) say(hand_.trouble = news.failure, Weight::warning);
    if (news.devices) {
        hand_.devices = std::move(*news.devices);
        hand_.has_looked = true;
        std::erase_if(refused_, [&](const std::string& id) { return !row_with_id(hand_.devices, id); });
    }
    if (news.opened) {
        const std::string id = std::exchange(hand_.opening, {});
        const DeviceListing* const row = row_with_id(hand_.devices, id);
        if (news.opened->device && row && !is_given_device_) {
            take_device(std::move(news.opened->device), DeviceListing(*row));
            say(sentence(name_in_words(hand_.name, hand_.serial),
                         document_->touch.is_mouse() ? " moves the view" : " moves the probe"));
        } else if (!news.opened->failure.empty()) {
            refused_.insert(id);
            hand_.trouble = news.opened->failure;
            say(hand_.trouble, Weight::warning);
        }
    }
    if (news.devices || news.opened) choose_device();
}

void Workbench::act(const UseDevice& action)
{
    Preferences preferences = preferences_;
    const DeviceListing* const row = row_with_id(hand_.devices, action.device);
    if (!action.device.empty() && !row)
        fail("haptic device ", action.device, ": is not there; expected the id of a device that is listed");
    preferences.device = row ? ChosenDevice{row->name, row->serial} : ChosenDevice{};
    prefer(std::move(preferences));
    refused_.clear();
    is_given_device_ = false;
    if (!row || row->id != hand_.in_use) {
        const DeviceListing wanted = row ? *row : DeviceListing{};
        leave_device();
        say(!row                               ? std::string("The first device that can be used moves the probe")
            : wanted.kind == DeviceKind::mouse ? std::string("The mouse moves the probe")
                                               : name_in_words(wanted.name, wanted.serial) + " is being opened");
    }
    if (watch_) choose_device();
}

void Workbench::act(const FindDevices&)
{
    refused_.clear();
    look_again_s_ = 0.0;
    hand_.trouble.clear();
    say("Looking for haptic devices");
}

/// Back ends calibrate when they open; those that need a hand for it say what to do.
void Workbench::act(const CalibrateDevice&)
{
    if (!device_) fail("no haptic device is in use; expected one to calibrate");
    if (is_given_device_ || !watch_) fail(hand_.name, " is calibrated by the program that gave it");
    const std::string id = hand_.in_use;
    leave_device();
    hand_.opening = id;
    watch_->open(id);
    say("Calibrating: leave the stylus in its holder");
}

void Workbench::act(const LetGo& action)
{
    if (hand_.is_let_go == action.on) return;
    hand_.is_let_go = action.on;
    if (action.on) act(GrabVolume{false});
    say(action.on ? "Let go: no force until you switch that off" : "Force again: it comes back within a second");
    if (document_->touch.servo()) document_->touch.advance(touch_settings());
}

// ---- Moves ----------------------------------------------------------------------------------------------------------

TouchSettings Workbench::touch_settings() const
{
    const Document& document = *document_;
    TouchSettings settings{
        .guide = guide_settings(document.session, document.probe_radius()),
        .camera = document.camera,
        .view_height = pixel_size(document.camera, {1, 1}, glm::distance(document.camera.eye, document.camera.target)),
        .scale = document.session.interaction.workspace_scale,
        // While the volume moves with the stylus, what is felt would lag behind it.
        .lets_go = hand_.is_let_go || grab_.has_value(),
        .source = document.source,
        .offsets = &document.annotator.document().density,
        .mask = &document.annotator.document().mask,
        .voxels = document.annotator.revision()};
    settings.guide.assists = settings.guide.assists && options_.has_servo;
    return settings;
}

void Workbench::follow_touch()
{
    follow_devices();
    Touch& touch = document_->touch;
    touch.use(device_, hand_.is_puck && preferences_.puck == PuckMoves::view);
    touch.advance(touch_settings());
    follow_buttons(touch.buttons());
    follow_grab();
    follow_puck();
    if (touch.recorder() && !touch.recorder()->end().empty()) finish_recording();
    note_hand();
}

void Workbench::note_hand()
{
    const Touch& touch = document_->touch;
    hand_.moves_probe = !touch.is_mouse();
    hand_.is_realtime = touch.is_realtime();
    hand_.is_grabbing = grab_.has_value();
    hand_.tap = touch.tap();
    hand_.recorded_s = touch.recorder() ? std::optional(touch.recorder()->seconds()) : std::nullopt;
    if (device_ && *device_->trouble()) hand_.trouble = device_->trouble();
}

void Workbench::act(const GrabVolume& action)
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
void Workbench::follow_grab()
{
    const Touch& touch = document_->touch;
    if (!grab_) return;
    if (touch.is_mouse() || !touch.servo() || (touch.last_state().step.flags & FORCE_NO_DEVICE))
        return act(GrabVolume{false});
    const DeviceState& device = touch.last_state().device;
    const TouchSettings settings = touch_settings();
    const double units_per_m = settings.scale * settings.view_height / WORKSPACE_M;
    look_from(camera_of_grab(*grab_, device.position_m, device.rotation, units_per_m));
}

/// Its silence is rest: the back end gives no speed then.
void Workbench::follow_puck()
{
    const double now = options_.now_s();
    const double seconds = std::min(now - std::exchange(puck_at_s_, now), LONGEST_PUCK_TURN_S);
    const ServoState* const puck = document_->touch.puck();
    if (!puck || puck->ticks == 0 || (puck->step.flags & FORCE_NO_DEVICE)) return;
    for (const Action& move : moves_of_puck(puck->device, seconds)) apply(move);
}

// ---- Recordings -----------------------------------------------------------------------------------------------------

void Workbench::act(const RecordStylus& action)
{
    if (!options_.has_servo) fail("no device runs here; expected the window");
    if (document_->touch.recorder()) fail("the stylus is being recorded already; expected that to be ended first");
    if (document_->touch.puck()) fail("the device moves the view; expected one that moves the probe");
    hand_.recording = action.path.empty() ? free_trace_path(screenshot_stem()) : action.path;
    document_->touch.begin_recording(hand_.recording);
    note_hand();
    say("Recording what the stylus does");
}

void Workbench::act(const StopRecording&)
{
    if (!document_->touch.recorder()) fail("nothing is being recorded; expected a recording to end");
    finish_recording();
}

/// Its file is written beside the work.
void Workbench::finish_recording()
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

void Workbench::act(const FollowStylus& action)
{
    const Document& document = *document_;
    if (document.annotator.stroke_is_running()) fail("a stroke is being painted; expected it to have ended");
    const std::shared_ptr<const VolumeSource> source =
        with_offsets(document.source, document.annotator.document().density);
    jobs_.start("following " + short_name(action.path),
                [this, action, source, guide = guide_settings(document.session, document.probe_radius()),
                 mask = document.annotator.document().mask, of = openings_](ProgressReporter&) -> Jobs::Completion {
                    auto points = std::make_shared<std::vector<StylusPoint>>(
                        play_stylus(read_trace(action.path), guide, action.by_hand, source, mask));
                    return [this, points, of, action] {
                        if (document_ && openings_ == of) follow_points(*points, action.node_every_voxels);
                    };
                });
}

/// As a hand would: while the first button is down it paints, or adds nodes in the trace tool.
void Workbench::follow_points(const std::vector<StylusPoint>& points, double node_every)
{
    constexpr double APART_VOXELS = 0.5;
    const glm::dvec3 spacing = document_->volume().spacing;
    const FeelSettings feel = document_->session.probe.touch;
    const bool is_tracing = document_->session.probe.tool == Tool::trace;
    const double apart = (is_tracing ? node_every : APART_VOXELS) * spacing.x;
    PaintOp stroke = document_->stroke();
    std::optional<glm::dvec3> last;
    const auto end_stroke = [&] {
        if (!stroke.path.empty()) act(PaintOp(stroke));
        stroke.path.clear();
        last.reset();
    };
    size_t placed = 0;
    for (const StylusPoint& point : points) {
        if (!point.is_pressed) {
            end_stroke();
            continue;
        }
        const glm::dvec3 at = feel.at_proxy ? point.proxy : point.probe;
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
        trace(node);
    }
    end_stroke();
    if (!points.empty()) move_probe(points.back().probe, true);
    say(sentence("Followed ", points.size(), " steps of the stylus: ", placed,
                 is_tracing ? " nodes" : " points of strokes"));
}

/// A node that draws the tool is linked and selected in place of a new one.
void Workbench::add_node_here()
{
    add_node_at(node_or_link_at_probe(model()));
}

/// Returns what was done.
Actions Workbench::add_node_at(const Action& action)
{
    if (const auto* node = std::get_if<NodeOp>(&action)) {
        trace(*node);
        return {action};
    }
    Actions done{action};
    if (const auto* link = std::get_if<LinkOp>(&action)) {
        trace(*link);
        done.push_back(SelectOp{.near = {}, .number = link->node, .within_voxels = {}});
    }
    trace(std::get<SelectOp>(done.back()));
    return done;
}

}  // namespace shvr::ui
