#pragma once
// An interactive picture: coarse at once, then sharp, tile by tile, nearest to the probe first.
//
//   look changed      the bricks of the view are listed in the background; while the camera moves faster than that, the
//                     picture follows at the pace of the lists
//                     sketch of the whole picture, at a scale that takes about `motion_ms`   -> shown when all is done
//                     and at most the session's `interaction.resolution`
//   probe moved       sketch of the pixels its ball may cover, drawn over everything else    -> shown when done
//   still             a finer sketch of the whole picture, where that is a small part of the work
//                     then sharp tiles, until the picture equals that of `Renderer::render` bit for bit. They are shown
//                     a large part of the picture at a time, so that no seam runs through it
//   voxels changed    the tiles that show them, again
//   occlusion due     ambient occlusion, nearest bricks first, before the sharp tiles that show it
//
// Everything is drawn in small graphs of about `step_ms` each, with at most about `in_flight_ms` of them in flight, so
// that a user interface, a brush or a relevance pass on the same queue waits no longer than that. Nothing is submitted
// when nothing changed. One thread, the renderer's; no call waits for the device.

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
        double in_flight_ms = 3.5;   ///< device time of the graphs in flight
        double motion_ms = 40.0;     ///< for a sketch of the whole picture
        double probe_ms = 20.0;      ///< time limit for a sketch of the pixels that the probe may cover
        double moment_ms = 300.0;    ///< sharp tiles that take less are shown all at once
        bool swap_red_blue = false;  ///< in the shown images
    };
    View(Renderer& renderer, const Options& options) : renderer_(renderer), options_(options) {}
    explicit View(Renderer& renderer) : View(renderer, Options{}) {}

    /// Sets the displayed content and redraws everything. Call it only if something changed.
    void look(const Look& look, const InteractionSettings& interaction, const Shot& shot, const glm::uvec2& pixels);
    void look(const Session& session, const Shot& shot, const glm::uvec2& pixels)
    {
        look(session.look(), session.interaction, shot, pixels);
    }
    void show_probe(const std::optional<ProbeLook>& probe);
    /// Reports that the user has changed these voxels.
    void changed(const VoxelBox& voxels);
    /// Reports that finer paged bricks of these voxels have arrived. While more arrive, tiles drawn without them are
    /// redrawn a few times a second.
    void bricks_arrived(const VoxelBox& voxels);
    /// Reports that the ambient occlusion of these voxels has been renewed.
    void light_changed(const VoxelBox& voxels);

    /// Renews ambient occlusion once, even if the session has disabled automatic updates.
    void update_occlusion() { occlusion_is_asked_for_ = true; }

    /// Collects finished submissions and loaded bricks, and submits the next work.
    void advance();
    // advance() in steps, for owners of several views, who take the scene's changes and report them to each view.
    void collect() { reap(); }
    // `ahead_ms`: extra time beyond `in_flight_ms` that may be in flight, since the caller will not poll for that long.
    void submit_sketches(double ahead_ms = 0.0);  ///< only the work that is_sketched() waits for
    void submit_due(double ahead_ms = 0.0);
    /// Whether the whole picture is shown, perhaps coarsely.
    bool is_sketched() const { return sight_ == shown_sight_ && !base_.job && !patch_.job && !patch_is_due(); }
    /// Whether nothing is due or in flight; bricks may still arrive.
    bool is_finished() const;
    bool is_idle() const { return running_.empty(); }

    /// Waits for the graphs in flight, about `in_flight_ms`.
    void wait();
    /// Whether the picture is as sharp as the budget allows, and nothing is due or in flight.
    bool complete() const;
    /// The camera of the picture in layers(); null before the first picture.
    const Camera* shown_camera() const { return shown_sight_ ? &shown_sight_->shot.camera : nullptr; }
    /// Changes whenever layers() does, for callers that show them.
    uint64_t revision() const { return revision_; }

    /// Images to copy over each other, back to front. Each is an rgba8_unorm image (with red and blue swapped if the
    /// options say so); source and target have the same size.
    struct Layer {
        Import image;
        PixelBox source, target;
    };
    std::vector<Layer> layers() const;
    /// The layers combined, as a screen would show them; waits for the device.
    Image8 read_back();

    /// Device time of one pass, in the current picture or the last one.
    struct PassTime {
        std::string name;
        uint64_t runs = 0;
        double total_ms = 0.0;
        double longest_ms = 0.0;
        uint64_t waits = 0;  ///< runs that had to wait for results of earlier passes
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

    /// A part of a picture at some scale, in its own image. Double-buffered: one image is shown while the other is
    /// drawn.
    struct Sketch {
        struct Content {
            SightRef sight;
            std::optional<ProbeLook> probe;
            double share = 1.0;    ///< scale relative to the screen along each axis; 1: sharp
            glm::uvec2 pixels{0};  ///< size of the whole picture, scaled
            PixelBox part;         ///< scaled pixels; may be empty
            PixelBox target;       ///< screen pixels that it covers
        };
        std::array<gpu::Storage, 2> images;
        uint32_t front = 0;
        Content shown;               ///< the picture in images[front]; its sight is null if there is none
        std::optional<Content> job;  ///< drawn into the other image
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
        bool is_drawn = false;  ///< drawn, and shown together with the other tiles of its batch
        bool is_in_batch = false;
        bool is_due = false;
        bool is_urgent = false;  ///< changed by painting
        double drawn_s = 0.0;    ///< host time of the last submission
    };
    enum class Purpose : uint8_t { preparation, base, patch, tiles };
    struct Running {
        gpu::Submission submission;
        Purpose purpose = Purpose::preparation;
        double estimate_ms = 0.0;
        Pace* pace = nullptr;         ///< updated with its time, if any
        double units = 0.0;           ///< in units of that pace
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
    /// The host's clock is used on lavapipe, whose timestamps are wrong during a window's render passes.
    bool host_tells_time() const
    {
        const gpu::DeviceTraits& traits = renderer_.device().traits();
        return traits.is_cpu || traits.timestamp_bits == 0;
    }
    glm::uvec2 tile_counts() const;

    Renderer& renderer_;
    Options options_;
    SightRef sight_;                  ///< the requested state
    SightRef shown_sight_;            ///< the state shown by base, tiles and patch
    SightRef coming_sight_;           ///< a requested state whose bricks are being listed
    SightRef cut_short_sight_;        ///< the last state with rays that stopped before their end
    std::optional<ProbeLook> probe_;  ///< the requested probe
    Sketch base_, patch_;
    bool patch_is_dirty_ = false;  ///< paint under the probe has changed
    gpu::Storage work_;            ///< linear light of the sketch being drawn
    /// Linear light of sharp tiles: for the graphs in flight and the next one, so that none waits for another.
    std::array<gpu::Storage, 3> strips_;
    size_t next_strip_ = 0;
    bool has_no_strips_ = false;  ///< set when out of memory: tiles are drawn in `work_`
    gpu::Storage sharp_;          ///< all sharp tiles
    std::vector<Tile> tiles_;
    std::vector<VoxelBox> changed_during_base_;
    SightRef finer_sight_;    ///< the last state for which a finer sketch was begun
    SightRef unsharp_sight_;  ///< the last state whose sharp tiles did not fit in memory
    bool occlusion_is_asked_for_ = false;
    bool occlusion_was_renewed_ = false;  ///< set while the pixels under the probe do not show it yet
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
