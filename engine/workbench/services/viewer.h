#pragma once
// The view: cameras, cutting and clip planes, and slices. Also picks points in the picture.

#include "engine/workbench/desk/service.h"

namespace shvr::ui {

class Viewer : public Service {
public:
    /// Functions of other services that it calls.
    struct Others {
        Call<void()> note_edit;
        Call<void()> note_to_keep;
        Call<void(Session)> take_session;
    };
    Viewer(Desk& desk, Others others);
    void act(const Orbit& action);
    void act(const Roll& action);
    void act(const Move& action);
    void act(const Zoom& action);
    void act(const DragInMap& action);
    void act(const LookFrom& action);
    void act(const KeepCamera& action);
    void act(const ForgetCamera& action);
    void act(const RenameCamera& action);
    void act(const PivotAt& action);
    void act(const GoTo& action);
    void act(const MoveCut& action);
    void act(const MoveClip& action);
    void act(const PlaceClips& action);
    void act(const CutObliquely& action);
    void act(const ResetCuts& action);
    void act(const FitView& action);
    void act(const ResetView& action);
    void act(const LookAtSelection& action);
    void act(const UpdateOcclusion& action);
    void act(const Resize& action);

    void advance() override;
    /// Draws the whole picture again.
    void look_again() { look_is_stale_ = true; }
    void look_from(const Camera& camera);
    /// Returns the pane for the current camera and probe; the screen's own pane may be older within a frame.
    Pane pane(size_t index) const;
    /// Returns the visible point at a pixel of a pane, in volume space; in a slice, the point in its plane. Null: none.
    std::optional<glm::dvec3> seen_at(const Pane& pane, const glm::dvec2& pixel) const;
    /// Like seen_at(), but the point's depth along the view may differ from `depth` by at most `reach`.
    std::optional<glm::dvec3> seen_near(const Pane& pane, const glm::dvec2& pixel, double depth, double reach) const;
    /// Returns the size of the picture in pixels; 0, 0: no picture is drawn.
    const glm::uvec2& pixels() const { return pixels_; }
    /// Returns whether a picture exists that does not show the last changes yet.
    bool is_stirring() const { return pixels_.x > 0 && pixels_.y > 0 && (look_is_stale_ || camera_moved_); }
    void set_pointer(const std::optional<Pointer>& pointer) { pointer_ = pointer; }
    const std::optional<Pointer>& pointer() const { return pointer_; }
    /// Shows the box of the cutting planes for a short time; called whenever they move.
    void show_cut_box();
    bool shows_cut_box() const { return options_.now_s() < cut_shown_until_s_; }
    ViewModel model() const;

private:
    void show_slices(SliceSettings slices);
    void follow_slices();
    void follow_look();
    glm::dvec3 pivot() const;

    const Others others_;
    glm::uvec2 pixels_{0};
    bool look_is_stale_ = true, camera_moved_ = false;
    std::optional<Pointer> pointer_;
    glm::dvec3 followed_voxel_{0.0};  ///< position of the probe when the slices last followed it
    double cut_shown_until_s_ = 0.0;
    Attempt looking_;
};

}  // namespace shvr::ui
