#include "engine/formats/rescaled.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "engine/base/error.h"
#include "engine/volume/voxel_numbers.h"

namespace shvr {
namespace {

/// Number of voxels to convert at a time, through a buffer of doubles.
constexpr size_t BLOCK = 512;

template <class T>
ValueRange range_of()
{
    return {double{std::numeric_limits<T>::min()}, double{std::numeric_limits<T>::max()}};
}

/// The range of an integer type.
ValueRange range_of(VoxelType type)
{
    switch (type) {
        case VoxelType::uint8: return range_of<uint8_t>();
        case VoxelType::int8: return range_of<int8_t>();
        case VoxelType::uint16: return range_of<uint16_t>();
        case VoxelType::int16: return range_of<int16_t>();
        case VoxelType::uint32: return range_of<uint32_t>();
        case VoxelType::int32: return range_of<int32_t>();
        case VoxelType::float32:
        case VoxelType::float64: break;
    }
    SHVR_CHECK(false, "voxel type ", int(type));
    return {};
}

VolumeInfo rescaled(VolumeInfo info, const Rescale& rescale)
{
    const VoxelType stored = std::exchange(info.type, rescaled_type(info.type, rescale));
    if (!is_float(stored) && is_float(info.type)) {
        info.warnings.push_back(sentence("intensities are ", rescale.slope, " times what is stored, plus ",
                                         rescale.intercept, "; ", name_of(stored), " became ", name_of(info.type)));
    }
    return info;
}

class RescaledSource final : public VolumeSource {
public:
    RescaledSource(std::unique_ptr<VolumeSource> source, const Rescale& rescale)
        : VolumeSource(rescaled(source->info(), rescale)), source_(std::move(source)), rescale_(rescale)
    {
        SHVR_CHECK(source_->levels() == 1, source_->levels());
    }

    void read(const VoxelBox& box, std::span<std::byte> voxels) const override
    {
        const VoxelType stored = source_->info().type;
        const size_t count = voxels.size() / bytes_of(info().type);
        // Reads the stored voxels into the end of the output, where they fit because they are not larger than
        // intensities. Conversion proceeds from the front, so it never overwrites a stored voxel that is still needed.
        const std::span<std::byte> tail = voxels.last(count * bytes_of(stored));
        source_->read(box, tail);
        rescale_voxels(stored, tail, rescale_, info().type, voxels);
    }

private:
    std::unique_ptr<VolumeSource> source_;
    Rescale rescale_;
};

}  // namespace

VoxelType rescaled_type(VoxelType stored, const Rescale& rescale)
{
    if (rescale.changes_nothing()) return stored;
    const bool is_whole =
        rescale.slope == std::floor(rescale.slope) && rescale.intercept == std::floor(rescale.intercept);
    if (!is_float(stored) && is_whole) {
        const ValueRange numbers = rescale.stored.value_or(range_of(stored));
        const double one_end = rescale.slope * numbers.lower + rescale.intercept;
        const double other_end = rescale.slope * numbers.upper + rescale.intercept;
        for (const VoxelType type : {stored, VoxelType::uint8, VoxelType::int8, VoxelType::uint16, VoxelType::int16,
                                     VoxelType::uint32, VoxelType::int32}) {
            const ValueRange range = range_of(type);
            const bool fits =
                std::min(one_end, other_end) >= range.lower && std::max(one_end, other_end) <= range.upper;
            if (fits && bytes_of(type) >= bytes_of(stored)) return type;
        }
    }
    const bool is_narrow = bytes_of(stored) <= 2 || stored == VoxelType::float32;
    return is_narrow ? VoxelType::float32 : VoxelType::float64;
}

void rescale_voxels(VoxelType from, std::span<const std::byte> stored, const Rescale& rescale, VoxelType to,
                    std::span<std::byte> intensities)
{
    const size_t count = stored.size() / bytes_of(from);
    SHVR_CHECK(intensities.size() == count * bytes_of(to), intensities.size(), " ", stored.size());
    double values[BLOCK];
    for (size_t at = 0; at < count; at += BLOCK) {
        const std::span<double> block(values, std::min(BLOCK, count - at));
        load_voxels(from, stored.data() + at * bytes_of(from), block);
        for (double& value : block) value = rescale.slope * value + rescale.intercept;
        store_voxels(to, block, intensities.data() + at * bytes_of(to));
    }
}

std::unique_ptr<VolumeSource> rescaled(std::unique_ptr<VolumeSource> source, const Rescale& rescale)
{
    if (rescale.changes_nothing()) return source;
    SHVR_CHECK(std::isfinite(rescale.slope) && rescale.slope != 0.0 && std::isfinite(rescale.intercept));
    return std::make_unique<RescaledSource>(std::move(source), rescale);
}

}  // namespace shvr
