#pragma once
// A picture that is made part by part, so that it may be larger than the device can hold and leaves time for other work
// in between. The parts together equal a picture drawn whole, bit for bit. One thread, the renderer's.

#include "engine/look/overlay.h"
#include "engine/picture/renderer.h"

namespace shvr {

class PictureJob {
public:
    /// Fails where the host's budget cannot hold the picture.
    PictureJob(Renderer& renderer, const Session& session, const Camera& camera, const RenderOptions& options);

    bool is_done() const { return parts_.empty() && pane_ + 1 >= panes_.size(); }
    /// Draws the next part and waits for it, and for paged bricks: a part is drawn again until all bricks that its rays
    /// visit are on the device. A part that needs more bricks than there is room for is split into quarters.
    void step();
    /// The share of all pixels drawn so far.
    double progress() const { return double(drawn_pixels_) / double(uint64_t(size_.x) * size_.y); }
    /// The picture, once it is done.
    Picture take();

private:
    void begin_pane();
    void end_pane();
    std::vector<gpu::PassReport> draw(const PicturePart& part);
    void draw_completely(const PicturePart& part);
    void renew_occlusion(const Progress& progress);
    Progress progress_of(const PicturePart& part, int round);
    Scene& scene() const { return renderer_.scene(); }
    const Pane& pane() const { return panes_[pane_]; }

    Renderer& renderer_;
    Look look_;
    RenderOptions options_;
    glm::uvec2 size_;
    OverlayScene overlay_;
    std::vector<Pane> panes_;
    size_t pane_ = 0;
    std::vector<PicturePart> parts_;  ///< parts of the pane still to be drawn, the next one last
    Picture picture_;
    uint64_t drawn_pixels_ = 0;
    double told_ = 0.0;  ///< share, which never falls
};

}  // namespace shvr
