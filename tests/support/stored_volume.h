#pragma once
// Procedural volumes for tests that load the same one many times.

#include <map>
#include <tuple>

#include "engine/volume/procedural/source_procedural.h"
#include "tests/support/volume_files.h"

namespace shvr::test {

/// Evaluates the function of `kind` at each voxel once per process; later loads read it from memory. Bytes, one
/// level.
inline std::shared_ptr<const VolumeSource> stored_volume(const std::string& kind, const Size3& size, uint32_t seed)
{
    static std::map<std::tuple<std::string, int64_t, int64_t, int64_t, uint32_t>, std::shared_ptr<MemorySource>> stored;
    std::shared_ptr<MemorySource>& source = stored[{kind, size.x, size.y, size.z, seed}];
    if (source == nullptr) {
        const auto evaluated = open_procedural({.kind = kind, .size = size, .seed = seed, .levels = 1});
        std::vector<std::byte> voxels(size_t(size.x * size.y * size.z));
        evaluated->read({Size3(0), size}, voxels);
        source = std::make_shared<MemorySource>(evaluated->info(), std::move(voxels));
    }
    return source;
}

}  // namespace shvr::test
