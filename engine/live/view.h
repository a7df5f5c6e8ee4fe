#pragma once
// An interactive picture: coarse at once, then sharp, tile by tile, nearest to the probe first.
//
//   look changed      the view's bricks are listed in the background; if the camera is faster than this listing,
//                     the picture follows at the pace of the listing;
//                     then a sketch of the whole picture, at a scale that takes about `motion_ms` and is at most the
//                     session's `interaction.resolution`                                     -> shown when complete
//   probe moved       a sketch of the pixels that its ball may cover, over everything else   -> shown when complete
//   nothing moves     a finer sketch of the whole picture, if it is a small part of the work;
//                     then sharp tiles, until the picture equals that of `Renderer::render` bit for bit. They are shown
//                     in batches that cover a large part of the picture, so that no seam runs through it
//   voxels changed    the tiles that show these voxels are drawn again
//   occlusion due     ambient occlusion, nearest bricks first, before the sharp tiles that show it
//
// Everything is drawn in small graphs of about `step_ms` each, with about `in_flight_ms` of them in flight at most, so
// that a user interface, a brush or a relevance pass on the same queue waits at most that long. Nothing is submitted
// while nothing changes. Used only by the renderer's thread. A call waits for the device only if its comment says so.

#include <array>
#include <chrono>
#include <deque>
#include <memory>

#include "engine/live/pace.h"
#include "engine/look/camera_motion.h"
#include "engine/picture/renderer.h"
#include "shaders/encode.h"

namespace shvr {

class View {
public:
    static constexpr uint32_t TILE = 32;  ///< pixels a side

    struct Options {
        double step_ms = 2.0;        ///< device time of one graph
        double in_flight_ms = 3.5;   ///< total device time of the graphs in flight
        double motion_ms = 40.0;     ///< device time of a sketch of the whole picture
        double probe_ms = 20.0;      ///< device time of a sketch of the pixels that the probe covers
        double moment_ms = 300.0;    ///< sharp tiles that take less than this in total are shown all at once
        bool swap_red_blue = false;  ///< swaps red and blue in the shown images
    };
    View(Renderer& renderer, const Options& options) : renderer_(renderer), options_(options) {}
    explicit View(Renderer& renderer) : View(renderer, Options{}) {}

    /// Sets the displayed content and redraws everything. Call it only if something has changed.
    void look(const Look& look, const InteractionSettings& interaction, const Shot& shot, const glm::uvec2& pixels);
    void look(const Session& session, const Shot& shot, const glm::uvec2& pixels)
    {
        look(session.look(), session.interaction, shot, pixels);
    }
    void show_probe(const std::optional<ProbeLook>& probe);
    /// Reports that the user has changed these voxels.
    void changed(const VoxelBox& voxels);
    /// Reports that finer paged bricks of these voxels have arrived. While more bricks arrive, tiles that were drawn
    /// without them are redrawn a few times a second.
    void bricks_arrived(const VoxelBox& voxels);
    /// Reports that the ambient occlusion of these voxels has changed.
    void light_changed(const VoxelBox& voxels);

    /// Updates ambient occlusion once, even if the session has disabled automatic updates.
    void update_occlusion() { occlusion_is_asked_for_ = true; }

    /// Collects finished submissions and loaded bricks, then submits the next work.
    void advance();
    // The steps of advance(), for owners of several views. Such an owner reports the scene's changes to its views.
    void collect() { reap(); }
    // `ahead_ms`: device time allowed in flight in addition to `in_flight_ms`, while the caller cannot poll.
    void submit_sketches(double ahead_ms = 0.0);  ///< submits only the work that is_sketched() requires
    void submit_due(double ahead_ms = 0.0);
    /// Whether the requested sight is shown in the whole picture, even if coarsely.
    bool is_sketched() const { return sight_ == shown_sight_ && !base_.job && !patch_.job && !patch_is_due(); }
    /// Whether the picture has yet to follow the user: the sight or the probe. Bricks and light do not matter.
    bool lags() const
    {
        return sight_ != shown_sight_ || base_.job || patch_.job || patch_.shown.sight != shown_sight_ ||
               patch_.shown.probe != probe_;
    }
    /// Whether no work is due or in flight. Bricks may still arrive.
    bool is_finished() const;
    bool is_idle() const { return running_.empty(); }

