#pragma once
// Counts and measures of an annotation: segments, branches, groups and loops of the trace, and the topology of the
// mask. Lengths, radii and positions are in the volume's unit, angles in degrees. Any thread may call these.

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "engine/annotation/mask.h"
#include "engine/annotation/trace/trace_file.h"
#include "engine/annotation/trace/trace_segments.h"
#include "engine/base/progress.h"

namespace shvr {

struct SegmentMeasures {
    uint32_t internode = 0;  ///< identifies the segment: the smallest number among its internodes
    uint8_t group = 0;       ///< group with the greatest share of the length; in a tie, the smallest number
    uint32_t from = 0, to = 0;
    size_t internodes = 0;
    double length = 0.0;
    double chord = 0.0;                ///< distance between the two ends; 0 for a loop
    std::optional<double> tortuosity;  ///< length / chord, 1 if straight; null if the chord is 0
    double radius_mean = 0.0;          ///< averaged along its length
    double radius_least = 0.0, radius_most = 0.0;
};

struct BranchMeasures {
    uint32_t node = 0;
    uint8_t group = 0;
    std::vector<double> angles_degrees;  ///< one per pair of the branch's internodes, ordered by their numbers
};

/// Betti numbers. A trace has no cavities.
struct Topology {
    int64_t components = 0;  ///< b0
    int64_t loops = 0;       ///< b1
    int64_t cavities = 0;    ///< b2
    bool operator==(const Topology&) const = default;
};

struct TraceMeasures {
    std::vector<SegmentMeasures> segments;  ///< sorted by name
    std::vector<BranchMeasures> branches;   ///< nodes with three or more internodes, ascending
    std::map<uint8_t, int64_t> nodes_by_group, internodes_by_group;
    std::map<uint8_t, double> length_by_group;
    int64_t ends = 0;  ///< nodes with one internode
    Topology topology;
};
TraceMeasures measure(const TraceGraph& trace);

/// b0 = number of connected parts, b1 = internodes - nodes + b0.
Topology topology_of(const TraceGraph& trace);

/// The topology of all painted voxels, or of the voxels of one group. Painted voxels are connected over faces, edges
/// and corners (26), unpainted ones over faces (6); voxels outside the volume are unpainted. b1 follows from the Euler
/// characteristic of the union of the voxels as closed cubes, vertices - edges + faces - cubes = b0 - b1 + b2 (Kong and
/// Rosenfeld 1989). Takes time and memory proportional to the painted bricks.
Topology topology_of(const Mask& mask, std::optional<uint8_t> group = {});

inline constexpr int ALL_GROUPS = -1;
/// The topology of all painted voxels (ALL_GROUPS) and of each group. Reads only those bricks that contain the group.
std::map<int, Topology> topology_by_group(const Mask& mask, const Progress& progress = {});

/// Returns a field of a table, quoted as in RFC 4180. Text that begins like a formula is prefixed with an apostrophe,
/// because spreadsheets would execute it.
std::string csv_field(std::string text);

/// A table, one measure per row: item, number, group, measure, value, unit (RFC 4180).
std::string metrics_csv(const TraceMeasures& trace, const std::array<int64_t, 256>& voxels_by_group,
                        const std::map<int, Topology>& mask_topology, const TraceSpace& space);

}  // namespace shvr
