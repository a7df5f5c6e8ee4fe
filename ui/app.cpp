#include "ui/app.h"

#include <algorithm>
#include <fstream>
#include <limits>
#include <utility>

#include <GLFW/glfw3.h>
#include <imgui/imgui.h>

#include "engine/workbench/bindings/preferences_file.h"
#include "ui/browser.h"
#include "ui/panels/field_keys.h"
#include "ui/panels/tools/outline_tool.h"

namespace shvr::ui {

namespace {

/// Interval of the loop while work is pending, short enough that the device never runs out of work.
constexpr double WORK_S = 0.001;
constexpr double IDLE_S = 0.25;
constexpr double CLICK_S = 0.05;  ///< interval while a click may turn out to be a double click
/// Interval at which sharper tiles are shown without input. Drawing more often would delay the tiles themselves.
constexpr double SHARPEN_S = 0.12;
/// Duration after the last event for which the interface is drawn, so that widgets can settle, hover and blink.
constexpr double AFTERGLOW_S = 0.3;

/// Takes budgets from the preferences unless the command line sets them. The workbench reports invalid preferences.
gpu::Budget budget_of(const AppOptions& options)
{
    gpu::Budget budget = options.budget;
    const auto bytes = [](double mebibytes) { return uint64_t(mebibytes) << 20; };
    try {
        const Preferences preferences = load_preferences(preferences_file(options.settings_folder));
        if (budget.device_bytes == 0) budget.device_bytes = bytes(preferences.budget_device_mib.value_or(0.0));
        if (budget.host_bytes == 0) budget.host_bytes = bytes(preferences.budget_host_mib.value_or(0.0));
    } catch (const Error&) {
    }
    return budget;
}

}  // namespace

App::App(const AppOptions& options) : options_(options), window_("SHVR", options.window_size)
{
    begin_at_kept_place();
    gpu::DeviceOptions device = window_.device_needs();
    device.device = options.device;
    device.validation = options.validation;
    device.looks_ahead = true;
    renderer_ = std::make_unique<Renderer>(
        Renderer::Options{.device = device, .budget = budget_of(options), .threads = options.threads});
    appearance_.scale = window_.content_scale();
    set_style(appearance_);
    attach();
    WorkbenchOptions wanted{.saves_outside = options.saves_outside,
                            .allow_force = options.allow_force,
                            .settings = options.settings_folder,
                            .now_s = [this] { return window_.now_s(); },
                            .version = options.version,
                            .draw_texts = draw_texts};
    wanted.view.swap_red_blue = window_.swaps_red_and_blue();
    bench_ = std::make_unique<Workbench>(*renderer_, std::move(wanted));
    if (!options.log.empty()) {
        log_ = std::make_unique<std::ofstream>(options.log);
        if (!*log_) fail(options.log.string(), ": cannot be written; expected a file for the log of actions");
        bench_->log_to([this](const std::string& line) { *log_ << with_present_time(line) << std::endl; });
    }
    // Errors while opening are shown over the start page, since no document is open then.
    if (!options.input.empty())
        bench_->begin_open(options.input, options.settings);
    else
        bench_->say("Open a volume, a session or a project folder, or drop one onto the window");
}

App::~App() = default;

// ---- The loop -------------------------------------------------------------------------------------------------------

void App::run()
{
    for (bool goes_on = true; goes_on;) {
        try {
            goes_on = !closes();
            if (goes_on) turn();
        } catch (const DeviceLost& error) {
            restart_device(error.what());
        }
    }
    keep_place();
    bench_->wait_for_screenshots();
}

void App::turn()
{
    try {
        handle_events(time_to_wait());
    } catch (const DeviceLost&) {
        throw;
    } catch (const std::exception& error) {
        bench_->say(told_of(error), Weight::error);
    }
    apply_all();
    bench_->set_pixels(bench_->is_open() ? viewport_.pixels() : glm::uvec2(0));
    bench_->set_hand_down(ImGui::IsAnyMouseDown());
    bench_->set_still(!something_moves());
    bench_->set_units(appearance_.font_pixels * appearance_.scale / FONT_UNITS);
    bench_->advance();
    follow_workbench();
    report_.done(window_.frames_done(), window_.now_s());
    const double now = window_.now_s();
    if (now < next_frame_s_ || now < next_reason_to_draw_s()) return;
    draw();
    if (undrawable_since_s_) return;
    const double frames_per_second = bench_->model().session.interaction.frames_per_second;
    next_frame_s_ = std::max(next_frame_s_ + 1.0 / frames_per_second, now);
}

/// Applies changes in the workbench's state to the window.
void App::follow_workbench()
{
    if (const std::string text = bench_->take_clipboard(); !text.empty()) ImGui::SetClipboardText(text.c_str());
    if (const std::filesystem::path page = bench_->take_page(); !page.empty() && !show_in_browser(page))
        bench_->say(sentence("xdg-open, of the package xdg-utils, cannot be started; open this page in a browser: ",
                             page.string()),
                    Weight::warning);
    if (std::exchange(drawn_openings_, bench_->openings()) != bench_->openings()) {
        report_.opened(bench_->opened_s());
        window_.set_title("SHVR");  // until the volume is visible
    }
    if (bench_->take_quit()) window_.close();
    if (bench_->take_stay_open()) window_.stay_open();
    window_.set_full_screen(bench_->shows_full_screen());
    // The end of a job removes its progress, and may show a dialog.
    if (std::exchange(drew_jobs_, bench_->shows_jobs()) != bench_->shows_jobs()) keep_drawing(AFTERGLOW_S);
    // What a dialog waited for gives it another layout. Its job may begin and end within one iteration.
    if (std::exchange(choosers_were_busy_, choosers_are_busy()) && !choosers_are_busy()) keep_drawing(AFTERGLOW_S);
    if (std::exchange(drew_cut_box_, bench_->shows_cut_box()) != bench_->shows_cut_box()) keep_drawing(AFTERGLOW_S);
    if (std::exchange(drawn_messages_, bench_->messages().count()) != bench_->messages().count())
        keep_drawing(AFTERGLOW_S);
}

/// If every frame fails for a while, the window cannot be used, so the program ends with the reason.
void App::draw()
{
    constexpr double PATIENCE_S = 10.0;
    try {
        if (!draw_ui()) try_again_soon();
        frame_failure_.clear();
        return undrawn_since_s_.reset();
    } catch (const DeviceLost&) {
        throw;
    } catch (const std::exception& error) {
        const std::string why = told_of(error);
        if (std::exchange(frame_failure_, why) != why) bench_->say(why, Weight::error);
    }
    const double now = window_.now_s();
    undrawable_since_s_.reset();
    if (!undrawn_since_s_) undrawn_since_s_ = now;
    if (now - *undrawn_since_s_ > PATIENCE_S) fail("the window cannot be drawn: ", frame_failure_);
}

/// Called if no image is available, because all are queued for the screen or the window is hidden. The loop continues,
/// and the frame is tried again at growing intervals.
void App::try_again_soon()
{
    constexpr double FIRST_S = 0.002, LAST_S = 0.05, GROWTH = 0.1;
    const double now = window_.now_s();
    if (window_.pixels().x == 0 || window_.pixels().y == 0) return undrawable_since_s_.reset();  // minimised
    if (!undrawable_since_s_) undrawable_since_s_ = now;
    next_frame_s_ = now + std::clamp(GROWTH * (now - *undrawable_since_s_), FIRST_S, LAST_S);
}

/// Never loses work: saves before the window closes, and keeps the window open if saving fails.
bool App::closes()
{
    if (options_.stop && *options_.stop && !messages_at_stop_) {
        messages_at_stop_ = bench_->messages().count();
        bench_->cancel_tasks();
        window_.close();
    }
    if (!window_.should_close()) return false;
    std::string why;
    switch (bench_->leave(why)) {
        case Workbench::Leave::now: return true;
        case Workbench::Leave::later: return false;  // closes once saving is done; until then, work can go on
        case Workbench::Leave::refused: return !refuses_to_close(why);
    }
    return false;
}

/// Never discards paint. If the journal has all of it, the window closes when the user asks a second time, and unsaved
/// settings are discarded.
bool App::refuses_to_close(const std::string& why)
{
    const Document& document = bench_->document();
    const bool is_kept = document.work_is_saved() || document.annotator.work().is_kept();
    if (std::exchange(was_asked_to_close_, true) && is_kept) return false;
    bench_->note_kept_open(why);
    bench_->say("The window stays open, since not all could be saved: " + why +
                    (document.work_is_saved() ? "; close it again to leave without saving"
                     : is_kept                ? "; all paint is in the journal: close it again to leave it there"
                                              : ""),
                Weight::error);
    window_.stay_open();
    return true;
}

/// Draws the interface for at least `for_s`, and for as many frames as widgets need to determine their sizes.
void App::keep_drawing(double for_s)
{
    constexpr uint64_t SETTLING_FRAMES = 3;
    ui_until_s_ = std::max(ui_until_s_, window_.now_s() + for_s);
    ui_until_frame_ = window_.frames_presented() + SETTLING_FRAMES;
}

bool App::something_moves() const
{
    if (window_.frames_presented() < ui_until_frame_ || window_.now_s() < ui_until_s_ || report_.has_unanswered() ||
        choosers_are_busy())
        return true;
    if (!bench_->is_open()) return false;
    constexpr double STIR_VOXELS = 0.05;
    return bench_->is_stirring() || glm::distance(bench_->document().probe_voxel(), drawn_probe_voxel_) > STIR_VOXELS;
}

/// Returns when the interface has to be drawn next, according to the present state: now, at a later time, or never.
double App::next_reason_to_draw_s() const
{
    if (undrawable_since_s_) return 0.0;
    // Until the first picture exists, the interface is drawn rarely, so that the device is free to draw the picture.
    const bool waits_for_picture =
        bench_->is_open() && !bench_->document().screen.shows_anything() && viewport_.pixels().x > 0;
    if (waits_for_picture && !report_.has_unanswered()) return report_.last_begun_s() + SHARPEN_S;
    if (something_moves()) return 0.0;
    if (bench_->shows_jobs()) return report_.last_begun_s() + SHARPEN_S;
    const bool sharpens_or_tells =
        bench_->is_open() && (bench_->document().screen.revision() != drawn_revision_ ||
                              bench_->document().screen.complete() != drew_complete_ ||
                              bench_->document().touch.servo() || bench_->takes_large_screenshot());
    return sharpens_or_tells ? report_.last_begun_s() + SHARPEN_S : std::numeric_limits<double>::infinity();
}

double App::time_to_wait() const
{
    const double until_frame = std::max(next_frame_s_, next_reason_to_draw_s()) - window_.now_s();
    return std::clamp(until_frame, 0.0, bench_->has_work() ? WORK_S : viewport_.is_waiting() ? CLICK_S : IDLE_S);
}

namespace {

/// Returns whether the key has to wait for a frame, so that the interface neither ignores text of the last frame (as it
/// does while Ctrl or Alt is down) nor takes two presses of the key for one.
bool comes_too_early(const KeyEvent& event, const Window& window)
{
    if (!event.pressed || event.repeated) return false;
    const bool is_shift = event.key == GLFW_KEY_LEFT_SHIFT || event.key == GLFW_KEY_RIGHT_SHIFT;
    if (is_modifier(event)) return !is_shift && !ImGui::GetIO().InputQueueCharacters.empty();
    return !types_text(event) && window.was_just_pressed(event.key);
}

/// Returns whether another motion with no button held follows: of such motions, only the last position matters.
bool is_overtaken(const std::vector<InputEvent>& events, const InputEvent& event)
{
    const size_t next = size_t(&event - events.data()) + 1;
    return std::holds_alternative<MoveEvent>(event.what) && !ImGui::IsAnyMouseDown() && next < events.size() &&
           std::holds_alternative<MoveEvent>(events[next].what);
}

/// Gives Enter and Escape over the picture to the outline that is drawn there, if there is one.
bool is_for_outline(const KeyEvent& event)
{
    using Wish = OutlineTool::Wish;
    if (!event.pressed || event.repeated || (event.mods & (GLFW_MOD_CONTROL | GLFW_MOD_ALT))) return false;
    if (event.key == GLFW_KEY_ENTER || event.key == GLFW_KEY_KP_ENTER) return outline_tool().wants(Wish::apply);
    return event.key == GLFW_KEY_ESCAPE && outline_tool().wants(Wish::cancel);
}

}  // namespace

/// Dear ImGui answers for the previous frame. Unless a button is held or a popup is open, looks up the window instead.
bool App::ui_has_mouse(const InputEvent& event) const
{
    const ImGuiIO& io = ImGui::GetIO();
    glm::dvec2 at(0.0);
    if (const auto* move = std::get_if<MoveEvent>(&event.what))
        at = move->at;
    else if (const auto* button = std::get_if<ButtonEvent>(&event.what))
        at = button->at;
    else
        return io.WantCaptureMouse;
    if (ImGui::IsAnyMouseDown() || ImGui::IsPopupOpen(nullptr, ImGuiPopupFlags_AnyPopup)) return io.WantCaptureMouse;
    return covers(at / glm::dvec2(io.DisplayFramebufferScale.x, io.DisplayFramebufferScale.y));
}

/// Returns whether the interface takes a key. Typed text goes to the field being edited. While panels are used by
/// keyboard, or a popup is open, these get the navigation keys, and all other keys act as shortcuts.
bool App::ui_has_key(const KeyEvent& event) const
{
    if (field_has_keys() || choosers_have_keys() || bench_->model().shows_palette) return true;
    // Keys typed while a dialog is shown are no shortcuts: the scene behind the dialog must not change.
    if (dialog_is_shown() && types_text(event)) return true;
    if (!bench_->model().awaits_key.empty()) return false;  // any key may be the one to be bound
    return panels_have_keyboard() && moves_in_panels(event);
}

/// Returns whether a field, a menu or a dialog is open, or the user navigates a panel by keyboard.
bool App::panels_have_keyboard() const
{
    const bool has_popup = ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopupId | ImGuiPopupFlags_AnyPopupLevel);
    return ImGui::GetIO().NavVisible || has_popup || field_has_keys() || choosers_have_keys() ||
           bench_->model().shows_palette;
}

