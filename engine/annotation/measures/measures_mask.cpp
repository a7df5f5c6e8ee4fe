// The topology of a mask, from runs of voxels along x. Only rows near painted bricks are read; all voxels elsewhere
// belong to one unpainted set around them, so the cost depends only on the painted part. Union-find joins runs
// (Rosenfeld and Pfaltz 1966; Wu, Otoo and Suzuki 2009 for the arrays).
//
// The Euler characteristic needs only the number of runs: n voxels of a row in r runs have n + r planes across x. Let R
// be a row, P and Q its unions with the previous row along y and along z, and A the union of all four rows. Then the
// cells between the row and the previous ones are |A| + r(A) vertices, |A| + |P| + r(P) + |Q| + r(Q) edges, |R| + r(R)
// + |P| + |Q| faces and |R| cubes; their alternating sum is r(R) - r(P) - r(Q) + r(A).

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <set>

#include "engine/annotation/measures/measures.h"
#include "engine/annotation/trace/trace_forms.h"
#include "engine/base/error.h"
#include "engine/volume/grid.h"

namespace shvr {

namespace {

class Sets {
public:
    uint32_t add()
    {
        if (parents_.size() == std::numeric_limits<uint32_t>::max())
            fail(
                "the mask: holds more than 4294967295 runs of voxels; expected at most that many to count its "
                "components");
        parents_.push_back(uint32_t(parents_.size()));
        ++count_;
        return parents_.back();
    }
    void join(uint32_t a, uint32_t b)
    {
        a = root_of(a);
        b = root_of(b);
        if (a == b) return;
        parents_[std::max(a, b)] = std::min(a, b);
        --count_;
    }
    int64_t count() const { return count_; }

private:
    uint32_t root_of(uint32_t set)
    {
        while (parents_[set] != set) set = parents_[set] = parents_[parents_[set]];
        return set;
    }
    std::vector<uint32_t> parents_;
    int64_t count_ = 0;
};

/// A run of painted voxels in a row, `first` to `last`. `gap`: union-find set of the unpainted voxels before the run.
struct Run {
    int64_t first = 0, last = 0;
    uint32_t set = 0, gap = 0;
};
using Runs = std::vector<Run>;

struct Row {
    Runs painted;
    Runs with_previous;  ///< union of the row's runs with those of the same row in the previous slice
};

/// Whether run `a` ends before run `b` begins, with at least one voxel between the two.
bool is_apart(const Run& a, const Run& b)
{
    return a.last + 1 < b.first;
}

/// Calls `take` for each run of the union of two rows, in ascending order.
template <class Take>
void unite(const Runs& a, const Runs& b, const Take& take)
{
    size_t i = 0, j = 0;
    const auto next = [&] { return j == b.size() || (i < a.size() && a[i].first <= b[j].first) ? a[i++] : b[j++]; };
    if (a.empty() && b.empty()) return;
    Run run = next();
    while (i < a.size() || j < b.size()) {
        const Run following = next();
        if (is_apart(run, following)) {
            take(run);
            run = following;
        }
        run.last = std::max(run.last, following.last);
    }
    take(run);
}

int64_t runs_in_union(const Runs& a, const Runs& b)
{
    if (a.empty() || b.empty()) return int64_t(a.size() + b.size());
    int64_t count = 0;
    unite(a, b, [&](const Run&) { ++count; });
    return count;
}

/// Joins painted runs of two neighbouring rows if they touch, also over edges and corners.
void join_painted(const Runs& a, const Runs& b, Sets& parts)
{
    for (size_t i = 0, j = 0; i < a.size() && j < b.size();) {
        if (!is_apart(a[i], b[j]) && !is_apart(b[j], a[i])) parts.join(a[i].set, b[j].set);
        (a[i].last < b[j].last ? i : j)++;
    }
}

constexpr uint32_t OUTSIDE = 0;  ///< the set of the unpainted voxels that are connected with infinity

/// Joins unpainted runs (gaps) of two neighbouring rows that touch over faces. A row of n painted runs has n + 1 gaps;
/// the first gap begins, and the last gap ends, at infinity.
void join_gaps(const Runs& a, const Runs& b, Sets& gaps)
{
    constexpr int64_t FAR = std::numeric_limits<int64_t>::max();
    const auto begin = [](const Runs& runs, size_t gap) { return gap == 0 ? -FAR : runs[gap - 1].last + 1; };
    const auto end = [](const Runs& runs, size_t gap) { return gap == runs.size() ? FAR : runs[gap].first; };
    const auto set = [](const Runs& runs, size_t gap) { return gap == runs.size() ? OUTSIDE : runs[gap].gap; };
    for (size_t i = 0, j = 0; i <= a.size() && j <= b.size();) {
        if (begin(a, i) < end(b, j) && begin(b, j) < end(a, i)) gaps.join(set(a, i), set(b, j));
        (end(a, i) < end(b, j) ? i : j)++;
    }
}

/// Selects the voxels to count: those of one group, or all painted voxels.
class Chosen {
public:
    explicit Chosen(std::optional<uint8_t> group)
        : group_(group), pattern_(group ? *group * uint64_t{0x0101010101010101} : 0)
    {}
    /// Appends the runs of a row of a brick; `x` is the position of the row's first voxel.
    void append(const uint8_t* voxels, int64_t x, Runs& runs) const
    {
        for (int64_t at = 0; at < BRICK_SIDE; at += WORD) {
            uint64_t word = 0;
            std::memcpy(&word, voxels + at, WORD);
            word ^= pattern_;
            const bool has_zero = ((word - uint64_t{0x0101010101010101}) & ~word & uint64_t{0x8080808080808080}) != 0;
            const bool holds_none = group_ ? !has_zero : word == 0;
            if (holds_none) continue;
            if (group_ ? word == 0 : !has_zero) {
                extend(runs, x + at, x + at + WORD - 1);
                continue;
            }
            for (int64_t i = at; i < at + WORD; ++i)
                if (group_ ? voxels[i] == *group_ : voxels[i] != 0) extend(runs, x + i, x + i);
        }
    }

private:
    static constexpr int64_t WORD = sizeof(uint64_t);
    static void extend(Runs& runs, int64_t first, int64_t last)
    {
        if (!runs.empty() && runs.back().last + 1 == first)
            runs.back().last = last;
        else
            runs.push_back({.first = first, .last = last});
    }
    std::optional<uint8_t> group_;
    uint64_t pattern_;
};

/// Painted bricks with the same y and z, ascending in x. Empty for a row that is only needed next to painted rows.
struct BrickRow {
    int64_t y = 0;
    std::vector<std::pair<int64_t, const MaskBrick*>> bricks;  ///< x of the first voxel
    std::array<Row, BRICK_SIDE> rows, previous;                ///< rows of this slice and of the previous one
};
/// Rows of bricks with the same z, by ascending y: all rows with painted bricks, and all rows that follow a painted row
/// along y, z or both.
using Layer = std::vector<BrickRow>;

class Counter {
public:
    Counter(const Mask& mask, std::optional<uint8_t> group) : mask_(mask), chosen_(group) { gaps_.add(); }

