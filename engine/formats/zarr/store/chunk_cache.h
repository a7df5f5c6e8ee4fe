#pragma once
// A cache of recently used decoded chunks, limited in bytes. If two threads need the same chunk, it is decoded once,
// and the second thread waits for the first. Any thread may call it.

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

namespace shvr {

/// A decoded chunk; empty if all its voxels are the fill value.
using Block = std::vector<std::byte>;

class ChunkCache {
public:
    explicit ChunkCache(int64_t budget_bytes) : budget_bytes_(budget_bytes) {}

    struct Key {
        int level = 0;
        int64_t chunk = 0;
        auto operator<=>(const Key&) const = default;
    };

    /// Returns the cached block, or else the result of `make`, which is then cached. If `make` throws, nothing is
    /// cached, and other threads that wait for the block call their own `make`.
    std::shared_ptr<const Block> get(const Key& key, const std::function<Block()>& make);

    bool has(const Key& key) const;  ///< whether the block is in the cache or being decoded
    int64_t bytes() const;           ///< size of the cached blocks; only a single large block can exceed the budget

private:
    struct Entry {
        std::shared_ptr<const Block> block;  ///< null while a thread makes it
        std::list<Key>::iterator age{};
    };
    void make_room();

    int64_t budget_bytes_;
    mutable std::mutex mutex_;
    std::condition_variable made_;
    std::map<Key, Entry> entries_;
    std::list<Key> ages_;  ///< most recent first
    int64_t bytes_ = 0;
};

}  // namespace shvr
