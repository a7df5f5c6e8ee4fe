#pragma once
// Changes settings, applies the effects, and decides which changes become history steps; also undo and redo.

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

    /// Records pending changes as one step of the history, and writes the view to the journal.
    void advance() override;
    /// Forgets state of the previous document.
    void begin_document();
    void take_session(Session session);
    /// Updates the window's data about the trace; the annotator itself passes changes to the scene.
    void show_changes(const Command& command);
    /// Call after a change of the session that is to become a step of the history.
    void note_edit();
    /// Call after a change of view, probe and similar settings: these are written to the journal when the hand rests,
    /// and every few seconds while it moves.
    void note_to_keep();
    /// Makes a step of pending changes, so that undo reverts them separately from later steps.
    void record_settings();
    bool has_settings_to_record() const { return settings_to_record_; }
    /// Returns whether the view, the probe or similar settings changed since they were last written to the journal.
    bool has_view_to_keep() const { return to_keep_since_s_.has_value(); }
    /// While the hand is down, changes make no history step, so that a drag is one step.
    void set_hand_down(bool is_down) { is_hand_down_ = is_down; }
    /// Notes whether the stroke that just ended changed nothing; if so, the next undo only takes back that stroke.
    void note_stroke(bool is_empty);
    /// Discards changes. Files stay unchanged. The journal keeps the changes: undo restores them next time.
    void discard();
    /// Returns whether nothing was done since the work was discarded; saving is then unnecessary.
    bool is_discarded() const;
    HistoryModel model() const;

private:
    void settings_changed(const Session& before);
    void follow_view();
    void follow_settings();
    bool follows_empty_stroke();
    template <class Way>
    void step(int count, const char* done, const char* nothing, Way way);

    const Others others_;
    bool is_hand_down_ = false;
    bool settings_to_record_ = false, was_set_in_this_turn_ = false;
    std::optional<double> to_keep_since_s_;       ///< time of the oldest view change that the journal lacks; null: none
    double last_change_s_ = 0.0;                  ///< time of the last change to keep
    std::optional<Session> session_before_hand_;  ///< the session before the hand began to change settings
    /// Number of undoable steps when the work was discarded; while the number stays the same, nothing is saved.
    std::optional<size_t> discarded_steps_;
    /// Number of undoable steps when the last stroke ended without a change; undo then first takes back that stroke.
    std::optional<size_t> steps_at_empty_stroke_;
    Attempt recording_, keeping_;
};

}  // namespace shvr::ui
