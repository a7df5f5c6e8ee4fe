#pragma once
// Queues of voxels for floods: the voxel with the lowest cost comes first, and of equal costs the one that was pushed
// first. Voxels are numbers below the `voxels` of the constructor; each is pushed at most once.

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <memory>
#include <vector>

namespace shvr {

/// For costs that are whole numbers below 65536: a list of voxels for each cost.
class BucketQueue {
public:
    static constexpr uint64_t BYTES_OF_VOXEL = sizeof(uint32_t);
    explicit BucketQueue(size_t voxels) : next_(voxels), first_(COSTS), last_(COSTS) {}
    bool is_empty() const { return size_ == 0; }
    void push(uint32_t voxel, double cost)
    {
        const auto bucket = size_t(cost);
        if (!has(bucket))
            first_[bucket] = voxel;
        else
            next_[last_[bucket]] = voxel;
        last_[bucket] = voxel;
        words_[bucket / 64] |= uint64_t{1} << (bucket % 64);
        lowest_ = std::min(lowest_, bucket / 64);
        ++size_;
    }
    uint32_t pop()
    {
        while (words_[lowest_] == 0) ++lowest_;
        const size_t bucket = 64 * lowest_ + size_t(std::countr_zero(words_[lowest_]));
        const uint32_t voxel = first_[bucket];
        if (voxel == last_[bucket])
            words_[lowest_] &= words_[lowest_] - 1;
        else
            first_[bucket] = next_[voxel];
        --size_;
        return voxel;
    }

private:
    static constexpr size_t COSTS = 65536;
    bool has(size_t bucket) const { return (words_[bucket / 64] >> (bucket % 64) & 1u) != 0; }

    std::vector<uint32_t> next_;  ///< for each voxel, the next of its cost
    std::vector<uint32_t> first_, last_;
    std::array<uint64_t, COSTS / 64> words_{};  ///< a bit for each cost that has voxels
    size_t lowest_ = COSTS / 64 - 1;            ///< no word before it has bits
    size_t size_ = 0;
};

/// For any costs except NaN: a binary heap in blocks, so that it never takes more than its greatest size.
class HeapQueue {
public:
    static constexpr uint64_t BYTES_OF_VOXEL = 16;
    explicit HeapQueue(size_t) {}
    bool is_empty() const { return size_ == 0; }
    void push(uint32_t voxel, double cost)
    {
        if (size_ == blocks_.size() * BLOCK) blocks_.push_back(std::make_unique<std::array<Entry, BLOCK>>());
        const Entry entry{cost, pushed_++, voxel};
        size_t place = size_++;
        for (; place > 0 && entry.is_before(at((place - 1) / 2)); place = (place - 1) / 2)
            at(place) = at((place - 1) / 2);
        at(place) = entry;
    }
    uint32_t pop()
    {
        const uint32_t voxel = at(0).voxel;
        const Entry last = at(--size_);
        size_t place = 0;
        while (2 * place + 1 < size_) {
            size_t child = 2 * place + 1;
            if (child + 1 < size_ && at(child + 1).is_before(at(child))) ++child;
            if (!at(child).is_before(last)) break;
            at(place) = at(child);
            place = child;
        }
        at(place) = last;
        return voxel;
    }

private:
    struct Entry {
        double cost = 0.0;
        uint32_t order = 0, voxel = 0;
        bool is_before(const Entry& other) const
        {
            return cost < other.cost || (cost == other.cost && order < other.order);
        }
    };
    static_assert(sizeof(Entry) == BYTES_OF_VOXEL);
    static constexpr size_t BLOCK = 65536;
    Entry& at(size_t place) { return (*blocks_[place / BLOCK])[place % BLOCK]; }

    std::vector<std::unique_ptr<std::array<Entry, BLOCK>>> blocks_{};
    size_t size_ = 0;
    uint32_t pushed_ = 0;
};

}  // namespace shvr
