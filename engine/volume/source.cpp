#include "engine/volume/source.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>

#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/volume/gaps.h"
#include "engine/volume/outliers.h"
#include "engine/volume/voxel_walk.h"

namespace shvr {
namespace {

constexpr size_t BINS = 256;

/// The volume to measure, and where to report progress and gaps. Several passes may visit the same walk.
struct Measured {
    const VolumeSource& source;
    const VoxelWalk& walk;
    const Progress& progress;
    Gaps* gaps;
};

/// Calls `take(span<const T>, count)` for every box of the walk, or for its readable parts. `count`: how many voxels of
/// the volume each voxel of the span represents.
template <class T, class Take>
void for_each_slab(const Measured& measured, double lower, double upper, const Take& take)
{
    int64_t done = 0;
    read_boxes(measured.source, measured.walk,
               [&](const VoxelBox& box, std::span<std::byte> voxels, const std::exception_ptr& failure) {
                   const auto take_part = [&](const VoxelBox&, std::span<const std::byte> part) {
                       take(std::span(reinterpret_cast<const T*>(part.data()), part.size() / sizeof(T)), int64_t{1});
                   };
                   if (!failure)
                       take_part(box, voxels);
                   else if (!measured.gaps)
                       std::rethrow_exception(failure);
                   else
                       read_parts(measured.source, box, voxels, measured.gaps, take_part);
                   const Size3 extent = box.size();
                   done += extent.x * extent.y * extent.z;
                   tell(measured.progress, lower + (upper - lower) * double(done) / double(measured.walk.voxels()));
               });
    const auto fill = static_cast<T>(measured.walk.fill());
    if (measured.walk.rest() > 0) take(std::span(&fill, 1), measured.walk.rest());
}

size_t bin_of(const ValueRange& range, double value)
{
    // Computes half of the extent: the full extent of doubles can overflow to infinity.
    const double extent = 0.5 * range.upper - 0.5 * range.lower;
    if (!(extent > 0.0)) return 0;
    const double place = (0.5 * std::clamp(value, range.lower, range.upper) - 0.5 * range.lower) / extent;
    return std::min(BINS - 1, size_t(place * double{BINS}));
}

/// Counts each value. Neighbouring voxels are often equal: with alternating tables, an increment need not wait for the
/// previous increment of the same counter.
template <class Unsigned, size_t VALUES, size_t TABLES>
void count_values(std::span<const Unsigned> voxels, int64_t times, std::span<int64_t> counts)
{
    size_t i = 0;
    for (; i + TABLES <= voxels.size(); i += TABLES)
        for (size_t table = 0; table < TABLES; ++table) counts[table * VALUES + voxels[i + table]] += times;
    for (; i < voxels.size(); ++i) counts[voxels[i]] += times;
}

/// For integers of 8 and 16 bits, counts each value; all statistics follow from the counts.
template <class T>
VolumeStatistics measure_integers(const Measured& measured)
{
    using Unsigned = std::make_unsigned_t<T>;
    constexpr size_t VALUES = size_t{std::numeric_limits<Unsigned>::max()} + 1, TABLES = sizeof(T) == 1 ? 8 : 4;
    std::vector<int64_t> counts(TABLES * VALUES);
    for_each_slab<T>(measured, 0.0, 1.0, [&](std::span<const T> voxels, int64_t times) {
        const std::span as_unsigned(reinterpret_cast<const Unsigned*>(voxels.data()), voxels.size());
        count_values<Unsigned, VALUES, TABLES>(as_unsigned, times, counts);
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
    return statistics_of(ascending, LOWEST, measured.source.info().nodata);
}

// ---- Types with too many values to count each -----------------------------------------------------------------------

/// Calls `take(value, count)` for each finite value and its number of voxels. Returns the number of other voxels.
template <class T, class Take>
int64_t for_each_finite(const Measured& measured, double lower, double upper, const Take& take)
{
    int64_t others = 0;
    for_each_slab<T>(measured, lower, upper, [&](std::span<const T> voxels, int64_t times) {
        for (const T voxel : voxels) {
            if constexpr (std::is_floating_point_v<T>) {
                if (!std::isfinite(voxel)) {
                    others += times;
                    continue;
                }
            }
            take(double(voxel), times);
        }
    });
    return others;
}

/// Finds fill values and outliers, and sets the range of the statistics without these.
void find_bulk(OutlierFinder& outliers, std::optional<double> nodata, VolumeStatistics& statistics)
{
    std::optional<OutlierFinder::Bulk> bulk = outliers.bulk();
    if (!bulk) return;
    statistics.bulk = bulk->range;
    statistics.beyond_bulk = bulk->outliers;
    statistics.fill = std::move(bulk->fill);
    statistics.fill_is_given = nodata && !statistics.fill.empty();
}

bool is_fill(const VolumeStatistics& statistics, double value)
{
    return std::ranges::any_of(statistics.fill, [&](const ValueCount& fill) { return fill.value == value; });
}

/// A sum and the number of its values, for a mean.
struct Sum {
    long double sum = 0.0L;
    int64_t voxels = 0;
    void add(double value, int64_t times)
    {
        sum += static_cast<long double>(value) * static_cast<long double>(times);
        voxels += times;
    }
    double mean() const { return voxels > 0 ? double(sum / static_cast<long double>(voxels)) : 0.0; }
};

template <class T>
VolumeStatistics measure_wide(const Measured& measured)
{
    VolumeStatistics statistics;
    statistics.histogram.assign(BINS, 0);
    ValueRange all{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
    const VolumeInfo& info = measured.source.info();
    OutlierFinder outliers(measured.walk.voxels() + measured.walk.rest(), info.type, info.nodata);
    statistics.not_finite = for_each_finite<T>(measured, 0.0, 0.5, [&](double value, int64_t times) {
        all.lower = std::min(all.lower, value);
        all.upper = std::max(all.upper, value);
        outliers.add(value, times);
    });
    if (!(all.lower <= all.upper)) return statistics;
    statistics.minimum = all.lower;
    statistics.maximum = all.upper;
    find_bulk(outliers, info.nodata, statistics);
    const ValueRange range = statistics.range();
    Sum sum;
    for_each_finite<T>(measured, 0.5, 1.0, [&](double value, int64_t times) {
        if (!statistics.fill.empty() && is_fill(statistics, value)) return;
        statistics.histogram[bin_of(range, value)] += times;
        sum.add(value, times);
    });
    statistics.mean = sum.mean();
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

std::optional<StoredBlocks> VolumeSource::stored_blocks(int /*level*/, int64_t /*most*/) const
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
    std::optional<StoredBlocks> stored_blocks(int /*level*/, int64_t most) const override
    {
        return source_.stored_blocks(level_, most);
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

VolumeStatistics measure_walk(const VolumeSource& source, const VoxelWalk& walk, const MeasureOptions& options)
{
    const Measured measured{source, walk, options.progress, options.gaps};
    switch (source.info().type) {
        case VoxelType::uint8: return measure_integers<uint8_t>(measured);
        case VoxelType::int8: return measure_integers<int8_t>(measured);
        case VoxelType::uint16: return measure_integers<uint16_t>(measured);
        case VoxelType::int16: return measure_integers<int16_t>(measured);
        case VoxelType::uint32: return measure_wide<uint32_t>(measured);
        case VoxelType::int32: return measure_wide<int32_t>(measured);
        case VoxelType::float32: return measure_wide<float>(measured);
        case VoxelType::float64: return measure_wide<double>(measured);
    }
    SHVR_CHECK(false, "voxel type ", int(source.info().type));
    return {};
}

double voxels_of_level(const VolumeSource& source, int level)
{
    const Size3 size = size_of_level(source.info().size, level);
    return double(size.x) * double(size.y) * double(size.z);
}

/// Returns a level's stored blocks; null if over `most_voxels` voxels, or if the level is small enough to read whole.
std::optional<StoredBlocks> stored_in(const VolumeSource& source, int level, int64_t most_voxels)
{
    if (voxels_of_level(source, level) <= double(MAX_VOXELS_MEASURED)) return std::nullopt;
    const Size3 block = source.block();
    const double most = double(most_voxels) / (double(block.x) * double(block.y) * double(block.z));
    return source.stored_blocks(level, int64_t(std::clamp(most, 64.0, double(MAX_STORED_BLOCKS))));
}

/// Measures one level: all voxels, or only the stored blocks.
VolumeStatistics measure_exactly(const VolumeSource& source, std::optional<StoredBlocks> stored,
                                 const MeasureOptions& options)
{
    return measure_walk(source, stored ? VoxelWalk::stored(source, *std::move(stored)) : VoxelWalk::all(source),
                        options);
}

}  // namespace

VolumeStatistics measure_level(const VolumeSource& source, int level, const MeasureOptions& options)
{
    const OneLevel one(source, level);
    return measure_exactly(one, stored_in(one, 0, std::numeric_limits<int64_t>::max()), options);
}

Size3 size_of_level(const Size3& size, int level)
{
    const int64_t side = int64_t{1} << level;
    return (size + (side - 1)) / side;
}

VolumeStatistics statistics_of(std::span<const int64_t> counts, int lowest, std::optional<double> nodata)
{
    std::vector<std::pair<double, int64_t>> present;  // value, how often; ascending
    for (size_t i = 0; i < counts.size(); ++i) {
        if (counts[i] > 0) present.emplace_back(lowest + int(i), counts[i]);
    }
    VolumeStatistics statistics;
    statistics.histogram.assign(BINS, 0);
    if (present.empty()) return statistics;  // nothing could be read
    statistics.minimum = present.front().first;
    statistics.maximum = present.back().first;
    int64_t voxels = 0;
    for (const auto& [value, count] : present) voxels += count;
    const bool is_signed = lowest<0, is_short = counts.size()> 256;
    const VoxelType type = is_short ? (is_signed ? VoxelType::int16 : VoxelType::uint16)
                                    : (is_signed ? VoxelType::int8 : VoxelType::uint8);
    OutlierFinder outliers(voxels, type, nodata);
    for (const auto& [value, count] : present) outliers.add(value, count);
    find_bulk(outliers, nodata, statistics);
    Sum sum;
    for (const auto& [value, count] : present) {
        if (is_fill(statistics, value)) continue;
        statistics.histogram[bin_of(statistics.range(), value)] += count;
        sum.add(value, count);
    }
    statistics.mean = sum.mean();
    return statistics;
}

VolumeStatistics measure(const VolumeSource& source, const MeasureOptions& options)
{
    if (std::optional<VolumeStatistics> known = source.statistics()) return *std::move(known);
    static_cast<void>(voxel_count(source.info()));
    if (options.exact) {
        constexpr int64_t ANY = std::numeric_limits<int64_t>::max();
        return measure_exactly(source, stored_in(source, 0, ANY), options);
    }
    for (int level = 0; level < source.levels(); ++level) {
        std::optional<StoredBlocks> stored = stored_in(source, level, MAX_VOXELS_MEASURED);
        if (!stored && voxels_of_level(source, level) > double(MAX_VOXELS_MEASURED)) continue;
        if (level == 0) return measure_exactly(source, std::move(stored), options);
        VolumeStatistics statistics = measure_exactly(OneLevel(source, level), std::move(stored), options);
        statistics.measured_level = level;
        return statistics;
    }
    const int coarsest = source.levels() - 1;
    if (voxels_of_level(source, coarsest) <= double(MAX_VOXELS_EXACT)) {
        if (coarsest == 0) return measure_exactly(source, std::nullopt, options);
        VolumeStatistics statistics = measure_level(source, coarsest, options);
        statistics.measured_level = coarsest;
        return statistics;
    }
    if (std::optional<StoredBlocks> stored = stored_in(source, 0, MAX_VOXELS_EXACT))
        return measure_exactly(source, std::move(stored), options);
    const VoxelWalk walk = VoxelWalk::sample(source);
    VolumeStatistics statistics = measure_walk(source, walk, options);
    statistics.sampled_voxels = walk.voxels();
    return statistics;
}

namespace {

/// Whether outliers are clamped to the code of the nearer end (window_for). Assumes integers if all extremes are whole.
bool are_clamped(const VolumeStatistics& statistics)
{
    const auto [lower, upper] = statistics.range();
    const double all = statistics.maximum - statistics.minimum;
    const bool is_whole = std::floor(lower) == lower && std::floor(upper) == upper &&
                          std::floor(statistics.minimum) == statistics.minimum &&
                          std::floor(statistics.maximum) == statistics.maximum;
    return !(is_whole && all <= 65535.0) && all > 5.0 * (upper - lower);
}

std::string warning_of_outliers(const VolumeStatistics& statistics)
{
    const bool is_one = statistics.beyond_bulk == 1;
    const std::string first =
        sentence(statistics.beyond_bulk, is_one ? " voxel lies" : " voxels lie", " far outside ",
                 statistics.bulk->lower, " to ", statistics.bulk->upper, ", where all others are (with ",
                 is_one ? "it" : "them", " the range is ", statistics.minimum, " to ", statistics.maximum, "), and ");
    if (are_clamped(statistics))
        return sentence(first, is_one ? "is shown as if it were" : "are shown as if they were",
                        " at the nearer end of that range");
    return sentence(first, is_one ? "counts" : "count",
                    " neither for the histogram's range nor for automatic settings");
}

std::string warning_of_fill(const ValueCount& fill)
{
    return sentence(fill.voxels, fill.voxels == 1 ? " voxel has" : " voxels have", " the value ", digits_of(fill.value),
                    ", far outside all others: it is taken for a fill value, which counts neither for the histogram's "
                    "range nor for automatic settings; `volume.nodata` can state another one, or \"none\"");
}

}  // namespace

std::vector<std::string> warnings_of(const VolumeStatistics& statistics)
{
    std::vector<std::string> warnings;
    if (statistics.not_finite > 0) {
        const bool is_one = statistics.not_finite == 1;
        warnings.push_back(sentence(statistics.not_finite, is_one ? " voxel is" : " voxels are",
                                    " NaN or infinite and ", is_one ? "is" : "are", " left out of every number"));
    }
    if (!statistics.fill_is_given)
        for (const ValueCount& fill : statistics.fill) warnings.push_back(warning_of_fill(fill));
    if (statistics.beyond_bulk > 0) warnings.push_back(warning_of_outliers(statistics));
    if (statistics.sampled_voxels > 0) {
        warnings.push_back(sentence("intensities were estimated from a sample of ", statistics.sampled_voxels,
                                    " voxels; others may lie beyond ", statistics.range().lower, " to ",
                                    statistics.range().upper,
                                    ": `shvr info --exact` goes through all, and so does `shvr import`"));
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
