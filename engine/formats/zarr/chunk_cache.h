#pragma once
// Decoded chunks that were asked for lately, up to a number of bytes. Two threads that want the same chunk decode it
// once: the second one waits for the first. Any thread may call it.

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

namespace shvr {

/// A decoded chunk; empty where all its voxels are the fill value.
using Block = std::vector<std::byte>;

class ChunkCache {
public:
    explicit ChunkCache(int64_t budget_bytes) : budget_bytes_(budget_bytes) {}

    struct Key {
        int level = 0;
        int64_t chunk = 0;
        auto operator<=>(const Key&) const = default;
    };

    /// The block, from `make` where it is not here. What `make` throws is thrown on and not remembered: those who
    /// waited for it try themselves.
    std::shared_ptr<const Block> get(const Key& key, const std::function<Block()>& make);

    int64_t bytes() const;  ///< held now; above the budget only by what is the latest block alone

private:
    struct Entry {
        std::shared_ptr<const Block> block;  ///< null while somebody makes it
        std::list<Key>::iterator age{};
    };
    void make_room();

    int64_t budget_bytes_;
    mutable std::mutex mutex_;
    std::condition_variable made_;
    std::map<Key, Entry> entries_;
    std::list<Key> ages_;  ///< the latest first
    int64_t bytes_ = 0;
};

}  // namespace shvr