    /// `bricks` ascend, and hold every chosen voxel.
    Topology count(const std::vector<int64_t>& bricks)
    {
        for (auto at = bricks.begin(); at != bricks.end() || !last_.empty();) {
            const int64_t z = last_.empty() ? mask_.position_of(*at).z : last_z_ + 1;
            const auto end =
                std::find_if(at, bricks.end(), [&](int64_t brick) { return mask_.position_of(brick).z != z; });
            const bool holds_any = at != bricks.end() && mask_.position_of(*at).z == z;
            Layer layer = layer_of({at, holds_any ? end : at});
            for (int64_t slice = 0; slice < (holds_any ? BRICK_SIDE : 1); ++slice) count_slice(layer, slice);
            last_ = holds_any ? std::move(layer) : Layer();
            last_z_ = z;
            if (holds_any) at = end;
        }
        const int64_t b0 = parts_.count(), b2 = gaps_.count() - 1;
        return {.components = b0, .loops = b0 + b2 - euler_, .cavities = b2};
    }

private:
    Layer layer_of(std::span<const int64_t> bricks)
    {
        std::set<int64_t> places;
        for (const int64_t brick : bricks) places.insert({mask_.position_of(brick).y, mask_.position_of(brick).y + 1});
        for (const BrickRow& row : last_)
            if (!row.bricks.empty()) places.insert({row.y, row.y + 1});
        Layer layer;
        auto last = last_.begin();
        auto brick = bricks.begin();
        for (const int64_t y : places) {
            layer.push_back({.y = y});
            for (; brick != bricks.end() && mask_.position_of(*brick).y == y; ++brick)
                layer.back().bricks.emplace_back(BRICK_SIDE * mask_.position_of(*brick).x, mask_.brick(*brick).get());
            while (last != last_.end() && last->y < y) ++last;
            if (last != last_.end() && last->y == y) layer.back().rows = std::move(last->rows);
        }
        return layer;
    }

