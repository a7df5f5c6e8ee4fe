#pragma once
// Runs of set bits in two rows that touch, found in 64 voxels at a time. For labelled_range.h.

#include <bit>
#include <cstddef>
#include <cstdint>

namespace shvr {

/// Number of set bits. Processors without an instruction for it are supported, and std::popcount is a slow call there.
inline uint32_t bits_in(uint64_t word)
{
    constexpr uint64_t PAIRS = 0x5555555555555555u, FOURS = 0x3333333333333333u, BYTES = 0x0f0f0f0f0f0f0f0fu;
    word -= word >> 1 & PAIRS;
    word = (word & FOURS) + (word >> 2 & FOURS);
    return uint32_t(((word + (word >> 4)) & BYTES) * 0x0101010101010101u >> 56);
}

/// A row of bits, read word by word.
class RowReader {
public:
    /// `index`: index of the row's first run.
    RowReader(const uint64_t* words, uint32_t index) : words_(words), index_(index) {}

    void next()
    {
        index_ += bits_in(begins);
        bits = *words_++;
        const uint64_t shifted = bits << 1 | last_;
        last_ = bits >> 63;
        begins = bits & ~shifted;
        ends = ~bits & shifted;
    }
    /// The index of the last run that begins at or before a bit.
    uint32_t run_at(uint64_t bit) const { return index_ + bits_in(begins & (bit | (bit - 1))) - 1; }
    /// The index after the last run so far.
    uint32_t index() const { return index_ + bits_in(begins); }

    uint64_t bits = 0, begins = 0, ends = 0;  ///< `ends`: the bit after a run's last

private:
    const uint64_t* words_;
    uint64_t last_ = 0;
    uint32_t index_;
};

/// Calls `join(run, other)` with the indices of all pairs of touching runs; with `over_edges`, of runs that touch at an
/// edge, too. Advances the indices of the rows' first runs by the numbers of their runs.
template <class Join>
void for_each_touching(const uint64_t* row, const uint64_t* other, size_t words, bool over_edges, uint32_t& run,
                       uint32_t& other_run, const Join& join)
{
    RowReader a(row, run), b(other, other_run);
    uint64_t last = 0;
    for (size_t word = 0; word < words; ++word) {
        a.next();
        b.next();
        // Two runs share one run of bits, if any, and runs that touch at an edge share an end and a beginning.
        const uint64_t both = a.bits & b.bits;
        uint64_t places = both & ~(both << 1 | last);
        last = both >> 63;
        if (over_edges) places |= (a.begins & b.ends) | (a.ends & b.begins);
        for (; places != 0; places &= places - 1) {
            const uint64_t bit = places & (~places + 1);
            join(a.run_at(bit), b.run_at(bit));
        }
    }
    run = a.index();
    other_run = b.index();
}

}  // namespace shvr
