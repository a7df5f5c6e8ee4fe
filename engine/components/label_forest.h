#pragma once
// Sets of provisional labels, joined when a scan finds that they belong together: union-find with path halving (Tarjan
// and van Leeuwen 1984) in arrays, with the smallest label as representative of its set, as in Wu, Otoo and Suzuki
// 2009. A label is therefore never smaller than its parent, and one pass in ascending order resolves all labels.
//
// Labels are stored in blocks that never move: adding labels copies nothing, forests are appended to each other
// cheaply, and `bytes` is the exact memory use. One thread at a time.

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace shvr {

inline constexpr uint32_t LABELS_IN_BLOCK = uint32_t{1} << 14;

/// A number for each label.
class LabelNumbers {
public:
    uint64_t size() const { return size_; }
    uint32_t operator[](uint32_t label) const { return (*blocks_[label / LABELS_IN_BLOCK])[label % LABELS_IN_BLOCK]; }

private:
    friend class LabelForest;
    using Block = std::array<uint32_t, LABELS_IN_BLOCK>;

    std::vector<std::unique_ptr<Block>> blocks_;
    uint64_t size_ = 0;
};

class LabelForest {
public:
    static constexpr uint32_t BLOCK = LABELS_IN_BLOCK;
    /// The maximum number of labels.
    static constexpr uint64_t MOST = uint64_t{1} << 32;

    /// Adds a new set of one label, and returns it. There must be fewer than MOST labels.
    uint32_t add()
    {
        if (next_ == room()) add_block();
        const auto label = uint32_t(next_++);
        parent(label) = label;
        return label;
    }
    /// Replaces each element that is `none` by a new label, in order. There must be room for as many as there are
    /// elements. Without branches: no processor can predict which runs of noise are new.
    void add_in_place_of(uint32_t none, std::span<uint32_t> labels)
    {
        for (size_t done = 0; done < labels.size();) {
            if (next_ == room()) add_block();
            const auto first = uint32_t(next_ / BLOCK * BLOCK);
            Block& block = *blocks_.back();
            const size_t end = std::min<size_t>(labels.size(), done + (room() - next_));
            auto next = uint32_t(next_ - first);
            for (; done < end; ++done) {
                const bool is_new = labels[done] == none;
                block[next].parent = first + next;
                labels[done] = is_new ? first + next : labels[done];
                next += is_new ? 1 : 0;
            }
            next_ = uint64_t{first} + next;
        }
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

    /// Joins `label` with `other`; a label that is `none` becomes `other`.
    void join_into(uint32_t& label, uint32_t other, uint32_t none)
    {
        if (label == none)
            label = other;
        else if (label != other)
            label = join(label, other);
    }

    /// During labelling, the parent of a label. Afterwards, the caller may use the value for other purposes.
    uint32_t& parent(uint32_t label) { return at(label).parent; }
    uint32_t parent(uint32_t label) const { return at(label).parent; }
    /// Number of voxels in the runs that got this label.
    int64_t voxels(uint32_t label) const
    {
        const int64_t low = at(label).voxels;
        if (carries_.empty()) [[likely]]
            return low;
        const auto carry = carries_.find(label);
        return low + (carry == carries_.end() ? 0 : carry->second);
    }
    void add_voxels(uint32_t label, int64_t voxels)
    {
        uint32_t& low = at(label).voxels;
        const int64_t sum = int64_t{low} + voxels;
        low = uint32_t(sum);
        if (sum > int64_t{low}) [[unlikely]]
            carries_[label] += sum - int64_t{low};
    }
    int64_t take_voxels(uint32_t label)
    {
        const int64_t taken = voxels(label);
        at(label).voxels = 0;
        if (!carries_.empty()) carries_.erase(label);
        return taken;
    }

    /// Appends another forest. Returns the offset that was added to the labels of `other`.
    uint64_t append(LabelForest&& other)
    {
        const uint64_t base = room();
        for (auto& block : other.blocks_) {
            for (Label& label : *block) label.parent += uint32_t(base);
            blocks_.push_back(std::move(block));
        }
        for (const auto& [label, voxels] : other.carries_) carries_[label + uint32_t(base)] = voxels;
        next_ = base + other.next_;
        other = LabelForest();
        return base;
    }

    /// Returns the parents alone, and frees the rest.
    LabelNumbers take_parents()
    {
        LabelNumbers numbers;
        numbers.size_ = next_;
        for (auto& block : blocks_) {
            auto& parents = numbers.blocks_.emplace_back(std::make_unique<LabelNumbers::Block>());
            for (size_t i = 0; i < BLOCK; ++i) (*parents)[i] = (*block)[i].parent;
            block.reset();
        }
        *this = LabelForest();
        return numbers;
    }

    int64_t bytes() const { return int64_t(blocks_.size() * (sizeof(Block) + sizeof(void*))); }

private:
    struct Label {
        uint32_t parent = 0;
        uint32_t voxels = 0;  ///< without what is in `carries_`
    };
    using Block = std::array<Label, BLOCK>;

    const Label& at(uint32_t label) const { return (*blocks_[label / BLOCK])[label % BLOCK]; }
    Label& at(uint32_t label) { return (*blocks_[label / BLOCK])[label % BLOCK]; }
    uint64_t room() const { return blocks_.size() * uint64_t{BLOCK}; }
    void add_block() { blocks_.push_back(std::make_unique<Block>()); }

    std::vector<std::unique_ptr<Block>> blocks_;
    std::map<uint32_t, int64_t> carries_;  ///< multiples of 2^32 voxels, of the few labels that have as many
    uint64_t next_ = 0;
};

}  // namespace shvr
