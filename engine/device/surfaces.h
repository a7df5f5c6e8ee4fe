#pragma once
// The opaque surfaces of a scene on the device, and the parameters for drawing them with a camera. Without surfaces,
// nothing is allocated on the device. Used only by the thread that owns the memory.

#include <optional>

#include "engine/gpu/memory.h"
#include "engine/look/camera.h"
#include "engine/look/surfaces/mesh_tree.h"
#include "engine/look/surfaces/surface_forest.h"
#include "engine/passes/surfaces.h"

namespace shvr {

class SurfaceScene {
public:
    explicit SurfaceScene(gpu::Memory& memory) : memory_(memory) {}

    /// Replaces all surfaces. If the budget cannot hold the new surfaces, fails and keeps the old ones. Waits for the
    /// device if surfaces are on it already.
    void set(SurfaceForest forest);
    /// Replaces a few surfaces, as SurfaceForest::replace does.
    bool replace(std::span<const uint64_t> keys, std::span<const KeyedSurface> surfaces, const VolumeInfo& volume);
    /// Changes the looks of existing surfaces, as SurfaceForest::restyle does.
    bool restyle(std::span<const KeyedSurface> surfaces, const VolumeInfo& volume);
    bool empty() const { return forest_.nodes().empty(); }

    /// Handles for a graph that must be submitted; uploads changes. Null if there are no surfaces.
    std::optional<SurfaceList> upload(FrameGraph& graph);
    /// The parameters for drawing with `planes` in `volume`, without those of the probe.
    gpu::SurfaceParams params(const RayPlanes& planes, const glm::uvec2& pixels, const VolumeInfo& volume) const;

private:
    gpu::Memory& memory_;
    SurfaceForest forest_;
    gpu::Storage nodes_, list_;
    bool is_sent_ = false;  ///< whether the device is up to date, except for values written by `replace`
};

/// The triangles of a scene's meshes, likewise. They change as a whole.
class MeshScene {
public:
    explicit MeshScene(gpu::Memory& memory) : memory_(memory) {}
    /// Replaces all triangles. If the budget cannot hold them, fails and keeps the old ones. The host keeps them only
    /// until they are on the device.
    void set(MeshTree tree);
    bool empty() const { return node_count_ == 0; }
    std::optional<SurfaceList> upload(FrameGraph& graph);
    gpu::SurfaceParams params(const RayPlanes& planes, const glm::uvec2& pixels, const VolumeInfo& volume) const;

private:
    gpu::Memory& memory_;
    MeshTree unsent_;
    size_t node_count_ = 0;
    double largest_ = 0.0;  ///< absolute coordinate, in reference lengths
    gpu::Storage nodes_, list_;
};

}  // namespace shvr
