#pragma once
// A picture that is made while somebody looks at it: coarse at once, then sharp, tile by tile, nearest to the probe
// first.
//
//   look changed      sketch of the whole picture, at a scale that takes about `motion_ms`   -> shown when all is done
//                     and at most the session's `interaction.resolution`
//   probe moved       sketch of the pixels its ball may cover, drawn over everything else    -> shown when done
//   still             sharp tiles, until the picture is what `Renderer::render` makes, bit for bit
//   voxels changed    the tiles that show them, again
//   occlusion due     ambient occlusion, nearest bricks first, before the sharp tiles that show it
//
// Everything is drawn in small graphs of about `step_ms` each, and no more than about `in_flight_ms` of them are on the
// way at a time, so that a user interface, a brush or a relevance pass on the same queue waits no longer than that.
// Nothing is submitted when nothing changed. One thread, the renderer's; no call waits for the device.

#include <chrono>
#include <deque>
#include <memory>

#include "engine/look/camera_motion.h"
#include "engine/picture/renderer.h"
#include "shaders/encode.h"

namespace shvr {

class View {
public:
    static constexpr uint32_t TILE = 32;  ///< pixels a side

    struct Options {
        double step_ms = 2.0;        ///< of the device, for one graph
        double in_flight_ms = 3.5;   ///< of graphs on their way
        double motion_ms = 40.0;     ///< for the sketch of a picture
        double probe_ms = 20.0;      ///< for the sketch of the pixels that the probe may cover
        bool swap_red_blue = false;  ///< in what is shown
    };
    View(Renderer& renderer, const Options& options) : renderer_(renderer), options_(options) {}
    explicit View(Renderer& renderer) : View(renderer, Options{}) {}

    /// What is to be seen: all of it is drawn anew. Not to be called where nothing changed.
    void look(const Look& look, const InteractionSettings& interaction, const Shot& shot, const glm::uvec2& pixels);
    void look(const Session& session, const Shot& shot, const glm::uvec2& pixels)
    {
        look(session.look(), session.interaction, shot, pixels);
    }
    void show_probe(const std::optional<ProbeLook>& probe);
    /// These voxels look different: a person has changed them.
    void changed(const VoxelBox& voxels);
    /// Paged bricks of them have arrived, finer than before. While more of them come, tiles that were drawn without
    /// them are drawn again a few times a second.
    void bricks_arrived(const VoxelBox& voxels);
    /// Their ambient occlusion has been renewed.
    void light_changed(const VoxelBox& voxels);

    /// Ambient occlusion is renewed though the session says not to do so by itself.
    void update_occlusion() { occlusion_is_asked_for_ = true; }

    /// Takes what the device has finished and what has come to it, and submits what is due next.
    void advance();
    // The parts of advance(), for owners of several views, who take what has changed from the scene and report it.
    void collect() { reap(); }
    void submit_sketches();  ///< only what is_sketched() waits for
    void submit_due();
    /// All of the picture is there, coarse perhaps.
    bool is_sketched() const { return sight_ == shown_sight_ && !base_.job && !patch_.job && !patch_is_due(); }
    /// Nothing is due or on its way, whatever may still come to the device.
    bool is_finished() const;
    bool is_idle() const { return running_.empty(); }

    /// Waits for what is on its way; `in_flight_ms` or so.
    void wait();
    /// The picture is as sharp as the budget lets it be, and nothing is due or on its way.
    bool complete() const;
    /// The camera of what layers() show; null before there is anything.
    const Camera* shown_camera() const { return shown_sight_ ? &shown_sight_->shot.camera : nullptr; }
    /// Changes with layers(), for callers that show them.
    uint64_t revision() const { return revision_; }

    /// Images to be copied over each other, back to front. Each is an rgba8_unorm image (red and blue swapped where the
    /// options say so); source and target are equally large.
    struct Layer {
        Import image;
        PixelBox source, target;
    };
    std::vector<Layer> layers() const;
    /// What the layers show together, as a screen would; waits for the device.
    Image8 read_back();

    /// Device time of the picture that is being made or was made last, by pass.
    struct PassTime {
        std::string name;
        uint64_t runs = 0;
        double total_ms = 0.0;
        double longest_ms = 0.0;
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

