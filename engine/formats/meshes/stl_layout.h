#pragma once
// Sizes of binary STL: 80 bytes of any text, the number of triangles, and 50 bytes for each triangle.

#include <cstdint>
#include <cstring>
#include <string_view>

namespace shvr {

inline constexpr uint64_t STL_HEADER_BYTES = 80, STL_FIRST_TRIANGLE = 84, STL_TRIANGLE_BYTES = 50;

/// Whether the file has triangles, and exactly the size that its header states.
inline bool is_stl_of_its_size(std::string_view head, uint64_t size)
{
    uint32_t count = 0;
    if (head.size() < STL_FIRST_TRIANGLE) return false;
    std::memcpy(&count, head.data() + STL_HEADER_BYTES, sizeof count);
    return count > 0 && size == STL_FIRST_TRIANGLE + STL_TRIANGLE_BYTES * count;
}

}  // namespace shvr