    void count_slice(Layer& layer, int64_t slice)
    {
        for (BrickRow& row : layer) std::swap(row.rows, row.previous);
        for (size_t i = 0; i < layer.size(); ++i) {
            const bool follows = i > 0 && layer[i - 1].y + 1 == layer[i].y;
            const bool precedes = i + 1 < layer.size() && layer[i].y + 1 == layer[i + 1].y;
            for (int64_t y = 0; y < BRICK_SIDE; ++y) {
                read(layer[i], y, slice);
                const BrickRow* const before = y > 0 ? &layer[i] : follows ? &layer[i - 1] : nullptr;
                const BrickRow* const after = y + 1 < BRICK_SIDE ? &layer[i] : precedes ? &layer[i + 1] : nullptr;
                const size_t y_before = size_t(y + BRICK_SIDE - 1) % BRICK_SIDE, y_after = size_t(y + 1) % BRICK_SIDE;
                static const Row NONE;
                join(layer[i].rows[size_t(y)], layer[i].previous[size_t(y)], before ? before->rows[y_before] : NONE,
                     before ? before->previous[y_before] : NONE, after ? after->previous[y_after] : NONE);
            }
        }
    }

    /// Reads row `y` of a slice. Makes a union-find set for each run of voxels, and for each gap between two runs.
    void read(BrickRow& bricks, int64_t y, int64_t slice)
    {
        Runs& runs = bricks.rows[size_t(y)].painted;
        runs.clear();
        const int64_t first = BRICK_SIDE * (y + BRICK_SIDE * slice);
        for (const auto& [x, brick] : bricks.bricks) chosen_.append(brick->data() + first, x, runs);
        for (Run& run : runs) {
            run.set = parts_.add();
            run.gap = &run == runs.data() ? OUTSIDE : gaps_.add();
        }
    }

    /// Joins a row with its neighbours in this slice and the previous one, and counts the cells between them.
    void join(Row& row, const Row& below, const Row& before, const Row& before_below, const Row& after_below)
    {
        row.with_previous.clear();
        const Runs& painted = row.painted;
        if (painted.empty() && below.painted.empty() && before.painted.empty() && below.with_previous.empty()) return;
        join_painted(painted, before.painted, parts_);
        for (const Row* near : {&before_below, &below, &after_below}) join_painted(painted, near->painted, parts_);
        join_gaps(painted, before.painted, gaps_);
        join_gaps(painted, below.painted, gaps_);
        unite(painted, before.painted, [&](const Run& run) { row.with_previous.push_back(run); });
        euler_ += int64_t(painted.size()) - int64_t(row.with_previous.size()) - runs_in_union(painted, below.painted) +
                  runs_in_union(row.with_previous, below.with_previous);
    }

    const Mask& mask_;
    Chosen chosen_;
    Layer last_;          ///< the previous layer; empty if that layer has no painted brick
    int64_t last_z_ = 0;  ///< its place along z
    Sets parts_, gaps_;
    int64_t euler_ = 0;
};

/// The bricks that hold each group, ascending.
std::map<uint8_t, std::vector<int64_t>> bricks_by_group(const Mask& mask)
{
    std::map<uint8_t, std::vector<int64_t>> found;
    for (const int64_t index : mask.painted_bricks()) {
        std::array<bool, 256> holds{};
        for (const uint8_t group : *mask.brick(index)) holds[group] = true;
        for (size_t group = 1; group < holds.size(); ++group)
            if (holds[group]) found[uint8_t(group)].push_back(index);
    }
    return found;
}

}  // namespace

Topology topology_of(const Mask& mask, std::optional<uint8_t> group)
{
    return Counter(mask, group).count(mask.painted_bricks());
}

std::map<int, Topology> topology_by_group(const Mask& mask, const Progress& progress)
{
    std::map<int, Topology> topology{{ALL_GROUPS, topology_of(mask)}};
    for (const auto& [group, bricks] : bricks_by_group(mask)) {
        tell(progress, double(group) / 256.0);
        topology[group] = Counter(mask, group).count(bricks);
    }
    return topology;
}

}  // namespace shvr
