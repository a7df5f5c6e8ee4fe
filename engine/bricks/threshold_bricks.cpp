#include "engine/bricks/threshold_bricks.h"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <functional>
#include <utility>

#include "engine/base/error.h"
#include "engine/base/waits/waits.h"
#include "engine/volume/grid.h"
#include "engine/volume/voxel_dispatch.h"

namespace shvr {
namespace {

/// Visits the bricks that overlap a box, x fastest.
template <class Visit>
void for_each_brick(const VoxelBox& box, int64_t side, const Visit& visit)
{
    const Size3 first = box.lower / side, last = (box.upper - int64_t{1}) / side;
    for (int64_t z = first.z; z <= last.z; ++z)
        for (int64_t y = first.y; y <= last.y; ++y)
            for (int64_t x = first.x; x <= last.x; ++x) visit(Size3(x, y, z));
}

/// The bits of `count` (at most 32) consecutive voxels of a row.
template <class T>
uint32_t word_of(const std::byte* voxels, int64_t count, double threshold)
{
    uint32_t word = 0;
    for (int64_t i = 0; i < count; ++i) {
        T voxel;
        std::memcpy(&voxel, voxels + size_t(i) * sizeof(T), sizeof(T));
        word |= uint32_t{double(voxel) >= threshold} << i;
    }
    return word;
}

}  // namespace

size_t ThresholdBricks::KeyHash::operator()(const Key& key) const
{
    const Size3& brick = key.brick;
    return std::hash<double>()(key.threshold) ^ std::hash<int64_t>()(brick.x + (brick.y << 20) + (brick.z << 40));
}

ThresholdBricks::ThresholdBricks(std::shared_ptr<const VolumeSource> source) : source_(std::move(source)) {}

ThresholdBricks::~ThresholdBricks()
{
    is_ending_ = true;
}

bool ThresholdBricks::get_ready(const VoxelBox& box, double threshold)
{
    const bool is_reading = reading_.valid();
    if (is_reading && reading_.wait_for(std::chrono::seconds(0)) != std::future_status::ready)
        return missing(box, threshold).empty();
    if (is_reading) take_reading();
    std::vector<Size3> bricks = missing(box, threshold);
    if (bricks.empty()) return true;
    reading_is_stale_ = false;
    reading_ = std::async(std::launch::async, [this, source = source_, bricks = std::move(bricks), threshold] {
        const WaitsUntil waits([this] { return is_ending_.load(); });
        return read(*source, bricks, threshold);
    });
    return false;
}

std::vector<uint32_t> ThresholdBricks::bits_in(const VoxelBox& box, double threshold)
{
    if (reading_.valid() && !missing(box, threshold).empty()) {
        try {
            take_reading();
        } catch (const Error&) {  // if the brick is still needed, a later read reports the failure
        }
    }
    if (kept_.size() + missing(box, threshold).size() > MAX_BRICKS) kept_.clear();
    if (const std::vector<Size3> unread = missing(box, threshold); !unread.empty())
        kept_.merge(read(*source_, unread, threshold));
    std::vector<const Bits*> bricks;
    for_each_brick(box, SIDE, [&](const Size3& brick) { bricks.push_back(kept_.at({threshold, brick}).get()); });
    const Size3 first = box.lower / SIDE, counts = (box.upper - int64_t{1}) / SIDE - first + int64_t{1};
    const Size3 size = box.size();
    const int64_t words = (size.x + 31) / 32, shift = box.lower.x % SIDE;
    std::vector<uint32_t> bits(size_t(words * size.y * size.z));
    auto next = bits.begin();
    for (int64_t z = box.lower.z; z < box.upper.z; ++z)
        for (int64_t y = box.lower.y; y < box.upper.y; ++y) {
            const int64_t row_of_bricks = counts.x * (y / SIDE - first.y + counts.y * (z / SIDE - first.z));
            const size_t row = size_t(y % SIDE + SIDE * (z % SIDE));
            const auto word = [&](int64_t i) {
                return i < counts.x ? uint64_t{(*bricks[size_t(row_of_bricks + i)])[row]} : uint64_t{0};
            };
            for (int64_t w = 0; w < words; ++w) {
                const int64_t left = size.x - 32 * w;
                const auto both = uint32_t((word(w) | word(w + 1) << 32) >> shift);
                *next++ = left < 32 ? both & ((1u << left) - 1u) : both;
            }
        }
    return bits;
}

void ThresholdBricks::renew(std::span<const VoxelBox> changed)
{
    reading_is_stale_ = true;
    std::erase_if(kept_, [&](const auto& kept) {
        const VoxelBox voxels{kept.first.brick * SIDE, (kept.first.brick + int64_t{1}) * SIDE};
        return std::ranges::any_of(changed, [&](const VoxelBox& box) {
            return glm::all(glm::lessThan(box.lower, voxels.upper)) && glm::all(glm::lessThan(voxels.lower, box.upper));
        });
    });
}

std::vector<Size3> ThresholdBricks::missing(const VoxelBox& box, double threshold) const
{
    std::vector<Size3> bricks;
    for_each_brick(box, SIDE, [&](const Size3& brick) {
        if (!kept_.contains({threshold, brick})) bricks.push_back(brick);
    });
    return bricks;
}

/// Reads all bricks of a layer together, so that a block of the file that spans several bricks is decoded only once.
ThresholdBricks::Bricks ThresholdBricks::read(const VolumeSource& source, const std::vector<Size3>& bricks,
                                              double threshold)
{
    static const auto none = std::make_shared<const Bits>(Bits{});
    Bricks made;
    std::vector<Size3> unknown;
    for (const Size3& brick : bricks) {
        const std::optional<ValueRange> range = source.brick_range(0, brick);
        if (range && range->upper < threshold)
            made.emplace(Key{threshold, brick}, none);
        else
            unknown.push_back(brick);
    }
    const Size3 size = source.info().size;
    const size_t voxel_bytes = bytes_of(source.info().type);
    std::vector<std::byte> voxels;
    for (auto begin = unknown.begin(); begin != unknown.end();) {
        const auto end = std::find_if(begin, unknown.end(), [&](const Size3& each) { return each.z != begin->z; });
        VoxelBox box{*begin, *begin};
        for (auto each = begin; each != end; ++each)
            box = {glm::min(box.lower, *each), glm::max(box.upper, *each + int64_t{1})};
        box = {box.lower * SIDE, glm::min(box.upper * SIDE, size)};
        const Size3 extent = box.size();
        voxels.resize(size_t(extent.x * extent.y * extent.z) * voxel_bytes);
        source.read(box, voxels);
        for (; begin != end; ++begin) {
            const VoxelBox own{*begin * SIDE, glm::min((*begin + int64_t{1}) * SIDE, size)};
            auto bits = std::make_shared<Bits>(Bits{});
            with_voxel_type(source.info().type, [&]<class T>(T) {
                for (int64_t z = own.lower.z; z < own.upper.z; ++z)
                    for (int64_t y = own.lower.y; y < own.upper.y; ++y) {
                        const int64_t at = index_of(Size3(own.lower.x, y, z) - box.lower, extent);
                        (*bits)[size_t(y % SIDE + SIDE * (z % SIDE))] =
                            word_of<T>(voxels.data() + size_t(at) * sizeof(T), own.size().x, threshold);
                    }
            });
            made.emplace(Key{threshold, *begin}, std::move(bits));
        }
    }
    return made;
}

void ThresholdBricks::take_reading()
{
    Bricks read = std::exchange(reading_, {}).get();
    if (reading_is_stale_) return;
    if (kept_.size() + read.size() > MAX_BRICKS) kept_.clear();
    kept_.merge(std::move(read));
}

}  // namespace shvr
