#include "engine/formats/zarr/crc32c.h"

#include <array>

namespace shvr {
namespace {

/// Tables for processing eight bytes at a time: table k is for a byte that is followed by k zero bytes.
using Tables = std::array<std::array<uint32_t, 256>, 8>;

constexpr Tables make_tables()
{
    constexpr uint32_t REFLECTED = 0x82f63b78;
    Tables tables{};
    for (uint32_t byte = 0; byte < 256; ++byte) {
        uint32_t crc = byte;
        for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1) != 0 ? REFLECTED : 0);
        tables[0][byte] = crc;
    }
    for (size_t k = 1; k < 8; ++k) {
        for (size_t byte = 0; byte < 256; ++byte) {
            const uint32_t before = tables[k - 1][byte];
            tables[k][byte] = (before >> 8) ^ tables[0][before & 0xff];
        }
    }
    return tables;
}

constexpr Tables TABLES = make_tables();

}  // namespace

uint32_t crc32c(std::span<const std::byte> bytes)
{
    const auto at = [&](size_t i) { return std::to_integer<uint32_t>(bytes[i]); };
    uint32_t crc = 0xffffffff;
    for (; bytes.size() >= 8; bytes = bytes.subspan(8)) {
        crc ^= at(0) | at(1) << 8 | at(2) << 16 | at(3) << 24;
        crc = TABLES[7][crc & 0xff] ^ TABLES[6][(crc >> 8) & 0xff] ^ TABLES[5][(crc >> 16) & 0xff] ^
              TABLES[4][crc >> 24] ^ TABLES[3][at(4)] ^ TABLES[2][at(5)] ^ TABLES[1][at(6)] ^ TABLES[0][at(7)];
    }
    for (const std::byte byte : bytes) crc = (crc >> 8) ^ TABLES[0][(crc ^ std::to_integer<uint32_t>(byte)) & 0xff];
    return ~crc;
}

}  // namespace shvr