/// Returns whether no frame can be drawn for so long that input must not wait for one any more.
bool App::is_hidden() const
{
    constexpr double PATIENCE_S = 1.0;
    return undrawable_since_s_ && window_.now_s() - *undrawable_since_s_ > PATIENCE_S;
}

/// After input whose effect the next event depends on (`decides`), holds back the rest until a frame shows that effect.
std::vector<InputEvent> App::events_in_turn(double timeout_s)
{
    for (InputEvent& event : window_.wait_events(timeout_s)) held_back_.push_back(std::move(event));
    const bool awaits_frame = held_back_in_frame_ == ImGui::GetFrameCount() && !is_hidden();
    return awaits_frame ? std::vector<InputEvent>() : std::exchange(held_back_, {});
}

void App::hold_back(std::vector<InputEvent>& events, size_t first)
{
    const auto begin = events.begin() + std::ptrdiff_t(first);
    held_back_.assign(std::move_iterator(begin), std::move_iterator(events.end()));
    held_back_in_frame_ = ImGui::GetFrameCount();
    events.erase(begin, events.end());
}

/// Returns whether the interface must apply this event in a frame of its own before it gets the next one: a key that
/// opens or closes a field, edits text or moves the focus, or a click that may give the keyboard to another field.
/// Within one frame, Dear ImGui applies text before keys.
bool App::decides(const InputEvent& event, bool is_for_ui) const
{
    if (std::holds_alternative<ButtonEvent>(event.what)) return is_for_ui || field_has_keys();
    const auto* const key = std::get_if<KeyEvent>(&event.what);
    if (!key || !key->pressed || key->repeated) return false;
    const auto shows_field = [](const Action& action) {
        return action.is<AskOpen>() || action.is<ShowPalette>() || action.is<ShowDialog>();
    };
    return (is_for_ui && !is_modifier(*key) && !types_text(*key)) || std::ranges::any_of(actions_, shows_field);
}

