#include "engine/bricks/code_rows.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "engine/base/error.h"

namespace shvr {
namespace {

/// Compilers vectorise loops of constant length even at -O2.
constexpr size_t BLOCK = 64;

/// Runs `convert_block(const T* voxels, uint16_t* codes)` on blocks of BLOCK voxels; the last block is padded.
template <class T, class ConvertBlock>
void for_each_block(std::span<const std::byte> voxels, std::span<uint16_t> codes, const ConvertBlock& convert_block)
{
    alignas(64) T in[BLOCK] = {};
    alignas(64) uint16_t out[BLOCK];
    for (size_t at = 0; at < codes.size(); at += BLOCK) {
        const size_t count = std::min(BLOCK, codes.size() - at);
        std::memcpy(in, voxels.data() + at * sizeof(T), count * sizeof(T));
        convert_block(in, out);
        std::memcpy(codes.data() + at, out, count * sizeof(uint16_t));
    }
}

/// Converts exactly: voxels are clamped to the window, so their difference from the window's lower end fits into 32
/// unsigned bits.
template <class T>
void convert_whole(std::span<const std::byte> voxels, std::span<uint16_t> codes, const IntensityWindow& window)
{
    const auto lower = int64_t(window.lower);
    const auto factor = uint32_t(window.codes_per_unit);
    const int64_t upper = lower + int64_t(65535u / factor);
    const auto lowest = static_cast<T>(std::max<int64_t>(lower, std::numeric_limits<T>::min()));
    const auto highest = static_cast<T>(std::min<int64_t>(upper, std::numeric_limits<T>::max()));
    const auto lower_bits = uint32_t(lower);
    for_each_block<T>(voxels, codes, [=](const T* __restrict in, uint16_t* __restrict out) {
        for (size_t i = 0; i < BLOCK; ++i) {
            const T voxel = std::min(std::max(in[i], lowest), highest);
            out[i] = uint16_t((uint32_t(voxel) - lower_bits) * factor);
        }
    });
}

template <class T>
void convert_any(std::span<const std::byte> voxels, std::span<uint16_t> codes, const IntensityWindow& window)
{
    const double lower = window.lower;
    const double factor = window.codes_per_unit;
    for_each_block<T>(voxels, codes, [=](const T* __restrict in, uint16_t* __restrict out) {
        for (size_t i = 0; i < BLOCK; ++i) {
            double code = (double(in[i]) - lower) * factor;
            code = code > 0.0 ? code : 0.0;  // also for NaN
            code = (code < 65535.0 ? code : 65535.0) + 0.5;
            out[i] = uint16_t(int32_t(code));
        }
    });
}

template <class T>
void convert_integers(std::span<const std::byte> voxels, std::span<uint16_t> codes, const IntensityWindow& window,
                      bool is_whole)
{
    return is_whole ? convert_whole<T>(voxels, codes, window) : convert_any<T>(voxels, codes, window);
}

}  // namespace

CodeRows::CodeRows(VoxelType type, const IntensityWindow& window)
    : type_(type),
      window_(window),
      is_whole_(window.lower == std::floor(window.lower) && std::abs(window.lower) <= 4294967295.0 &&
                window.codes_per_unit == std::floor(window.codes_per_unit) && window.codes_per_unit >= 1.0 &&
                window.codes_per_unit <= 65535.0)
{
    // If the whole window is outside the range of the voxel type, its bounds cannot be converted to that type.
    const auto ends_within = [&]<class T>(T) {
        return window.lower <= double{std::numeric_limits<T>::max()} &&
               window.upper() >= double{std::numeric_limits<T>::min()};
    };
    if (type == VoxelType::uint8) is_whole_ = is_whole_ && ends_within(uint8_t{});
    if (type == VoxelType::int8) is_whole_ = is_whole_ && ends_within(int8_t{});
    if (type == VoxelType::uint16) is_whole_ = is_whole_ && ends_within(uint16_t{});
    if (type == VoxelType::int16) is_whole_ = is_whole_ && ends_within(int16_t{});
    if (type == VoxelType::uint32) is_whole_ = is_whole_ && ends_within(uint32_t{});
    if (type == VoxelType::int32) is_whole_ = is_whole_ && ends_within(int32_t{});
}

void CodeRows::convert(std::span<const std::byte> voxels, std::span<uint16_t> codes) const
{
    SHVR_CHECK(voxels.size() == codes.size() * bytes_of(type_), voxels.size(), " ", codes.size());
    switch (type_) {
        case VoxelType::uint8: return convert_integers<uint8_t>(voxels, codes, window_, is_whole_);
        case VoxelType::int8: return convert_integers<int8_t>(voxels, codes, window_, is_whole_);
        case VoxelType::uint16: return convert_integers<uint16_t>(voxels, codes, window_, is_whole_);
        case VoxelType::int16: return convert_integers<int16_t>(voxels, codes, window_, is_whole_);
        case VoxelType::uint32: return convert_integers<uint32_t>(voxels, codes, window_, is_whole_);
        case VoxelType::int32: return convert_integers<int32_t>(voxels, codes, window_, is_whole_);
        case VoxelType::float32: return convert_any<float>(voxels, codes, window_);
        case VoxelType::float64: return convert_any<double>(voxels, codes, window_);
    }
}

}  // namespace shvr
