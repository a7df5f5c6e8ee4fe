#pragma once
// Connected components of a set of voxels in sparse bricks: runs of voxels along x with labels, joined by union-find
// (engine/components/label_forest.h). Memory: 4 KiB per brick, 8 bytes per run and 8 bytes per provisional label. One
// thread.

#include <map>
#include <vector>

#include "engine/annotation/sets/brick_bits.h"
#include "engine/components/label_forest.h"

namespace shvr {

class BrickComponents {
public:
    /// The voxels `first` to `last` (inclusive) of a row, with their label.
    struct Run {
        uint8_t first = 0, last = 0;
        uint32_t label = 0;
    };
    /// `counts`: numbers of bricks along the volume's axes; `connectivity`: 6 or 26.
    BrickComponents(const Size3& counts, int64_t connectivity) : counts_(counts), is_26_(connectivity == 26) {}

    /// Adds a brick, whose index must be greater than those of all bricks added before, and joins it to its neighbours.
    void add(int64_t brick, const BrickBits& bits);
    /// The bricks added.
    std::vector<int64_t> bricks() const;
    bool has(int64_t brick) const { return bricks_.contains(brick); }
    /// The runs in row y + 32 z of a brick that was added.
    std::span<const Run> runs(int64_t brick, size_t row) const;
    /// The representative of all labels that are joined with this label.
    uint32_t root_of(uint32_t label) { return forest_.root_of(label); }
    /// For callers that join labels for other reasons; `add_label` returns a new label that has no voxels.
    uint32_t add_label() { return forest_.add(); }
    void join(uint32_t a, uint32_t b) { forest_.join(a, b); }
    /// Joins a label with the runs on one face of an added brick, whose coordinate along `axis` (0 ... 2) is `at`.
    void join_face(int64_t brick, int axis, int64_t at, uint32_t label);

private:
    struct Brick {
        std::array<uint32_t, std::tuple_size_v<BrickBits> + 1> rows{};  ///< index of the first run of each row
        std::vector<Run> runs{};
        std::span<Run> row(size_t index) { return std::span(runs).subspan(rows[index], rows[index + 1] - rows[index]); }
    };
    void label(Brick& brick, const BrickBits& bits);
    void join_bricks(Brick& brick, Brick& other, const Size3& offset);
    void join_rows(std::span<Run> row, std::span<Run> other, int64_t offset, int reach);

    Size3 counts_;
    bool is_26_;
    LabelForest forest_;
    std::map<int64_t, Brick> bricks_;
};

}  // namespace shvr
