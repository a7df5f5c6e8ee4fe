#pragma once
// Makes pictures: owns the volume, the mask and the leap grid on the device, and lists the passes of a frame in order.
//
//   [mask changed]            upload mask bricks
//   [look or mask changed]    leap_occupancy -> leap_distance x, y, z      (one thread a cell)
//   every picture             raycast -> read back                         (one thread a pixel)
//
// One thread, the one that owns the device. `render` waits for the picture; nothing is kept running in between.

#include <memory>
#include <optional>

#include "engine/base/image.h"
#include "engine/scene/device_mask.h"
#include "engine/scene/device_volume.h"
#include "engine/scene/session.h"
#include "shaders/raycast.h"

namespace shvr {

struct RenderOptions {
    bool count_work = false;  ///< keep the exact work counters (a little slower)
    bool serialize = false;   ///< a full barrier between passes
    bool timestamps = true;
};

struct Picture {
    ImageF image;          ///< linear light, premultiplied, over the background
    bool complete = true;  ///< every brick was there at its wanted level
    std::vector<gpu::PassReport> passes;
    double wall_ms = 0.0;
    FrameGraph graph;  ///< what was run, for `profile --graph`
};

class Renderer {
public:
    struct Options {
        gpu::DeviceOptions device;
        gpu::Budget budget;
        int threads = 0;  ///< workers that build bricks; 0: one a core
    };
    explicit Renderer(const Options& options);

    gpu::Device& device() { return device_; }
    gpu::Memory& memory() { return memory_; }
    gpu::Executor& executor() { return executor_; }

    /// Replaces the volume. The statistics give the intensity window and the scale of gradients; `sampling` decides how
    /// the device holds the bricks.
    void load(const VolumeSource& source, const VolumeStatistics& statistics, Sampling sampling = Sampling::automatic);
    const DeviceVolume& volume() const;
    const VolumeStatistics& statistics() const { return statistics_; }

    /// Brings changed bricks of the mask to the device.
    void update_mask(const Mask& mask, std::span<const int64_t> bricks);

    /// The picture of `session` (its light, transfer function, groups, cut) from `camera`.
    Picture render(const Session& session, const Camera& camera, const RenderOptions& options = {});

private:
    bool filters(Sampling sampling) const;
    bool leap_is_stale(const LeapGridInput& input) const;
    Resource upload_table(FrameGraph& graph, std::span<const glm::vec4> table);

    gpu::Device device_;
    gpu::Memory memory_;
    gpu::Executor executor_;
    int threads_;
    VolumeStatistics statistics_;
    std::optional<DeviceVolume> volume_;
    DeviceMask mask_;
    gpu::Storage table_, table_staging_;
    std::vector<glm::vec4> table_on_device_;
    /// What the leap grid on the device was built from.
    struct LeapState {
        gpu::OccupancyParams params;
        std::vector<uint32_t> visible_intervals;
        std::array<uint32_t, 8> visible_groups;
    };
    std::optional<LeapState> leap_state_;
};

/// Entries of the transfer function's table on the device.
inline constexpr uint32_t TABLE_ENTRIES = gpu::TABLE_WIDTH * gpu::TABLE_HEIGHT;

}  // namespace shvr
