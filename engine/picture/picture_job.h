#pragma once
// Renders a picture part by part and delivers it in bands of rows, so that it may exceed the memory of device and host,
// and other work can run between parts. The parts together equal, bit for bit, the picture drawn whole. One thread, the
// renderer's.
//
//   picture -> bands of rows, as high as host memory allows -> panes that a band meets -> parts, as large as device
//   memory allows -> quarters, if a part needs more bricks than fit -> small parts in rounds: their rays wait at
//   missing bricks, and resume when those have arrived (engine/passes/raycast.h)

#include <algorithm>
#include <functional>
#include <optional>

#include "engine/look/overlay.h"
#include "engine/picture/renderer.h"

namespace shvr {

/// Rows [lower, upper) of a picture; without an upper row, all that follow.
struct RowRange {
    uint32_t lower = 0;
    std::optional<uint32_t> upper{};
};

class PictureJob {
public:
    /// Receives the next rows from the top, as wide as the picture.
    using TakeRows = std::function<void(ImageF rows)>;
    PictureJob(Renderer& renderer, const Session& session, const Camera& camera, const RenderOptions& options,
               TakeRows take_rows, const RowRange& rows = {});
    ~PictureJob();
    PictureJob(const PictureJob&) = delete;
    PictureJob& operator=(const PictureJob&) = delete;

    bool is_done() const { return parts_.empty() && !rounds_ && band_end_ == rows_end_; }
    /// Draws the next part. For a paged volume, waits for the part and for bricks: a part is drawn again until all
    /// bricks that its rays visit are on the device. A part that needs more bricks than fit is split into quarters, or
    /// drawn by rays that wait for bricks. For a resident volume on a GPU, waits only for the previous part, so that
    /// the device stays busy while the previous part's pixels are copied. Delivers the rows of each finished band.
    ///
    /// If `waits` is false, does not wait for bricks that are being read, and computes one slice of ambient light: the
    /// next step continues the same part; other callers may set the volume's view and draw in between.
    void step(bool waits = true);
    /// Whether the last step left a part unfinished, because its bricks or its ambient light are not available yet.
    bool is_waiting() const { return rounds_.has_value(); }
    /// The fraction of these rows' pixels drawn so far.
    double progress() const { return double(drawn_pixels_) / double(std::max<uint64_t>(pixels(), 1)); }
    /// Whether all parts drawn so far are complete (Picture::complete).
    bool is_complete() const { return picture_.complete && !scene().occlusion_has_no_room() && rays_cut_short_ == 0; }
    /// Returns the picture without its image, whose rows were delivered. Call it after the last step.
    Picture take();

private:
    void begin_parts();
    void begin_band();
    void end_band();
    uint32_t part_side();
    /// A part that the device is drawing.
    struct UnderWay {
        PicturePart part;
        glm::uvec2 origin;  ///< its first pixel in the picture
        uint32_t pixels;    ///< index of the read-back
        DeviceVolume::Feedback feedback;
        gpu::Submission submission;
    };
    UnderWay begin(const PicturePart& part, WaitingRays* waiting = nullptr);
    std::vector<gpu::PassReport> take(UnderWay part);
    std::vector<gpu::PassReport> draw(const PicturePart& part, WaitingRays* waiting = nullptr);
    bool draw_ahead(const PicturePart& part, bool waits);
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
    /// Number of pixels in the rows to draw.
    uint64_t pixels() const { return uint64_t(size_.x) * (rows_end_ - rows_begin_); }
    const Pane& pane() const { return panes_[pane_]; }

    Renderer& renderer_;
    Look look_;
    RenderOptions options_;
    TakeRows take_rows_;
    glm::uvec2 size_;
    std::optional<VoxelBox> always_shown_;
    OverlayScene overlay_;
    std::vector<Pane> panes_;
    uint32_t rows_begin_ = 0, rows_end_ = 0;  ///< rows of the picture to draw
    uint32_t band_rows_ = 1;
    uint32_t band_begin_ = 0, band_end_ = 0;  ///< rows of the picture
    ImageF band_;
    size_t pane_ = 0;
    std::vector<PicturePart> parts_;  ///< undrawn parts of this pane and band; the next one to draw comes last
    /// A part that is drawn repeatedly, until no brick is missing.
    struct Rounds {
        PicturePart part;
        int round = 0;          ///< each round updates the part's ambient light, draws the part, and loads bricks
        bool is_drawn = false;  ///< whether the part was already drawn in this round
        std::vector<gpu::PassReport> passes{};
        /// State of the rays that wait for bricks and, if `waits_for_light`, also for the ambient light of bricks.
        std::optional<WaitingRays> rays{};
        bool waits_for_light = false;
    };
    std::optional<Rounds> rounds_;         ///< begun by draw_completely
    std::optional<UnderWay> under_way_;    ///< begun by draw_ahead
    std::optional<double> last_taken_ms_;  ///< time on a monotonic clock
    Picture picture_;
    uint64_t drawn_pixels_ = 0;
    uint64_t rays_cut_short_ = 0;
    double told_ = 0.0;  ///< progress last reported, which never decreases
};

}  // namespace shvr
