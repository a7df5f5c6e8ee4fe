#pragma once
// The graph of a thinned set of voxels, homotopic to the set: it has as many parts and loops.
//
// The union of the voxels as closed cubes is homotopic to their nerve, the complex of all sets of pairwise touching
// voxels, since boxes that meet in pairs have a common point. An edge between touching voxels is kept if it connects
// two parts or closes a loop that no triangles fill; shorter edges are considered first (persistent homology,
// Edelsbrunner, Letscher and Zomorodian 2002). One thread.

#include <vector>

#include "engine/annotation/sets/voxels_near.h"

namespace shvr {

struct LineGraph {
    struct Vertex {
        glm::dvec3 position{0.0};  ///< volume space
        double radius = 0.0;
        std::vector<uint32_t> joined{};  ///< the vertices next to it, ascending
        bool is_gone = false;
    };
    /// A path from one vertex to another, or back to the first; each vertex in between has exactly two neighbours.
    using Line = std::vector<uint32_t>;

    std::vector<Vertex> vertices{};

    /// Lines that contain each edge once: first lines at ends or branches, then separate loops; sorted by first vertex.
    std::vector<Line> lines() const;
    double length_of(const Line& line) const;
    /// Removes spurs, shortest first, until none is left: lines from a branch to a loose end whose length plus radius
    /// at the end is at most `spur` times the branch's radius. Returns the number of lines removed.
    int64_t prune(double spur);
    /// Merges branches that are adjacent, or joined by a line that stays within `tolerance` of the first branch, unless
    /// that would remove a loop. A merged branch has the position and radius of the branch with the larger radius.
    void merge_branches(double tolerance);
    /// Removes lines with a loose end whose vertices are all within `within` of the other end, as vertices that were
    /// moved to the same place are: of a separate line, one end stays. Returns the number of lines removed.
    int64_t drop_collapsed(double within);
    int64_t count_edges() const;

private:
    void remove_edge(uint32_t a, uint32_t b);
    /// Removes all of a line but its first vertex.
    void remove_beyond_first(const Line& line);
    Line line_from(uint32_t start, uint32_t next) const;
    bool is_branch(uint32_t vertex) const { return vertices[vertex].joined.size() > 2; }
    void join(uint32_t a, uint32_t b);
    /// The line from a branch over `next` to another branch if they can be merged; otherwise empty.
    Line line_to_merge(uint32_t branch, uint32_t next, double tolerance) const;
    void merge(const Line& line);
};

/// The graph of thinned voxels: one vertex at the centre of each voxel, by ascending voxel index, without radii.
LineGraph graph_of(const BrickSet& lines, const Mask& mask, const glm::dvec3& spacing, const Progress& progress);

/// Simplifies a line (Douglas and Peucker 1973): keeps its first and last vertex, and at least `inner` others, so that
/// positions and radii deviate by at most `tolerance`. Drops the vertices inside the ball of a branch at an end, if
/// enough others are left: inside a thick junction, thinned voxels do not show a line's course.
LineGraph::Line simplified(const LineGraph& graph, const LineGraph::Line& line, double tolerance, size_t inner);

}  // namespace shvr
