#include "engine/volume/procedural/tubes_truth.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "engine/volume/procedural/tube_scene.h"

namespace shvr {

namespace {

double distance_of(const glm::dvec3& a, const glm::dvec3& b)
{
    const glm::dvec3 d = a - b;
    return std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z);
}

/// The point of a strand's axis nearest to a position. It lies between the points `before` and `before` + 1.
struct Fork {
    size_t before = 0;
    glm::dvec3 place{};
    double distance = std::numeric_limits<double>::infinity();
};
Fork nearest_on(const TubeStrand& strand, const glm::dvec3& position)
{
    Fork nearest;
    for (size_t i = 0; i + 1 < strand.points.size(); ++i) {
        const glm::dvec3 from = strand.points[i], along = strand.points[i + 1] - from, d = position - from;
        const double t = std::clamp((d.x * along.x + d.y * along.y + d.z * along.z) /
                                        (along.x * along.x + along.y * along.y + along.z * along.z),
                                    0.0, 1.0);
        const glm::dvec3 place = from + along * t;
        const double distance = distance_of(place, position);
        if (distance < nearest.distance) nearest = {i, place, distance};
    }
    return nearest;
}

/// Returns the fractions of a piece between which balls of `radius` lie inside the volume; x > y if none does.
glm::dvec2 part_inside(const glm::dvec3& from, const glm::dvec3& to, double radius, const Size3& size)
{
    glm::dvec2 part(0.0, 1.0);
    for (int axis = 0; axis < 3; ++axis) {
        const double lower = radius, upper = double(size[axis]) - radius, along = to[axis] - from[axis];
        if (along == 0.0) {
            if (from[axis] < lower || from[axis] > upper) return {1.0, 0.0};
            continue;
        }
        const double a = (lower - from[axis]) / along, b = (upper - from[axis]) / along;
        part = {std::max(part.x, std::min(a, b)), std::min(part.y, std::max(a, b))};
    }
    return part;
}

class TruthMaker {
public:
    TruthMaker(const std::vector<TubeStrand>& strands, const Size3& size)
        : strands_(strands), size_(size), forks_(strands.size()), fork_nodes_(strands.size())
    {
        for (const TubeStrand& strand : strands_)
            if (strand.parent) forks_[*strand.parent] = nearest_on(strands_[*strand.parent], strand.points.front());
    }

    ProceduralTruth make()
    {
        std::vector<Tube> tubes;
        for (size_t i = 0; i < strands_.size(); ++i) {
            const TubeStrand& strand = strands_[i];
            for (size_t k = 0; k + 1 < strand.points.size(); ++k)
                tubes.push_back({.ends = {strand.points[k], strand.points[k + 1]},
                                 .radii = {strand.radius, strand.radius},
                                 .group = group_of(strand)});
            add_strand(i);
        }
        truth_.group = [scene = std::make_shared<const TubeScene>(std::move(tubes), size_, 1e-5)](
                           const glm::dvec3& voxel) { return scene->group(voxel); };
        return std::move(truth_);
    }

private:
    static uint8_t group_of(const TubeStrand& strand) { return strand.parent ? 2 : 1; }

    void add_strand(size_t index)
    {
        const TubeStrand& strand = strands_[index];
        std::vector<glm::dvec3> points = strand.points;
        std::optional<size_t> fork;  // of `points`
        if (forks_[index]) {
            fork = forks_[index]->before + 1;
            points.insert(points.begin() + ptrdiff_t(*fork), forks_[index]->place);
        }
        std::optional<size_t> previous;  // node at points[k]; null if no part of the line ends there
        for (size_t k = 0; k + 1 < points.size(); ++k) {
            const glm::dvec2 part = part_inside(points[k], points[k + 1], strand.radius, size_);
            if (!(part.x < part.y)) {
                previous.reset();
                continue;
            }
            if (!previous) {
                previous = add_node(points[k] + (points[k + 1] - points[k]) * part.x, strand);
                if (k == 0 && part.x == 0.0) join(*previous, strand);
                if (fork == k && part.x == 0.0) fork_nodes_[index] = previous;
            }
            const size_t next =
                add_node(part.y < 1.0 ? points[k] + (points[k + 1] - points[k]) * part.y : points[k + 1], strand);
            truth_.links.push_back({*previous, next});
            if (fork == k + 1 && part.y == 1.0) fork_nodes_[index] = next;
            previous = part.y == 1.0 ? std::optional(next) : std::nullopt;
        }
    }

    size_t add_node(const glm::dvec3& voxel, const TubeStrand& strand)
    {
        truth_.nodes.push_back({voxel, strand.radius, group_of(strand)});
        return truth_.nodes.size() - 1;
    }

    void join(size_t node, const TubeStrand& strand)
    {
        if (!strand.parent || !fork_nodes_[*strand.parent]) return;
        const double fits = strands_[*strand.parent].radius - forks_[*strand.parent]->distance;
        if (!(fits > 0.0)) return;
        double& radius = truth_.nodes[node].radius_voxels;
        radius = std::min(radius, fits);
        truth_.links.push_back({*fork_nodes_[*strand.parent], node});
    }

    const std::vector<TubeStrand>& strands_;
    Size3 size_;
    std::vector<std::optional<Fork>> forks_;         ///< by parent
    std::vector<std::optional<size_t>> fork_nodes_;  ///< by parent
    ProceduralTruth truth_;
};

}  // namespace

ProceduralTruth truth_of_tubes(const std::vector<TubeStrand>& strands, const Size3& size)
{
    return TruthMaker(strands, size).make();
}

}  // namespace shvr