    /// A part of a picture at some scale, in an image of its own. Two images: one is shown while the other is drawn.
    struct Sketch {
        struct Content {
            SightRef sight;
            std::optional<ProbeLook> probe;
            double share = 1.0;    ///< of the screen's pixels, along each axis; 1: sharp
            glm::uvec2 pixels{0};  ///< of the whole picture, scaled
            PixelBox part;         ///< scaled pixels; may be empty
            PixelBox target;       ///< screen pixels that it covers
        };
        std::array<gpu::Storage, 2> images;
        uint32_t front = 0;
        Content shown;               ///< in images[front]; sight is null where there is nothing
        std::optional<Content> job;  ///< goes to the other image
        uint32_t next_row = 0;       ///< of the job, that is to be drawn next
        uint32_t next_encoded = 0;   ///< row of the target, that is to be encoded next
        uint32_t running = 0;        ///< graphs on their way
        bool is_drawn() const
        {
            return !job || (running == 0 && next_row >= job->part.end.y && next_encoded >= job->target.end.y);
        }
    };
    struct Tile {
        bool is_shown = false;
        bool is_due = false;
        bool is_urgent = false;  ///< painted
        double drawn_s = 0.0;    ///< host's time of the last submission
    };
    enum class Purpose : uint8_t { preparation, base, patch, tiles };
    struct Running {
        gpu::Submission submission;
        Purpose purpose = Purpose::preparation;
        double estimate_ms = 0.0;
        uint64_t pixels = 0;
        std::vector<uint32_t> tiles;  ///< indices
        SightRef sight;
        DeviceVolume::Feedback feedback;
    };

    bool submit_next(bool sketches_alone);
    bool may_draw(const Tile& tile) const;
    bool submit_preparation(const Sight& sight);
    bool submit_refinement();
    Scene& scene() const { return renderer_.scene(); }
    Resource draw(FrameGraph& graph, const PicturePart& part, Running& running);
    void start(Sketch& sketch, const SightRef& sight, const std::optional<ProbeLook>& probe, double target_ms);
    bool submit_sketch(Sketch& sketch, Purpose purpose);
    void submit_rows(Sketch& sketch, Purpose purpose);
    void submit_encoding(Sketch& sketch, Purpose purpose);
    bool submit_occlusion();
    bool occlusion_is_due() const;
    void mark_voxels(const VoxelBox& voxels, bool is_urgent = true);
    PixelBox pixels_of(const Sight& sight, const VoxelBox& voxels) const;
    bool submit_tiles();
    void encode_rows(FrameGraph& graph, Resource light, const Sketch& sketch, uint32_t begin, uint32_t end);
    gpu::EncodeParams encoding() const;
    void submit(FrameGraph graph, Running running);
    void reap();
    void account(const gpu::FrameResult& result, uint64_t pixels);
    void note(const std::string& pass, double ms);
    void learn(double ms, uint64_t pixels);
    void finish_sketches();
    void flip(Sketch& sketch);
    void reset_tiles();
    void mark_due(const PixelBox& pixels, bool is_urgent);
    void reserve(gpu::Storage& image, const std::string& name, Format format, const glm::uvec2& pixels);
    bool patch_is_due() const;
    double cost_ms(uint64_t pixels) const { return double(pixels) * ms_per_pixel_; }
    /// Timestamps of lavapipe are wrong beside a window's render passes, so the time there is the host's.
    bool host_tells_time() const { return renderer_.device().traits().is_cpu; }
    glm::uvec2 tile_counts() const;

    Renderer& renderer_;
    Options options_;
    SightRef sight_;                  ///< what is wanted
    SightRef shown_sight_;            ///< what base, tiles and patch show
    std::optional<ProbeLook> probe_;  ///< what is wanted
    Sketch base_, patch_;
    bool patch_is_dirty_ = false;  ///< painted under the probe
    gpu::Storage work_;            ///< linear light of the part that is being drawn
    gpu::Storage sharp_;           ///< all sharp tiles
    std::vector<Tile> tiles_;
    std::vector<VoxelBox> changed_during_base_;
    bool occlusion_is_asked_for_ = false;
    bool occlusion_was_renewed_ = false;  ///< and what covers the probe does not show it yet
    std::deque<Running> running_;
    double in_flight_ms_ = 0.0;
    double ms_per_pixel_ = 0.002;          ///< learnt: where the picture is costly
    double average_ms_per_pixel_ = 0.002;  ///< learnt: of whole sketches
    double sketch_ms_ = 0.0;               ///< of the one that is being drawn
    std::chrono::steady_clock::time_point busy_since_;
    uint64_t revision_ = 0;
    uint64_t submissions_ = 0;
    std::vector<PassTime> pass_times_;
};

}  // namespace shvr
