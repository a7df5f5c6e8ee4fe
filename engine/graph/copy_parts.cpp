#include "engine/graph/copy_parts.h"

#include <algorithm>

namespace shvr {

namespace {

/// Collects regions into parts: each region goes into the last part or, if that is full, into a new one.
template <class Region>
class Parts {
public:
    void add(const Region& region, uint64_t bytes)
    {
        const bool is_full = parts_.empty() || parts_.back().size() == MAX_COPY_REGIONS || bytes > room_;
        if (is_full) {
            parts_.emplace_back();
            room_ = MAX_COPY_BYTES;
        }
        parts_.back().push_back(region);
        room_ -= std::min(room_, bytes);
    }
    std::vector<std::vector<Region>> take() { return std::move(parts_); }

private:
    std::vector<std::vector<Region>> parts_;
    uint64_t room_ = 0;  ///< bytes left in the last part
};

}  // namespace

std::vector<std::vector<BufferRegion>> copy_parts(const std::vector<BufferRegion>& regions)
{
    Parts<BufferRegion> parts;
    for (const BufferRegion& region : regions)
        for (uint64_t done = 0; done < region.bytes; done += MAX_COPY_BYTES) {
            const uint64_t bytes = std::min(region.bytes - done, MAX_COPY_BYTES);
            parts.add({region.source_offset + done, region.target_offset + done, bytes}, bytes);
        }
    return parts.take();
}

std::vector<std::vector<ImageRegion>> copy_parts(const std::vector<ImageRegion>& regions, Format format)
{
    Parts<ImageRegion> parts;
    for (const ImageRegion& region : regions) {
        const uint64_t slice = uint64_t{region.texels.x} * region.texels.y * bytes_per_texel(format);
        if (slice == 0) continue;
        const auto slices = uint32_t(std::clamp<uint64_t>(MAX_COPY_BYTES / slice, 1, region.texels.z));
        for (uint32_t z = 0; z < region.texels.z; z += slices) {
            const uint32_t count = std::min(slices, region.texels.z - z);
            parts.add({region.buffer_offset + z * slice,
                       region.texel + glm::uvec3(0, 0, z),
                       {region.texels.x, region.texels.y, count}},
                      count * slice);
        }
    }
    return parts.take();
}

}  // namespace shvr
