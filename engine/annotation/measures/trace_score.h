#pragma once
// Scores how well an annotation agrees with the truth. Masks are scored by the Dice coefficient (1945). Traces are
// scored by the share of balls inside the true mask (one ball per node, one at the middle of each internode; after
// Acciai et al. 2016), and by comparing graphs. Any thread may call these.

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <span>

#include "engine/annotation/mask.h"
#include "engine/annotation/trace/tracing.h"

namespace shvr {

struct Dice {
    std::optional<double> painted;       ///< 2 |A and B| / (|A| + |B|) over all painted voxels; null if there are none
    std::map<uint8_t, double> by_group;  ///< groups present in either mask
    std::map<uint8_t, int64_t> voxels_in_a, voxels_in_b;  ///< for each group that is present
};
/// Counts pairs of voxels at the same positions of two masks, a batch at a time.
class DiceCounter {
public:
    void add(std::span<const uint8_t> a, std::span<const uint8_t> b);
    Dice result() const;

private:
    std::array<int64_t, 256> in_a_{}, in_b_{}, in_both_{};
    int64_t painted_in_both_ = 0;
};
/// Both masks have the same size (SHVR_CHECK).
Dice dice_of(const Mask& a, const Mask& b);

struct BallScores {
    std::optional<double> mean;  ///< mean of the balls' shares; null if there is no ball
    int64_t out = 0;             ///< balls with less than half of their voxels in the mask
    int64_t total = 0;
};
/// Returns the share of a ball's voxels that are painted. As for brushes, a voxel belongs to the ball if its centre is
/// at most the radius away; a ball without voxel centres consists of the voxel at its centre. Voxels outside the volume
/// are unpainted. Fails if the ball's box exceeds 2^31 voxels. `radius`, `position`: in the volume's unit.
double share_in_mask(const Mask& mask, const glm::dvec3& spacing, const glm::dvec3& position, double radius);
BallScores score_nodes(const TraceGraph& trace, const Mask& truth, const glm::dvec3& spacing);
/// Scores a ball at the middle of each internode, with its radius there.
BallScores score_internodes(const TraceGraph& trace, const Mask& truth, const glm::dvec3& spacing);

/// A position of a trace is *near* a position of the truth if the gap between their balls is at most `slack`. Branches
/// and ends of the truth are paired one to one with nodes of the trace near them (branches with branches first, nearest
/// first), and the trace is cut into segments at these nodes. A segment of the trace *stands for* a segment of the
/// truth if their ends are paired and each is near the other for its whole length. Each segment stands for at most one;
/// if several join the same two nodes (both graphs are multigraphs), the smallest mean squared distance wins.
struct TraceComparison {
    /// Counts segments of the truth. A segment is found if a segment of the trace stands for it, or if its two ends are
    /// paired and paths between the paired nodes cover all of it. Such paths stay near the segment, pass no other
    /// paired node and stand for nothing else. A segment that is only partly traced is not found.
    int64_t segments_found = 0, segments_total = 0;
    /// Segments of the trace that leave the truth, or switch to a segment of the truth that does not begin there.
    int64_t wrong = 0;
    /// Segments of the trace that stand for no segment of the truth, but follow a part of one that another segment of
    /// the trace also follows. The shared part is longer than the surroundings of the two segments' ends or, if both
    /// join the same two nodes, at least half of what the shorter segment follows.
    int64_t doubled = 0;
    /// Ends of the trace that should be joined at a traced branch of the truth, but are not: ends near the branch, ends
    /// on the way to it with nothing traced in between, and ends paired with it although another segment passes it.
    int64_t gaps = 0;
    /// Places along a segment of the truth between two traced parts that are not joined to each other. For a partly
    /// traced ring, one more place is counted.
    int64_t breaks = 0;
    /// Side branches with a loose end, not counted above, that alone follow the truth for under half of their length.
    int64_t spurs = 0;
    /// Like `spurs`, but with no or two loose ends: small loops, rungs, and pieces that are joined to nothing.
    int64_t superfluous = 0;
    int64_t topological_errors() const { return wrong + doubled + gaps + breaks + spurs + superfluous; }
    /// Distance from positions on the trace to the nearest position of the truth; null if either has no internodes.
    std::optional<double> centreline_rms, centreline_most;
};
TraceComparison compare(const TraceGraph& trace, const TraceGraph& truth, double slack);

}  // namespace shvr
