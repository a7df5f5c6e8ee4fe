#pragma once
// The graph of a thinned set of voxels, homotopic to it: as many parts and loops.
//
// The voxels as closed cubes have the topology of the complex of all sets of voxels that touch each other in pairs
// (the nerve; boxes that meet in pairs have a common point). An edge between touching voxels stays if it spans a part
// or closes a loop that no triangles fill (persistent homology, Edelsbrunner, Letscher and Zomorodian 2002); short
// edges come first. One thread.

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
    /// A way between two vertices that are no passages, or back to the first vertex; each vertex once otherwise.
    using Line = std::vector<uint32_t>;

    std::vector<Vertex> vertices{};

    /// Ways that together have every edge once, in the order of their first vertices.
    std::vector<Line> lines() const;
    double length_of(const Line& line) const;
    /// Removes lines from a branch to a loose end, while there are any, whose length and radius at the end together are
    /// at most `spur` radii of the branch; the shortest go first. Returns how many.
    int64_t prune(double spur);
    /// Merges branches that are next to each other, or joined by a line that stays within `tolerance` of one, where
    /// that keeps all loops. The one with the larger radius gives the position.
    void merge_branches(double tolerance);
    int64_t count_edges() const;

private:
    void remove_edge(uint32_t a, uint32_t b);
    Line line_from(uint32_t start, uint32_t next) const;
    bool is_branch(uint32_t vertex) const { return vertices[vertex].joined.size() > 2; }
    void join(uint32_t a, uint32_t b);
    /// The way from a branch to another, if it stays within `tolerance`; otherwise empty.
    Line line_to_merge(uint32_t branch, uint32_t next, double tolerance) const;
    void merge(const Line& line);
};

/// Vertices at the centres of the voxels, ascending, without radii.
LineGraph graph_of(const BrickSet& lines, const Mask& mask, const glm::dvec3& spacing, const Progress& progress);

/// The vertices of a line that stay, first and last among them, so that between two of them positions and radii are
/// within `tolerance` (Douglas and Peucker 1973); at least `inner` of those between. Inside the ball of a branch at an
/// end the line leads straight to its middle: the parts of a thick junction that belong to one line are not its course.
LineGraph::Line simplified(const LineGraph& graph, const LineGraph::Line& line, double tolerance, size_t inner);

}  // namespace shvr
