#pragma once
// CRC-32C, the checksum of Zarr's codec crc32c (RFC 3720, appendix B.4: polynomial 0x1edc6f41, reflected). About 1.5
// GB/s. Any thread.

#include <cstddef>
#include <cstdint>
#include <span>

namespace shvr {

uint32_t crc32c(std::span<const std::byte> bytes);

}  // namespace shvr