    /// Waits for the graphs in flight, for about `in_flight_ms`.
    void wait();
    /// Whether the picture is as sharp as the budget allows, with no work due or in flight.
    bool complete() const;
    /// The camera of the picture in layers(); null before the first picture.
    const Camera* shown_camera() const { return shown_sight_ ? &shown_sight_->shot.camera : nullptr; }
    /// A number that changes whenever the result of layers() does, for callers that show the layers.
    uint64_t revision() const { return revision_; }

    /// Images to copy over each other, from back to front. Each is an rgba8_unorm image (with red and blue swapped if
    /// the options say so). Source and target of a copy have the same size.
    struct Layer {
        Import image;
        PixelBox source, target;
    };
    std::vector<Layer> layers() const;
    /// Returns the layers combined, as a screen would show them. Waits for the device.
    Image8 read_back();

    /// Device times of one pass since the current picture's first sketch was started.
    struct PassTime {
        std::string name;
        uint64_t runs = 0;
        double total_ms = 0.0;
        double longest_ms = 0.0;
        uint64_t waits = 0;  ///< number of runs that waited for results of earlier passes
    };
    const std::vector<PassTime>& pass_times() const { return pass_times_; }
    uint64_t submissions() const { return submissions_; }

private:
    struct Sight {
        Look look;
        InteractionSettings interaction;
        Shot shot;
        glm::uvec2 pixels{0};
    };
    using SightRef = std::shared_ptr<const Sight>;

    /// A part of a picture at some scale, in images of its own. Double-buffered: one image is shown while the other is
    /// being drawn.
    struct Sketch {
        struct Content {
            SightRef sight;
            std::optional<ProbeLook> probe;
            double share = 1.0;    ///< size relative to the screen along each axis; 1 is sharp
            glm::uvec2 pixels{0};  ///< size of the whole picture at this scale
            PixelBox part;         ///< scaled pixels; may be empty
            PixelBox target;       ///< screen pixels that `part` covers
        };
        std::array<gpu::Storage, 2> images;
        uint32_t front = 0;
        Content shown;               ///< the content of images[front]; without a sight if there is none
        std::optional<Content> job;  ///< the content being drawn into the other image
        uint32_t next_row = 0;       ///< next row of the job to draw
        uint32_t next_encoded = 0;   ///< next row of the target to encode
        uint32_t running = 0;        ///< graphs in flight
        bool is_drawn() const
        {
            return !job || (running == 0 && next_row >= job->part.end.y && next_encoded >= job->target.end.y);
        }
    };
    struct Tile {
        bool is_shown = false;
        bool is_drawn = false;  ///< drawn, but shown only once all tiles of the batch are drawn
        bool is_in_batch = false;
        bool is_due = false;
        bool is_urgent = false;  ///< changed by painting, so it is drawn first
        double drawn_s = 0.0;    ///< host time of the last submission
    };
    enum class Purpose : uint8_t { preparation, base, patch, tiles };
    struct Running {
        gpu::Submission submission;
        Purpose purpose = Purpose::preparation;
        double estimate_ms = 0.0;
        Pace* pace = nullptr;         ///< the estimate, if any, to be updated by the graph's time
        double units = 0.0;           ///< number of units of work in that estimate
        uint64_t pixels = 0;          ///< number of pixels ray-cast
        std::vector<uint32_t> tiles;  ///< indices
        SightRef sight;
        DeviceVolume::Feedback feedback;
    };

