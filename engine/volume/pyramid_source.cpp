#include "engine/volume/pyramid_source.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "engine/base/error.h"
#include "engine/volume/halving.h"
#include "engine/volume/voxel_dispatch.h"
#include "shaders/bricks.h"

namespace shvr {

namespace {

/// A level in the layout of a file.
struct Level {
    Size3 size{0};
    std::vector<std::byte> voxels;
};

template <class T>
Level halved(const VolumeSource& source, int level)
{
    const Size3 size = size_of_level(source.info().size, level), half = size_of_level(source.info().size, level + 1);
    Level result{half, {}};
    result.voxels.resize(size_t(half.x * half.y * half.z) * sizeof(T));
    auto* to = reinterpret_cast<T*>(result.voxels.data());
    std::vector<T> slices(size_t(size.x * size.y * std::min<int64_t>(size.z, 2)));
    for (int64_t z = 0; z < size.z; z += 2) {
        const VoxelBox box{{0, 0, z}, {size.x, size.y, std::min(z + 2, size.z)}};
        const Size3 extent = box.size();
        const std::span<T> read(slices.data(), size_t(extent.x * extent.y * extent.z));
        source.read_level(level, box, std::as_writable_bytes(read));
        for (int64_t y = 0; y < extent.y; y += 2, to += half.x) {
            HalvingRows<T> rows;
            for (int64_t slice = 0; slice < extent.z; ++slice)
                for (int64_t row = y; row < std::min(y + 2, extent.y); ++row)
                    rows.first[size_t(rows.count++)] = read.data() + extent.x * (row + extent.y * slice);
            halve_rows(rows, extent.x, to);
        }
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
        const Level& coarse = coarse_.at(size_t(level - 1));
        const Size3 extent = box.size();
        const auto voxel_bytes = int64_t(bytes_of(info().type));
        std::byte* to = voxels.data();
        for (int64_t z = box.lower.z; z < box.upper.z; ++z)
            for (int64_t y = box.lower.y; y < box.upper.y; ++y, to += extent.x * voxel_bytes)
                std::memcpy(
                    to, coarse.voxels.data() + voxel_bytes * (box.lower.x + coarse.size.x * (y + coarse.size.y * z)),
                    size_t(extent.x * voxel_bytes));
    }
    Size3 block() const override { return base_->block(); }
    std::optional<ValueRange> brick_range(int level, const Size3& brick) const override
    {
        // Means lie within the range of their voxels, but only the source knows that range.
        return level == 0 ? base_->brick_range(level, brick) : std::nullopt;
    }
    std::optional<VolumeStatistics> statistics() const override { return base_->statistics(); }

private:
    std::shared_ptr<const VolumeSource> base_;
    std::vector<Level> coarse_;
};

}  // namespace

std::shared_ptr<const VolumeSource> with_levels(std::shared_ptr<const VolumeSource> source, uint64_t host_budget_bytes)
{
    constexpr int MEBIBYTE = 20;  // as a shift
    const VolumeInfo& info = source->info();
    const auto bytes_in = [&](const Size3& size) { return uint64_t(size.x * size.y * size.z) * bytes_of(info.type); };
    int levels = 1;
    uint64_t bytes = bytes_in({info.size.x, info.size.y, std::min<int64_t>(info.size.z, 2)});
    for (Size3 size = info.size; std::max({size.x, size.y, size.z}) > int64_t{gpu::BRICK_SIZE}; ++levels) {
        size = size_of_level(size, 1);
        bytes += bytes_in(size);
    }
    if (source->levels() > 1 || levels == 1) return source;
    if (bytes > host_budget_bytes / LEVELS_SHARE_OF_HOST) {
        fail(info.name, ": is drawn in pieces, and making its coarser levels takes ", (bytes >> MEBIBYTE) + 1,
             " MiB; expected at most ", (host_budget_bytes / LEVELS_SHARE_OF_HOST) >> MEBIBYTE,
             " MiB, a quarter of --budget-host: use --budget-host ", (LEVELS_SHARE_OF_HOST * bytes >> MEBIBYTE) + 1,
             ", or make a project with `shvr import FILE PROJECT` and open that");
    }
    auto pyramid = std::make_shared<PyramidSource>(std::move(source));
    with_voxel_type(pyramid->info().type, [&]<class T>(T) { pyramid->build<T>(levels); });
    return pyramid;
}

}  // namespace shvr
