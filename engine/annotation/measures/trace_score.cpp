#include "engine/annotation/measures/trace_score.h"

#include <cmath>
#include <set>

#include "engine/annotation/trace/trace_forms.h"
#include "engine/base/error.h"
#include "engine/volume/grid.h"

namespace shvr {

namespace {

/// Counts the painted voxels of a row from x = `first` to `last`. The row must lie inside the volume.
int64_t painted_in_row(const Mask& mask, int64_t first, int64_t last, int64_t y, int64_t z)
{
    const glm::i64vec3 counts = mask.brick_counts();
    int64_t painted = 0;
    for (int64_t x = first; x <= last; x = (x / BRICK_SIDE + 1) * BRICK_SIDE) {
        const MaskBrick* brick = mask.brick(index_of(Size3(x, y, z) / BRICK_SIDE, counts)).get();
        if (!brick) continue;
        const uint8_t* row = brick->data() + BRICK_SIDE * (y % BRICK_SIDE + BRICK_SIDE * (z % BRICK_SIDE));
        for (int64_t i = x; i <= std::min(last, x / BRICK_SIDE * BRICK_SIDE + BRICK_SIDE - 1); ++i)
            painted += row[i % BRICK_SIDE] != 0;
    }
    return painted;
}

template <class Shares>
BallScores scores_of(const Shares& shares)
{
    BallScores scores;
    double sum = 0.0;
    for (const double share : shares) {
        sum += share;
        scores.out += share < 0.5;
        ++scores.total;
    }
    if (scores.total > 0) scores.mean = sum / double(scores.total);
    return scores;
}

}  // namespace

void DiceCounter::add(std::span<const uint8_t> a, std::span<const uint8_t> b)
{
    SHVR_CHECK(a.size() == b.size(), a.size(), " ", b.size());
    for (size_t i = 0; i < a.size(); ++i) {
        ++in_a_[a[i]];
        ++in_b_[b[i]];
        if (a[i] == b[i]) ++in_both_[a[i]];
        painted_in_both_ += a[i] != 0 && b[i] != 0;
    }
}

Dice DiceCounter::result() const
{
    Dice dice;
    int64_t painted = 0;
    for (size_t group = 1; group < 256; ++group) {
        const int64_t sum = in_a_[group] + in_b_[group];
        painted += sum;
        if (in_a_[group] > 0) dice.voxels_in_a[uint8_t(group)] = in_a_[group];
        if (in_b_[group] > 0) dice.voxels_in_b[uint8_t(group)] = in_b_[group];
        if (sum > 0) dice.by_group[uint8_t(group)] = 2.0 * double(in_both_[group]) / double(sum);
    }
    if (painted > 0) dice.painted = 2.0 * double(painted_in_both_) / double(painted);
    return dice;
}

Dice dice_of(const Mask& a, const Mask& b)
{
    SHVR_CHECK(a.size() == b.size());
    static const MaskBrick UNPAINTED{};
    std::set<int64_t> bricks;
    for (const Mask* mask : {&a, &b})
        for (const int64_t brick : mask->painted_bricks()) bricks.insert(brick);
    DiceCounter counter;
    for (const int64_t brick : bricks)
        counter.add(a.brick(brick) ? *a.brick(brick) : UNPAINTED, b.brick(brick) ? *b.brick(brick) : UNPAINTED);
    return counter.result();
}

double share_in_mask(const Mask& mask, const glm::dvec3& spacing, const glm::dvec3& position, double radius)
{
    constexpr double MAX_VOXELS = double(int64_t{1} << 31);
    const glm::dvec3 centre = position / spacing, reach = radius / spacing;
    const glm::dvec3 box = 2.0 * reach + 1.0;
    // `centre` must be in the range of int64_t, too: even a small box may be far from the origin.
    if (!(box.x * box.y * box.z <= MAX_VOXELS) || !glm::all(glm::lessThan(glm::abs(centre), glm::dvec3(1e18))))
        fail("the ball of radius ", digits_of(radius), " at ", digits_of(position),
             " has a bounding box of more than 2147483648 voxels; expected a smaller radius");
    const Size3 lower(glm::floor(centre - reach)), upper(glm::floor(centre + reach));
    const Size3 size = mask.size();
    int64_t painted = 0, all = 0;
    for (int64_t z = lower.z; z <= upper.z; ++z)
        for (int64_t y = lower.y; y <= upper.y; ++y) {
            const double dy = (double(y) + 0.5 - centre.y) * spacing.y, dz = (double(z) + 0.5 - centre.z) * spacing.z;
            const auto belongs = [&](int64_t x) {
                const double dx = (double(x) + 0.5 - centre.x) * spacing.x;
                return dx * dx + dy * dy + dz * dz <= radius * radius;
            };
            int64_t first = lower.x, last = upper.x;
            while (first <= last && !belongs(first)) ++first;
            while (last >= first && !belongs(last)) --last;
            if (first > last) continue;
            all += last - first + 1;
            if (y < 0 || z < 0 || y >= size.y || z >= size.z) continue;
            painted += painted_in_row(mask, std::max<int64_t>(first, 0), std::min(last, size.x - 1), y, z);
        }
    if (all > 0) return double(painted) / double(all);
    const Size3 voxel(glm::floor(centre));
    const bool is_inside = glm::all(glm::greaterThanEqual(voxel, Size3(0))) && glm::all(glm::lessThan(voxel, size));
    return is_inside && mask.at(voxel) != 0 ? 1.0 : 0.0;
}

BallScores score_nodes(const TraceGraph& trace, const Mask& truth, const glm::dvec3& spacing)
{
    std::vector<double> shares;
    for (const auto& [number, node] : trace.nodes())
        shares.push_back(share_in_mask(truth, spacing, node.position, node.radius));
    return scores_of(shares);
}

BallScores score_internodes(const TraceGraph& trace, const Mask& truth, const glm::dvec3& spacing)
{
    std::vector<double> shares;
    for (const auto& [number, internode] : trace.internodes()) {
        const glm::dvec3 middle = (trace.node(internode.a).position + trace.node(internode.b).position) / 2.0;
        shares.push_back(share_in_mask(truth, spacing, middle, trace.radius_of(internode, 0.5)));
    }
    return scores_of(shares);
}

}  // namespace shvr
