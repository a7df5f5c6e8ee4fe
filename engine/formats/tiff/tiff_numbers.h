#pragma once
// Reads whole numbers from TIFF directories, in either byte order. Any thread may call this function.

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace shvr {

static_assert(std::endian::native == std::endian::little, "what is not big-endian is taken as it is");

/// Reads a number of 1, 2, 4 or 8 bytes. Written for speed: some files have a million directories.
inline uint64_t tiff_number(const std::byte* bytes, size_t count, bool is_big_endian)
{
    const auto read = [&](auto bits, auto swapped) -> uint64_t {
        std::memcpy(&bits, bytes, sizeof(bits));
        return is_big_endian ? swapped(bits) : bits;
    };
    if (count == 1) return std::to_integer<uint8_t>(*bytes);
    if (count == 2) return read(uint16_t{}, [](uint16_t bits) { return __builtin_bswap16(bits); });
    if (count == 4) return read(uint32_t{}, [](uint32_t bits) { return __builtin_bswap32(bits); });
    return read(uint64_t{}, [](uint64_t bits) { return __builtin_bswap64(bits); });
}

}  // namespace shvr
