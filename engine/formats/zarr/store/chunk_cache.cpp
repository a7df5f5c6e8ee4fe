#include "engine/formats/zarr/store/chunk_cache.h"

#include <utility>

namespace shvr {
namespace {

/// Bytes counted for an entry besides its voxels, so that entries without voxels (fill value only) do not pile up.
constexpr int64_t OVERHEAD_BYTES = 256;

int64_t cost_of(const Block& block)
{
    return int64_t(block.capacity()) + OVERHEAD_BYTES;
}

}  // namespace

std::shared_ptr<const Block> ChunkCache::get(const Key& key, const std::function<Block()>& make)
{
    std::unique_lock lock(mutex_);
    for (auto found = entries_.find(key); found != entries_.end(); found = entries_.find(key)) {
        if (found->second.block) {
            ages_.splice(ages_.begin(), ages_, found->second.age);
            return found->second.block;
        }
        made_.wait(lock);
    }
    entries_.emplace(key, Entry{});
    lock.unlock();

    std::shared_ptr<const Block> block;
    try {
        block = std::make_shared<const Block>(make());
    } catch (...) {
        lock.lock();
        entries_.erase(key);
        made_.notify_all();
        throw;
    }
    lock.lock();
    ages_.push_front(key);
    entries_[key] = {block, ages_.begin()};
    bytes_ += cost_of(*block);
    make_room();
    made_.notify_all();
    return block;
}

void ChunkCache::make_room()
{
    while (bytes_ > budget_bytes_ && ages_.size() > 1) {
        const auto oldest = entries_.find(ages_.back());
        bytes_ -= cost_of(*oldest->second.block);
        entries_.erase(oldest);
        ages_.pop_back();
    }
}

bool ChunkCache::has(const Key& key) const
{
    const std::lock_guard lock(mutex_);
    return entries_.contains(key);
}

int64_t ChunkCache::bytes() const
{
    const std::lock_guard lock(mutex_);
    return bytes_;
}

}  // namespace shvr
