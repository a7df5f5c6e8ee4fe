#pragma once
// Estimates the host and device memory of a volume before it is loaded, from sizes alone. The result is an upper bound
// of the volume's own share of memory, as Scene allocates it.

#include <cstdint>
#include <string>

#include "engine/look/settings.h"
#include "engine/passes/atlas_codes.h"
#include "engine/volume/source.h"

namespace shvr {

struct SceneEstimate {
    uint64_t device_bytes = 0;  ///< memory of the volume itself: all bricks, or the atlas of paged bricks
    uint64_t device_budget = 0;
    uint64_t host_bytes = 0;  ///< bricks kept on the host, and coarser levels that the file lacks
    uint64_t host_budget = 0;
    bool is_paged = false;      ///< bricks are loaded on demand
    bool makes_levels = false;  ///< whether all voxels are read once more to make coarser levels
    std::string refusal{};      ///< why the volume cannot be loaded; empty if it can
};

/// `device_budget`, `host_budget`: budgets of the whole program in bytes, with nothing else loaded.
/// `can_be_resident`: one image of the device could hold all bricks (Scene::can_be_resident). `codes`:
/// Scene::codes_for. `most_atlas_bytes`: Scene::most_atlas_bytes. Reads no voxels. May be called on any
/// thread.
SceneEstimate estimate_scene(const VolumeSource& source, Paging paging, bool with_occlusion, uint64_t device_budget,
                             uint64_t host_budget, bool can_be_resident, AtlasCodes codes, uint64_t most_atlas_bytes);
/// A sentence for a dialog: "312 MiB of 4 GiB on the device, 40 MiB of 2 GiB on the host".
std::string in_words(const SceneEstimate& estimate);

}  // namespace shvr
