#include "engine/gpu/memory_block.h"

#include "engine/base/error.h"

namespace shvr::gpu {

std::optional<uint64_t> MemoryBlock::take(uint64_t bytes, uint64_t alignment)
{
    const auto aligned = [&](uint64_t offset) { return (offset + alignment - 1) & ~(alignment - 1); };
    uint64_t begin = 0;
    for (const auto& [first, end] : used_) {
        if (begin + bytes <= first) break;
        begin = aligned(end);
    }
    if (begin + bytes > BYTES) return std::nullopt;
    used_.emplace(begin, begin + bytes);
    return begin;
}

void MemoryBlock::give_back(uint64_t offset)
{
    SHVR_CHECK(used_.erase(offset) == 1);
}

}  // namespace shvr::gpu
