#include "ui/workbench/workbench.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "engine/base/assets.h"
#include "engine/base/text.h"

namespace shvr::ui {

struct Workbench::Nothing {
    Session session;
    VolumeInfo volume;
    VolumeStatistics statistics;
    Camera camera;
    std::vector<Screen::Part> panes;
    TraceGraph trace;
    std::filesystem::path path;
};

Workbench::Workbench(Renderer& renderer, WorkbenchOptions options)
    : renderer_(renderer), options_(std::move(options)), nothing_(std::make_unique<Nothing>())
{
    if (!options_.now_s)
        options_.now_s = [] {
            return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
        };
    load_presets();
    load_preferences();
}

/// What is being written, preferences among it, is written to its end.
Workbench::~Workbench()
{
    static_cast<void>(savers_.wait());
}

void Workbench::say(std::string text, Weight weight)
{
    messages_.add(options_.now_s(), weight, std::move(text));
    if (shows_messages_) messages_.note_read();
}

// ---- Actions --------------------------------------------------------------------------------------------------------

void Workbench::perform(const Action& action)
{
    if (!document_ && !ui::why_not(model(), action).empty())
        fail(opening_ ? sentence(opening_name(), " is being opened") : std::string("Nothing is open"));
    if (log_ && document_ && document_->touch.servo()) log_(line_of(PlaceProbe{document_->probe_voxel()}));
    if (document_ && document_->annotator.stroke_is_running() && waits_for_strokes(model(), action)) await_strokes();
    recent_.begin(action);
    logged_instead_.clear();
    std::visit([&](const auto& each) { act(each); }, action);
    if (options_.is_script && document_ && document_->annotator.is_behind()) document_->annotator.catch_up();
    recent_.note_done();
    if (!log_) return;
    if (logged_instead_.empty()) logged_instead_.push_back(line_of(action));
    for (const std::string& line : logged_instead_) log_(line);
}

/// What is seen at a pixel depends on what has been painted and loaded by then; where it was does not.
void Workbench::log_instead(const Actions& actions)
{
    if (!log_) return;
    for (const Action& action : actions) logged_instead_.push_back(line_of(action));
}

bool Workbench::apply(const Action& action)
{
    try {
        perform(action);
        return true;
    } catch (const DeviceLost&) {
        throw;
    } catch (const std::exception& error) {
        say(told_of(error), Weight::error);
        return false;
    }
}

void Workbench::act(const AskOpen& action)
{
    asks_what_to_open_ = action.on;
}

void Workbench::act(const Resize& action)
{
    if (std::exchange(pixels_, action.pixels) != action.pixels) look_again();
}

void Workbench::act(const ShowHelp& action)
{
    shows_help_ = action.on;
    if (!action.on) awaits_key_.clear();
}

void Workbench::act(const ShowMessages& action)
{
    shows_messages_ = action.on;
    messages_.note_read();
}

void Workbench::act(const ShowPalette& action)
{
    shows_palette_ = action.on;
}

void Workbench::act(const ShowPreferences& action)
{
    shows_preferences_ = action.on;
}

void Workbench::act(const FocusOn& action)
{
    focus_ = action.what;
}

void Workbench::act(const ShowFullScreen& action)
{
    is_full_screen_ = action.on;
}

void Workbench::act(const Quit& action)
{
    if (!action.saves) discard();
    quits_ = true;
}

/// Files stay as they are. The journal keeps what was done since: undo brings it back next time.
void Workbench::discard()
{
    if (!document_ || document_->only_looks() || !document_->annotator.work().disputes().empty()) return;
    static_cast<void>(finish_stroke());  // which is discarded
    record_settings();
    const Command* done = nullptr;
    try {
        done = document_->annotator.revert();
    } catch (const Error&) {  // what was never saved was nothing
        while (const Command* const undone = document_->annotator.undo()) show_changes(*undone);
    }
    if (done) show_changes(*done);
    discarded_steps_ = document_->annotator.history().undoable();
}

// ---- Turns ----------------------------------------------------------------------------------------------------------

void Workbench::attempt(Attempt& state, const std::function<void()>& part)
{
    if (options_.now_s() < state.again_s) return;
    try {
        part();
    } catch (const DeviceLost&) {
        throw;
    } catch (const std::exception& error) {
        note_failure(state, told_of(error));
    }
}

void Workbench::note_failure(Attempt& state, const std::string& why)
{
    constexpr double AGAIN_S = 0.25, SAY_AGAIN_S = 1.0;
    const double now = options_.now_s();
    const bool is_known = state.failed_s > 0.0 && why == state.said && now - state.failed_s < SAY_AGAIN_S;
    if (!is_known) say(why, Weight::error);
    state = {.said = why, .failed_s = now, .again_s = now + AGAIN_S};
}

void Workbench::set_pixels(const glm::uvec2& pixels)
{
    if (pixels != pixels_) perform(Resize{pixels});
}

bool Workbench::has_work() const
{
    if (!jobs_.is_idle() || !savers_.is_idle() || opening_ || reload_ || is_saving()) return true;
    return document_ &&
           (!document_->screen.complete() || document_->annotator.stroke_is_running() || document_->touch.servo() ||
            document_->annotator.is_behind() || is_stirring() || screenshots_.is_writing() ||
            screenshots_.has_large() || !document_->previewer.is_current() || document_->meter.is_asking());
}

void Workbench::advance()
{
    follow_jobs();
    follow_opening();
    follow_reload();
    if (!document_) return;
    attempt(saving_, [this] { follow_save(); });
    attempt(touching_, [this] { follow_touch(); });
    attempt(recording_, [this] { follow_settings(); });
    attempt(keeping_, [this] { follow_view(); });
    attempt(painting_, [this] { follow_stroke(); });
    attempt(previewing_, [this] { follow_preview(); });
    attempt(looking_, [this] { follow_look(); });
    attempt(reading_turn_, [this] { follow_reading(); });
    for (const std::string& message : renderer_.scene().take_messages()) say(message, Weight::warning);
    attempt(photographing_, [this] { follow_screenshots(); });
}

void Workbench::follow_stroke()
{
    Annotator& annotator = document_->annotator;
    const std::string failure = annotator.work().journal().failure;
    if (failure != journal_failure_)
        say(failure.empty() ? "The journal can be written again: all work is kept" : failure,
            failure.empty() ? Weight::done : Weight::error);
    journal_failure_ = failure;
    if (!annotator.stroke_is_running() && !annotator.is_behind()) return;
    extend_stroke();
    const uint64_t done = annotator.strokes_done();
    advance_stroke();
    if (annotator.strokes_done() != done) stroke_ended();
}

void Workbench::advance_stroke()
{
    const bool has_painted = document_->annotator.advance().has_value();
    const uint64_t before =
        std::exchange(stroke_uploads_, renderer_.volume().counts().value_or(DeviceVolume::Counts{}).uploads);
    if (has_painted || before != stroke_uploads_) stroke_progress_s_ = options_.now_s();
}

void Workbench::follow_look()
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
    // A running stroke, or touch, requests its own bricks.
    if (!document.touch.servo() && !document.annotator.stroke_is_running())
        renderer_.volume().prefer(document.voxels_around_probe());
    document.screen.show_probe(document.probe_look());
    document.screen.advance();
}

