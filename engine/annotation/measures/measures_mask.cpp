// The topology of a mask, slice by slice, over rows of bits. Union-find joins runs of equal voxels (Rosenfeld and
// Pfaltz 1966; Wu, Otoo and Suzuki 2009 for the arrays); the Euler characteristic counts cells by population counts.

#include <algorithm>
#include <bit>
#include <limits>

#include "engine/annotation/measures/measures.h"
#include "engine/annotation/trace/trace_forms.h"
#include "engine/base/error.h"
#include "engine/volume/grid.h"

namespace shvr {

namespace {

constexpr int64_t MAX_VOXELS = int64_t{1} << 36;

using Words = std::vector<uint64_t>;

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

/// Bits [first, last] of a row, and the set that the run belongs to.
struct Run {
    int64_t first, last;
    uint32_t set;
};

/// Position of the next bit equal to `value`, from `at` on; `width` if there is none.
int64_t find(const uint64_t* row, int64_t at, int64_t width, bool value)
{
    while (at < width) {
        const uint64_t word = (value ? row[at / 64] : ~row[at / 64]) >> (at % 64);
        if (word != 0) return std::min(width, at + std::countr_zero(word));
        at += 64 - at % 64;
    }
    return width;
}

/// Joins runs of two neighbouring rows that touch; with `reach` 1 edges and corners count, too.
void join_rows(const std::vector<Run>& a, const std::vector<Run>& b, int64_t reach, Sets& sets)
{
    for (size_t i = 0, j = 0; i < a.size() && j < b.size();) {
        if (a[i].first <= b[j].last + reach && b[j].first <= a[i].last + reach) sets.join(a[i].set, b[j].set);
        (a[i].last < b[j].last ? i : j)++;
    }
}

/// The rows of one slice, with one extra row on each side of the mask's box.
struct Slice {
    Words bits;                                        ///< painted
    std::vector<std::vector<Run>> painted, unpainted;  ///< by row
};

class Counter {
public:
    Counter(const Mask& mask, std::optional<uint8_t> group, const Size3& lower, const Size3& upper)
        : mask_(mask), group_(group), lower_(lower), upper_(upper), size_(upper - lower + Size3(2))
    {}

    Topology count()
    {
        Slice last = slice_at(lower_.z - 1);
        for (int64_t z = lower_.z; z <= upper_.z; ++z) {
            Slice next = slice_at(z);
            for (int64_t y = 0; y < size_.y; ++y) {
                for (int64_t near = std::max<int64_t>(0, y - 1); near <= std::min(y + 1, size_.y - 1); ++near)
                    join_rows(next.painted[size_t(y)], last.painted[size_t(near)], 1, parts_);
                join_rows(next.unpainted[size_t(y)], last.unpainted[size_t(y)], 0, gaps_);
            }
            count_cells(last, next);
            last = std::move(next);
        }
        const int64_t b0 = parts_.count(), b2 = gaps_.count() - 1;
        return {.components = b0, .loops = b0 + b2 - euler_, .cavities = b2};
    }

private:
    size_t words() const { return size_t((size_.x + 63) / 64); }

    void fill_row(uint64_t* row, int64_t y, int64_t z) const
    {
        if (y < 0 || z < 0 || y >= mask_.size().y || z >= mask_.size().z) return;
        const glm::i64vec3 counts = mask_.brick_counts();
        const int64_t first_brick = counts.x * (y / BRICK_SIDE + counts.y * (z / BRICK_SIDE));
        for (int64_t x = lower_.x; x < upper_.x; x = (x / BRICK_SIDE + 1) * BRICK_SIDE) {
            const MaskBrick* brick = mask_.brick(first_brick + x / BRICK_SIDE).get();
            if (!brick) continue;
            const uint8_t* voxels = brick->data() + BRICK_SIDE * (y % BRICK_SIDE + BRICK_SIDE * (z % BRICK_SIDE));
            for (int64_t i = x % BRICK_SIDE; i < std::min(BRICK_SIDE, upper_.x - x / BRICK_SIDE * BRICK_SIDE); ++i) {
                const bool is_painted = group_ ? voxels[i] == *group_ : voxels[i] != 0;
                const int64_t bit = x / BRICK_SIDE * BRICK_SIDE + i - lower_.x + 1;
                row[bit / 64] |= uint64_t{is_painted} << (bit % 64);
            }
        }
    }

