#pragma once
// Settings: how they change, what follows from it, and which of it becomes a step of the history; undo and redo.

#include "engine/workbench/desk/service.h"

namespace shvr::ui {

class Painter;
class Reloader;
struct Services;
class Tracer;
class Viewer;

class SettingsEditor : public Service {
public:
    explicit SettingsEditor(Services& all);
    void act(const Set& action);
    void act(const NewGroup& action);
    void act(const EndStep& action);
    void act(const AutoContrast& action);
    void act(const TakePreset& action);
    void act(const UndoOp& action);
    void act(const RedoOp& action);
    void act(const RevertOp& action);
    void act(const ChooseBelief& action);

    /// Makes a step of the history of what was set, and keeps the view in the journal.
    void advance() override;
    /// Forgets what was of the document before.
    void begin_document();
    void take_session(Session session);
    /// Updates the window's data about the trace; the annotator passes changes to the scene itself.
    void show_changes(const Command& command);
    /// Call after a change of the session that is a step of the history.
    void note_edit();
    /// Call after a change of view, probe and the like: they go into the journal when the hand rests, and every few
    /// seconds while it does not.
    void note_to_keep();
    /// Makes a step of what was set: of what follows, undo is to take back that first.
    void record_settings();
    bool has_settings_to_record() const { return settings_to_record_; }
    /// While a hand is setting something no step of the history is made of it: one drag is one step.
    void set_hand_down(bool is_down) { is_hand_down_ = is_down; }
    /// Whether the stroke that ended now changed nothing: undo takes that back first.
    void note_stroke(bool is_empty);
    /// Files stay as they are. The journal keeps what was done since: undo brings it back next time.
    void discard();
    /// Nothing was done since the work was discarded: nothing is to be saved.
    bool is_discarded() const;
    HistoryModel model() const;

private:
    void settings_changed(const Session& before);
    void follow_view();
    void follow_settings();
    bool follows_empty_stroke();
    template <class Way>
    void step(int count, const char* done, const char* nothing, Way way);

    Viewer& viewer_;
    Tracer& tracer_;
    Painter& painter_;
    Reloader& reloader_;
    bool is_hand_down_ = false;
    bool settings_to_record_ = false, was_set_in_this_turn_ = false;
    std::optional<double> to_keep_since_s_;       ///< since when the journal does not hold the view as it is
    double last_change_s_ = 0.0;                  ///< time of the last change to be kept
    std::optional<Session> session_before_hand_;  ///< as it was before the hand began to set something
    /// Steps that could be undone when the work was discarded: as long as nothing else is done, nothing is saved.
    std::optional<size_t> discarded_steps_;
    /// Steps that could be undone when the last stroke ended that changed nothing: undo takes that back first.
    std::optional<size_t> steps_at_empty_stroke_;
    Attempt recording_, keeping_;
};

}  // namespace shvr::ui
