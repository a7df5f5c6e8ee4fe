#pragma once
// One loaded volume and everything on the device that belongs to it: density offsets, mask, ambient occlusion,
// surfaces, tables. Built and destroyed as a whole.
//
//   commands (paint, offsets, trace)  -> show()  -> what is on the device -+
//   bricks that have been loaded      -> advance() ------------------------+-> take_changed() -> views
//   slices of ambient occlusion       -> add_occlusion() ------------------+
//
// engine/picture/frame.h makes pictures of a scene. Used only by the thread that owns the executor.

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/annotation/work/history.h"
#include "engine/bricks/threshold_bricks.h"
#include "engine/device/device_mask.h"
#include "engine/device/device_volume.h"
#include "engine/device/look_table.h"
#include "engine/device/occlusion.h"
#include "engine/device/surfaces.h"
#include "engine/volume/held_source.h"
#include "engine/volume/offset_source.h"

namespace shvr {

class Scene {
public:
    struct Options {
        Sampling sampling = Sampling::automatic;
        Paging paging = Paging::automatic;
        /// Reserves memory for ambient occlusion: 0.7 times the memory of 16-bit bricks, 1.3 times that of 8-bit ones.
        bool with_occlusion = false;
        int threads = 1;  ///< workers that build bricks
        uint64_t host_bytes =
            0;                   ///< a quarter is for paged bricks, a quarter for coarser levels if the source has none
        Progress progress{};     ///< progress of loading, also if show() has to load the volume again
        bool in_slices = false;  ///< the constructor only starts loading; until it is done, only load_on() may be
                                 ///< called
        uint64_t reserved_bytes = 0;  ///< device memory kept free for content shown in addition to the volume
                                      ///< (bytes_to_show)
    };
    /// Loads the volume. The statistics determine the intensity window and the scale of gradients. Fails if the source
    /// cannot be read, the budget is too small or the device does not support `options`.
    Scene(gpu::Executor& executor, gpu::Memory& memory, std::shared_ptr<const VolumeSource> source,
          const VolumeStatistics& statistics, const Options& options);
    /// Continues loading for about `seconds`, without waiting for a disk. Returns true once loading is complete.
    bool load_on(double seconds) { return volume_->load_on(seconds); }
    double loaded() const { return volume_->loaded(); }
    /// Upper bound of the device memory needed to show a document.
    static uint64_t bytes_to_show(const Document& document);
    /// Maximum sizes of the atlas of paged bricks: under a budget (atlas_share) and on a device (most_atlas_bytes).
    static uint64_t atlas_share(uint64_t device_budget, bool with_occlusion);
    static uint64_t most_atlas_bytes(const gpu::DeviceTraits& traits, AtlasCodes codes, bool with_occlusion);
    /// Device memory of a resident volume, including its ambient light.
    static uint64_t resident_bytes(const VolumeInfo& info, AtlasCodes codes, bool with_occlusion);
    /// How the device stores the codes of voxels of `type`. Fails if the device does not support `sampling`.
    static AtlasCodes codes_for(const gpu::DeviceTraits& traits, VoxelType type, Sampling sampling);
    /// Whether one image of the device could hold all bricks of the source, regardless of free memory.
    static bool can_be_resident(const gpu::Memory& memory, const VolumeSource& source, const Options& options);
    /// Whether a scene of this source would be paged even if the device held nothing else but `reserved_bytes`.
    static bool pages_alone(const gpu::Memory& memory, const VolumeSource& source, const Options& options);
    /// Whether a scene of this source would be resident and fits in addition to everything now on the device. Fails if
    /// the device does not support `options`.
    static bool fits_now(gpu::Memory& memory, const VolumeSource& source, const Options& options);
    /// Fails if the sizes alone show that a scene of this source is impossible; reads no voxels.
    static void check_sizes(gpu::Memory& memory, const VolumeSource& source, const Options& options);

