#include "engine/device/surfaces.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "engine/look/split_digits.h"

namespace shvr {

namespace {

/// Ray and box coordinates are off by a few ulps of the largest number involved; this allows 16 ulps.
constexpr double ROUNDING = 0x1p-20;
/// Replaces infinity, since zero times infinity is NaN.
constexpr double FAR = 1e20;
/// Up to this many unchanged values are copied again if this saves a separate copy region.
constexpr uint32_t SHORT_GAP = 16;

template <class Value>
constexpr uint32_t TEXELS = sizeof(Value) / sizeof(glm::uvec4);
static_assert(TEXELS<gpu::Surface> == gpu::SURFACE_TEXELS && sizeof(gpu::Surface) == 64);
static_assert(TEXELS<gpu::Triangle> == gpu::SURFACE_TEXELS && sizeof(gpu::Triangle) == 64);
static_assert(MAX_TRIANGLES_SHOWN <= 1u << gpu::SURFACE_BLOCK && MAX_TRIANGLES_SHOWN / gpu::SURFACES_IN_ROW <= 4096);
static_assert(TEXELS<gpu::SurfaceNode> == gpu::SURFACE_NODE_TEXELS && sizeof(gpu::SurfaceNode) == 48);
static_assert(MAX_SURFACES + SurfaceForest::MAX_SURFACES_ADDED <= 1u << gpu::SURFACE_BLOCK);

template <class Value>
ResourceDesc desc_of(uint64_t values)
{
    const uint64_t rows = (values + gpu::SURFACES_IN_ROW - 1) / gpu::SURFACES_IN_ROW;
    return picture_desc(Format::rgba32_uint,
                        {TEXELS<Value> * uint32_t(std::min<uint64_t>(values, gpu::SURFACES_IN_ROW)), uint32_t(rows)});
}

/// Adds copy regions for the values begin ... end, contiguous in a buffer from `offset` on. Joins whole rows.
template <class Value>
void add_regions(uint32_t begin, uint32_t end, uint64_t offset, std::vector<ImageRegion>& regions)
{
    while (begin < end) {
        const uint32_t column = begin % gpu::SURFACES_IN_ROW;
        const uint32_t rows = column == 0 ? std::max((end - begin) / gpu::SURFACES_IN_ROW, 1u) : 1;
        const uint32_t count = std::min(end - begin, rows * gpu::SURFACES_IN_ROW - column);
        regions.push_back({offset,
                           {TEXELS<Value> * column, begin / gpu::SURFACES_IN_ROW, 0},
                           {TEXELS<Value> * (count / rows), rows, 1}});
        begin += count;
        offset += count * sizeof(Value);
    }
}

template <class Value>
Resource send_all(FrameGraph& graph, const std::string& name, const std::vector<Value>& values, Resource target)
{
    std::vector<ImageRegion> regions;
    add_regions<Value>(0, uint32_t(values.size()), 0, regions);
    return graph.copy_to_image(graph.upload<Value>(name + " to upload", values), target, std::move(regions),
                               "upload " + name);
}

template <class Value>
Resource send(FrameGraph& graph, const std::string& name, const std::vector<Value>& values,
              std::vector<uint32_t> places, Resource target)
{
    std::ranges::sort(places);
    places.erase(std::unique(places.begin(), places.end()), places.end());
    while (!places.empty() && places.back() >= values.size()) places.pop_back();  // removed since it was written
    if (places.empty()) return target;
    std::vector<Value> written;
    std::vector<ImageRegion> regions;
    for (size_t first = 0, last = 0; first < places.size(); first = last + 1) {
        last = first;
        while (last + 1 < places.size() && places[last + 1] - places[last] <= SHORT_GAP) ++last;
        add_regions<Value>(places[first], places[last] + 1, written.size() * sizeof(Value), regions);
        written.insert(written.end(), values.begin() + places[first], values.begin() + places[last] + 1);
    }
    return graph.copy_to_image(graph.upload<Value>(name + " to upload", written), target, std::move(regions),
                               "upload " + name);
}

double largest(const glm::dvec3& v)
{
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

/// The largest absolute coordinate, in reference lengths.
double largest(std::span<const gpu::SurfaceNode> nodes)
{
    double most = 0.0;
    for (size_t root = 0; root < nodes.size(); root = nodes[root].skip)
        most = std::max({most, largest(nodes[root].lower), largest(nodes[root].upper)});
    return most;
}

gpu::SurfaceParams surface_params(const RayPlanes& planes, const glm::uvec2& pixels, const VolumeInfo& volume,
                                  size_t nodes, double largest_coordinate)
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
    split_digits(origin, params.origin, params.origin_rest);
    params.middle_corner = corner - origin;
    params.middle_dx = dx;
    params.middle_dy = dy;
    params.along_corner = along;
    params.along_dx = scale * (planes.far_dx - planes.near_dx);
    params.along_dy = scale * (planes.far_dy - planes.near_dy);
    params.begin = float(std::max(planes.begin, -FAR));
    params.middle = float(planes.middle);
    params.end = float(std::min(planes.end, FAR));
    params.slack = float(ROUNDING * (largest_coordinate + largest(origin) + largest(corner - origin)));
    params.node_count = uint32_t(nodes);
    return params;
}

}  // namespace

void SurfaceScene::set(SurfaceForest forest)
{
    gpu::Storage nodes, list;
    if (!forest.nodes().empty()) {
        const auto create = [&](const char* name, const ResourceDesc& desc) {
            return memory_.create(name, desc, gpu::Placement::device, "the surfaces of the trace");
        };
        nodes = create("surface nodes", desc_of<gpu::SurfaceNode>(forest.max_nodes()));
        list = create("surface list", desc_of<gpu::Surface>(forest.max_surfaces()));
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

gpu::SurfaceParams SurfaceScene::params(const RayPlanes& planes, const glm::uvec2& pixels,
                                        const VolumeInfo& volume) const
{
    return surface_params(planes, pixels, volume, forest_.nodes().size(), largest(forest_.nodes()));
}

void MeshScene::set(MeshTree tree)
{
    gpu::Storage nodes, list;
    if (!tree.nodes.empty()) {
        const auto create = [&](const char* name, const ResourceDesc& desc) {
            return memory_.create(name, desc, gpu::Placement::device, "the triangles of meshes");
        };
        nodes = create("mesh nodes", desc_of<gpu::SurfaceNode>(tree.nodes.size()));
        list = create("mesh list", desc_of<gpu::Triangle>(tree.list.size()));
    }
    nodes_ = std::move(nodes);
    list_ = std::move(list);
    node_count_ = tree.nodes.size();
    largest_ = largest(tree.nodes);
    unsent_ = std::move(tree);
}

std::optional<SurfaceList> MeshScene::upload(FrameGraph& graph)
{
    if (empty()) return std::nullopt;
    Resource nodes = graph.import("mesh nodes", nodes_.import()), list = graph.import("mesh list", list_.import());
    if (!unsent_.nodes.empty()) {
        nodes = send_all(graph, "mesh nodes", unsent_.nodes, nodes);
        list = send_all(graph, "mesh list", unsent_.list, list);
        // The graph holds copies of them, which are kept until it has been submitted, or dropped without that.
        const auto sent = std::make_shared<MeshTree>(std::exchange(unsent_, {}));
        graph.unless_submitted([this, sent] { unsent_ = std::move(*sent); });
    }
    return SurfaceList{nodes, list, true};
}

gpu::SurfaceParams MeshScene::params(const RayPlanes& planes, const glm::uvec2& pixels, const VolumeInfo& volume) const
{
    return surface_params(planes, pixels, volume, node_count_, largest_);
}

}  // namespace shvr
