#include "engine/workbench/services/settings_editor.h"

#include <algorithm>

#include "engine/session/session_patch.h"
#include "engine/workbench/actions/action_rows.h"
#include "engine/workbench/desk/declined.h"
#include "engine/workbench/edits/edit.h"
#include "engine/workbench/edits/group_steps.h"
#include "engine/workbench/sight/words.h"
#include "engine/workbench/words/settings_words.h"

namespace shvr::ui {

namespace {

IntensityWords intensity_words(const Document& document)
{
    return {document.volume().type, document.statistics.range()};
}

/// Returns whether both sessions give the same picture of the volume. Other settings may differ.
bool look_the_same(Session before, const Session& after)
{
    before.probe = after.probe;  // drawn separately over the picture, like measurements
    before.measurements = after.measurements;
    if (!shows_occlusion(before.light) && !shows_occlusion(after.light)) before.light.occlusion = after.light.occlusion;
    return before == after;
}

/// Returns the user's or the program's transfer function of that name; fails with the program's names.
TransferPreset preset_named(const std::vector<TransferPreset>& presets, const std::string& name)
{
    const auto found = std::ranges::find(presets, name, &TransferPreset::name);
    return found == presets.end() ? transfer_preset_named(name) : *found;
}

}  // namespace

SettingsEditor::SettingsEditor(Desk& desk, Others others) : Service(desk), others_(std::move(others)) {}

void SettingsEditor::advance()
{
    attempt(recording_, [this] { follow_settings(); });
    attempt(keeping_, [this] { follow_view(); });
}

void SettingsEditor::begin_document()
{
    settings_to_record_ = was_set_in_this_turn_ = false;
    discarded_steps_.reset();
    steps_at_empty_stroke_.reset();
    to_keep_since_s_.reset();
    end_drag();
}

void SettingsEditor::act(const Set& action)
{
    if (action.patch.empty()) return log_instead({Set{"{}"}});  // a key for what is so already
    Session after = patched(document_->session, action.patch);
    if (!after.transfer_preset.empty()) {
        const TransferPreset preset = preset_named(desk_.model().presets, std::exchange(after.transfer_preset, {}));
        after.transfer_function = transfer_function_of(preset, document_->statistics);
        const std::string patch = patch_between(document_->session, after);
        // A log can be replayed on a machine without this preset.
        if (preset.is_own) log_instead({Set{patch.empty() ? "{}" : patch}});
    }
    document_->choose_thresholds(after);
    document_->choose_for_volume(after);
    const Session before = document_->session;
    take_session(std::move(after));
    if (is_hand_down_ && !session_before_hand_) session_before_hand_ = before;
    const Session& since = session_before_hand_ ? *session_before_hand_ : before;
    say_change(change_since(since));
    for (std::string& removed : removed_keys_in(session_document(action.patch, "settings"), "settings"))
        say(std::move(removed), Weight::warning);
}

/// A transfer function that a preset gives is said by the preset's name, however it was chosen.
std::string SettingsEditor::change_since(const Session& before) const
{
    const TransferFunction& function = document_->session.transfer_function;
    if (!(before.transfer_function == function)) {
        const VolumeStatistics& statistics = document_->statistics;
        const Model now = desk_.model();
        for (const TransferPreset& preset : now.presets)
            if (transfer_function_of(preset, statistics) == function) return "Transfer function: " + preset.name;
        if (automatic_transfer_function(statistics) == function) return "Transfer function: from the histogram";
    }
    return change_in_words(before, document_->session, intensity_words(*document_));
}

/// Says what changed. A drag has one message, which follows it, as it has one step of the history.
void SettingsEditor::say_change(std::string said)
{
    if (!session_before_hand_) {
        if (!said.empty()) say(std::move(said));
        return;
    }
    if (said.empty() && drag_message_ == 0) return;
    if (said.empty()) said = "Everything is as it was";
    drag_message_ = desk_.messages.amend(drag_message_, options_.now_s(), std::move(said));
}

void SettingsEditor::end_drag()
{
    session_before_hand_.reset();
    drag_message_ = 0;
}

void SettingsEditor::act(const NewGroup&)
{
    const uint8_t next = unused_group(desk_.model());
    if (next == 0) fail("all 255 groups are in use; expected an unused one");
    act(edited(document_->session, [&](Session& s) {
        s.groups[next].name = group_of(s.groups, next).name;
        s.probe.brush.group = next;
    }));
}

void SettingsEditor::act(const EndStep&)
{
    record_settings();
}

void SettingsEditor::act(const AutoContrast&)
{
    const ValueRange contrast = automatic_contrast(document_->statistics);
    Session after = document_->session;
    after.view.slices.black = contrast.lower;
    after.view.slices.white = contrast.upper;
    take_session(std::move(after));
    const IntensityWords intensity = intensity_words(*document_);
    say(sentence("Slices: black at ", intensity(contrast.lower), ", white at ", intensity(contrast.upper)));
}

void SettingsEditor::act(const TakePreset& action)
{
    Session after = document_->session;
    const TransferPreset preset = read_transfer_preset(action.path);
    after.transfer_function = transfer_function_of(preset, document_->statistics);
    take_session(std::move(after));
    say("Transfer function: " + preset.name);
}

/// Keeps the path that was begun when another tool or kind of measurement is chosen.
void SettingsEditor::keep_begun_path(Session& after)
{
    Document& document = *document_;
    const ProbeSettings &was = document.session.probe, &is = after.probe;
    if (was.tool == is.tool && was.measure == is.measure) return;
    std::vector<glm::dvec3> points = std::exchange(document.measuring, {});
    std::vector<Measurement>& all = after.measurements;
    if (was.measure == MeasureKind::path && points.size() >= 2 && all.size() < MAX_MEASUREMENTS) {
        all.push_back({std::move(points), MeasureKind::path, unused_name(all, MeasureKind::path)});
        say(sentence(all.back().name, ": ", value_in_words(all.back(), document.volume())));
    } else if (!points.empty()) {
        say(sentence("The ", spelled(was.measure), " that was begun is dropped"));
    }
}

void SettingsEditor::take_session(Session session)
{
    Document& document = *document_;
    std::vector<glm::dvec3> begun = document.measuring;
    keep_begun_path(session);
    Session before = std::exchange(document.session, std::move(session));
    const Session& after = document.session;
    try {
        settings_changed(before);
    } catch (...) {
        document.session = before;
        document.measuring = std::move(begun);
        throw;
    }
    note_edit();
    if (!look_the_same(std::move(before), after)) others_.look_again();
}

/// Updates the drag and settings after changes of trace or settings; the annotator passes changes on to the scene.
void SettingsEditor::show_changes(const Command& command)
{
    Document& document = *document_;
    const bool is_traced = std::ranges::any_of(
        command.changes, [](const Change& change) { return std::holds_alternative<TraceChange>(change); });
    if (is_traced) document.drags_node = false;
    const bool is_set = std::ranges::any_of(
        command.changes, [](const Change& change) { return std::holds_alternative<SettingChange>(change); });
    if (!is_set) return;
    const Session before = document.session;
    document.take_settings();
    if (!look_the_same(before, document.session)) others_.look_again();
}

/// Applies the effects of changed settings, except that the picture is not drawn again.
void SettingsEditor::settings_changed(const Session& before)
{
    Document& document = *document_;
    const Session& after = document.session;
    if (before.render.sampling != after.render.sampling || before.render.paging != after.render.paging) {
        others_.reload(before.render);
    } else if (before.groups != after.groups) {
        renderer_.scene().show_surfaces(document.surfaces, document.annotator.document().trace, after.groups);
    }
    if (before.cut.lower != after.cut.lower || before.cut.upper != after.cut.upper) others_.show_cut_box();
    if (before.probe.tool != after.probe.tool) {
        if (document.annotator.stroke_is_open()) document.annotator.end_stroke();
        if (document.drags_node) others_.stop_drag();
    }
}

/// Requests that view, probe etc. are written to the journal: once they stop changing, or every few seconds until then.
void SettingsEditor::note_to_keep()
{
    last_change_s_ = options_.now_s();
    if (!to_keep_since_s_) to_keep_since_s_ = last_change_s_;
}

void SettingsEditor::follow_view()
{
    constexpr double REST_S = 0.2, MAX_UNKEPT_S = 5.0;
    const double now = options_.now_s();
    if (!to_keep_since_s_ || (now - last_change_s_ < REST_S && now - *to_keep_since_s_ < MAX_UNKEPT_S)) return;
    to_keep_since_s_.reset();
    document_->keep_settings();
}

void SettingsEditor::note_edit()
{
    note_to_keep();
    document_->note_edit();
    settings_to_record_ = was_set_in_this_turn_ = true;
}

/// Makes changed settings a history step, unless the user is holding a control: a whole drag thus becomes one step.
void SettingsEditor::follow_settings()
{
    const bool is_being_set = std::exchange(was_set_in_this_turn_, false) || is_hand_down_;
    if (!is_hand_down_) end_drag();
    if (!settings_to_record_ || is_being_set) return;
    record_settings();
}

/// Makes changed settings a history step now, so that undo reverts them separately from later changes.
void SettingsEditor::record_settings(const std::string& label)
{
    if (document_->annotator.stroke_is_running() || document_->annotator.work().is_saving_as()) return;
    settings_to_record_ = false;
    end_drag();
    if (document_->record_settings(label) && log_) log_(line_of(EndStep{}));
}

// ---- The history ----------------------------------------------------------------------------------------------------

template <class Way>
void SettingsEditor::step(int count, const char* done, const char* nothing, Way way)
{
    record_settings();
    std::string last;
    int steps = 0;
    for (; steps < count; ++steps) {
        const Command* const command = way(document_->annotator);
        if (!command) break;
        show_changes(*command);
        last = command->label;
    }
    if (steps == 0 && document_->annotator.stroke_is_running()) decline("A stroke is being painted");
    if (steps == 0) return say(nothing);
    say(steps == 1 ? sentence(done, ": ", last) : sentence(done, ": ", steps, " steps, the last: ", last));
}

/// Returns whether undo must do nothing because the last stroke changed nothing and so added no step: undo would revert
/// an earlier step. Returns true only once after such a stroke, and never in scripts, which count steps.
bool SettingsEditor::follows_empty_stroke()
{
    record_settings();
    const size_t steps = document_->annotator.history().undoable();
    return std::exchange(steps_at_empty_stroke_, {}) == steps && steps > 0 && !document_->is_script();
}

void SettingsEditor::note_stroke(bool is_empty)
{
    if (is_empty)
        steps_at_empty_stroke_ = document_->annotator.history().undoable();
    else
        steps_at_empty_stroke_.reset();
}

void SettingsEditor::act(const UndoOp& action)
{
    if (follows_empty_stroke() && action.count == 1) {
        const History& history = document_->annotator.history();
        say(sentence("The last stroke changed nothing, and nothing is undone; the next undo reverts: ",
                     history.label_of(history.undoable() - 1)));
        return log_instead({Set{"{}"}});
    }
    step(action.count, "Undone", "Nothing to undo", [](Annotator& annotator) { return annotator.undo(); });
}

void SettingsEditor::act(const RedoOp& action)
{
    steps_at_empty_stroke_.reset();
    step(action.count, "Redone", "Nothing to redo", [](Annotator& annotator) { return annotator.redo(); });
}

void SettingsEditor::act(const RevertOp&)
{
    record_settings();
    const Command* const command = document_->annotator.revert();
    if (!command && document_->annotator.stroke_is_running()) fail("A stroke is being painted");
    if (!command) return say("Nothing has changed since the last save");
    show_changes(*command);
    say("Reverted to the last save; undo takes that back");
}

void SettingsEditor::act(const ChooseBelief& action)
{
    std::string said;
    for (const Notice& notice : document_->annotator.choose(action.takes_files ? Belief::files : Belief::journal))
        said += (said.empty() ? "" : "; ") + notice.text;
    document_->drags_node = false;
    others_.look_again();
    say(said);
}

/// Discards unsaved changes without touching files. The journal keeps the changes, so that undo can restore them later.
void SettingsEditor::discard()
{
    if (!document_ || document_->only_looks() || !document_->annotator.work().disputes().empty()) return;
    static_cast<void>(others_.finish_stroke());  // which is discarded
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

bool SettingsEditor::is_discarded() const
{
    return discarded_steps_ == document_->annotator.history().undoable() && !settings_to_record_;
}

HistoryModel SettingsEditor::model() const
{
    if (!document_) return {};
    const History& history = document_->annotator.history();
    return {.history = &history, .undoable = history.undoable() + settings_to_record_, .redoable = history.redoable()};
}

}  // namespace shvr::ui
