#pragma once
// Strokes: how they begin, go on with the probe and end; the preview of the brush; the state of the journal.

#include "engine/workbench/desk/service.h"

namespace shvr::ui {

class PreferenceKeeper;
struct Services;
class SettingsEditor;
class Tracer;

class Painter : public Service {
public:
    explicit Painter(Services& all);
    void act(const Paint& action);
    void act(const PaintOp& op);

    void advance() override;
    /// Forgets what was of the document before.
    void begin_document() { journal_failure_.clear(); }
    /// An open stroke goes to where the probe is.
    void extend_stroke();
    /// Turns until a running stroke is painted. Returns why part of it was not; empty if all was.
    std::string finish_stroke();
    /// Waits for strokes that the hand has ended.
    void await_strokes();
    /// Its bricks are waited for from now on.
    void note_progress() { stroke_progress_s_ = options_.now_s(); }
    /// None of its bricks came for so long that it is given up.
    bool is_stuck() const;
    /// What is said of a stroke that was.
    static std::string why_stuck();
    /// Voxels that the preview showed when the last stroke began, if it had one.
    std::optional<int64_t> previewed_at_stroke() const { return previewed_at_stroke_; }
    PaintModel model() const;

private:
    void follow_stroke();
    void advance_stroke();
    bool tries_stroke(std::string& unpainted);
    void stroke_ended();
    std::string how_to_reach_this() const;
    void follow_preview();

    SettingsEditor& settings_;
    Tracer& tracer_;
    PreferenceKeeper& keeper_;
    double stroke_progress_s_ = 0.0;  ///< when the last of its bricks came
    uint64_t stroke_uploads_ = 0;
    glm::dvec3 stroke_end_voxel_{0.0};  ///< where an open stroke was extended to
    std::string journal_failure_;       ///< as last reported
    std::optional<int64_t> previewed_at_stroke_;
    Attempt painting_, previewing_;
};

}  // namespace shvr::ui
