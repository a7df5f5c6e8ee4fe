#pragma once
// Sets of provisional labels, joined when a scan finds that they belong together: union-find with path halving (Tarjan
// and van Leeuwen 1984) in arrays, with the smallest label as representative of its set, as in Wu, Otoo and Suzuki
// 2009. A label is therefore never smaller than its parent, and one pass in ascending order resolves all labels.
//
// Labels are stored in blocks that never move: adding labels copies nothing, forests are appended to each other
// cheaply, and `bytes` is the exact memory use. One thread at a time.

#include <array>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

namespace shvr {

class LabelForest {
public:
    static constexpr uint32_t BLOCK = uint32_t{1} << 14;
    /// The maximum number of labels.
    static constexpr uint64_t MOST = uint64_t{1} << 32;

    /// Adds a new set of one label, and returns it. There must be fewer than MOST labels.
    uint32_t add()
    {
        if (next_ % BLOCK == 0) add_block();
        const auto label = uint32_t(next_++);
        parent(label) = label;
        return label;
    }
    /// Number of labels so far, including unused ones (0 voxels) that `append` skips to start at a new block.
    uint64_t size() const { return next_; }

    uint32_t root_of(uint32_t label)
    {
        while (parent(label) != label) label = parent(label) = parent(parent(label));
        return label;
    }
    /// Returns the representative of the joined set.
    uint32_t join(uint32_t a, uint32_t b)
    {
        a = root_of(a);
        b = root_of(b);
        if (a == b) return a;
        if (a > b) std::swap(a, b);
        parent(b) = a;
        return a;
    }

    /// During labelling, the parent of a label. Afterwards, the caller may use the value for other purposes.
    uint32_t& parent(uint32_t label) { return blocks_[label / BLOCK]->parents[label % BLOCK]; }
    uint32_t parent(uint32_t label) const { return blocks_[label / BLOCK]->parents[label % BLOCK]; }
    /// Number of voxels in the runs that got this label.
    int64_t& voxels(uint32_t label) { return counts_[label / BLOCK]->at(label % BLOCK); }

    /// Appends another forest. Returns the offset that was added to the labels of `other`.
    uint64_t append(LabelForest&& other)
    {
        const uint64_t base = blocks_.size() * uint64_t{BLOCK};
        for (auto& block : other.blocks_) {
            for (uint32_t& parent : block->parents) parent += uint32_t(base);
            blocks_.push_back(std::move(block));
        }
        for (auto& counts : other.counts_) counts_.push_back(std::move(counts));
        next_ = base + other.next_;
        other = LabelForest();
        return base;
    }

    /// Frees the voxel counts.
    void drop_counts() { counts_ = std::vector<std::unique_ptr<Counts>>(); }

    int64_t bytes() const
    {
        return int64_t(blocks_.size() * (sizeof(Block) + sizeof(void*)) +
                       counts_.size() * (sizeof(Counts) + sizeof(void*)));
    }

private:
    struct Block {
        std::array<uint32_t, BLOCK> parents{};
    };
    using Counts = std::array<int64_t, BLOCK>;

    void add_block()
    {
        blocks_.push_back(std::make_unique<Block>());
        counts_.push_back(std::make_unique<Counts>());
    }

    std::vector<std::unique_ptr<Block>> blocks_;
    std::vector<std::unique_ptr<Counts>> counts_;
    uint64_t next_ = 0;
};

}  // namespace shvr
