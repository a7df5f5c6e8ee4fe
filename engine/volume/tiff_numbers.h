#pragma once
// Whole numbers as TIFF files hold them, in either byte order. Any thread may call these.

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

namespace shvr {

static_assert(std::endian::native == std::endian::little, "what is not big-endian is taken as it is");

inline uint8_t swapped(uint8_t bits)
{
    return bits;
}
inline uint16_t swapped(uint16_t bits)
{
    return __builtin_bswap16(bits);
}
inline uint32_t swapped(uint32_t bits)
{
    return __builtin_bswap32(bits);
}
inline uint64_t swapped(uint64_t bits)
{
    return __builtin_bswap64(bits);
}

template <class Bits>
Bits tiff_number(const std::byte* bytes, bool is_big_endian)
{
    Bits bits;
    std::memcpy(&bits, bytes, sizeof(bits));
    return is_big_endian ? swapped(bits) : bits;
}
/// Of 1, 2, 4 or 8 bytes.
inline uint64_t tiff_number(const std::byte* bytes, size_t count, bool is_big_endian)
{
    if (count == 1) return std::to_integer<uint8_t>(*bytes);
    if (count == 2) return tiff_number<uint16_t>(bytes, is_big_endian);
    if (count == 4) return tiff_number<uint32_t>(bytes, is_big_endian);
    return tiff_number<uint64_t>(bytes, is_big_endian);
}

/// Calls `change` on each number of type `Bits`, wherever it lies.
template <class Bits, class Change>
void change_each(std::span<std::byte> bytes, const Change& change)
{
    for (size_t at = 0; at + sizeof(Bits) <= bytes.size(); at += sizeof(Bits)) {
        Bits bits;
        std::memcpy(&bits, bytes.data() + at, sizeof(Bits));
        bits = change(bits);
        std::memcpy(bytes.data() + at, &bits, sizeof(Bits));
    }
}

/// `Change` is a generic callable on uint8_t, uint16_t, uint32_t and uint64_t.
template <class Change>
void change_each_of(size_t size_bytes, std::span<std::byte> bytes, const Change& change)
{
    if (size_bytes == 1) change_each<uint8_t>(bytes, change);
    if (size_bytes == 2) change_each<uint16_t>(bytes, change);
    if (size_bytes == 4) change_each<uint32_t>(bytes, change);
    if (size_bytes == 8) change_each<uint64_t>(bytes, change);
}

}  // namespace shvr
