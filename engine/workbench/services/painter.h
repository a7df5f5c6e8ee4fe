#pragma once
// Carries out strokes and their preview, and reports the state of the journal.

#include "engine/workbench/desk/preference_keeper.h"
#include "engine/workbench/desk/service.h"

namespace shvr::ui {

class Painter : public Service {
public:
    /// Functions of other services that it calls.
    struct Others {
        Call<bool()> has_settings_to_record;
        Call<void()> record_settings;
        Call<void()> note_edit;
        Call<void(bool is_empty)> note_stroke;
        Call<void()> stop_drag;
        Call<void()> add_node_here;
    };
    Painter(Desk& desk, PreferenceKeeper& keeper, Others others);
    void act(const Paint& action);
    void act(const PaintOp& op);

    void advance() override;
    /// Forgets state of the previous document.
    void begin_document()
    {
        journal_failure_.clear();
        unpreviewed_.reset();
    }
    /// Extends a stroke that is in progress to the probe's position.
    void extend_stroke();
    /// Advances until the current stroke is fully painted. Returns why part of it could not be painted; empty: all was.
    std::string finish_stroke();
    /// Waits, for a limited time, until strokes that have ended are fully painted.
    void await_strokes();
    /// Restarts the time limit after which a stroke that waits for bricks is abandoned.
    void note_progress() { stroke_progress_s_ = options_.now_s(); }
    /// Returns whether a stroke that waits for bricks has got none for so long that it should be abandoned.
    bool is_stuck() const;
    /// Returns the message about an abandoned stroke.
    static std::string why_stuck();
    /// Returns how many voxels the brush's preview showed when the last stroke began; null if no preview was shown.
    std::optional<int64_t> previewed_at_stroke() const { return previewed_at_stroke_; }
    /// Notes a failure that says that no journal can be made, so that a banner stays until a save succeeds.
    void note_trouble(const std::string& failure);
    PaintModel model() const;

private:
    void follow_stroke();
    void advance_stroke();
    bool tries_stroke(std::string& unpainted);
    void stroke_ended();
    bool paints_later() const;
    std::string how_to_reach_this() const;
    void follow_preview();

    PreferenceKeeper& keeper_;
    const Others others_;
    double stroke_progress_s_ = 0.0;  ///< time when its last brick arrived
    uint64_t stroke_uploads_ = 0;
    glm::dvec3 stroke_end_voxel_{0.0};  ///< last point of the open stroke
    std::string journal_failure_;       ///< failure last reported
    std::optional<int64_t> previewed_at_stroke_;
    std::optional<BrushSettings> unpreviewed_;  ///< brush whose preview by default has failed
    Attempt painting_, previewing_;
};

}  // namespace shvr::ui
