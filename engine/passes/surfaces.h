#pragma once
// Opaque surfaces along the rays of a picture (shaders/rays/surfaces.comp).

#include <optional>

#include "engine/graph/frame_graph.h"
#include "engine/passes/pixel_groups.h"
#include "shaders/nearer.h"
#include "shaders/raycast.h"
#include "shaders/surfaces.h"

namespace shvr {

/// Surfaces on the device, and the hierarchy of boxes around them.
struct SurfaceList {
    Resource nodes;          ///< gpu::SurfaceNode, params.node_count nodes in depth-first order
    Resource list;           ///< gpu::Surface; an rgba32_uint image with rows of gpu::SURFACES_IN_ROW, like `nodes`
    bool triangles = false;  ///< gpu::Triangle instead
};

/// Maximum number of nodes that one dispatch may visit: some devices abort a thread's loops after 65535 iterations in
/// total. Each node costs one iteration. If lanes run in lockstep, so does each surface of any leaf that a lane visits.
/// Tile lists add a few hundred iterations. A lower limit would cost more dispatches, and a dispatch that finds nothing
/// still sets up every ray.
inline constexpr uint32_t NODES_IN_DISPATCH = 60'000 / (2 + gpu::SURFACES_IN_LEAF);
/// Maximum number of dispatches in which rays search the boxes of triangles. A ray along a sheet of a million triangles
/// visits about 10,000 nodes; one that needs more than these rounds is counted as cut short. Balls and rods may lie in
/// one row, so rays search their boxes in as many rounds as all nodes need.
inline constexpr uint32_t MAX_SEARCH_ROUNDS = 6;

struct SurfacesInput {
    gpu::RaycastParams params;  ///< the ray caster's parameters: only pixels, light and distance blending are used
    gpu::SurfaceParams scene;
    std::optional<SurfaceList> listed;
    bool probe = false;  ///< requires scene.probe_* to be set
    PixelGroups pixel_groups;
    uint32_t nodes_in_dispatch = NODES_IN_DISPATCH;  ///< other values are for tests, as is the next
    uint32_t max_rounds = MAX_SEARCH_ROUNDS;
};

/// Device bytes per tile of a part, in addition to the image.
inline constexpr uint64_t SURFACE_TILE_BYTES = sizeof(uint32_t) * gpu::SURFACE_TILE * gpu::SURFACE_TILE;

/// Returns an image of the part's size. A texel has the lit colour, in linear light, and the distance along the pixel's
/// ray at which a surface ends the ray, or gpu::NO_SURFACE. Valid in this frame only.
Resource surfaces(FrameGraph& graph, const SurfacesInput& input);

/// Keeps, of two such images of `size`, the nearer surface at each pixel (shaders/picture/nearer.comp). Changes
/// `surfaces`, and returns its new version.
Resource nearer(FrameGraph& graph, Resource other, Resource surfaces, const glm::uvec2& size);

}  // namespace shvr
