#pragma once
// The opaque surfaces of a scene on the device, and the parameters to draw them with a camera. Nothing is allocated
// there while there are none. One thread, the one that owns the memory.

#include <optional>

#include "engine/gpu/memory.h"
#include "engine/look/camera.h"
#include "engine/look/surface_forest.h"
#include "engine/passes/surfaces.h"

namespace shvr {

class SurfaceScene {
public:
    explicit SurfaceScene(gpu::Memory& memory) : memory_(memory) {}

    /// Replaces all of them. Fails where the budget cannot hold them; then the earlier ones stay. Waits for the device
    /// unless there were none.
    void set(SurfaceForest forest);
    /// Replaces a few, as SurfaceForest::replace does.
    bool replace(std::span<const uint64_t> keys, std::span<const KeyedSurface> surfaces, const VolumeInfo& volume);
    /// Gives those that there are other looks, as SurfaceForest::restyle does.
    bool restyle(std::span<const KeyedSurface> surfaces, const VolumeInfo& volume);
    bool empty() const { return forest_.nodes().empty(); }

    /// Handles for a graph that must be submitted; uploads what has changed. Null where there are none.
    std::optional<SurfaceList> upload(FrameGraph& graph);
    /// The parameters for `camera` and `volume`, except the probe's.
    gpu::SurfaceParams params(const RayPlanes& planes, const glm::uvec2& pixels, const VolumeInfo& volume) const;

private:
    double largest() const;
    gpu::Memory& memory_;
    SurfaceForest forest_;
    gpu::Storage nodes_, list_;
    bool is_sent_ = false;  ///< except what `replace` wrote
};

}  // namespace shvr
