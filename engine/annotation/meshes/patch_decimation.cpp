#include "engine/annotation/meshes/patch_decimation.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <queue>
#include <tuple>

#include "engine/annotation/meshes/quadric.h"
#include "engine/annotation/meshes/surface_distance.h"

namespace shvr {

namespace {

constexpr uint32_t GONE = UINT32_MAX;

struct Collapse {
    double order = 0.0;  ///< cheapest first
    uint32_t from = 0, to = 0;
    uint32_t version = 0;  ///< of both, as a sum: larger after every change of either
    glm::dvec3 place{0.0};
    bool operator<(const Collapse& other) const  // for a queue with the largest first
    {
        return std::tie(other.order, other.from, other.to) < std::tie(order, from, to);
    }
};

class Decimator {
public:
    Decimator(Patch& patch, const PatchLimits& limits)
        : positions_(patch.positions),
          triangles_(patch.triangles),
          limits_(limits),
          origin_(middle()),
          before_(patch.positions, patch.triangles, limits.error),
          is_attached_(patch.positions.size()),
          attached_(patch.triangles.size()),
          is_moved_(patch.triangles.size())
    {
        for (const std::vector<uint32_t>& same : patch.same)
            if (!same.empty()) sides_.emplace_back(same);
        stars_.resize(positions_.size());
        for (uint32_t i = 0; i < triangles_.size(); ++i)
            for (int corner = 0; corner < 3; ++corner) stars_[triangles_[i][corner]].push_back(i);
        fixed_.resize(positions_.size());
        for (uint32_t vertex = 0; vertex < positions_.size(); ++vertex) fixed_[vertex] = !is_inside(vertex);
        quadrics_.resize(positions_.size());
        versions_.resize(positions_.size());
        for (const glm::uvec3& t : triangles_) {
            const glm::dvec3 normal = normal_of(positions_[t.x], positions_[t.y], positions_[t.z]);
            const double length = glm::length(normal);
            for (int corner = 0; corner < 3 && length > 0.0; ++corner)
                quadrics_[t[corner]].add(normal / length, positions_[t.x] - origin_);
        }
    }

    double run(const Progress& progress)
    {
        for (const glm::uvec3& t : triangles_)
            for (int i = 0; i < 3; ++i)
                if (t[i] < t[(i + 1) % 3]) offer(t[i], t[(i + 1) % 3]);
        size_t left = triangles_.size();
        const size_t all = left;
        for (size_t step = 0; left > limits_.triangles && !queue_.empty(); ++step) {
            if (step % 4096 == 0) tell(progress, double(all - left) / double(all - limits_.triangles));
            const Collapse next = queue_.top();
            queue_.pop();
            if (next.version != versions_[next.from] + versions_[next.to] || stars_[next.from].empty() ||
                stars_[next.to].empty())
                continue;
            // The place depends on triangles around, which may have changed.
            const Collapse now = collapse_of(next.from, next.to);
            if (now.order > next.order)
                queue_.push(now);
            else if (is_allowed(now) && attach(now))
                left -= carry_out(now);
        }
        const double error = measure_error(progress);
        std::erase_if(triangles_, [](const glm::uvec3& t) { return t.x == GONE; });
        return error;
    }

private:
    /// How the vertices of the patch are those of a mesh that it is a part of: at its border, one may be several.
    struct Side {
        explicit Side(const std::vector<uint32_t>& same) : name(same), next(same.size())
        {
            for (uint32_t i = 0; i < next.size(); ++i) {
                next[i] = i;
                if (name[i] != i) std::swap(next[i], next[name[i]]);
            }
        }
        const std::vector<uint32_t>& name;  ///< the first vertex that is the same
        std::vector<uint32_t> next;         ///< the next one that is the same, in a ring
    };

    glm::dvec3 middle() const
    {
        glm::dvec3 sum(0.0);
        for (const glm::dvec3& position : positions_) sum += position;
        return positions_.empty() ? sum : sum / double(positions_.size());
    }
    static glm::dvec3 normal_of(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c)
    {
        return glm::cross(b - a, c - a);
    }

