#pragma once
// The interactive picture: a list of panes, each with a View. The panes take turns in using the device.
//
// Sketches come first, pane by pane, so that the whole screen follows the user; then the panes are drawn sharp, in
// order. Panes share the volume, the paint and the ambient occlusion. Used only by the renderer's thread. A call waits
// for the device only if its comment says so.

#include <memory>

#include "engine/live/trace_marks.h"
#include "engine/live/view.h"
#include "engine/look/overlay.h"

namespace shvr {

class Screen {
public:
    Screen(Renderer& renderer, const View::Options& options) : renderer_(renderer), options_(options) {}

    /// Sets the displayed content and redraws everything. Call it only if something has changed.
    void look(const Session& session, const Camera& camera, const glm::uvec2& pixels, const glm::dvec3& probe_voxel);
    /// Moves the camera or the probe in the same session; redraws only the panes that change.
    void look_from(const Camera& camera, const glm::dvec3& probe_voxel);
    /// Sets the point that slices go through (SliceSettings::cross); redraws only the slices that change.
    void go_through(const std::optional<glm::dvec3>& cross);
    /// Sets the probe; slices without a point of their own follow it.
    void show_probe(const ProbeLook& probe);
    void update_occlusion();

    void advance();
    /// Submits due work for another `ahead_ms` of device time, so that the device stays busy while this thread waits
    /// that long for something else.
    void submit_ahead(double ahead_ms);
    /// While held, up-to-date panes are not made sharper: that would request bricks for these panes, and displace
    /// bricks that another picture waits for. The hold ends when a pane has to follow the user, or shows an edit.
    void hold(bool is_held) { is_held_ = is_held; }
    bool is_held() const { return is_held_; }
    void wait();
    /// Frees all panes and their device memory; look() creates new panes.
    void clear();
    /// Like clear(), for a lost device: does not wait.
    void drop();
    bool complete() const;

    struct Part {
        Pane pane;
        std::unique_ptr<View> view;
    };
    /// The panes; the first shows the camera's view.
    const std::vector<Part>& parts() const { return parts_; }
    /// Returns the lines over a pane, in pane pixels. `shows_cut_box`: draws the cut box even if the session hides it.
    std::vector<Stroke> strokes(const Part& part, const ProbeLook& probe, const TraceMarks& marks = {},
                                bool shows_cut_box = false) const;
    /// Whether the first pane has a picture to show.
    bool shows_anything() const { return !parts_.empty() && parts_[0].view->shown_camera() != nullptr; }

    /// Returns the picture as shown, including the lines over maps and slices but not the probe's lines. Waits for the
    /// device.
    Image8 read_back();

    // Of all panes together
    std::vector<View::Layer> layers() const;
    uint64_t revision() const;
    uint64_t submissions() const;
    std::vector<View::PassTime> pass_times() const;

private:
    void arrange(bool look_changed);
    void retire_beyond(size_t panes);
    void take_changed();
    void give_turn(size_t part);
    bool is_loading() const;
    std::optional<OverlayScene::Box> cut_box(bool is_wanted) const;
    std::optional<glm::dvec3> cross() const;

    Renderer& renderer_;
    View::Options options_;
    Look look_;
    ViewSettings view_;
    CutBox cut_;
    InteractionSettings interaction_;
    Camera camera_;
    glm::uvec2 pixels_{0};
    glm::dvec3 probe_voxel_{0.0};
    std::vector<Part> parts_;
    size_t turn_ = 0;  ///< index of the pane for which bricks are being loaded
    bool is_held_ = false;
    uint64_t retired_submissions_ = 0, retired_revisions_ = 0;  ///< submissions and revisions of removed panes
};

}  // namespace shvr