    /// A number that no other scene of this process has.
    uint64_t number() const { return number_; }
    const VolumeInfo& info() const { return volume_->info(); }
    const VolumeStatistics& statistics() const { return statistics_; }
    const gpu::DeviceTraits& traits() const { return memory_.device().traits(); }
    DeviceVolume& volume() { return *volume_; }
    /// Whether pictures draw the finest level everywhere because the source has no other level: a larger budget would
    /// make the volume resident, and budgets must not change pictures. Live views draw coarser levels as needed.
    bool draws_finest() const { return draws_finest_; }
    /// Decides which voxels a brush or touch may select if several values share a code; null if each has its own code.
    ThresholdBricks* threshold_bricks() { return threshold_bricks_.get(); }
    const DeviceMask& mask() const { return *mask_; }
    Occlusion& occlusion() { return occlusion_; }
    SurfaceScene& surfaces() { return surfaces_; }
    MeshScene& meshes() { return meshes_; }
    bool has_surfaces() const { return !surfaces_.empty() || !meshes_.empty(); }
    LookTables& tables() { return tables_; }

    // ---- Changes

    /// Whether a change of offsets whose voxels must be read, from a network for example, is shown later instead of
    /// waiting for them: by catch_up(), once they have been read in the background. Off at first.
    void read_in_background(bool on) { reads_in_background_ = on; }
    bool reads_in_background() const { return reads_in_background_; }
    /// Shows all paint and offsets of the document, and reserves memory for its trace. If memory is short, loads the
    /// volume again with fewer bricks, which come from the host where it has them; with read_in_background(), never
    /// waits for the others, which arrive like all bricks. Must be called before anything else refers to this scene's
    /// volume. Fails if the budget cannot hold the document's content.
    void show(const Document& document);
    /// Shows `changes`, which the document already contains: paint, offsets and, once show_surfaces() has been called,
    /// the trace. Returns whether paint or offsets are among the changes. Frames submitted later show them. Fails if
    /// voxels cannot be read or memory is short; is_behind() is then true.
    bool show(const Document& document, std::span<const Change> changes);
    void show(const Document& document, const Touched& touched, const std::optional<VoxelBox>& within = {});
    /// Whether paint or offsets shown are out of date because an update failed, or because voxels are being read.
    bool is_behind() const { return mask_->is_stale() || !unshown_density_.empty(); }
    /// Whether the reason is that voxels are being read in the background. Brushes would not see the latest offsets.
    bool awaits_voxels() const { return awaits_voxels_; }
    /// Retries updates that failed, and those whose voxels were being read. Fails as `show` does.
    void catch_up(const Document& document);
    /// Updates the mask in these bricks. `within`: a box that holds all changed voxels.
    void update_mask(const Mask& mask, std::span<const int64_t> bricks, const std::optional<VoxelBox>& within = {});
    /// Updates the offsets in these boxes. Offsets never raise intensities above the intensity window.
    void update_density(const DensityField& field, std::span<const VoxelBox> changed);

    /// Sets the opaque balls and rods that end rays: `surfaces`, and those of the trace in the colours of `groups`.
    /// Fails as `surface_tree` and gpu::Memory::create do, and then keeps the earlier surfaces. If only colours or
    /// sizes differ from the surfaces shown, only colours and sizes are written.
    void show_surfaces(std::vector<SurfaceLook> surfaces, const TraceGraph& trace, const Groups& groups);
    /// Sets the triangles of meshes that end rays. Fails as gpu::Memory::create does, and then keeps the earlier ones.
    void show_meshes(MeshTree tree) { meshes_.set(std::move(tree)); }
    /// Shows the trace after these changes. The cost is proportional to the number of changes, except if thousands of
    /// nodes change at once or a group's radius changes.
    void show_trace(const TraceGraph& trace, std::span<const Change> changes);
    /// Sets these surfaces and no trace.
    void set_surfaces(const std::vector<SurfaceLook>& surfaces) { set_keyed_surfaces(keyed(surfaces)); }
    void set_keyed_surfaces(std::vector<KeyedSurface> surfaces);
    /// Removes the surfaces with `keys` and adds `surfaces`, at a cost proportional to the change. If
    /// `set_keyed_surfaces` is as cheap, changes nothing and returns false.
    bool replace_surfaces(std::span<const uint64_t> keys, std::span<const KeyedSurface> surfaces);