    /// The vertices around a vertex, ascending.
    std::vector<uint32_t> around(uint32_t vertex) const
    {
        std::vector<uint32_t> found;
        for (const uint32_t i : stars_[vertex])
            for (int corner = 0; corner < 3; ++corner)
                if (triangles_[i][corner] != vertex) found.push_back(triangles_[i][corner]);
        std::ranges::sort(found);
        found.erase(std::unique(found.begin(), found.end()), found.end());
        return found;
    }
    /// Whether the triangles at the vertex are a ring: then no mesh has others at it.
    bool is_inside(uint32_t vertex) const { return around(vertex).size() == stars_[vertex].size(); }

    bool holds(uint32_t triangle, uint32_t vertex) const
    {
        const glm::uvec3& t = triangles_[triangle];
        return t.x == vertex || t.y == vertex || t.z == vertex;
    }
    bool is_border(uint32_t a, uint32_t b) const
    {
        return std::ranges::count_if(stars_[a], [&](uint32_t i) { return holds(i, b); }) == 1;
    }

    /// Calls `visit(triangle)` for those at the vertex in the mesh of a side, as far as they are in this patch.
    template <class Visit>
    void for_each_at(uint32_t vertex, const Side& side, const Visit& visit) const
    {
        uint32_t one = vertex;
        do {
            for (const uint32_t i : stars_[one]) visit(i);
            one = side.next[one];
        } while (one != vertex);
    }
    /// The vertices around a vertex in that mesh, by name, ascending.
    std::vector<uint32_t> around(uint32_t vertex, const Side& side) const
    {
        std::vector<uint32_t> found;
        for_each_at(vertex, side, [&](uint32_t i) {
            for (int corner = 0; corner < 3; ++corner)
                if (const uint32_t name = side.name[triangles_[i][corner]]; name != side.name[vertex])
                    found.push_back(name);
        });
        std::ranges::sort(found);
        found.erase(std::unique(found.begin(), found.end()), found.end());
        return found;
    }
    bool has_triangle_with(uint32_t vertex, uint32_t a, uint32_t b, const Side& side) const
    {
        bool found = false;
        for_each_at(vertex, side, [&](uint32_t i) {
            const glm::uvec3& t = triangles_[i];
            const std::array names{side.name[t.x], side.name[t.y], side.name[t.z]};
            found = found || (std::ranges::count(names, a) == 1 && std::ranges::count(names, b) == 1);
        });
        return found;
    }

    /// Calls `visit(triangle, corner)` for the triangles that have exactly one of the two vertices, at that corner.
    template <class Visit>
    void for_each_moved(uint32_t from, uint32_t to, const Visit& visit) const
    {
        for (const uint32_t vertex : {from, to})
            for (const uint32_t i : stars_[vertex]) {
                if (holds(i, vertex == from ? to : from)) continue;
                visit(i, triangles_[i].x == vertex ? 0 : triangles_[i].y == vertex ? 1 : 2);
            }
    }

    /// Six times the volume between the triangles around the two vertices and a point, and how it grows if both move.
    struct Volume {
        glm::dvec3 normal{0.0};
        double held = 0.0;
    };
    Volume volume_around(uint32_t from, uint32_t to, const glm::dvec3& base) const
    {
        Volume volume;
        for_each_moved(from, to, [&](uint32_t i, int corner) {
            const glm::uvec3& t = triangles_[i];
            volume.normal += glm::cross(positions_[t[(corner + 1) % 3]] - base, positions_[t[(corner + 2) % 3]] - base);
        });
        const auto add = [&](uint32_t i) {
            const glm::uvec3& t = triangles_[i];
            volume.held += glm::dot(positions_[t.x] - base, glm::cross(positions_[t.y] - base, positions_[t.z] - base));
        };
        for (const uint32_t i : stars_[from]) add(i);
        for (const uint32_t i : stars_[to])
            if (!holds(i, from)) add(i);
        return volume;
    }

