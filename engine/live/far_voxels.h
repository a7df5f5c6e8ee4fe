#pragma once
// Reads voxels of a volume on another machine in the background, for a main thread that must not wait for a network.
// Used by one thread.

#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "engine/live/densities.h"

namespace shvr {

class FarVoxels {
public:
    FarVoxels() = default;
    FarVoxels(const FarVoxels&) = delete;
    /// Ends the present read, also while it waits for a network.
    ~FarVoxels();

    /// Returns the intensities of a box, without density offsets, if they have been read. Otherwise starts reading
    /// them, and ends the read of any other box. A box that cannot be read has no values; it is not read again until
    /// another one was asked for.
    std::optional<DensityBox> find(const std::shared_ptr<const VolumeSource>& source, const VoxelBox& box);
    /// Whether the box last asked for is still being read.
    bool is_reading() const;

private:
    struct Wanted {
        std::shared_ptr<const VolumeSource> source{};
        VoxelBox box{};
    };
    bool is_wanted(const Wanted& wanted) const;
    void read(const std::stop_token& stop);

    mutable std::mutex mutex_;
    std::condition_variable_any asked_;
    std::optional<Wanted> wanted_;  ///< the box last asked for
    std::optional<DensityBox> read_;
    bool is_done_ = false;  ///< `wanted_` was read, or could not be read
    std::jthread thread_;   ///< declared last, since it uses the other members; started by the first box
};

}  // namespace shvr
