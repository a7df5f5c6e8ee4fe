#pragma once
// Makes pictures: owns the volume, the mask and the leap grid on the device, and lists the passes of a frame in order.
//
//   [look changed]            upload transfer function
//   [look changed]            leap_occupancy -> leap_distance x, y, z      (one thread a cell)
//   [paint or offsets]        leap_bound, leap_occupancy; when idle, the above     (one thread a cell around them)
//   [surfaces or a probe]     surfaces                                     (one thread a pixel)
//   every part of a picture   raycast                                      (one thread a pixel)
//
// `render` makes a whole picture and waits for it; `draw` adds the passes of a part to a graph that somebody else submits
// (engine/live/view.h does while a person looks). One thread, the one that owns the device.

#include <cmath>
#include <memory>
#include <optional>

#include "engine/annotation/density.h"
#include "engine/annotation/work/paint_preview.h"
#include "engine/base/image.h"
#include "engine/device/device_mask.h"
#include "engine/device/device_volume.h"
#include "engine/device/look_table.h"
#include "engine/device/occlusion.h"
#include "engine/device/surfaces.h"
#include "engine/passes/raycast.h"
#include "engine/session/session.h"
#include "engine/volume/offset_source.h"
#include "shaders/raycast.h"

namespace shvr {

/// A thin-shell iso-surface in the probe's region (shaders/library/shell.glsl).
struct ShellLook {
    double threshold = 0.0;  ///< intensity
    double opacity = 0.4;    ///< of one crossing
    bool is_box = false;     ///< the region; otherwise a ball
    bool operator==(const ShellLook&) const = default;
};

/// The probe as it is seen: a ball that rays stop at, and a shell.
struct ProbeLook {
    glm::dvec3 center{0.0};   ///< volume space
    double radius = 1.0;      ///< of its region, physical units
    glm::dvec3 color{1.0};    ///< linear light
    double ball_share = 1.0;  ///< of the radius, of the ball; 0: none
    std::optional<ShellLook> shell;
    std::shared_ptr<const PaintPreview>
        preview;  ///< what its brush would change, which slices show, too; null: not shown
    bool operator==(const ProbeLook&) const = default;
    /// Of a ball that holds all of it. `spacing`: of the volume.
    double reach(const glm::dvec3& spacing) const;
};
/// The ball beside a shell, which it must not hide.
inline constexpr double BALL_IN_SHELL = 0.12;
/// Its group's; grey where it erases.
glm::dvec3 probe_color(const Session& session, uint8_t group);
/// What pictures of a session show of its probe.
std::optional<ProbeLook> shown_probe(const Session& session, const VolumeInfo& volume,
                                     const VolumeStatistics& statistics);

/// A rectangle of a picture, and where it goes.
struct PicturePart {
    glm::uvec2 pixels{0};         ///< of the whole picture
    glm::uvec2 begin{0}, end{0};  ///< the pixels that are drawn
    glm::uvec2 target{0};         ///< texel that `begin` goes to
    glm::uvec2 detail_pixels{0};  ///< of the picture that decides how fine the bricks are; 0: this one
    std::optional<ProbeLook> probe;
};

struct RenderOptions {
    std::optional<ProbeLook> probe;
    bool outlines_probe = false;  ///< through what hides it; an arrow where it is out of sight
    bool count_work = false;      ///< keep the exact work counters (a little slower)
    bool serialize = false;       ///< a full barrier between passes
    bool timestamps = true;
    /// Pixels a side of what is drawn at a time: it bounds what a picture of any size takes of the device.
    uint32_t part_pixels = 1024;
};

struct Picture {
    ImageF image;          ///< linear light, premultiplied, over the background
    bool complete = true;  ///< every brick that rays came by was there, as fine as wanted, and every feature had room
    std::vector<std::string> warnings;  ///< what was not
    std::vector<gpu::PassReport> passes;
    double wall_ms = 0.0;
    FrameGraph graph;  ///< what was run, for `profile --graph`
};

class Renderer {
public:
    struct Options {
        gpu::DeviceOptions device;
        /// Of the host's bytes (0: 2 GiB) half are for mapped memory, a quarter for bricks kept on the host and a quarter
        /// for the coarser levels of files that have none.
        gpu::Budget budget;
        int threads = 0;  ///< workers that build bricks; 0: one a core
    };
    explicit Renderer(const Options& options);

    gpu::Device& device() { return device_; }
    gpu::Memory& memory() { return memory_; }
    gpu::Executor& executor() { return executor_; }

    /// Replaces the volume. The statistics give the intensity window and the scale of gradients; of `settings` sampling
    /// and paging decide how the device holds the bricks. `with_occlusion`: they leave room for ambient occlusion, which takes
    /// about as much again.
    void load(std::shared_ptr<const VolumeSource> source, const VolumeStatistics& statistics,
              const RenderSettings& settings = {}, bool with_occlusion = false);
    DeviceVolume& volume() const;
    const VolumeStatistics& statistics() const { return statistics_; }
    /// Mapped memory, and bricks kept on the host.
    uint64_t host_bytes() const;
    uint64_t peak_host_bytes() const;

    /// Brings changed bricks of the mask to the device.
    void update_mask(const Mask& mask, std::span<const int64_t> bricks);

    /// Where bricks come and go, those of these voxels are among what views need, whatever the transfer function hides: for
    /// a shell, which may lie where nothing else is seen. A brick is the finest grain of it. Null: none.
    void show_always(const std::optional<VoxelBox>& voxels);

