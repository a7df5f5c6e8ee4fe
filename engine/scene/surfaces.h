#pragma once
// The opaque surfaces of a scene on the device, and what a camera adds to draw them. Nothing exists there while there are
// none. One thread, the one that owns the memory.

#include <optional>

#include "engine/gpu/memory.h"
#include "engine/passes/surfaces.h"
#include "engine/scene/camera.h"
#include "engine/scene/surface_tree.h"

namespace shvr {

class SurfaceScene {
public:
    explicit SurfaceScene(gpu::Memory& memory) : memory_(memory) {}

    /// Replaces all of them. Fails as `surface_tree` does, and where the budget does not hold them; then the ones before
    /// stay. Waits for the device where there were some.
    void set(SurfaceTree tree);
    bool empty() const { return node_count_ == 0; }

    /// Handles for a graph that must be submitted; nothing where there are none.
    std::optional<SurfaceList> import(FrameGraph& graph);
    /// What `camera` sees of `volume`, but for the probe.
    gpu::SurfaceParams params(const RayPlanes& planes, const glm::uvec2& pixels, const VolumeInfo& volume) const;

private:
    gpu::Memory& memory_;
    SurfaceTree waiting_;  ///< for the device
    gpu::Storage nodes_, list_;
    uint32_t node_count_ = 0;
    double largest_ = 0.0;  ///< of the coordinates, in reference lengths
};

}  // namespace shvr
