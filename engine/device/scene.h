#pragma once
// One loaded volume and all that goes with it on the device: density offsets, mask, ambient occlusion, surfaces,
// tables. Built whole and destroyed whole.
//
//   commands (paint, offsets, trace)  -> show()  -> what is on the device -+
//   bricks that have been loaded      -> advance() ------------------------+-> take_changed() -> who shows pictures
//   slices of ambient occlusion       -> add_occlusion() ------------------+
//
// Pictures of it are made by engine/picture/frame.h. One thread, the one that owns the executor.

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/annotation/work/history.h"
#include "engine/device/device_mask.h"
#include "engine/device/device_volume.h"
#include "engine/device/look_table.h"
#include "engine/device/occlusion.h"
#include "engine/device/surfaces.h"
#include "engine/volume/offset_source.h"

namespace shvr {

class Scene {
public:
    struct Options {
        Sampling sampling = Sampling::automatic;
        Paging paging = Paging::automatic;
        /// Leave room for ambient occlusion, which takes about as much again as the bricks.
        bool with_occlusion = false;
        int threads = 1;  ///< workers that build bricks
        uint64_t host_bytes =
            0;  ///< a quarter is for paged bricks, a quarter for coarser levels of sources that have none
    };
    /// Loads the volume. The statistics give the intensity window and the scale of gradients. Fails as sources, budgets
    /// and `options` make it.
    Scene(gpu::Executor& executor, gpu::Memory& memory, std::shared_ptr<const VolumeSource> source,
          const VolumeStatistics& statistics, const Options& options);
    /// Such a scene would be resident, and finds room beside all that is on the device now. Fails where the device
    /// cannot do what `options` ask for.
    static bool fits_now(gpu::Memory& memory, const VolumeSource& source, const Options& options);

    const VolumeInfo& info() const { return volume_->info(); }
    const VolumeStatistics& statistics() const { return statistics_; }
    const gpu::DeviceTraits& traits() const { return memory_.device().traits(); }
    DeviceVolume& volume() { return *volume_; }
    const DeviceMask& mask() const { return mask_; }
    Occlusion& occlusion() { return occlusion_; }
    SurfaceScene& surfaces() { return surfaces_; }
    LookTables& tables() { return tables_; }

    // ---- What has changed

    /// All of the document's paint and offsets.
    void show(const Document& document);
    /// What these changes are about, of which the document holds the result: paint, offsets and, once show_surfaces()
    /// has been called, the trace. Returns whether paint or offsets are among them. Frames submitted later see it.
    /// Fails where voxels cannot be read.
    bool show(const Document& document, std::span<const Change> changes);
    /// Paint in these bricks. `within`: the voxels lie in this box.
    void update_mask(const Mask& mask, std::span<const int64_t> bricks, const std::optional<VoxelBox>& within = {});
    /// Voxels in these boxes have other offsets than before. Offsets raise intensities no higher than the volume's
    /// window.
    void update_density(const DensityField& field, std::span<const VoxelBox> changed);

    /// Opaque balls and rods that rays stop at: these, and those of the trace in the colours of `groups`. Fails as
    /// `surface_tree` and gpu::Memory::create do; then the ones before stay.
    void show_surfaces(std::vector<SurfaceLook> surfaces, const TraceGraph& trace, const Groups& groups);
    /// The trace after these changes. What it costs follows the changes, but for those of thousands of nodes, and of a
    /// group's size.
    void show_trace(const TraceGraph& trace, std::span<const Change> changes);
    /// These and no trace.
    void set_surfaces(const std::vector<SurfaceLook>& surfaces) { set_keyed_surfaces(keyed(surfaces)); }
    void set_keyed_surfaces(std::vector<KeyedSurface> surfaces);
    /// Those of `keys` go and `surfaces` come, at a cost that follows the change. False: nothing happened,
    /// `set_keyed_surfaces` is as cheap.
    bool replace_surfaces(std::span<const uint64_t> keys, std::span<const KeyedSurface> surfaces);

    /// Takes bricks that have been loaded. `wait`: for all that are wanted.
    void advance(bool wait = false);

    enum class Cause : uint8_t {
        edit,    ///< a person's command
        bricks,  ///< they have come to the device, finer than before
        light    ///< ambient occlusion has been renewed
    };
    struct Changed {
        VoxelBox voxels;
        Cause cause = Cause::edit;
    };
    /// Voxels that may look different since the last call, whatever the reason.
    std::vector<Changed> take_changed();
    bool has_changed() const { return !changed_.empty(); }

    // ---- How it looks

    /// What of a volume may be seen; it does not depend on the length of a step.
    Visibility visibility_of(const Look& look);
    /// Below this, in codes a voxel, gradients fade out.
    double gradient_fade_codes(const Light& light) const;
    /// Whether the look wants ambient occlusion and has room for it. Where memory is short, a message says so once, and
    /// pictures go without until it is switched off.
    bool has_occlusion(const Look& look);
    bool occlusion_has_no_room() const { return occlusion_has_no_room_; }
    /// The look wants ambient occlusion: bricks that it needs are wanted, too.
    void want_occlusion(const Look& look);
    /// The next slice of ambient occlusion in a graph that must be submitted.
    void add_occlusion(FrameGraph& graph, const Camera& camera, const Occlusion::Most& most);

    /// What pictures go without (bricks that cannot be read, features without room), one sentence each, since the last
    /// call.
    std::vector<std::string> take_messages();

private:
    Occlusion::Look occlusion_look(const Look& look);
    void note_changed(const VoxelBox& voxels, Cause cause);

    gpu::Memory& memory_;
    VolumeStatistics statistics_;
    std::shared_ptr<OffsetSource> offsets_;  ///< what volume_ is made of
    std::unique_ptr<DeviceVolume> volume_;
    DeviceMask mask_;
    Occlusion occlusion_;
    bool occlusion_has_no_room_ = false;
    SurfaceScene surfaces_;
    /// What is shown beside the trace, and the trace's colours; null: no trace is shown.
    struct TraceLook {
        std::vector<SurfaceLook> surfaces;
        Groups groups;
    };
    std::optional<TraceLook> trace_look_;
    LookTables tables_;
    std::vector<Changed> changed_;
    std::vector<std::string> messages_;
};

}  // namespace shvr
