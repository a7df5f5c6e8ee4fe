#pragma once
// Local ambient occlusion of the bricks on the device: tracks which cells (coarse opacity) and values (light at voxels)
// are stale, and updates them in batches, nearest to the eye first. Its images use the slots of the density atlas, so
// they need no table of their own. Allocates nothing on the device until a look asks for ambient occlusion.
// Changes, and the data that they make stale:
//   new bricks, painted voxels, cut      -> cells of the changed bricks, and the values that their light reaches
//   transfer function, radius            -> all cells, all values
//   rays, hemisphere                     -> all values
//
// Stale values stay until they are updated; bricks that never had values are fully lit. Updating only stale values
// gives the same bits as recomputing everything. While a brick from which light comes is not on the device, its finest
// ancestor on the device stands in; once the brick arrives, the values are updated. Values computed with all of their
// bricks stay valid when those bricks are evicted. Used only by the thread that owns the memory.

#include <optional>
#include <unordered_map>

#include "engine/device/device_mask.h"
#include "engine/device/device_volume.h"
#include "engine/gpu/memory.h"
#include "engine/look/settings.h"
#include "engine/look/transfer_function.h"
#include "engine/passes/brick_leap.h"
#include "engine/passes/occlusion.h"

namespace shvr {

class Occlusion {
public:
    explicit Occlusion(gpu::Memory& memory) : memory_(memory) {}

    /// The settings that the values depend on.
    struct Look {
        TransferFunction function;
        Visibility visibility;             ///< visibility of the same transfer function
        std::array<double, 256> groups{};  ///< opacities per reference length; 0: hidden
        CutBox cut;                        ///< geometry that is cut away blocks no light
        double radius = 16.0;              ///< reference lengths
        uint32_t rays = 32;
        bool full_sphere = false;
        double gradient_fade = 0.0;  ///< codes per voxel
        bool preintegrated = false;  ///< if true, a ray step may show opacity up to half a step from the lit position
    };

    /// Frees all memory.
    void clear();
    /// Sets the look for which light is computed. Fails if the budget cannot hold the images.
    void look(const Look& look, const DeviceVolume& volume, const DeviceMask& mask);
    /// Reports a change of voxels. `apron`: 0 if their paint changed; if their densities changed, the apron in voxels
    /// of each brick's own level.
    void changed(const VoxelBox& voxels, int64_t apron = 0);

    /// Device memory: slot_bytes() per slot of the atlas, scratch_bytes() for scratch images under `device_budget`.
    static uint64_t slot_bytes();
    static uint64_t scratch_bytes(const gpu::DeviceTraits& traits, uint64_t device_budget);

    bool exists_for(const DeviceVolume& volume) const { return volume_ == &volume; }
    bool has_memory() const { return bool(values_); }
    /// For each level: the maximum distance, in bricks, between a brick and the bricks that cast light on it.
    std::vector<int> reach() const;
    /// Whether anything is stale.
    bool is_due();
    /// Whether pictures show the final light of a brick: it is on the device, and its values were computed when all
    /// bricks that they depend on were on the device.
    bool is_lit(const BrickKey& key);
    /// Limits of one slice.
    struct Most {
        size_t bricks = 1;       ///< bricks whose values are computed, up to gpu::OCCLUSION_SLICE
        size_t cell_bricks = 8;  ///< bricks whose cells are computed
    };
    /// Adds the next slice to a graph that must be submitted. Returns the voxels that it updates. `eye` is in voxels.
    std::vector<VoxelBox> next(FrameGraph& graph, const VolumeBinding& volume, const std::optional<MaskBinding>& mask,
                               const glm::dvec3& eye, const Most& most);
    /// Handles for a graph that must be submitted. Adds passes that make bricks without values fully lit.
    OcclusionBinding bring_up_to_date(FrameGraph& graph);

    struct Counts {
        uint64_t cells = 0;   ///< bricks whose cells have been computed
        uint64_t values = 0;  ///< bricks whose values have been computed
        uint64_t looks = 0;   ///< how often a brick's visibility was computed from paint and neighbours
        uint64_t walks = 0;   ///< bricks checked for being due
    };
    const Counts& counts() const { return counts_; }

private:
    struct Entry {
        uint32_t slot = 0;
        BrickTexels::Range range;
        bool needs_cells = true, needs_values = true;
        bool is_new = true;             ///< its values have never been computed
        bool is_exact = false;          ///< whether all bricks that its values depend on were on the device
        std::optional<bool> is_seen{};  ///< null after a change of the brick's range, look, paint or neighbours
    };
    using Entries = std::unordered_map<BrickKey, Entry, BrickKeyHash>;

    void create(const DeviceVolume& volume);
    template <class Set>
    void mark(const std::vector<BrickKey>& keys, const Set& set);
    void sync();
    void mark_all(bool cells);
    void mark_cut(const CutBox& before, const CutBox& after);
    void changed_by_planes(const glm::dvec4& was, const glm::dvec4& is);
    double radius_of(int level) const;
    bool is_painted(const BrickKey& key, int reach) const;
    bool shows(const BrickKey& key, const Entry& entry) const;
    bool look_whether_seen(const BrickKey& key, const Entry& entry) const;
    bool is_seen(const BrickKey& key, Entry& entry);
    bool has_all_around(const BrickKey& key) const;
    bool is_candidate(const BrickKey& key, Entry& entry);
    void fill_queue(const glm::dvec3& eye);
    std::vector<BrickKey> nearest(const glm::dvec3& eye, size_t most);
    uint32_t around(const BrickKey& key, std::vector<BrickKey>* keys) const;
    OcclusionCellsInput cells_input(int level, double stretch, const std::optional<MaskBinding>& mask) const;
    void add_cells(FrameGraph& graph, const VolumeBinding& volume, OcclusionBinding& images,
                   const std::optional<MaskBinding>& mask, const std::vector<BrickKey>& keys);
    void add_values(FrameGraph& graph, const VolumeBinding& volume, OcclusionBinding& images,
                    const std::optional<MaskBinding>& mask, const std::vector<BrickKey>& keys);

    gpu::Memory& memory_;
    const DeviceVolume* volume_ = nullptr;
    const DeviceMask* mask_ = nullptr;
    std::optional<Look> look_;
    gpu::Storage values_;
    std::array<gpu::Storage, gpu::OCCLUSION_SIZES> cells_;
    gpu::Storage near_;
    std::array<gpu::Storage, gpu::OCCLUSION_SIZES> around_;
    bool is_paged_ = false;
    uint32_t slice_ = gpu::OCCLUSION_SLICE;  ///< capacity of the scratch images, in bricks
    bool images_are_new_ = false;
    Entries entries_;
    uint64_t revision_ = 0;  ///< places_revision() of the volume
    Counts counts_;

    /// The inputs that, together with completed work, determine which bricks are due.
    struct Cause {
        uint64_t visits = 0;   ///< DeviceVolume::visits_revision
        uint64_t changes = 0;  ///< changes_
        bool operator==(const Cause&) const = default;
    };
    Cause cause() const { return {volume_->visits_revision(), changes_}; }
    struct Candidate {
        double distance;
        BrickKey key;
    };
    uint64_t changes_ = 1;            ///< incremented when entries may become due
    Cause nothing_due_{}, queued_{};  ///< inputs at which nothing was due, and inputs at which the queue was filled
    glm::dvec3 queued_eye_{0.0};
    std::vector<Candidate> queue_;  ///< nearest due bricks, all of one level, sorted from far to near
};

}  // namespace shvr
