#include "engine/device/surfaces.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace shvr {

namespace {

/// Points of rays and boxes are off by a few ulps of the largest number involved; this allows 16.
constexpr double ROUNDING = 0x1p-20;
/// In place of infinity, since zero times infinity is not a number.
constexpr double FAR = 1e20;
/// So many values that have not changed are sent again rather than left out.
constexpr uint32_t SHORT_GAP = 16;

template <class Value>
Resource send_all(FrameGraph& graph, const std::string& name, const std::vector<Value>& values, Resource target)
{
    return graph.copy(graph.upload<Value>(name + " to upload", values), target, {{0, 0, values.size() * sizeof(Value)}},
                      "upload " + name);
}

template <class Value>
Resource send(FrameGraph& graph, const std::string& name, const std::vector<Value>& values,
              std::vector<uint32_t> places, Resource target)
{
    std::ranges::sort(places);
    places.erase(std::unique(places.begin(), places.end()), places.end());
    while (!places.empty() && places.back() >= values.size()) places.pop_back();  // removed since
    if (places.empty()) return target;
    std::vector<Value> written;
    std::vector<BufferRegion> regions;
    uint32_t next = 0;  // after the last one written
    for (const uint32_t place : places) {
        if (regions.empty() || place - next > SHORT_GAP) {
            regions.push_back({written.size() * sizeof(Value), place * sizeof(Value), 0});
            next = place;
        }
        for (; next <= place; ++next) {
            written.push_back(values[next]);
            regions.back().bytes += sizeof(Value);
        }
    }
    return graph.copy(graph.upload<Value>(name + " to upload", written), target, std::move(regions), "upload " + name);
}

double largest(const glm::dvec3& v)
{
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

}  // namespace

void SurfaceScene::set(SurfaceForest forest)
{
    gpu::Storage nodes, list;
    if (!forest.nodes().empty()) {
        const auto create_buffer = [&](const char* name, uint64_t bytes) {
            return memory_.create(name, buffer_desc(bytes), gpu::Placement::device, "the surfaces of the trace");
        };
        nodes = create_buffer("surface nodes", forest.max_nodes() * sizeof(gpu::SurfaceNode));
        list = create_buffer("surface list", forest.max_surfaces() * sizeof(gpu::Surface));
    }
    nodes_ = std::move(nodes);
    list_ = std::move(list);
    forest_ = std::move(forest);
    is_sent_ = false;
}

bool SurfaceScene::replace(std::span<const uint64_t> keys, std::span<const KeyedSurface> surfaces,
                           const VolumeInfo& volume)
{
    return forest_.replace(keys, surfaces, volume);
}

bool SurfaceScene::restyle(std::span<const KeyedSurface> surfaces, const VolumeInfo& volume)
{
    return forest_.restyle(surfaces, volume);
}

std::optional<SurfaceList> SurfaceScene::upload(FrameGraph& graph)
{
    if (empty()) return std::nullopt;
    const Resource nodes = graph.import("surface nodes", nodes_.import());
    const Resource list = graph.import("surface list", list_.import());
    SurfaceForest::Written written = forest_.take_written();
    if (!is_sent_ || !written.nodes.empty() || !written.list.empty())
        graph.unless_submitted([this] { is_sent_ = false; });
    if (!std::exchange(is_sent_, true))
        return SurfaceList{send_all(graph, "surface nodes", forest_.nodes(), nodes),
                           send_all(graph, "surface list", forest_.list(), list)};
    return SurfaceList{send(graph, "surface nodes", forest_.nodes(), std::move(written.nodes), nodes),
                       send(graph, "surface list", forest_.list(), std::move(written.list), list)};
}

/// The largest of the coordinates, in reference lengths.
double SurfaceScene::largest() const
{
    double most = 0.0;
    for (size_t root = 0; root < forest_.nodes().size(); root = forest_.nodes()[root].skip)
        most = std::max({most, shvr::largest(forest_.nodes()[root].lower), shvr::largest(forest_.nodes()[root].upper)});
    return most;
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
    params.slack = float(ROUNDING * (largest() + shvr::largest(origin) + shvr::largest(corner - origin)));
    params.node_count = uint32_t(forest_.nodes().size());
    return params;
}

}  // namespace shvr
