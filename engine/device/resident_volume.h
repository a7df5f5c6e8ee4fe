#pragma once
// A volume with all of its bricks on the device, side by side in one image or buffer, together with the value range of
// every cell and the leap grid, which is updated when visibility or paint changes. Bricks have slot numbers, as ambient
// light is stored by slot. A volume that does not fit the device budget is refused with a message before any brick is
// read.
//
// Used only by the thread that owns the executor.

#include "engine/device/brick_uploads.h"
#include "engine/device/device_volume.h"
#include "engine/device/empty_space.h"

namespace shvr {

class ResidentVolume final : public DeviceVolume {
public:
    /// Reads, encodes and uploads every brick, using `threads` worker threads.
    ResidentVolume(gpu::Executor& executor, gpu::Memory& memory, std::shared_ptr<const VolumeSource> source,
                   const IntensityWindow& window, AtlasCodes codes, int threads, const Progress& progress = {});
    /// Starts loading for `load_on`: bricks are read and encoded on worker threads.
    struct InSlices {};
    ResidentVolume(gpu::Executor& executor, gpu::Memory& memory, std::shared_ptr<const VolumeSource> source,
                   const IntensityWindow& window, AtlasCodes codes, int threads, InSlices);
    ~ResidentVolume() override;
    bool load_on(double seconds) override;
    double loaded() const override;

    /// Device memory of such a volume, including cells and leap grid.
    static uint64_t bytes_for(const VolumeInfo& info, AtlasCodes codes);
    /// Whether the device supports images and buffers of the required size, regardless of free memory.
    static bool is_possible(const gpu::Memory& memory, const VolumeInfo& info, AtlasCodes codes);

    uint64_t brick_count() const;
    /// Handles for a new frame graph.
    VolumeBinding import(FrameGraph& graph) const;

    bool get_ready(const PageView&, const Visibility&) override { return true; }
    int look(const PageView& view, const Visibility& visibility) override;
    void look_by(const Visibility& visibility) override;
    bool has_view() const override { return true; }
    int finest_level() const override { return 0; }
    std::optional<FrameGraph> next_preparation(const Visibility& visibility, const DeviceMask& mask) override;
    std::optional<FrameGraph> next_refinement(const Visibility& visibility, const DeviceMask& mask) override;
    bool refinement_is_due() const override { return empty_space_.is_worth_refining(); }
    VolumeBinding prepare(FrameGraph& graph, const DeviceMask& mask, const std::optional<MaskBinding>& painted,
                          bool feedback) override;
    bool is_stale() const override { return false; }

    // Feedback about visited bricks is not needed, since all bricks are on the device.
    Feedback request_feedback(FrameGraph&, const VolumeBinding&) const override { return {}; }
    void take_feedback(const Feedback&, const gpu::FrameResult&) override {}
    void forget_visits() override {}
    void let_rays_wait(bool, std::function<bool(const BrickKey&)>) override {}
    bool limit_visits(const std::vector<int>&) override { return true; }
    Presence presence_of(const BrickKey&) const override { return Presence::there; }
    bool has_rays_waiting() const override { return false; }
    std::vector<VoxelBox> advance(bool, const Progress&) override { return {}; }
    State state() const override { return State::complete; }
    size_t missing() const override { return 0; }
    std::vector<std::string> take_messages() override { return {}; }
    bool is_drawn(const BrickKey&) const override { return true; }
    void want_around(const std::vector<int>&) override {}
    void prefer(const VoxelBox&) override {}

    std::vector<BrickKey> read_to_renew(std::span<const VoxelBox> changed) const override
    {
        return bricks_that_see(changed, info().size, 0);
    }
    /// Waits for the reads; also waits for the device if many bricks changed.
    void renew(std::span<const VoxelBox> changed) override;
    void note_painted(const Mask& mask, std::span<const int64_t> bricks) override;

    int levels() const override { return 1; }
    glm::uvec3 atlas_slots() const override { return atlas_slots_; }
    std::vector<Place> places() const override;
    uint64_t places_revision() const override { return places_revision_; }
    uint64_t visits_revision() const override { return 1; }
    VolumeBinding atlas(FrameGraph& graph) override { return import(graph); }
    std::optional<RegionBricks> region(const VoxelBox& voxels, bool wait) override;
    std::optional<Counts> counts() const override { return std::nullopt; }
    std::shared_ptr<BrickStore> host_bricks() const override { return nullptr; }

private:
    class Builder;
    struct Shape {
        glm::uvec3 atlas_slots;
        ResourceDesc atlas, page_table, cells;  ///< `cells`: for the cell ranges, the leap grid and its scratch images
    };
    static std::optional<Shape> shape_of(const gpu::Memory& memory, const glm::uvec3& brick_counts, AtlasCodes codes);
    void create_images();
    void upload_page_table();
    void upload(const BrickTexels& texels, const glm::uvec3& brick);
    void renew_bricks(std::span<const BrickKey> keys);
    LeapGridInput leap_input(const std::optional<MaskBinding>& painted) const;

    gpu::Executor& executor_;
    gpu::Memory& memory_;
    std::shared_ptr<const VolumeSource> source_;
    AtlasCodes codes_;
    glm::uvec3 brick_counts_{1}, cell_counts_{1}, atlas_slots_{1};
    gpu::Storage atlas_, page_table_, cell_ranges_, leap_, sample_bits_;
    std::array<gpu::Storage, 2> leap_scratch_;
    std::vector<BrickTexels::Range> ranges_;  ///< by brick
    uint64_t places_revision_ = 1;
    Visibility visibility_;
    EmptySpace empty_space_;
    std::optional<BrickUploads> uploads_;  ///< while bricks are being uploaded
    std::vector<uint32_t> slots_;          ///< slots of the bricks loaded so far
    std::unique_ptr<Builder> builder_;     ///< while the volume is loaded in slices
};

}  // namespace shvr
