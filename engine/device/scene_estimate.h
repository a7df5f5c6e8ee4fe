#pragma once
// Estimates the host and device memory of a volume before it is loaded, from sizes alone: an upper bound of the
// volume's own share, as Scene allocates it.

#include <cstdint>
#include <string>

#include "engine/look/settings.h"
#include "engine/passes/atlas_codes.h"
#include "engine/volume/source.h"

namespace shvr {

struct SceneEstimate {
    uint64_t device_bytes = 0;  ///< memory of the volume itself: all bricks, or the atlas of paged ones
    uint64_t device_budget = 0;
    uint64_t host_bytes = 0;  ///< bricks kept on the host, and coarser levels that the file lacks
    uint64_t host_budget = 0;
    bool is_paged = false;      ///< bricks are loaded on demand
    bool makes_levels = false;  ///< all voxels are read once more to make coarser levels
    std::string refusal{};      ///< why it cannot be loaded; empty: it can
};

/// `device_budget`, `host_budget`: the whole program's, in bytes, with nothing else loaded. `can_be_resident`: one
/// image of the device could hold all bricks (Scene::can_be_resident). `codes`: Scene::codes_for. `most_atlas_bytes`:
/// Scene::most_atlas_bytes.
/// Reads no voxels. Any thread.
SceneEstimate estimate_scene(const VolumeSource& source, Paging paging, bool with_occlusion, uint64_t device_budget,
                             uint64_t host_budget, bool can_be_resident, AtlasCodes codes, uint64_t most_atlas_bytes);
/// "312 MiB of 4 GiB on the device, 40 MiB of 2 GiB on the host": a sentence for a dialog.
std::string in_words(const SceneEstimate& estimate);

}  // namespace shvr
