#include "engine/components/threshold_bits.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <type_traits>

#include "engine/base/error.h"
#include "engine/volume/voxel_dispatch.h"

namespace shvr {
namespace {

/// Returns the smallest voxel value at or above the threshold; null if there is none.
template <class T>
std::optional<T> lowest_above(double threshold)
{
    if constexpr (std::is_floating_point_v<T>) {
        const auto nearest = static_cast<T>(threshold);
        if (double(nearest) >= threshold) return nearest;
        return std::nextafter(nearest, std::numeric_limits<T>::infinity());
    } else {
        const double whole = std::ceil(threshold);
        if (whole > double(std::numeric_limits<T>::max())) return std::nullopt;
        return static_cast<T>(std::max(whole, double(std::numeric_limits<T>::lowest())));
    }
}

/// Packs eight flags, bytes of 0 or 1, into one byte, the first flag in the lowest bit. The multiplication moves flag i
/// to bit 56 + i; all its partial products are at different bits, so none of them carries.
uint64_t gathered(const uint8_t* flags)
{
    uint64_t eight;
    std::memcpy(&eight, flags, sizeof eight);
    return (eight * 0x0102040810204080u) >> 56;
}
static_assert(std::endian::native == std::endian::little);

template <class T>
uint64_t word_of(const T* voxels, size_t count, T lowest)
{
    alignas(64) uint8_t flags[64] = {};
    for (size_t i = 0; i < count; ++i) flags[i] = voxels[i] >= lowest;
    uint64_t word = 0;
    for (size_t byte = 0; byte < 8; ++byte) word |= gathered(flags + 8 * byte) << 8 * byte;
    return word;
}

template <class T>
void convert_row(const T* voxels, size_t count, T lowest, uint64_t* words)
{
    size_t at = 0;
    // A compile-time length, which compilers unroll.
    for (; at + 64 <= count; at += 64) *words++ = word_of(voxels + at, 64, lowest);
    if (at < count) *words = word_of(voxels + at, count - at, lowest);
}

}  // namespace

ThresholdBits::ThresholdBits(VoxelType type, double threshold) : type_(type), threshold_(threshold)
{
    SHVR_CHECK(!std::isnan(threshold));
}

void ThresholdBits::convert(std::span<const std::byte> voxels, std::span<uint64_t> words) const
{
    with_voxel_type(type_, [&]<class T>(T) {
        const size_t count = voxels.size() / sizeof(T);
        SHVR_CHECK(words.size() == size_t(words_of_row(int64_t(count))));
        const std::optional<T> lowest = lowest_above<T>(threshold_);
        if (!lowest)
            std::ranges::fill(words, uint64_t{0});
        else
            convert_row(reinterpret_cast<const T*>(voxels.data()), count, *lowest, words.data());
    });
}

}  // namespace shvr