    std::vector<Run> runs_of(const uint64_t* row, bool value, Sets& sets) const
    {
        std::vector<Run> runs;
        for (int64_t at = find(row, 0, size_.x, value); at < size_.x;) {
            const int64_t end = find(row, at, size_.x, !value);
            runs.push_back({at, end - 1, sets.add()});
            at = find(row, end, size_.x, value);
        }
        return runs;
    }

    Slice slice_at(int64_t z)
    {
        Slice slice;
        slice.bits.assign(words() * size_t(size_.y), 0);
        for (int64_t y = 0; y < size_.y; ++y) {
            uint64_t* row = slice.bits.data() + words() * size_t(y);
            fill_row(row, lower_.y + y - 1, z);
            slice.painted.push_back(runs_of(row, true, parts_));
            slice.unpainted.push_back(runs_of(row, false, gaps_));
            if (y == 0) continue;
            join_rows(slice.painted[size_t(y)], slice.painted[size_t(y) - 1], 1, parts_);
            join_rows(slice.unpainted[size_t(y)], slice.unpainted[size_t(y) - 1], 0, gaps_);
        }
        return slice;
    }

    /// Counts cells between `last` and `next`, and those of `next` within the slice. A cell counts if any cube that it
    /// bounds does. Bit x of a shifted word stands for the plane between x - 1 and x.
    void count_cells(const Slice& last, const Slice& next)
    {
        for (int64_t y = 1; y < size_.y; ++y) {
            uint64_t carry_r = 0, carry_p = 0, carry_q = 0, carry_a = 0;
            for (size_t w = 0; w < words(); ++w) {
                const size_t here = words() * size_t(y) + w, before = here - words();
                const uint64_t r = next.bits[here];                          // the cube
                const uint64_t p = r | next.bits[before];                    // two along y
                const uint64_t q = r | last.bits[here];                      // two along z
                const uint64_t a = p | last.bits[here] | last.bits[before];  // four
                const auto both = [](uint64_t word, uint64_t& carry) {
                    const uint64_t shifted = word << 1 | carry;
                    carry = word >> 63;
                    return std::popcount(word | shifted);
                };
                const int cubes = std::popcount(r);
                const int faces = both(r, carry_r) + std::popcount(p) + std::popcount(q);
                const int edges = std::popcount(a) + both(p, carry_p) + both(q, carry_q);
                const int vertices = both(a, carry_a);
                euler_ += vertices - edges + faces - cubes;
            }
        }
    }

    const Mask& mask_;
    std::optional<uint8_t> group_;
    Size3 lower_, upper_;  ///< the bounding box of the painted voxels
    Size3 size_;           ///< size of that box, with one layer around it
    Sets parts_, gaps_;
    int64_t euler_ = 0;
};

}  // namespace

Topology topology_of(const Mask& mask, std::optional<uint8_t> group)
{
    Size3 lower = mask.size(), upper(0);
    for (const int64_t brick : mask.painted_bricks()) {
        const VoxelBox box = mask.box_of(brick);
        lower = glm::min(lower, box.lower);
        upper = glm::max(upper, box.upper);
    }
    if (lower.x >= upper.x) return {};
    const Size3 size = upper - lower;
    if (size.x * size.y > MAX_VOXELS / size.z)
        fail("the mask: its painted bricks lie in a box of ", digits_of(size), " voxels; expected at most ", MAX_VOXELS,
             " to count its components, loops and cavities");
    return Counter(mask, group, lower, upper).count();
}

}  // namespace shvr