    void offer(uint32_t from, uint32_t to)
    {
        if (fixed_[from] && fixed_[to]) return;
        if (fixed_[from]) std::swap(from, to);
        queue_.push(collapse_of(from, to));
    }
    /// `from` is not fixed.
    Collapse collapse_of(uint32_t from, uint32_t to) const
    {
        Quadric quadric = quadrics_[from];
        quadric += quadrics_[to];
        const double length = glm::distance(positions_[from], positions_[to]);
        Collapse best{.from = from, .to = to, .version = versions_[from] + versions_[to], .place = positions_[to]};
        double least = quadric.at(best.place - origin_);
        if (!fixed_[to]) {
            const Volume volume = volume_around(from, to, positions_[from]);
            const double area = glm::dot(volume.normal, volume.normal);
            least = std::numeric_limits<double>::infinity();
            for (const double share : {0.5, 0.0, 1.0}) {
                glm::dvec3 place = glm::mix(positions_[from], positions_[to], share);
                const double missing = volume.held - glm::dot(volume.normal, place - positions_[from]);
                const glm::dvec3 correction = area > 0.0 ? missing / area * volume.normal : glm::dvec3(0.0);
                if (glm::length(correction) < length) place += correction;
                const double error = quadric.at(place - origin_);
                if (!(error < least)) continue;
                least = error;
                best.place = place;
            }
        }
        constexpr double PER_LENGTH = 1e-6;  // of equal errors, short edges first
        best.order = least + PER_LENGTH * length * length;
        return best;
    }

    bool is_allowed(const Collapse& collapse) const
    {
        const auto [from, to] = std::pair(collapse.from, collapse.to);
        const std::vector<uint32_t> near_from = around(from), near_to = around(to);
        std::vector<uint32_t> common;
        std::ranges::set_intersection(near_from, near_to, std::back_inserter(common));
        if (common.size() != 2 || !keeps_manifold(from, to, common)) return false;
        // No new edge between vertices of the border: another patch may have it already.
        if (fixed_[to])
            for (const uint32_t vertex : near_from)
                if (fixed_[vertex] && vertex != to && !std::ranges::binary_search(common, vertex)) return false;
        bool keeps_sides = true;
        for_each_moved(from, to, [&](uint32_t i, int corner) {
            const glm::uvec3& t = triangles_[i];
            const glm::dvec3 &b = positions_[t[(corner + 1) % 3]], &c = positions_[t[(corner + 2) % 3]];
            const glm::dvec3 before = normal_of(positions_[t[corner]], b, c), after = normal_of(collapse.place, b, c);
            // By at most 60 degrees, and never a triangle without an area.
            if (!(glm::dot(before, after) > 0.5 * glm::length(before) * glm::length(after))) keeps_sides = false;
        });
        if (!keeps_sides) return false;
        return true;
    }
    /// The link condition in each mesh: the only common neighbours are the two opposite vertices, and no triangles
    /// become each other's double.
    bool keeps_manifold(uint32_t from, uint32_t to, const std::vector<uint32_t>& common) const
    {
        // Nor one that is the double of another patch's: a patch of three triangles within three sides stays.
        if (stars_[from].size() == 3 && is_border(to, common[0]) && is_border(to, common[1]) &&
            is_border(common[0], common[1]))
            return false;
        for (const Side& side : sides_) {
            const std::vector<uint32_t> near_from = around(from, side), near_to = around(to, side);
            std::vector<uint32_t> both;
            std::ranges::set_intersection(near_from, near_to, std::back_inserter(both));
            if (both.size() != 2) return false;
            if (has_triangle_with(from, both[0], both[1], side) && has_triangle_with(to, both[0], both[1], side))
                return false;
        }
        return true;
    }
    double change_of_volume(const Collapse& collapse) const
    {
        const glm::dvec3& base = positions_[collapse.from];
        const Volume volume = volume_around(collapse.from, collapse.to, base);
        return (glm::dot(volume.normal, collapse.place - base) - volume.held) / 6.0;
    }

    /// Whether the triangles that there will be are near the patch as it was given.
    bool is_near(const Collapse& collapse) const
    {
        uint32_t nearest = stars_[collapse.from].front();
        bool reaches = before_.from(collapse.place, limits_.error, nearest) <= limits_.error;
        for_each_moved(collapse.from, collapse.to, [&](uint32_t i, int corner) {
            const glm::uvec3& t = triangles_[i];
            reaches = reaches && before_.reaches({collapse.place, positions_[t[(corner + 1) % 3]],
                                                  positions_[t[(corner + 2) % 3]]});
        });
        return reaches;
    }
    /// The largest distance in both directions, rounded upwards.
    double measure_error(const Progress& progress) const
    {
        double least = std::sqrt(squared_error_), most = least;
        for (size_t i = 0; i < triangles_.size(); ++i) {
            if (i % 4096 == 0) tell(progress, 1.0);
            const glm::uvec3& t = triangles_[i];
            if (t.x == GONE || is_moved_[i] == 0) continue;
            most = std::max(most, before_.farthest({positions_[t.x], positions_[t.y], positions_[t.z]}, least));
        }
        return most;
    }

