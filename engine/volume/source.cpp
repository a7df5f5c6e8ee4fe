#include "engine/volume/source.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>

#include "engine/base/error.h"

namespace shvr {
namespace {

constexpr int64_t SLAB_BYTES = int64_t{32} << 20;
constexpr size_t BINS = 256;

/// Calls `take(span<const T>)` for every slab. Slabs are whole slices, or rows of one slice where that is too large.
template <class T, class Take>
void for_each_slab(const VolumeSource& source, const Take& take)
{
    const Size3 size = source.info().size;
    const int64_t row_bytes = size.x * static_cast<int64_t>(sizeof(T));
    const int64_t rows = std::min(size.y, std::max<int64_t>(1, SLAB_BYTES / row_bytes));
    const int64_t slices = rows < size.y ? 1 : std::min(size.z, std::max<int64_t>(1, SLAB_BYTES / (row_bytes * rows)));
    std::vector<T> slab(static_cast<size_t>(size.x * rows * slices));
    for (int64_t z = 0; z < size.z; z += slices) {
        for (int64_t y = 0; y < size.y; y += rows) {
            const VoxelBox box{{0, y, z}, {size.x, std::min(y + rows, size.y), std::min(z + slices, size.z)}};
            const Size3 extent = box.size();
            const std::span<T> voxels(slab.data(), static_cast<size_t>(extent.x * extent.y * extent.z));
            source.read(box, std::as_writable_bytes(voxels));
            take(std::span<const T>(voxels));
        }
    }
}

size_t bin_of(const VolumeStatistics& statistics, double value)
{
    const double range = statistics.maximum - statistics.minimum;
    if (!(range > 0.0)) return 0;
    return std::min(BINS - 1, static_cast<size_t>((value - statistics.minimum) / range * double{BINS}));
}

/// Integers have few enough values to count each; everything else follows from the counts.
template <class T>
VolumeStatistics measure_integers(const VolumeSource& source)
{
    using Unsigned = std::make_unsigned_t<T>;
    constexpr size_t VALUES = size_t{std::numeric_limits<Unsigned>::max()} + 1;
    // Neighbouring voxels are often equal; counting them in turn in several tables keeps one addition from waiting for
    // the one before.
    constexpr size_t TABLES = 4;
    std::vector<int64_t> counts(TABLES * VALUES);
    for_each_slab<T>(source, [&](std::span<const T> voxels) {
        for (size_t i = 0; i < voxels.size(); ++i) ++counts[(i % TABLES) * VALUES + static_cast<Unsigned>(voxels[i])];
    });

    std::vector<std::pair<double, int64_t>> present;  // value, how often; ascending
    constexpr int LOWEST = std::is_signed_v<T> ? -static_cast<int>(VALUES / 2) : 0;
    for (int value = LOWEST; value < LOWEST + static_cast<int>(VALUES); ++value) {
        int64_t count = 0;
        for (size_t table = 0; table < TABLES; ++table) {
            count += counts[table * VALUES + static_cast<Unsigned>(value)];
        }
        if (count > 0) present.emplace_back(value, count);
    }
    VolumeStatistics statistics{.minimum = present.front().first, .maximum = present.back().first};
    statistics.histogram.assign(BINS, 0);
    long double sum = 0.0L;
    int64_t voxels = 0;
    for (const auto& [value, count] : present) {
        statistics.histogram[bin_of(statistics, value)] += count;
        sum += static_cast<long double>(value) * static_cast<long double>(count);
        voxels += count;
    }
    statistics.mean = static_cast<double>(sum / static_cast<long double>(voxels));
    return statistics;
}

VolumeStatistics measure_floats(const VolumeSource& source)
{
    VolumeStatistics statistics;
    statistics.histogram.assign(BINS, 0);
    double minimum = std::numeric_limits<double>::infinity();
    double maximum = -minimum;
    long double sum = 0.0L;
    int64_t finite = 0;
    for_each_slab<float>(source, [&](std::span<const float> voxels) {
        for (const float voxel : voxels) {
            if (!std::isfinite(voxel)) {
                ++statistics.not_finite;
                continue;
            }
            const double value = voxel;
            minimum = std::min(minimum, value);
            maximum = std::max(maximum, value);
            sum += static_cast<long double>(value);
            ++finite;
        }
    });
    if (finite == 0) return statistics;
    statistics.minimum = minimum;
    statistics.maximum = maximum;
    statistics.mean = static_cast<double>(sum / static_cast<long double>(finite));
    for_each_slab<float>(source, [&](std::span<const float> voxels) {
        for (const float voxel : voxels) {
            if (std::isfinite(voxel))
                ++statistics.histogram[bin_of(statistics, std::clamp<double>(voxel, minimum, maximum))];
        }
    });
    return statistics;
}

}  // namespace

void VolumeSource::read_level(int level, const VoxelBox& box, std::span<std::byte> voxels) const
{
    SHVR_CHECK(level == 0, "level ", level, " of ", info_.name);
    read(box, voxels);
}

std::optional<ValueRange> VolumeSource::brick_range(int /*level*/, const Size3& /*brick*/) const
{
    return std::nullopt;
}

Size3 size_of_level(const Size3& size, int level)
{
    const int64_t side = int64_t{1} << level;
    return (size + (side - 1)) / side;
}

VolumeStatistics measure(const VolumeSource& source)
{
    if (std::optional<VolumeStatistics> known = source.statistics()) return *std::move(known);
    static_cast<void>(voxel_count(source.info()));
    switch (source.info().type) {
        case VoxelType::uint8: return measure_integers<uint8_t>(source);
        case VoxelType::int8: return measure_integers<int8_t>(source);
        case VoxelType::uint16: return measure_integers<uint16_t>(source);
        case VoxelType::int16: return measure_integers<int16_t>(source);
        case VoxelType::float32: return measure_floats(source);
    }
    SHVR_CHECK(false, "voxel type ", static_cast<int>(source.info().type));
    return {};
}

}  // namespace shvr
