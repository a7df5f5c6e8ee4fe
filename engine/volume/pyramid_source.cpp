#include "engine/volume/pyramid_source.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "engine/base/error.h"
#include "shaders/bricks.h"

namespace shvr {

namespace {

/// A level as its file would hold it.
struct Level {
    Size3 size{0};
    std::vector<std::byte> voxels;
};

/// Integers: to the nearest, halves up.
template <class T>
T mean_of(double sum, int count)
{
    if constexpr (std::is_floating_point_v<T>) return static_cast<T>(sum / count);
    return static_cast<T>(std::floor(sum / count + 0.5));
}

/// Halves two slices (one at an odd end) along each axis: means over the voxels that exist.
template <class T>
void halve(const T* slices, const Size3& size, T* halved)
{
    for (int64_t y = 0; y < size.y; y += 2)
        for (int64_t x = 0; x < size.x; x += 2) {
            double sum = 0.0;
            int count = 0;
            for (int64_t z = 0; z < size.z; ++z)
                for (int64_t j = y; j < std::min(y + 2, size.y); ++j)
                    for (int64_t i = x; i < std::min(x + 2, size.x); ++i, ++count)
                        sum += static_cast<double>(slices[i + size.x * (j + size.y * z)]);
            *halved++ = mean_of<T>(sum, count);
        }
}

template <class T>
Level halved(const VolumeSource& source, int level)
{
    const Size3 size = size_of_level(source.info().size, level), half = size_of_level(source.info().size, level + 1);
    Level result{half, {}};
    result.voxels.resize(static_cast<size_t>(half.x * half.y * half.z) * sizeof(T));
    std::vector<T> slices(static_cast<size_t>(size.x * size.y * 2));
    for (int64_t z = 0; z < half.z; ++z) {
        const VoxelBox box{{0, 0, 2 * z}, {size.x, size.y, std::min(2 * z + 2, size.z)}};
        const std::span<T> read(slices.data(), static_cast<size_t>(size.x * size.y * box.size().z));
        source.read_level(level, box, std::as_writable_bytes(read));
        halve(slices.data(), box.size(), reinterpret_cast<T*>(result.voxels.data()) + half.x * half.y * z);
    }
    return result;
}

class PyramidSource final : public VolumeSource {
public:
    explicit PyramidSource(std::shared_ptr<const VolumeSource> base)
        : VolumeSource(base->info()), base_(std::move(base))
    {}

    template <class T>
    void build(int levels)
    {
        while (int(coarse_.size()) + 1 < levels) coarse_.push_back(halved<T>(*this, int(coarse_.size())));
    }

    void read(const VoxelBox& box, std::span<std::byte> voxels) const override { base_->read(box, voxels); }
    int levels() const override { return int(coarse_.size()) + 1; }
    void read_level(int level, const VoxelBox& box, std::span<std::byte> voxels) const override
    {
        if (level == 0) return read(box, voxels);
        const Level& coarse = coarse_.at(static_cast<size_t>(level - 1));
        const Size3 extent = box.size();
        const auto voxel_bytes = static_cast<int64_t>(bytes_of(info().type));
        std::byte* to = voxels.data();
        for (int64_t z = box.lower.z; z < box.upper.z; ++z)
            for (int64_t y = box.lower.y; y < box.upper.y; ++y, to += extent.x * voxel_bytes)
                std::memcpy(
                    to, coarse.voxels.data() + voxel_bytes * (box.lower.x + coarse.size.x * (y + coarse.size.y * z)),
                    static_cast<size_t>(extent.x * voxel_bytes));
    }
    std::optional<VolumeStatistics> statistics() const override { return base_->statistics(); }

private:
    std::shared_ptr<const VolumeSource> base_;
    std::vector<Level> coarse_;
};

}  // namespace

std::shared_ptr<const VolumeSource> with_levels(std::shared_ptr<const VolumeSource> source, uint64_t most_bytes)
{
    const VolumeInfo& info = source->info();
    int levels = 1;
    uint64_t bytes = 0;
    for (Size3 size = info.size; std::max({size.x, size.y, size.z}) > int64_t{gpu::BRICK_SIZE}; ++levels) {
        size = size_of_level(size, 1);
        bytes += uint64_t(size.x) * uint64_t(size.y) * uint64_t(size.z) * bytes_of(info.type);
    }
    if (source->levels() > 1 || levels == 1) return source;
    if (bytes > most_bytes)
        fail(info.name, ": its coarser levels take ", (bytes >> 20) + 1, " MiB of host memory, which holds ",
             most_bytes >> 20, " MiB of bricks; expected a larger --budget-host, or a project made by `shvr import`");
    auto pyramid = std::make_shared<PyramidSource>(std::move(source));
    switch (pyramid->info().type) {
        case VoxelType::uint8: pyramid->build<uint8_t>(levels); break;
        case VoxelType::int8: pyramid->build<int8_t>(levels); break;
        case VoxelType::uint16: pyramid->build<uint16_t>(levels); break;
        case VoxelType::int16: pyramid->build<int16_t>(levels); break;
        case VoxelType::uint32: pyramid->build<uint32_t>(levels); break;
        case VoxelType::int32: pyramid->build<int32_t>(levels); break;
        case VoxelType::float32: pyramid->build<float>(levels); break;
        case VoxelType::float64: pyramid->build<double>(levels); break;
    }
    return pyramid;
}

}  // namespace shvr