    /// Takes loaded bricks. `wait`: waits for all requested bricks.
    void advance(bool wait = false, const Progress& progress = {});

    enum class Cause : uint8_t {
        edit,    ///< a user's command
        bricks,  ///< finer bricks have arrived on the device
        light    ///< ambient occlusion has been renewed
    };
    struct Changed {
        VoxelBox voxels;
        Cause cause = Cause::edit;
    };
    /// Voxels whose appearance may have changed since the last call, in boxes with their causes.
    std::vector<Changed> take_changed();
    bool has_changed() const { return !changed_.empty(); }

    // ---- Look

    /// Which densities are visible; the step length does not matter.
    Visibility visibility_of(const Look& look);
    /// The gradient, in codes per voxel, below which gradients fade out.
    double gradient_fade_codes(const Light& light) const;
    /// Whether the look uses ambient occlusion and memory suffices. If memory is short, warns once and draws without
    /// ambient occlusion until the look switches it off.
    bool has_occlusion(const Look& look);
    bool occlusion_has_no_room() const { return occlusion_has_no_room_; }
    /// Frees memory that pictures can do without, and adds a message that states the reason `why`. Returns false if no
    /// such memory is in use. Must not be called while a graph that uses the scene is under construction.
    bool give_way(const std::string& why);
    /// Requests the bricks that the look's ambient occlusion needs.
    void want_occlusion(const Look& look);
    /// Adds the next slice of ambient occlusion to a graph that must be submitted.
    void add_occlusion(FrameGraph& graph, const Camera& camera, const Occlusion::Most& most);

    /// Messages about what pictures lack (unreadable bricks, features without memory) since the last call, one sentence
    /// each.
    std::vector<std::string> take_messages();
    /// Adds such a message.
    void note_message(std::string message) { messages_.push_back(std::move(message)); }

private:
    void load(uint64_t reserved_bytes, const std::shared_ptr<BrickStore>& host_bricks = nullptr);
    bool load_resident(const IntensityWindow& window);
    void load_paged(const IntensityWindow& window, AtlasCodes codes, uint64_t reserved_bytes,
                    std::shared_ptr<BrickStore> host_bricks);
    bool has_room(uint64_t bytes);
    bool can_shrink() const;
    void make_room(uint64_t bytes);
    void drop_occlusion(const std::string& why);
    Occlusion::Look occlusion_look(const Look& look);
    void note_changed(const VoxelBox& voxels, Cause cause);
    void note_mask(const Mask& mask, std::span<const int64_t> bricks, const std::optional<VoxelBox>& within = {});
    void note_density(const DensityField& field, std::span<const VoxelBox> changed);
    bool voxels_are_there();
    void renew_density();

    static uint64_t next_number();

    const uint64_t number_ = next_number();
    gpu::Executor& executor_;
    gpu::Memory& memory_;
    std::shared_ptr<const VolumeSource> source_;
    Options options_;
    VolumeStatistics statistics_;
    bool draws_finest_ = false;
    std::shared_ptr<HeldSource> held_;       ///< without offsets
    std::shared_ptr<OffsetSource> offsets_;  ///< the source that volume_ reads from
    std::unique_ptr<ThresholdBricks> threshold_bricks_;
    std::unique_ptr<DeviceVolume> volume_;
    std::optional<DeviceMask> mask_;
    Occlusion occlusion_;
    bool occlusion_has_no_room_ = false;
    SurfaceScene surfaces_;
    MeshScene meshes_;
    /// The surfaces shown in addition to the trace, and the trace's colours; null while no trace is shown.
    struct TraceLook {
        std::vector<SurfaceLook> surfaces;
        Groups groups;
    };
    std::optional<TraceLook> trace_look_;
    LookTables tables_;
    std::vector<Changed> changed_;
    std::vector<VoxelBox> unshown_density_;  ///< boxes whose bricks could not be updated yet
    bool reads_in_background_ = false, awaits_voxels_ = false;
    std::vector<std::string> messages_;
};

}  // namespace shvr
