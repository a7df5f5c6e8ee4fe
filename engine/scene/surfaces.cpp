#include "engine/scene/surfaces.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace shvr {

namespace {

/// Points of rays and boxes are off by a few ulps of the largest number that goes into them; this is 16.
constexpr double ROUNDING = 0x1p-20;
/// Instead of infinity, of which a share is not a number.
constexpr double FAR = 1e20;

template <class Value>
gpu::Storage reserve(gpu::Memory& memory, const char* name, const std::vector<Value>& values)
{
    return memory.create(name, buffer_desc(values.size() * sizeof(Value)));
}

template <class Value>
Resource uploaded(FrameGraph& graph, const char* name, const std::vector<Value>& values, const gpu::Storage& storage)
{
    const Resource target = graph.import(name, storage.import());
    if (values.empty()) return target;
    return graph.copy(graph.upload<Value>(std::string(name) + " to upload", values), target,
                      {{0, 0, values.size() * sizeof(Value)}}, std::string("upload ") + name);
}

double largest(const glm::dvec3& v)
{
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

}  // namespace

void SurfaceScene::set(SurfaceTree tree)
{
    gpu::Storage nodes, list;
    if (!tree.nodes.empty()) {
        nodes = reserve(memory_, "surface nodes", tree.nodes);
        list = reserve(memory_, "surface list", tree.list);
    }
    nodes_ = std::move(nodes);
    list_ = std::move(list);
    node_count_ = uint32_t(tree.nodes.size());
    largest_ = tree.nodes.empty() ? 0.0 : std::max(largest(tree.nodes[0].lower), largest(tree.nodes[0].upper));
    waiting_ = std::move(tree);
}

std::optional<SurfaceList> SurfaceScene::import(FrameGraph& graph)
{
    if (empty()) return std::nullopt;
    const SurfaceTree tree = std::exchange(waiting_, {});
    return SurfaceList{uploaded(graph, "surface nodes", tree.nodes, nodes_),
                       uploaded(graph, "surface list", tree.list, list_)};
}

gpu::SurfaceParams SurfaceScene::params(const RayPlanes& planes, const glm::uvec2& pixels,
                                        const VolumeInfo& volume) const
{
    const glm::dvec3 scale = volume.spacing / std::min({volume.spacing.x, volume.spacing.y, volume.spacing.z});
    const auto between = [&](const glm::dvec3& near, const glm::dvec3& far) {
        return scale * (near + planes.middle * (far - near));
    };
    const glm::dvec3 corner = between(planes.near_corner, planes.far_corner);
    const glm::dvec3 dx = between(planes.near_dx, planes.far_dx), dy = between(planes.near_dy, planes.far_dy);
    const glm::dvec3 origin = corner + 0.5 * (double(pixels.x) * dx + double(pixels.y) * dy);
    const glm::dvec3 along = scale * (planes.far_corner - planes.near_corner);
    gpu::SurfaceParams params{};
    params.origin = origin;
    params.origin_rest = origin - glm::dvec3(params.origin);
    params.middle_corner = corner - origin;
    params.middle_dx = dx;
    params.middle_dy = dy;
    params.along_corner = along;
    params.along_dx = scale * (planes.far_dx - planes.near_dx);
    params.along_dy = scale * (planes.far_dy - planes.near_dy);
    params.begin = float(std::max(planes.begin, -FAR));
    params.middle = float(planes.middle);
    params.end = float(std::min(planes.end, FAR));
    params.slack = float(ROUNDING * (largest_ + largest(origin) + largest(corner - origin)));
    params.node_count = node_count_;
    return params;
}

}  // namespace shvr
