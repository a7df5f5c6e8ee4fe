#pragma once
// Changes settings, applies the effects, and decides which changes become history steps. Carries out undo and redo.

#include "engine/workbench/desk/service.h"

namespace shvr::ui {

class SettingsEditor : public Service {
public:
    /// Functions of other services that it calls.
    struct Others {
        Call<void()> look_again;
        Call<void()> show_cut_box;
        Call<void()> stop_drag;
        Call<std::string()> finish_stroke;
        Call<void(const RenderSettings& before)> reload;
    };
    SettingsEditor(Desk& desk, Others others);
    void act(const Set& action);
    void act(const NewGroup& action);
    void act(const EndStep& action);
    void act(const AutoContrast& action);
    void act(const TakePreset& action);
    void act(const UndoOp& action);
    void act(const RedoOp& action);
    void act(const RevertOp& action);
    void act(const ChooseBelief& action);

    /// Makes pending changes one step of the history, and writes the view to the journal.
    void advance() override;
    /// Forgets state of the previous document.
    void begin_document();
    void take_session(Session session);
    /// Updates the drag and settings after changes of trace or settings; the annotator passes changes to the scene.
    void show_changes(const Command& command);
    /// Call this after changing those settings of the session that the history records.
    void note_edit();
    /// Call this after changing the view, the probe or similar settings. They are written to the journal when they come
    /// to rest, and every few seconds while they keep changing.
    void note_to_keep();
    /// Makes pending changes a history step, so that undo reverts them separately from later changes.
    /// `label`: what the step is called, for example "applied the look mine"; empty: what differs.
    void record_settings(const std::string& label = {});
    bool has_settings_to_record() const { return settings_to_record_; }
    /// Returns whether the view, the probe or similar settings changed since they were last written to the journal.
    bool has_view_to_keep() const { return to_keep_since_s_.has_value(); }
    /// Sets whether the user holds a control. Until released, changes make no history step: a drag becomes one step.
    void set_hand_down(bool is_down) { is_hand_down_ = is_down; }
    /// Notes that a stroke has ended. If it changed nothing (`is_empty`), the next undo only reports that.
    void note_stroke(bool is_empty);
    /// Discards unsaved changes without touching files. The journal keeps the changes, so that undo can restore them.
    void discard();
    /// Returns whether the work was discarded and nothing was done since, so that nothing needs saving.
    bool is_discarded() const;
    HistoryModel model() const;

private:
    void keep_begun_path(Session& after);
    std::string change_since(const Session& before) const;
    void say_change(std::string said);
    void end_drag();
    void settings_changed(const Session& before);
    void follow_view();
    void follow_settings();
    bool follows_empty_stroke();
    template <class Way>
    void step(int count, const char* done, const char* nothing, Way way);

    const Others others_;
    bool is_hand_down_ = false;
    bool settings_to_record_ = false, was_set_in_this_turn_ = false;
    std::optional<double> to_keep_since_s_;       ///< time of the oldest view change not in the journal; null: none
    double last_change_s_ = 0.0;                  ///< time of the last change to be written to the journal
    std::optional<Session> session_before_hand_;  ///< the session before the user began to drag a control
    uint64_t drag_message_ = 0;                   ///< number of the message about that drag; 0: none
    /// Number of undoable steps just after the work was discarded. While this number is unchanged, nothing is saved.
    std::optional<size_t> discarded_steps_;
    /// Number of undoable steps after a stroke that changed nothing; while it is unchanged, undo reverts no step.
    std::optional<size_t> steps_at_empty_stroke_;
    Attempt recording_, keeping_;
};

}  // namespace shvr::ui
