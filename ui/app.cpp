#include "ui/app.h"

#include <algorithm>
#include <limits>
#include <utility>

#include <imgui/imgui.h>

#include "engine/base/assets.h"
#include "haptics/hid_device.h"

namespace shvr::ui {

namespace {

/// While work is pending the loop runs at this interval, so that the device never runs out of work.
constexpr double WORK_S = 0.001;
constexpr double IDLE_S = 0.25;
/// Without input, sharper tiles are shown at this interval, since drawing the interface takes time from them.
constexpr double SHARPEN_S = 0.12;
/// Widgets settle, hover and blink for that long after the last event.
constexpr double AFTERGLOW_S = 0.3;

}  // namespace

App::App(const AppOptions& options) : options_(options), window_("SHVR", options.window_size)
{
    gpu::DeviceOptions device = window_.device_needs();
    device.device = options.device;
    device.validation = options.validation;
    renderer_ = std::make_unique<Renderer>(
        Renderer::Options{.device = device, .budget = options.budget, .threads = options.threads});
    set_style(window_.content_scale());
    window_.attach(renderer_->device(), renderer_->memory());
    attached_.reset(&window_);
    try {
        presets_ = transfer_presets();
    } catch (const Error& error) {
        say(error.what());
    }
    if (!options.input.empty())
        open(options.input, options.settings);
    else
        say("Drop a volume, a session or a project folder onto the window");
}

void App::say(const std::string& status)
{
    status_ = status;
    report_.said(status);
    ui_until_s_ = std::max(ui_until_s_, window_.now_s() + AFTERGLOW_S);
}

/// The device holds one volume at a time. The previous document is kept until the next one is open, and comes back if
/// that fails.
void App::open(const std::filesystem::path& path, const std::vector<std::string>& settings)
{
    const double begun_s = window_.now_s();
    if (document_) document_->annotator.work().settle();  // it may be opened once more
    OpenedSession opened = open_session(path, settings);
    const std::vector<std::string> losses = opened.losses;
    screenshots_.drop_large();
    View::Options view_options;
    view_options.swap_red_blue = window_.swaps_red_and_blue();
    if (document_) document_->screen.clear();
    look_again();
    try {
        document_ = Document::open(*renderer_, std::move(opened), path, view_options, settings,
                                   document_ ? document_->annotator.work().hold() : nullptr);
    } catch (const Error& error) {
        if (!document_) throw;
        bring_back(error.what());
    }
    report_.opened(begun_s);
    std::string device_said;
    if (std::unique_ptr<HapticDevice> device = find_device(device_said))
        document_->touch.use(std::move(device), "haptic device");
    window_.set_title("SHVR");  // until the volume is visible
    std::string status = "Opened " + path.string();
    if (document_->only_looks()) status += "; read only, for it is open for writing in " + document_->holder;
    for (const std::string& loss : losses) status += "; " + loss;
    for (const std::string& warning : document_->volume().warnings) status += "; " + warning;
    for (const std::string& message : document_->messages) status += "; " + message;
    if (!device_said.empty()) status += "; " + device_said;
    say(status);
}

/// Reopens the previous scan after the next one failed to open. Always throws, with a message saying why and what is
/// open.
void App::bring_back(const std::string& why)
{
    const std::string before = document_->session_path.string();
    try {
        document_->show_again(*renderer_);
    } catch (const Error& error) {
        document_.reset();
        fail(why, "; ", before, " cannot be shown again either: ", error.what(), "; it is saved");
    }
    fail(why, "; ", before, " stays open");
}

/// If the device cannot be used, reports that; the mouse is used instead.
std::unique_ptr<HapticDevice> App::find_device(std::string& said) const
{
    try {
        const std::filesystem::path profiles = asset_folder("devices");
        return profiles.empty() ? nullptr : open_hid_device(load_hid_profiles(profiles), options_.allow_force);
    } catch (const Error& error) {
        said = error.what();
        return nullptr;
    }
}

// ---- The loop -------------------------------------------------------------------------------------------------------

void App::run()
{
    while (!closes()) {
        attempt(events_, [this] { handle_events(time_to_wait()); });
        apply_all();
        work();
        report_.done(window_.frames_done(), window_.now_s());
        const double now = window_.now_s();
        const double frames_per_second =
            (document_ ? document_->session.interaction : InteractionSettings{}).frames_per_second;
        if (now < next_frame_s_ || now < next_reason_to_draw_s()) continue;
        draw();
        next_frame_s_ = std::max(next_frame_s_ + 1.0 / frames_per_second, now);
    }
    screenshots_.wait();
}

template <class Part>
void App::attempt(Attempt& state, Part part)
{
    if (window_.now_s() < state.again_s) return;
    try {
        part();
    } catch (const std::exception& error) {
        note_failure(state, error.what());
    }
}

void App::note_failure(Attempt& state, const std::string& why)
{
    constexpr double AGAIN_S = 0.25, SAY_AGAIN_S = 1.0;
    const double now = window_.now_s();
    const bool is_known = state.failed_s > 0.0 && why == state.said && now - state.failed_s < SAY_AGAIN_S;
    if (!is_known) say(why);
    state = {.said = why, .failed_s = now, .again_s = now + AGAIN_S};
}

/// If frames keep failing the window is useless, so the program ends with the reason.
void App::draw()
{
    constexpr double PATIENCE_S = 10.0;
    bool is_drawn = false;
    attempt(drawing_, [&] {
        draw_ui();
        is_drawn = true;
    });
    if (is_drawn) return undrawn_since_s_.reset();
    const double now = window_.now_s();
    if (!undrawn_since_s_) undrawn_since_s_ = now;
    if (now - *undrawn_since_s_ > PATIENCE_S) fail("the window cannot be drawn: ", drawing_.said);
}

/// Never loses work: saves it before the window closes, and if saving fails keeps the window open.
bool App::closes()
{
    if (options_.stop && *options_.stop && !std::exchange(was_stopped_, true)) window_.close();
    if (!window_.should_close()) return false;
    if (!document_) return true;
    try {
        save_before_leaving();
        return true;
    } catch (const std::exception& error) {
        return !refuses_to_close(error.what());
    }
}

/// Paint is never discarded. If the journal has all of it, the window closes when the user asks for it a second time,
/// and unsaved settings are discarded.
bool App::refuses_to_close(const std::string& why)
{
    const bool is_kept = document_->work_is_saved() || document_->annotator.work().is_kept();
    if (is_kept && was_asked_to_close_) return false;
    was_asked_to_close_ = true;
    say("The window stays open, since not all could be saved: " + why +
        (document_->work_is_saved() ? "; close it again to leave without saving"
         : is_kept                  ? "; all paint is in the journal: close it again to leave it there"
                                    : ""));
    window_.stay_open();
    return true;
}

bool App::something_moves() const
{
    if (window_.now_s() < ui_until_s_ || report_.has_unanswered()) return true;
    if (!document_) return false;
    constexpr double STIR_VOXELS = 0.05;
    return look_is_stale_ || camera_moved_ || glm::distance(document_->probe_voxel(), drawn_probe_voxel_) > STIR_VOXELS;
}

/// When the interface should be drawn next, as far as known: at once, a little later, or not at all.
double App::next_reason_to_draw_s() const
{
    // Until there is something to see, the first picture has the device to itself.
    const bool waits_for_picture = document_ && !document_->screen.shows_anything() && viewport_.pixels().x > 0;
    if (waits_for_picture && !report_.has_unanswered()) return report_.last_begun_s() + SHARPEN_S;
    if (something_moves()) return 0.0;
    const bool sharpens_or_tells = document_ && (document_->screen.revision() != drawn_revision_ ||
                                                 document_->assistance || screenshots_.has_large());
    return sharpens_or_tells ? report_.last_begun_s() + SHARPEN_S : std::numeric_limits<double>::infinity();
}

double App::time_to_wait() const
{
    const bool has_work = document_ && (!document_->screen.complete() || document_->annotator.stroke_is_running() ||
                                        document_->assistance || look_is_stale_ || camera_moved_ ||
                                        screenshots_.is_writing() || !document_->previewer.is_current());
    const double until_frame = std::max(next_frame_s_, next_reason_to_draw_s()) - window_.now_s();
    return std::clamp(until_frame, 0.0, has_work ? WORK_S : IDLE_S);
}

void App::handle_events(double timeout_s)
{
    for (const InputEvent& event : window_.wait_events(timeout_s)) {
        ui_until_s_ = std::max(ui_until_s_, window_.now_s() + AFTERGLOW_S);
        const bool is_answered =
            std::holds_alternative<KeyEvent>(event.what) || std::holds_alternative<ButtonEvent>(event.what);
        if (is_answered) report_.asked(event.time_s);
        if (document_) {
            const ImGuiIO& io = ImGui::GetIO();
            viewport_.handle(event, model(), io.WantCaptureMouse, io.WantTextInput, actions_);
            apply_all();  // the next event may depend on it: the probe's position, the selection
        } else if (const auto* drop = std::get_if<DropEvent>(&event.what)) {
            if (!drop->paths.empty()) actions_.emplace_back(Open{drop->paths.front()});
        }
    }
    const double now = window_.now_s();
    if (document_ && !ImGui::GetIO().WantTextInput)
        keys_held(window_, std::min(now - last_keys_s_, 0.1), model(), actions_);
    last_keys_s_ = now;
}

void App::apply_all()
{
    for (const Action& action : std::exchange(actions_, {})) {
        const bool needs_document = !std::holds_alternative<Open>(action) &&
                                    !std::holds_alternative<ShowHelp>(action) && !std::holds_alternative<Quit>(action);
        if (needs_document && !document_) continue;
        try {
            std::visit([&](const auto& what) { apply(what); }, action);
            if (document_ && edits_session(action)) note_edit();
        } catch (const std::exception& error) {
            say(error.what());
        }
    }
}

TouchSettings App::touch_settings() const
{
    return {.assistance = document_->assistance,
            .threshold = *document_->session.probe.haptic_threshold,
            .probe_radius = document_->probe_radius(),
            .law = document_->law,
            .axes = axes_of(document_->camera),
            .target = document_->camera.target,
            .view_height =
                pixel_size(document_->camera, {1, 1}, glm::distance(document_->camera.eye, document_->camera.target))};
}

void App::work()
{
    if (!document_) return;
    attempt(touching_, [this] { follow_device(); });
    attempt(recording_, [this] { follow_settings(); });
    attempt(painting_, [this] { follow_stroke(); });
    attempt(previewing_, [this] { show_preview(); });
    attempt(looking_, [this] { follow_look(); });
    for (const std::string& message : renderer_->scene().take_messages()) say(message);
    attempt(photographing_, [this] { follow_screenshots(); });
}

void App::follow_device()
{
    Touch& touch = document_->touch;
    touch.advance(touch_settings());
    if (const bool paints = touch.paint_button(); paints != std::exchange(device_paints_, paints))
        actions_.emplace_back(Paint{paints});
}

void App::follow_stroke()
{
    Document& document = *document_;
    const std::string failure = document.annotator.work().journal().failure;
    if (failure != journal_failure_)
        say(failure.empty() ? "The journal can be written again: all work is kept" : failure);
    journal_failure_ = failure;
    if (!document.annotator.stroke_is_running()) return;
    extend_stroke();
    static_cast<void>(document.annotator.advance());
    if (!document.annotator.stroke_is_running()) stroke_ended();
}

void App::follow_look()
{
    Document& document = *document_;
    if (viewport_.pixels().x > 0 && viewport_.pixels().y > 0) {
        if (look_is_stale_)
            document.screen.look(document.session, document.camera, viewport_.pixels(), document.probe_voxel());
        else if (camera_moved_)
            document.screen.look_from(document.camera, document.probe_voxel());
        look_is_stale_ = camera_moved_ = false;
    }
    // A running stroke, or touch, requests its own bricks.
    if (!document.assistance && !document.annotator.stroke_is_running())
        renderer_->volume().prefer(document.voxels_around_probe());
    document.screen.show_probe(document.probe_look());
    document.screen.advance();
}

std::filesystem::path App::screenshot_stem() const
{
    return std::filesystem::path(document_->session_path).replace_extension();
}

void App::follow_screenshots()
{
    if (screenshots_.has_large() && document_->annotator.stroke_is_running()) {
        screenshots_.drop_large();  // paint would show in some of its parts only
        say("The large screenshot was cancelled by painting");
    }
    const Screenshots::Turn turn = screenshots_.advance(document_->screen, screenshot_stem(), !something_moves());
    if (!turn.said.empty()) say(turn.said);
    if (!turn.progress.empty()) status_ = turn.progress;
}

}  // namespace shvr::ui
