#pragma once
// A picture that is made part by part and handed on in bands of rows, so that it may be larger than device and host can
// hold, and leaves time for other work in between. The parts together equal a picture drawn whole, bit for bit. One
// thread, the renderer's.
//
//   picture -> bands of rows, as high as the host has room for -> panes that a band meets -> parts, as large as the
//   device has room for -> quarters, where a part needs more bricks than there is room for -> small ones in rounds:
//   their rays wait before bricks that are not there, and go on when those are (engine/passes/raycast.h)

#include <functional>

#include "engine/look/overlay.h"
#include "engine/picture/renderer.h"

namespace shvr {

class PictureJob {
public:
    /// Takes the next rows from the top, as wide as the picture.
    using TakeRows = std::function<void(ImageF rows)>;
    PictureJob(Renderer& renderer, const Session& session, const Camera& camera, const RenderOptions& options,
               TakeRows take_rows);
    ~PictureJob();
    PictureJob(const PictureJob&) = delete;
    PictureJob& operator=(const PictureJob&) = delete;

    bool is_done() const { return parts_.empty() && !rounds_ && band_end_ == size_.y; }
    /// Draws the next part. Of a paged volume waits for it, and for bricks: a part is drawn again until all bricks that
    /// its rays visit are on the device. A part that needs more bricks than there is room for is split into quarters,
    /// or drawn by rays that wait for them. Where nothing is paged, and a GPU draws, waits for the part before, so that
    /// the device has work while that one's pixels are taken. Hands on the rows of a band that is done.
    ///
    /// `waits` false: for no brick that is read; the next step goes on with the part, and others may look at the volume
    /// and draw meanwhile.
    void step(bool waits = true);
    /// The last step left a part whose bricks are still to come, or their light.
    bool is_waiting() const { return rounds_.has_value(); }
    /// The share of all pixels drawn so far.
    double progress() const { return double(drawn_pixels_) / double(uint64_t(size_.x) * size_.y); }
    /// Whether nothing is missing from what is drawn so far.
    bool is_complete() const { return picture_.complete && !scene().occlusion_has_no_room() && rays_cut_short_ == 0; }
    /// All but the image. Call it once no step follows.
    Picture take();

private:
    void begin_parts();
    void begin_band();
    void end_band();
    uint32_t part_side();
    /// A part that the device is drawing.
    struct UnderWay {
        PicturePart part;
        glm::uvec2 origin;  ///< in the picture
        uint32_t pixels;    ///< the read-back
        DeviceVolume::Feedback feedback;
        gpu::Submission submission;
    };
    UnderWay begin(const PicturePart& part, WaitingRays* waiting = nullptr);
    std::vector<gpu::PassReport> take(UnderWay part);
    std::vector<gpu::PassReport> draw(const PicturePart& part, WaitingRays* waiting = nullptr);
    void draw_ahead(const PicturePart& part);
    void catch_up();
    bool draw_completely(const PicturePart& part, bool waits);
    bool draw_rounds(bool waits);
    bool has_given_way(const PicturePart& part, const std::string& why);
    void begin_waiting();
    bool draw_waiting(bool waits);
    void note_limited();
    void finish(const PicturePart& part, std::vector<gpu::PassReport> passes);
    bool load(const Progress& progress, bool waits);
    bool load_around(const Progress& progress, bool waits);
    bool renew_occlusion(const Progress& progress, bool waits);
    Progress progress_of(const PicturePart& part, int round);
    Scene& scene() const { return renderer_.scene(); }
    const Pane& pane() const { return panes_[pane_]; }

    Renderer& renderer_;
    Look look_;
    RenderOptions options_;
    TakeRows take_rows_;
    glm::uvec2 size_;
    std::optional<VoxelBox> always_shown_;
    OverlayScene overlay_;
    std::vector<Pane> panes_;
    uint32_t band_rows_ = 1;
    uint32_t band_begin_ = 0, band_end_ = 0;  ///< rows of the picture
    ImageF band_;
    size_t pane_ = 0;
    std::vector<PicturePart> parts_;  ///< of the pane within the band, still to be drawn, the next one last
    /// A part that is drawn until no brick is missing.
    struct Rounds {
        PicturePart part;
        int round = 0;          ///< of which its light is renewed, it is drawn, and its bricks are loaded
        bool is_drawn = false;  ///< in this round
        std::vector<gpu::PassReport> passes{};
        /// Where its rays wait for bricks, or for their light as well.
        std::optional<WaitingRays> rays{};
        bool waits_for_light = false;
    };
    std::optional<Rounds> rounds_;         ///< begun by draw_completely
    std::optional<UnderWay> under_way_;    ///< begun by draw_ahead
    std::optional<double> last_taken_ms_;  ///< of a clock that does not go back
    Picture picture_;
    uint64_t drawn_pixels_ = 0;
    uint64_t rays_cut_short_ = 0;
    double told_ = 0.0;  ///< share, which never falls
};

}  // namespace shvr
