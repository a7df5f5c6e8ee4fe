#include "engine/volume/source.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>

#include "engine/base/error.h"
#include "engine/volume/outliers.h"

namespace shvr {
namespace {

constexpr int64_t SLAB_BYTES = int64_t{32} << 20;
constexpr size_t BINS = 256;

/// Calls `take(span<const T>)` for every slab. Slabs are whole slices, or rows of one slice if a slice is too large. If
/// the file stores blocks, slabs are as thick as a block and have rows of whole blocks.
template <class T, class Take>
void for_each_slab(const VolumeSource& source, const Take& take)
{
    const Size3 size = source.info().size;
    const Size3 block = glm::min(source.block(), size);
    const int64_t row_bytes = size.x * int64_t(sizeof(T));
    int64_t rows = std::min(size.y, std::max<int64_t>(1, SLAB_BYTES / (row_bytes * block.z)));
    if (rows < size.y) rows = std::max(rows / block.y, int64_t{1}) * block.y;
    int64_t slices = block.z;
    if (rows >= size.y) slices *= std::max<int64_t>(1, SLAB_BYTES / (row_bytes * size.y * block.z));
    rows = std::min(rows, size.y);
    slices = std::min(slices, size.z);
    std::vector<T> slab(size_t(size.x * rows * slices));
    for (int64_t z = 0; z < size.z; z += slices) {
        for (int64_t y = 0; y < size.y; y += rows) {
            const VoxelBox box{{0, y, z}, {size.x, std::min(y + rows, size.y), std::min(z + slices, size.z)}};
            const Size3 extent = box.size();
            const std::span<T> voxels(slab.data(), size_t(extent.x * extent.y * extent.z));
            source.read(box, std::as_writable_bytes(voxels));
            take(std::span<const T>(voxels));
        }
    }
}

size_t bin_of(const ValueRange& range, double value)
{
    // Halved, because doubles may lie so far apart that their difference is infinite.
    const double extent = 0.5 * range.upper - 0.5 * range.lower;
    if (!(extent > 0.0)) return 0;
    const double place = (0.5 * std::clamp(value, range.lower, range.upper) - 0.5 * range.lower) / extent;
    return std::min(BINS - 1, size_t(place * double{BINS}));
}

/// Integers of 8 and 16 bits have few enough values to count each; everything else follows from the counts.
template <class T>
VolumeStatistics measure_integers(const VolumeSource& source)
{
    using Unsigned = std::make_unsigned_t<T>;
    constexpr size_t VALUES = size_t{std::numeric_limits<Unsigned>::max()} + 1;
    // Neighbouring voxels are often equal; counting them in several tables in turn keeps one addition from waiting for
    // the previous one.
    constexpr size_t TABLES = 4;
    std::vector<int64_t> counts(TABLES * VALUES);
    for_each_slab<T>(source, [&](std::span<const T> voxels) {
        for (size_t i = 0; i < voxels.size(); ++i) ++counts[(i % TABLES) * VALUES + static_cast<Unsigned>(voxels[i])];
    });

    std::vector<int64_t> ascending;
    constexpr int LOWEST = std::is_signed_v<T> ? -int(VALUES / 2) : 0;
    for (int value = LOWEST; value < LOWEST + int(VALUES); ++value) {
        int64_t count = 0;
        for (size_t table = 0; table < TABLES; ++table) {
            count += counts[table * VALUES + static_cast<Unsigned>(value)];
        }
        ascending.push_back(count);
    }
    return statistics_of(ascending, LOWEST);
}

// ---- Types with too many values to count each -----------------------------------------------------------------------

/// Calls `take(double)` for every finite voxel.
template <class T, class Take>
void for_each_finite(const VolumeSource& source, const Take& take)
{
    for_each_slab<T>(source, [&](std::span<const T> voxels) {
        for (const T voxel : voxels) {
            if constexpr (std::is_floating_point_v<T>) {
                if (!std::isfinite(voxel)) continue;
            }
            take(double(voxel));
        }
    });
}

/// Excludes outliers from the statistics' range, if there are any.
template <class T>
void find_bulk(OutlierFinder& outliers, VolumeStatistics& statistics)
{
    // All integers have their own codes anyway.
    if (std::is_integral_v<T> && statistics.maximum - statistics.minimum <= 65535.0) return;
    const std::optional<OutlierFinder::Bulk> bulk = outliers.bulk();
    if (!bulk) return;
    statistics.bulk = bulk->range;
    statistics.beyond_bulk = bulk->outliers;
}

template <class T>
VolumeStatistics measure_wide(const VolumeSource& source)
{
    VolumeStatistics statistics;
    statistics.histogram.assign(BINS, 0);
    ValueRange all{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
    long double sum = 0.0L;
    int64_t finite = 0;
    OutlierFinder outliers(voxel_count(source.info()));
    for_each_finite<T>(source, [&](double value) {
        all.lower = std::min(all.lower, value);
        all.upper = std::max(all.upper, value);
        sum += static_cast<long double>(value);
        outliers.add(value);
        ++finite;
    });
    statistics.not_finite = voxel_count(source.info()) - finite;
    if (finite == 0) return statistics;
    statistics.minimum = all.lower;
    statistics.maximum = all.upper;
    statistics.mean = double(sum / static_cast<long double>(finite));
    find_bulk<T>(outliers, statistics);
    const ValueRange range = statistics.range();
    for_each_finite<T>(source, [&](double value) { ++statistics.histogram[bin_of(range, value)]; });
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

namespace {

/// Presents one level as a whole volume.
class OneLevel final : public VolumeSource {
public:
    OneLevel(const VolumeSource& source, int level)
        : VolumeSource(info_of(source, level)), source_(source), level_(level)
    {}
    void read(const VoxelBox& box, std::span<std::byte> voxels) const override
    {
        source_.read_level(level_, box, voxels);
    }

private:
    static VolumeInfo info_of(const VolumeSource& source, int level)
    {
        VolumeInfo info = source.info();
        info.size = size_of_level(info.size, level);
        return info;
    }
    const VolumeSource& source_;
    int level_;
};

int level_to_measure(const VolumeSource& source)
{
    int level = 0;
    const auto voxels = [&] {
        const Size3 size = size_of_level(source.info().size, level);
        return double(size.x) * double(size.y) * double(size.z);
    };
    while (level + 1 < source.levels() && voxels() > double(MAX_VOXELS_MEASURED)) ++level;
    return level;
}

}  // namespace

VolumeStatistics measure_level(const VolumeSource& source, int level)
{
    return measure(OneLevel(source, level));
}

Size3 size_of_level(const Size3& size, int level)
{
    const int64_t side = int64_t{1} << level;
    return (size + (side - 1)) / side;
}

VolumeStatistics statistics_of(std::span<const int64_t> counts, int lowest)
{
    std::vector<std::pair<double, int64_t>> present;  // value, how often; ascending
    for (size_t i = 0; i < counts.size(); ++i) {
        if (counts[i] > 0) present.emplace_back(lowest + int(i), counts[i]);
    }
    VolumeStatistics statistics{.minimum = present.front().first, .maximum = present.back().first};
    statistics.histogram.assign(BINS, 0);
    long double sum = 0.0L;
    int64_t voxels = 0;
    for (const auto& [value, count] : present) {
        statistics.histogram[bin_of(statistics.range(), value)] += count;
        sum += static_cast<long double>(value) * static_cast<long double>(count);
        voxels += count;
    }
    statistics.mean = double(sum / static_cast<long double>(voxels));
    return statistics;
}

VolumeStatistics measure(const VolumeSource& source)
{
    if (std::optional<VolumeStatistics> known = source.statistics()) return *std::move(known);
    if (const int level = level_to_measure(source); level > 0) {
        VolumeStatistics statistics = measure_level(source, level);
        statistics.measured_level = level;
        return statistics;
    }
    static_cast<void>(voxel_count(source.info()));
    switch (source.info().type) {
        case VoxelType::uint8: return measure_integers<uint8_t>(source);
        case VoxelType::int8: return measure_integers<int8_t>(source);
        case VoxelType::uint16: return measure_integers<uint16_t>(source);
        case VoxelType::int16: return measure_integers<int16_t>(source);
        case VoxelType::uint32: return measure_wide<uint32_t>(source);
        case VoxelType::int32: return measure_wide<int32_t>(source);
        case VoxelType::float32: return measure_wide<float>(source);
        case VoxelType::float64: return measure_wide<double>(source);
    }
    SHVR_CHECK(false, "voxel type ", int(source.info().type));
    return {};
}

std::vector<std::string> warnings_of(const VolumeStatistics& statistics)
{
    std::vector<std::string> warnings;
    if (statistics.not_finite > 0) {
        const bool is_one = statistics.not_finite == 1;
        warnings.push_back(sentence(statistics.not_finite, is_one ? " voxel is" : " voxels are",
                                    " NaN or infinite and ", is_one ? "is" : "are", " left out of every number"));
    }
    if (statistics.bulk) {
        const bool is_one = statistics.beyond_bulk == 1;
        warnings.push_back(sentence(
            statistics.beyond_bulk, is_one ? " voxel lies" : " voxels lie", " far outside ", statistics.bulk->lower,
            " to ", statistics.bulk->upper, ", where all others are (with ", is_one ? "it" : "them", " the range is ",
            statistics.minimum, " to ", statistics.maximum, "), and ",
            is_one ? "is shown as if it were" : "are shown as if they were", " at the nearer end of that range"));
    }
    if (statistics.measured_level > 0) {
        warnings.push_back(sentence("intensities were measured on level ", statistics.measured_level,
                                    ", whose voxels are means of ", int64_t{1} << (3 * statistics.measured_level),
                                    "; single voxels may lie beyond ", statistics.range().lower, " to ",
                                    statistics.range().upper));
    }
    return warnings;
}

}  // namespace shvr
