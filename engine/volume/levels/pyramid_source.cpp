#include "engine/volume/levels/pyramid_source.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "engine/base/error.h"
#include "engine/volume/grid.h"
#include "engine/volume/halving.h"
#include "engine/volume/levels/sparse_levels.h"
#include "engine/volume/voxel_dispatch.h"

namespace shvr {

namespace {

/// If a file's coarsest level has more bricks than this (512^3 voxels), coarser levels are computed.
constexpr int64_t MAX_COARSEST = 4096;

/// A level with x fastest, as in a file.
struct Level {
    Size3 size{0};
    std::vector<std::byte> voxels;
};

template <class T>
Level halved(const VolumeSource& source, int level, const Progress& progress)
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
        tell(progress, double(z) / double(size.z));
    }
    return result;
}

class PyramidSource final : public VolumeSource {
public:
    explicit PyramidSource(std::shared_ptr<const VolumeSource> base)
        : VolumeSource(base->info()), base_(std::move(base))
    {}

    template <class T>
    void build(int levels, const Progress& progress)
    {
        double begun = 0.0;
        // Progress is divided in proportion to voxels: each level has an eighth of the voxels of the previous level.
        for (double share = 0.875; this->levels() < levels; share /= 8.0) {
            coarse_.push_back(halved<T>(*this, this->levels() - 1, part_of(progress, begun, begun + share)));
            begun += share;
        }
    }
    void build(SparseLevels levels, int count, const Progress& progress)
    {
        levels.build(*base_, progress);
        sparse_ = std::move(levels);
        levels_ = count;
    }

    void read(const VoxelBox& box, std::span<std::byte> voxels) const override { base_->read(box, voxels); }
    int levels() const override { return sparse_ ? levels_ : base_->levels() + int(coarse_.size()); }
    void read_level(int level, const VoxelBox& box, std::span<std::byte> voxels) const override
    {
        if (level < base_->levels()) return base_->read_level(level, box, voxels);
        if (sparse_) return sparse_->read(level, box, voxels);
        const Level& coarse = coarse_.at(size_t(level - base_->levels()));
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
        if (level < base_->levels()) return base_->brick_range(level, brick);
        // The means lie in the range of the averaged voxels, which is not known here, except where nothing is stored.
        if (!sparse_ || !sparse_->is_gap(level, brick)) return std::nullopt;
        return sparse_->fills();
    }
    std::optional<StoredBlocks> stored_blocks(int level, int64_t most) const override
    {
        return level < base_->levels() ? base_->stored_blocks(level, most) : std::nullopt;
    }
    std::optional<VolumeStatistics> statistics() const override { return base_->statistics(); }

private:
    std::shared_ptr<const VolumeSource> base_;
    std::vector<Level> coarse_;
    std::optional<SparseLevels> sparse_;
    int levels_ = 0;  ///< including sparse ones
};

/// The levels that have to be computed for a source.
struct Plan {
    int levels = 0;  ///< 0: nothing
    std::optional<SparseLevels> sparse{};
    uint64_t bytes = 0;
};

Plan plan_of(const VolumeSource& source)
{
    const VolumeInfo& info = source.info();
    const auto bytes_in = [&](const Size3& size) { return uint64_t(size.x * size.y * size.z) * bytes_of(info.type); };
    const auto longest = [](const Size3& size) { return std::max({size.x, size.y, size.z}); };
    const int own = source.levels();
    Size3 size = size_of_level(info.size, own - 1);
    const Size3 bricks = brick_grid(size);
    const bool is_enough = longest(size) <= BRICK_SIDE || (own > 1 && bricks.x * bricks.y * bricks.z <= MAX_COARSEST);
    if (is_enough) return {};
    Plan plan{.levels = own};
    plan.bytes = bytes_in({size.x, size.y, std::min<int64_t>(size.z, 2)});
    for (; longest(size) > BRICK_SIDE; ++plan.levels) {
        size = size_of_level(size, 1);
        plan.bytes += bytes_in(size);
    }
    plan.sparse = SparseLevels::plan(source, plan.levels);
    if (plan.sparse) plan.bytes = plan.sparse->bytes();
    return plan;
}

Plan checked_plan_of(const VolumeSource& source, uint64_t host_budget_bytes)
{
    constexpr int MEBIBYTE = 20;  // as a shift
    Plan plan = plan_of(source);
    if (plan.bytes > host_budget_bytes / LEVELS_SHARE_OF_HOST) {
        fail(source.info().name, ": is drawn in pieces, and making its coarser levels takes ",
             (plan.bytes >> MEBIBYTE) + 1, " MiB; expected at most ",
             (host_budget_bytes / LEVELS_SHARE_OF_HOST) >> MEBIBYTE,
             " MiB, a quarter of --budget-host: use --budget-host ",
             (LEVELS_SHARE_OF_HOST * plan.bytes >> MEBIBYTE) + 1,
             ", or make a project with `shvr import FILE PROJECT` and open that");
    }
    return plan;
}

}  // namespace

int planned_levels(const VolumeSource& source, uint64_t host_budget_bytes)
{
    const int levels = checked_plan_of(source, host_budget_bytes).levels;
    return levels == 0 ? source.levels() : levels;
}

uint64_t bytes_of_levels(const VolumeSource& source)
{
    const Plan plan = plan_of(source);
    return plan.levels == 0 ? 0 : plan.bytes;
}

std::shared_ptr<const VolumeSource> with_levels(std::shared_ptr<const VolumeSource> source, uint64_t host_budget_bytes,
                                                const Progress& progress)
{
    Plan plan = checked_plan_of(*source, host_budget_bytes);
    if (plan.levels == 0) return source;
    auto pyramid = std::make_shared<PyramidSource>(std::move(source));
    if (plan.sparse)
        pyramid->build(*std::move(plan.sparse), plan.levels, progress);
    else
        with_voxel_type(pyramid->info().type, [&]<class T>(T) { pyramid->build<T>(plan.levels, progress); });
    return pyramid;
}

}  // namespace shvr