    bool is_listed(const Sight& sight);
    SightRef listed_sight();
    void list_ahead();
    bool submit_next(bool sketches_alone);
    bool submit_or_give_way(bool sketches_alone);
    void forget();
    bool has_room_for_tiles();
    bool submit_sketch_instead();
    bool may_draw(const Tile& tile) const;
    bool submit_preparation(const Sight& sight);
    bool submit_refinement();
    Scene& scene() const { return renderer_.scene(); }
    Resource draw(FrameGraph& graph, const PicturePart& part, Import light, Running& running);
    PixelBox strip_of_tiles(const glm::uvec2& nearest) const;
    Import strip_light(const glm::uvec2& pixels);
    void start(Sketch& sketch, const SightRef& sight, const std::optional<ProbeLook>& probe, double target_ms);
    void start(Sketch& sketch, Sketch::Content content, PixelBox part);
    bool submit_sketch(Sketch& sketch, Purpose purpose);
    void submit_rows(Sketch& sketch, Purpose purpose);
    void submit_encoding(Sketch& sketch, Purpose purpose);
    bool submit_occlusion();
    bool occlusion_is_due() const;
    void mark_voxels(const VoxelBox& voxels, bool is_urgent = true);
    PixelBox pixels_of(const Sight& sight, const VoxelBox& voxels) const;
    bool submit_finer_sketch();
    void drop_finer_sketch();
    bool is_drawing_finer_sketch() const { return base_.job && base_.job->sight == shown_sight_; }
    void choose_batch(const glm::dvec2& focus);
    void show_batch();
    bool submit_tiles();
    void encode_rows(FrameGraph& graph, Resource light, const Sketch& sketch, uint32_t begin, uint32_t end);
    gpu::EncodeParams encoding() const;
    void submit(FrameGraph graph, Running running);
    void reap();
    void note_cut_short(const Running& done, uint64_t rays);
    void account(const gpu::FrameResult& result, const Running& done);
    void note(const std::string& pass, double ms, bool waits);
    void finish_sketches();
    void flip(Sketch& sketch);
    void reset_tiles();
    void mark_due(const PixelBox& pixels, bool is_urgent);
    void reserve(gpu::Storage& image, const std::string& name, Format format, const glm::uvec2& pixels);
    bool patch_is_due() const;
    double cost_ms(uint64_t pixels) const { return double(pixels) * rays_.ms(); }
    /// Whether to use the host's clock, as on lavapipe, whose timestamps are wrong while a window renders.
    bool host_tells_time() const
    {
        const gpu::DeviceTraits& traits = renderer_.device().traits();
        return traits.is_cpu || traits.timestamp_bits == 0;
    }
    glm::uvec2 tile_counts() const;

    Renderer& renderer_;
    Options options_;
    SightRef sight_;                  ///< the requested state
    SightRef shown_sight_;            ///< the sight shown by base, tiles and patch
    SightRef coming_sight_;           ///< a requested sight whose bricks are being listed
    SightRef cut_short_sight_;        ///< the last sight in which some rays were cut short
    std::optional<ProbeLook> probe_;  ///< the requested probe
    Sketch base_, patch_;
    bool patch_is_dirty_ = false;  ///< paint under the probe has changed
    gpu::Storage work_;            ///< linear light of the sketch being drawn
    /// Linear light of sharp tiles: an image per graph in flight, and one for the next graph, so that no graph waits.
    std::array<gpu::Storage, 3> strips_;
    size_t next_strip_ = 0;
    bool has_no_strips_ = false;  ///< set if memory ran out: tiles are then drawn in `work_`
    gpu::Storage sharp_;          ///< all sharp tiles
    std::vector<Tile> tiles_;
    std::vector<VoxelBox> changed_during_base_;
    SightRef finer_sight_;    ///< the last sight for which a finer sketch was begun
    SightRef unsharp_sight_;  ///< the last sight whose sharp tiles did not fit in memory
    bool occlusion_is_asked_for_ = false;
    bool occlusion_was_renewed_ = false;  ///< set until the pixels under the probe show the updated occlusion
    std::deque<Running> running_;
    double in_flight_ms_ = 0.0;
    // Initial estimates, measured on two cores of a server.
    Pace rays_{0.002};                     ///< per pixel
    Pace enlarging_{2e-5};                 ///< per pixel of the screen
    Pace preparation_{5.0};                ///< per graph
    Pace occlusion_{1.25};                 ///< per brick
    double average_ms_per_pixel_ = 0.002;  ///< measured over whole sketches
    double sketch_ms_ = 0.0;               ///< for the sketch being drawn
    std::chrono::steady_clock::time_point busy_since_;
    uint64_t revision_ = 0;
    uint64_t submissions_ = 0;
    std::vector<PassTime> pass_times_;
};

}  // namespace shvr