void App::handle_events(double timeout_s)
{
    std::vector<InputEvent> events = events_in_turn(timeout_s);
    for (size_t i = 0; i < events.size(); ++i) {
        const InputEvent& event = events[i];
        keep_drawing(AFTERGLOW_S);
        const auto* const key = std::get_if<KeyEvent>(&event.what);
        if (key && !is_hidden() && comes_too_early(*key, window_)) {
            hold_back(events, i);
            break;
        }
        const bool is_button = std::holds_alternative<ButtonEvent>(event.what);
        if (key || is_button) report_.asked(event.time_s);
        const bool is_for_ui = key ? ui_has_key(*key) || is_for_outline(*key) : is_button && ui_has_mouse(event);
        if (!key || !key->pressed || panels_have_keyboard() || !moves_focus(*key)) window_.tell_ui(event);
        if (key) {
            keyboard_.handle(*key, model(), is_for_ui, actions_);
        } else if (bench_->model().is_painting || !is_overtaken(events, event)) {
            viewport_.handle(event, model(), ui_has_mouse(event), actions_);
        }
        const bool waits = decides(event, is_for_ui);
        if (key && waits && !is_for_ui) ImGui::GetIO().ClearInputCharacters();  // those were of shortcuts
        if (key && leaves_panels(*key)) leave_panels();
        bench_->set_pointer(viewport_.pointer());
        apply_all();  // the next event may depend on an action's effect, such as a new probe position or selection
        if (waits) hold_back(events, i + 1);
    }
    if (window_.has_clicks()) keep_drawing(AFTERGLOW_S);
    viewport_.wait(window_.now_s(), actions_);
    apply_all();
    const double now = window_.now_s();
    if (!field_has_keys() && !choosers_have_keys() && !dialog_is_shown() && !model().shows_palette)
        keyboard_.hold(
            std::min(now - last_keys_s_, 0.1), mods_held(window_), [this](int key) { return window_.is_down(key); },
            model(), actions_);
    last_keys_s_ = now;
}

void App::apply_all()
{
    for (const Action& action : std::exchange(actions_, {})) {
        was_asked_to_close_ &= action.is<Quit>();
        // While nothing is open, unavailable actions are ignored: an error message for each key would cover the hint.
        if (!bench_->is_open() && !bench_->why_not(action).empty()) continue;
        static_cast<void>(bench_->apply(action));
    }
}

}  // namespace shvr::ui
