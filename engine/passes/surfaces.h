#pragma once
// Opaque surfaces along the rays of a picture (shaders/surfaces.comp).

#include <optional>

#include "engine/graph/frame_graph.h"
#include "engine/passes/adaptive.h"
#include "engine/passes/pixel_groups.h"
#include "shaders/raycast.h"
#include "shaders/surfaces.h"

namespace shvr {

/// Surfaces on the device, and the hierarchy of boxes around them.
struct SurfaceList {
    Resource nodes;  ///< gpu::SurfaceNode, in depth-first order; params.node_count of them
    Resource list;   ///< gpu::Surface; both are rgba32_uint pictures, in rows of gpu::SURFACES_IN_ROW
};

/// Nodes that one dispatch may look at: some devices end a thread's loops after 65535 turns in all. A node is a turn,
/// and where lanes go in step, each surface of a leaf that one of them is at; lists are a few hundred more. Fewer
/// would cost more dispatches, and one that finds nothing sets up every ray all the same.
inline constexpr uint32_t NODES_IN_DISPATCH = 60'000 / (2 + gpu::SURFACES_IN_LEAF);

struct SurfacesInput {
    gpu::RaycastParams params;  ///< the same as the ray caster's: pixels, light and distance blending are read
    gpu::SurfaceParams scene;
    std::optional<SurfaceList> listed;
    bool probe = false;  ///< scene.probe_* are set
    PixelGroups pixel_groups;
    std::optional<ListedBlocks> blocks{};            ///< whose pixels alone are drawn
    uint32_t nodes_in_dispatch = NODES_IN_DISPATCH;  ///< others are for tests
};

/// The device takes this for each tile of a part, besides the image.
inline constexpr uint64_t SURFACE_TILE_BYTES = sizeof(uint32_t) * gpu::SURFACE_TILE * gpu::SURFACE_TILE;

/// An image of the part's size: lit colour in linear light, and the length along each pixel's ray at which a surface
/// ends it, gpu::NO_SURFACE where none does. It lasts for this frame only.
Resource surfaces(FrameGraph& graph, const SurfacesInput& input);

}  // namespace shvr
