#pragma once
// The opaque surfaces of a scene, as users specify them and as the device searches them: a hierarchy of boxes in
// depth-first order, in which each box has a skip link. Plain data; any thread.

#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "engine/volume/volume.h"
#include "shaders/surfaces.h"

namespace shvr {

/// A ball (`from` equals `to`), or a rod, the convex hull of two balls.
struct SurfaceLook {
    glm::dvec3 from{0.0}, to{0.0};              ///< volume space, physical units
    double radius_from = 1.0, radius_to = 1.0;  ///< physical units, above 0
    glm::dvec3 color{1.0};                      ///< linear light
    bool operator==(const SurfaceLook&) const = default;
};

/// The owner of a surface. Surfaces are sorted by kind, in this order, then by the session's index or the trace's
/// number. If two surfaces are equally far along a ray, the surface that sorts first is visible.
enum class SurfaceKind : uint8_t { session, node, internode };
constexpr uint64_t surface_key(SurfaceKind kind, uint32_t number)
{
    return uint64_t(kind) << 32 | number;
}

struct KeyedSurface {
    uint64_t key = 0;
    SurfaceLook look;
};

/// Uses each surface's index as its key.
std::vector<KeyedSurface> keyed(std::span<const SurfaceLook> surfaces);

/// A surface takes 60 bytes, and its nodes at most 60 more, so buffers stay below Vulkan's smallest limit, 128 MiB.
inline constexpr size_t MAX_SURFACES = 1'000'000;

struct SurfaceTree {
    std::vector<gpu::SurfaceNode> nodes;
    std::vector<gpu::Surface> list;  ///< in the order of the leaves
    std::vector<uint64_t> keys;      ///< keys of `list`
};

/// Fails, naming the surface, if one is not finite, has no size, or is more than 2^20 reference lengths away from any
/// place the volume may be, or if there are more than MAX_SURFACES surfaces. `max_in_leaf` is only set by tests.
SurfaceTree surface_tree(std::span<const KeyedSurface> surfaces, const VolumeInfo& volume,
                         size_t max_in_leaf = gpu::SURFACES_IN_LEAF);

/// The shortest side of a voxel: lengths on the device are multiples of it.
double reference_length_of(const VolumeInfo& volume);

/// Encodes one surface like the elements of `list`. Fails under the same conditions as `surface_tree`.
gpu::Surface surface_on_device(const KeyedSurface& surface, const VolumeInfo& volume);

/// Fits the boxes of `nodes`, one or more whole trees, to the surfaces in their leaves. Returns the changed nodes.
std::vector<uint32_t> refit(std::span<gpu::SurfaceNode> nodes, std::span<const gpu::Surface> list);

}  // namespace shvr