    /// Voxels in these boxes have other offsets than before: from now on the volume is that of its source plus `field`.
    /// What depends on them is renewed; frames submitted later see it. Offsets raise intensities no higher than the
    /// volume's window, which stays. Fails where voxels cannot be read.
    void update_density(const DensityField& field, std::span<const VoxelBox> changed);

    /// Opaque balls and rods that rays stop at, instead of those before; `load` forgets them. Fails as `surface_tree` and
    /// gpu::Memory::create do; then the ones before stay.
    void set_surfaces(const std::vector<SurfaceLook>& surfaces) { set_keyed_surfaces(keyed(surfaces)); }
    void set_keyed_surfaces(std::vector<KeyedSurface> surfaces);
    /// The same with those of `keys` gone and `surfaces` there, at a cost that follows the change. False: nothing happened,
    /// `set_keyed_surfaces` is as cheap.
    bool replace_surfaces(std::span<const uint64_t> keys, std::span<const KeyedSurface> surfaces);

    /// The picture of `session` (its light, transfer function, groups, cut, panes) from `camera`.
    Picture render(const Session& session, const Camera& camera, const RenderOptions& options = {});

    /// What has to be computed before parts of `session` are drawn, one short graph at a time; nothing when all is ready.
    /// Whoever does not ask gets it all in the first `draw`. The graph must be submitted before the next call.
    std::optional<FrameGraph> next_preparation(const Session& session);
    /// What makes pictures of it come sooner without making them different, for when nothing else is to be done; likewise.
    std::optional<FrameGraph> next_refinement(const Session& session);
    bool refinement_is_due() const { return volume().refinement_is_due(); }

    /// The next slice of the ambient occlusion that `session` wants, as seen from `camera`; nothing where it wants none or
    /// all is made. Must be submitted before the next call. Pictures are drawn with what is made so far.
    struct OcclusionSlice {
        FrameGraph graph;
        std::vector<VoxelBox> renewed;  ///< voxels that may look different
    };
    std::optional<OcclusionSlice> next_occlusion(const Session& session, const Camera& camera,
                                                 const Occlusion::Most& most);
    Occlusion& occlusion() { return occlusion_; }
    /// What pictures go without (bricks that cannot be read, features without room), one sentence each, since the last call.
    std::vector<std::string> take_messages();

    /// What was added to a graph: the target's new version, and what the volume takes back once the graph is done.
    struct Drawn {
        Resource target;
        DeviceVolume::Feedback feedback;
    };
    /// Adds the passes that draw a part of what `shot` sees of `session` into `target`, an rgba32_float image. The graph must be
    /// submitted, and before any other that was made later.
    Drawn draw(FrameGraph& graph, const Session& session, const Shot& shot, const PicturePart& part, Resource target,
               bool count_work = false);

    /// What is seen at a pixel: where its ray becomes half opaque, in volume space. Waits for the device.
    std::optional<glm::dvec3> pick(const Session& session, const Camera& camera, const glm::uvec2& pixels,
                                   const glm::uvec2& pixel);

private:
    friend class PictureJob;
    bool filters(Sampling sampling) const;
    bool pages(const VolumeSource& source, Paging paging, bool with_occlusion) const;
    const LookTable& table_of(const Session& session, double step_voxels);
    Visibility visibility_of(const Session& session);
    double gradient_fade_codes(const Session& session) const;
    Occlusion::Look occlusion_look(const Session& session);
    bool draws_occlusion(const Session& session);
    std::vector<gpu::PassReport> make_occlusion(const Session& session, const Camera& camera,
                                                const RenderOptions& options);
    double look(const Session& session, const Shot& shot, const glm::uvec2& pixels);
    Resource import_group_looks(FrameGraph& graph, const Session& session, double step_voxels);
    struct Prepared {
        VolumeBinding volume;
        RaycastInput input;
        std::optional<SurfaceList> listed;
    };
    Prepared prepare(FrameGraph& graph, const Session& session, const Shot& shot, const PicturePart& part,
                     bool feedback);
    Resource cast_rays(FrameGraph& graph, VolumeBinding& volume, RaycastInput& input, const Camera& camera,
                       const PicturePart& part, Resource target);
    std::optional<Resource> draw_surfaces(FrameGraph& graph, const Prepared& prepared, const RaycastInput& input,
                                          const Camera& camera, const PicturePart& part);

    gpu::Device device_;
    uint64_t host_budget_;
    gpu::Memory memory_;
    gpu::Executor executor_;
    int threads_;
    VolumeStatistics statistics_;
    std::shared_ptr<OffsetSource> offsets_;  ///< what volume_ is made of
    std::unique_ptr<DeviceVolume> volume_;
    std::optional<VoxelBox> always_shown_;
    DeviceMask mask_;
    Occlusion occlusion_;
    SurfaceScene surfaces_;
    bool occlusion_has_no_room_ = false;
    std::vector<std::string> messages_;
    std::optional<LookTable> table_;
    DeviceTable table_on_device_{memory_, "transfer function"};
    std::vector<glm::vec4> group_looks_;
    DeviceTable groups_on_device_{memory_, "groups"};
};

/// Whether the light of a session makes ambient occlusion.
bool shows_occlusion(const Light& light);

}  // namespace shvr
