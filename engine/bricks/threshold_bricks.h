#pragma once
// One bit per voxel: whether its value in the file is at or above a threshold. Bricks of bits are read on first
// use, and cached. Brushes and touch use these bits where several values share a 16-bit code (has_exact_codes,
// volume.h).
//
// Used by one thread; get_ready() reads on a separate thread.

#include <array>
#include <atomic>
#include <future>
#include <memory>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "engine/volume/source.h"

namespace shvr {

class ThresholdBricks {
public:
    /// `source` includes the density offsets, if there are any.
    explicit ThresholdBricks(std::shared_ptr<const VolumeSource> source);
    ~ThresholdBricks();
    ThresholdBricks(const ThresholdBricks&) = delete;

    /// Whether all bricks that bits_in() would need have been read. If not, starts reading them in the background; the
    /// caller has to ask again later. Fails if voxels cannot be read.
    bool get_ready(const VoxelBox& box, double threshold);
    /// The bits of a box inside the volume, in rows of whole words along x: bit b of word w of row (y, z) is voxel x =
    /// box.lower.x + 32 w + b. NaN is below every threshold. Reads missing bricks; fails if one cannot be read.
    std::vector<uint32_t> bits_in(const VoxelBox& box, double threshold);
    /// Drops the cached bits in these boxes, whose voxels have changed.
    void renew(std::span<const VoxelBox> changed);

private:
    static constexpr int64_t SIDE = 32;                    ///< voxels along each axis of a brick; a row fills one word
    static constexpr size_t MAX_BRICKS = size_t{1} << 12;  ///< maximum number of kept bricks: 16 MiB
    using Bits = std::array<uint32_t, SIDE * SIDE>;        ///< rows, y fastest
    struct Key {
        double threshold = 0.0;
        Size3 brick{0};
        bool operator==(const Key&) const = default;
    };
    struct KeyHash {
        size_t operator()(const Key& key) const;
    };
    using Bricks = std::unordered_map<Key, std::shared_ptr<const Bits>, KeyHash>;

    std::vector<Size3> missing(const VoxelBox& box, double threshold) const;
    static Bricks read(const VolumeSource& source, const std::vector<Size3>& bricks, double threshold);
    void take_reading();

    std::shared_ptr<const VolumeSource> source_;
    Bricks kept_;
    bool reading_is_stale_ = false;  ///< voxels changed since `reading_` began
    std::atomic<bool> is_ending_ = false;
    std::future<Bricks> reading_;  ///< in the background; its destructor waits, so it is declared last
};

}  // namespace shvr