    /// Attaches all vertices that the triangles around the two stood for to the nearest triangles of those that there
    /// will be. Changes nothing, and returns false, if one would be too far, or if the volume may not change that much.
    bool attach(const Collapse& collapse)
    {
        std::vector<uint32_t> points, changed;
        const auto take = [&](uint32_t i) {
            points.insert(points.end(), attached_[i].begin(), attached_[i].end());
            changed.push_back(i);
        };
        for (const uint32_t i : stars_[collapse.from]) take(i);
        for (const uint32_t i : stars_[collapse.to])
            if (!holds(i, collapse.from)) take(i);
        for (const uint32_t vertex : {collapse.from, collapse.to})
            if (!is_attached_[vertex] && !fixed_[vertex]) points.push_back(vertex);
        std::vector<uint32_t> nearest(points.size());
        double worst = 0.0;
        for (size_t i = 0; i < points.size(); ++i) {
            double least = std::numeric_limits<double>::infinity();
            for_each_moved(collapse.from, collapse.to, [&](uint32_t triangle, int corner) {
                const glm::uvec3& t = triangles_[triangle];
                const double distance = squared_distance(
                    before_.positions()[points[i]],
                    {collapse.place, positions_[t[(corner + 1) % 3]], positions_[t[(corner + 2) % 3]]});
                if (!(distance < least)) return;
                least = distance;
                nearest[i] = triangle;
            });
            worst = std::max(worst, least);
        }
        if (!(worst <= limits_.error * limits_.error) || !is_near(collapse)) return false;
        if (limits_.may_change && !limits_.may_change(change_of_volume(collapse))) return false;
        squared_error_ = std::max(squared_error_, worst);
        for (const uint32_t i : changed) attached_[i].clear();
        for (size_t i = 0; i < points.size(); ++i) {
            attached_[nearest[i]].push_back(points[i]);
            is_attached_[points[i]] = 1;
        }
        return true;
    }

    /// Returns how many triangles are gone.
    size_t carry_out(const Collapse& collapse)
    {
        const auto [from, to] = std::pair(collapse.from, collapse.to);
        size_t gone = 0;
        for (const uint32_t i : stars_[from]) {
            if (holds(i, to)) {
                for (int corner = 0; corner < 3; ++corner)
                    if (triangles_[i][corner] != from) std::erase(stars_[triangles_[i][corner]], i);
                triangles_[i] = glm::uvec3(GONE);
                ++gone;
                continue;
            }
            for (int corner = 0; corner < 3; ++corner)
                if (triangles_[i][corner] == from) triangles_[i][corner] = to;
            stars_[to].push_back(i);
        }
        std::vector<uint32_t>().swap(stars_[from]);
        positions_[to] = collapse.place;
        for (const uint32_t i : stars_[to]) is_moved_[i] = 1;
        quadrics_[to] += quadrics_[from];
        ++versions_[to];
        for (const uint32_t vertex : around(to)) offer(to, vertex);
        return gone;
    }

    std::vector<glm::dvec3>& positions_;
    std::vector<glm::uvec3>& triangles_;
    const PatchLimits& limits_;
    glm::dvec3 origin_;  ///< quadrics are relative to it
    SurfaceDistance before_;
    std::vector<Side> sides_;
    std::vector<uint8_t> is_attached_;             ///< for each vertex: as a point of `attached_`
    std::vector<std::vector<uint32_t>> attached_;  ///< for each triangle, vertices that were near it
    std::vector<uint8_t> is_moved_;                ///< for each triangle
    double squared_error_ = 0.0;
    std::vector<std::vector<uint32_t>> stars_;
    std::vector<uint8_t> fixed_;
    std::vector<Quadric> quadrics_;
    std::vector<uint32_t> versions_;
    std::priority_queue<Collapse> queue_;
};

}  // namespace

double decimate(Patch& patch, const PatchLimits& limits, const Progress& progress)
{
    return Decimator(patch, limits).run(progress);
}

}  // namespace shvr