void Workbench::drop_large_screenshot(const char* by)
{
    if (!screenshots_.has_large()) return;
    screenshots_.drop_large();
    say(sentence("The large screenshot was cancelled by ", by), Weight::warning);
}

void Workbench::follow_screenshots()
{
    if (document_->annotator.stroke_is_running()) drop_large_screenshot("painting");  // only some parts would show it
    const Screenshots::Turn turn =
        screenshots_.advance(document_->screen, screenshot_stem(), is_still_, texts_of_picture(pixels_, true),
                             [this] { return figure_of_picture(1); });
    if (!turn.said.empty()) say(turn.said);
    if (!turn.progress.empty()) messages_.amend(options_.now_s(), turn.progress);
}

// ---- What there is to see -------------------------------------------------------------------------------------------

Model Workbench::model() const
{
    if (!document_)
        return {.session = nothing_->session,
                .volume = nothing_->volume,
                .statistics = nothing_->statistics,
                .camera = nothing_->camera,
                .panes = nothing_->panes,
                .presets = presets_,
                .trace = nothing_->trace,
                .opening = opening_name(),
                .candidate = candidate_.get(),
                .open_failure = open_failure_,
                .failed_path = &failed_path_,
                .session_path = nothing_->path,
                .jobs = job_states(),
                .messages = messages_,
                .keymap = keymap_,
                .preferences = preferences_,
                .recent = &recent_,
                .version = options_.version,
                .shows_help = shows_help_,
                .shows_messages = shows_messages_,
                .shows_passes = shows_passes_,
                .shows_palette = shows_palette_,
                .is_full_screen = is_full_screen_,
                .asks_what_to_open = asks_what_to_open_,
                .shows_preferences = shows_preferences_,
                .awaits_key = awaits_key_,
                .gpu_name = renderer_.device().traits().name};
    const Document& document = *document_;
    const Previewer& previewer = document.previewer;
    const ToolPlace tool = document.tool_place();
    const bool has_preview = previewer.shown() && previewer.is_current();
    return {.is_open = true,
            .session = document.session,
            .volume = document.volume(),
            .statistics = document.statistics,
            .camera = document.camera,
            .panes = document.screen.parts(),
            .presets = presets_,
            .screen = &document.screen,
            .probe_voxel = document.probe_voxel(),
            .is_painting = document.annotator.stroke_is_running(),
            .stroke_is_open = document.annotator.stroke_is_open(),
            .servo = document.touch.servo(),
            .tool_voxel = tool.point / document.volume().spacing,
            .tool_node = tool.node,
            .tool_internode = tool.internode,
            .hand = &hand_,
            .pointer = pointer_,
            .reading = reading_,
            .picked_pivot = document.picked_pivot,
            .measurements = document.session.measurements,
            .measuring_from = document.measuring_from,
            .measuring_to = document.measuring_from ? std::optional(voxel_to_read()) : std::nullopt,
            .trace = document.annotator.document().trace,
            .nearby_node = document.nearby_node(),
            .drags_node = document.drags_node,
            .is_cut = document.is_cut(),
            .previewed_voxels = has_preview ? std::optional(previewer.shown()->voxels) : std::nullopt,
            .voxels_by_group = document.annotator.document().mask.voxels_by_group(),
            .history = &document.annotator.history(),
            .undoable = document.annotator.history().undoable() + settings_to_record_,
            .redoable = document.annotator.history().redoable(),
            .is_saved = document.is_saved(),
            .is_saving = is_saving(),
            .is_saving_as = document.annotator.work().is_saving_as(),
            .has_session_file = document.has_session_file(),
            .recovered = recovered_,
            .opening = opening_name(),
            .candidate = candidate_.get(),
            .open_failure = open_failure_,
            .failed_path = &failed_path_,
            .holder = document.holder,
            .session_path = document.session_path,
            .disputes = document.annotator.work().disputes(),
            .jobs = job_states(),
            .messages = messages_,
            .keymap = keymap_,
            .preferences = preferences_,
            .recent = &recent_,
            .version = options_.version,
            .shows_help = shows_help_,
            .shows_messages = shows_messages_,
            .shows_passes = shows_passes_,
            .shows_palette = shows_palette_,
            .is_full_screen = is_full_screen_,
            .asks_what_to_open = asks_what_to_open_,
            .shows_preferences = shows_preferences_,
            .awaits_key = awaits_key_,
            .gpu_name = renderer_.device().traits().name,
            .view_is_complete = document.screen.complete(),
            .view_is_limited = renderer_.volume().state() == DeviceVolume::State::limited,
            .relevance_age_ms = document.touch.relevance_age_ms(),
            .device_bytes = renderer_.memory().device_bytes(),
            .device_budget = renderer_.memory().device_budget(),
            .bytes_by_name = shows_passes_ ? renderer_.memory().bytes_by_name() : std::map<std::string, uint64_t>(),
            .compared_passes = compared_passes_ ? &*compared_passes_ : nullptr};
}

}  // namespace shvr::ui
