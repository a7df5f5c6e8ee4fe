#include "engine/volume/offset_source.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>
#include <limits>
#include <mutex>
#include <set>
#include <tuple>
#include <unordered_set>

#include "engine/base/error.h"
#include "engine/volume/grid.h"
#include "engine/volume/halving.h"
#include "engine/volume/voxel_dispatch.h"

namespace shvr {

namespace {

template <class T>
using OffsetOf = std::conditional_t<std::is_floating_point_v<T>, float, int32_t>;

/// Adds an offset to a voxel and clamps the sum to the type's range. NaN and infinities stay unchanged.
template <class T>
T raised(T voxel, OffsetOf<T> offset)
{
    using Limits = std::numeric_limits<T>;
    if constexpr (std::is_floating_point_v<T>) {
        if (!std::isfinite(voxel)) return voxel;
        return static_cast<T>(
            std::clamp(double(voxel) + double(offset), double(Limits::lowest()), double(Limits::max())));
    } else {
        return static_cast<T>(
            std::clamp<int64_t>(int64_t{voxel} + offset, int64_t{Limits::lowest()}, int64_t{Limits::max()}));
    }
}

/// Returns value + offset, clamped to the range of `type`. Not rounded for integer types, since it is used as a bound.
double raised_value(VoxelType type, double value, double offset)
{
    return with_voxel_type(type, [&]<class T>(T) {
        using Limits = std::numeric_limits<T>;
        const double sum = std::clamp(value + offset, double(Limits::lowest()), double(Limits::max()));
        if constexpr (std::is_floating_point_v<T>) return double(static_cast<T>(sum));
        return sum;
    });
}

template <class T>
void add_row(std::byte* voxels, const uint32_t* offsets, int64_t count)
{
    for (int64_t x = 0; x < count; ++x, voxels += sizeof(T)) {
        if (offsets[x] == 0) continue;
        T voxel;
        std::memcpy(&voxel, voxels, sizeof voxel);
        voxel = raised<T>(voxel, std::bit_cast<OffsetOf<T>>(offsets[x]));
        std::memcpy(voxels, &voxel, sizeof voxel);
    }
}

/// Halves the offsets of a brick (`extent` voxels) and stores them in one octant of its parent brick.
template <class Offset>
void halve(const OffsetBrick& brick, const Size3& extent, const Size3& octant, OffsetBrick& above)
{
    std::array<Offset, std::tuple_size_v<OffsetBrick>> finer;
    std::memcpy(finer.data(), brick.data(), sizeof finer);
    std::array<Offset, BRICK_SIDE> row;
    const int64_t half = (extent.x + 1) / 2;
    for (int64_t z = 0; z < extent.z; z += 2)
        for (int64_t y = 0; y < extent.y; y += 2) {
            HalvingRows<Offset> rows;
            for (int64_t slice = z; slice < std::min(z + 2, extent.z); ++slice)
                for (int64_t line = y; line < std::min(y + 2, extent.y); ++line)
                    rows.first[size_t(rows.count++)] = finer.data() + BRICK_SIDE * (line + BRICK_SIDE * slice);
            halve_rows(rows, extent.x, row.data());
            for (int64_t x = 0; x < half; ++x)
                if (row[size_t(x)] == Offset{0}) row[size_t(x)] = Offset{0};  // -0 does not count as an offset
            const Size3 to = octant * (BRICK_SIDE / 2) + Size3(0, y / 2, z / 2);
            std::memcpy(above.data() + to.x + BRICK_SIDE * (to.y + BRICK_SIDE * to.z), row.data(),
                        size_t(half) * sizeof(Offset));
        }
}

ValueRange range_of(VoxelType type, const OffsetBrick& offsets)
{
    ValueRange range;
    for (const uint32_t bits : offsets) {
        if (bits == 0) continue;
        const double offset = offset_of(type, bits);
        range = {std::min(range.lower, offset), std::max(range.upper, offset)};
    }
    return range;
}

bool is_none(const OffsetBrick& offsets)
{
    return std::all_of(offsets.begin(), offsets.end(), [](uint32_t bits) { return bits == 0; });
}

}  // namespace

double offset_limit(VoxelType type)
{
    if (is_float(type)) return double(std::numeric_limits<float>::max());
    const size_t bytes = bytes_of(type);
    return bytes == 1 ? 255.0 : bytes == 2 ? 65535.0 : 2147483647.0;
}

uint32_t offset_bits(VoxelType type, double offset)
{
    SHVR_CHECK(!std::isnan(offset), "an offset that is not a number");
    const double limit = offset_limit(type), within = std::clamp(offset, -limit, limit);
    if (!is_float(type)) return std::bit_cast<uint32_t>(int32_t(std::round(within)));
    const auto rounded = float(within);
    return rounded == 0.0f ? 0 : std::bit_cast<uint32_t>(rounded);
}

OffsetSource::OffsetSource(std::shared_ptr<const VolumeSource> base)
    : VolumeSource(base->info()), base_(std::move(base))
{}

const OffsetSource::Entry* OffsetSource::find(const Entries& changed, const BrickKey& key) const
{
    if (const auto found = changed.find(key); found != changed.end()) return &found->second;
    const auto found = entries_.find(key);
    return found == entries_.end() ? nullptr : &found->second;
}

/// Recomputes the offsets of a parent brick from its up to eight child bricks on the next finer level.
OffsetSource::Entry OffsetSource::parent(const Entries& changed, const BrickKey& key) const
{
    auto offsets = std::make_shared<OffsetBrick>(OffsetBrick{});
    const Size3 size = size_of_level(info().size, key.level - 1);
    Entry entry;
    for (int i = 0; i < 8; ++i) {
        const glm::ivec3 octant(i & 1, i >> 1 & 1, i >> 2);
        const BrickKey below{key.level - 1, 2 * key.brick + octant};
        const Entry* finer = find(changed, below);
        if (!finer) continue;
        entry.range = {std::min(entry.range.lower, finer->range.lower),
                       std::max(entry.range.upper, finer->range.upper)};
        if (!finer->offsets) continue;
        const Size3 extent = glm::min(Size3(BRICK_SIDE), size - BRICK_SIDE * Size3(below.brick));
        if (is_float(info().type))
            halve<float>(*finer->offsets, extent, Size3(octant), *offsets);
        else
            halve<int32_t>(*finer->offsets, extent, Size3(octant), *offsets);
    }
    if (!is_none(*offsets)) entry.offsets = std::move(offsets);
    return entry;
}

void OffsetSource::set(std::span<const Brick> bricks)
{
    Entries changed;
    std::unordered_set<BrickKey, BrickKeyHash> keys;
    for (const Brick& brick : bricks) {
        Entry& entry = changed[{0, brick.brick}];
        entry = {};
        if (brick.offsets && !is_none(*brick.offsets)) {
            entry.offsets = brick.offsets;
            entry.range = range_of(info().type, *brick.offsets);
        }
        keys.insert({0, brick.brick});
    }
    for (int level = 1; level < levels(); ++level) {
        std::unordered_set<BrickKey, BrickKeyHash> above;
        for (const BrickKey& key : keys) above.insert(parent_of(key));
        for (const BrickKey& key : above) {
            Entry entry = parent(changed, key);
            changed[key] = std::move(entry);
        }
        keys = std::move(above);
    }
    const std::unique_lock lock(mutex_);
    for (auto& [key, entry] : changed) {
        if (entry.offsets || entry.range != ValueRange{})
            entries_[key] = std::move(entry);
        else
            entries_.erase(key);
    }
    any_.store(!entries_.empty(), std::memory_order_release);
}

void OffsetSource::read_level(int level, const VoxelBox& box, std::span<std::byte> voxels) const
{
    base_->read_level(level, box, voxels);
    if (empty() || voxels.empty()) return;
    std::vector<std::pair<Size3, std::shared_ptr<const OffsetBrick>>> found;
    const Size3 first = box.lower / BRICK_SIDE, last = (box.upper - int64_t{1}) / BRICK_SIDE;
    {
        const std::shared_lock lock(mutex_);
        for (int64_t z = first.z; z <= last.z; ++z)
            for (int64_t y = first.y; y <= last.y; ++y)
                for (int64_t x = first.x; x <= last.x; ++x)
                    if (const auto at = entries_.find({level, glm::ivec3(x, y, z)});
                        at != entries_.end() && at->second.offsets)
                        found.emplace_back(BRICK_SIDE * Size3(x, y, z), at->second.offsets);
    }
    const Size3 extent = box.size();
    with_voxel_type(info().type, [&]<class T>(T) {
        for (const auto& [corner, offsets] : found) {
            const Size3 lower = glm::max(corner, box.lower), upper = glm::min(corner + BRICK_SIDE, box.upper);
            for (int64_t z = lower.z; z < upper.z; ++z)
                for (int64_t y = lower.y; y < upper.y; ++y) {
                    const Size3 to = Size3(lower.x, y, z) - box.lower, from = Size3(lower.x, y, z) - corner;
                    add_row<T>(voxels.data() + int64_t(sizeof(T)) * index_of(to, extent),
                               offsets->data() + from.x + BRICK_SIDE * (from.y + BRICK_SIDE * from.z),
                               upper.x - lower.x);
                }
        }
    });
}

std::optional<ValueRange> OffsetSource::brick_range(int level, const Size3& brick) const
{
    std::optional<ValueRange> range = base_->brick_range(level, brick);
    if (!range || range->lower > range->upper || empty()) return range;
    ValueRange offsets;
    {
        const std::shared_lock lock(mutex_);
        for (int i = 0; i < 27; ++i) {
            const glm::ivec3 around(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
            const auto at = entries_.find({level, glm::ivec3(brick) + around});
            if (at == entries_.end()) continue;
            offsets = {std::min(offsets.lower, at->second.range.lower),
                       std::max(offsets.upper, at->second.range.upper)};
        }
    }
    if (offsets == ValueRange{}) return range;
    return ValueRange{raised_value(info().type, range->lower, offsets.lower),
                      raised_value(info().type, range->upper, offsets.upper)};
}

std::optional<StoredBlocks> OffsetSource::stored_blocks(int level, int64_t most) const
{
    std::optional<StoredBlocks> stored = base_->stored_blocks(level, most);
    if (!stored || empty()) return stored;
    const auto before = [](const glm::ivec3& a, const glm::ivec3& b) {
        return std::tie(a.z, a.y, a.x) < std::tie(b.z, b.y, b.x);
    };
    std::set<glm::ivec3, decltype(before)> raised(before);
    const Size3 size = size_of_level(info().size, level);
    {
        const std::shared_lock lock(mutex_);
        for (const auto& [key, entry] : entries_) {
            if (key.level != level || !entry.offsets) continue;
            const Size3 corner = BRICK_SIDE * Size3(key.brick);
            const Size3 first = corner / stored->block;
            const Size3 last = (glm::min(corner + BRICK_SIDE, size) - int64_t{1}) / stored->block;
            for (int64_t z = first.z; z <= last.z; ++z)
                for (int64_t y = first.y; y <= last.y; ++y)
                    for (int64_t x = first.x; x <= last.x; ++x) raised.emplace(x, y, z);
        }
    }
    std::vector<glm::ivec3> all;
    std::ranges::set_union(stored->blocks, raised, std::back_inserter(all), before);
    if (int64_t(all.size()) > most) return std::nullopt;
    stored->blocks = std::move(all);
    return stored;
}

std::optional<VolumeStatistics> OffsetSource::statistics() const
{
    return empty() ? base_->statistics() : std::nullopt;
}

}  // namespace shvr
