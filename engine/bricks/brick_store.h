#pragma once
// The host tier of a volume's bricks: loader threads read, decode and cut the wanted bricks, most wanted first, and the
// store keeps them within a byte budget. Loaders do not start bricks that are no longer wanted. A brick that cannot be
// read is reported once and never retried. Loaders that wait for a network (engine/base/waits/waits.h) leave the
// processor alone: then the store starts more of them, so that more bricks are on their way at once.
//
// One thread makes all calls (want, take, get). The store owns the loader threads.

#include <atomic>
#include <condition_variable>
#include <exception>
#include <list>
#include <memory>
#include <mutex>
#include <thread>
#include <unordered_map>
#include <unordered_set>

#include "engine/bricks/brick_builder.h"

namespace shvr {

class BrickStore {
public:
    using Texels = std::shared_ptr<const BrickTexels>;
    struct Finished {
        BrickKey key;
        Texels texels;  ///< null: it cannot be read
    };
    struct Counts {
        uint64_t loads = 0;    ///< bricks read and cut
        uint64_t hits = 0;     ///< bricks found in the store
        uint64_t dropped = 0;  ///< bricks that were no longer wanted before a loader started them
        uint64_t failures = 0;
    };

    /// Number of loaders once one of them waits for a network.
    static constexpr int FAR_LOADERS = 16;

    /// The source must outlive the store. The budget is raised to the loaders' minimum if necessary.
    BrickStore(const VolumeSource& source, const IntensityWindow& window, uint64_t budget_bytes, int threads);
    ~BrickStore();
    BrickStore(const BrickStore&) = delete;
    BrickStore& operator=(const BrickStore&) = delete;

    /// Sets the wanted bricks, most wanted first. Replaces the previous list.
    void want(std::vector<BrickKey> keys);
    /// Returns up to `most` wanted bricks that are ready, without waiting; each brick once per call of want().
    std::vector<Finished> take(size_t most);
    /// Waits until take() has a brick to return; returns false if no more bricks will arrive.
    bool wait();
    /// Returns one brick. If the store lacks it, reads it now on this thread. Null if the brick cannot be read.
    Texels get(const BrickKey& key);
    /// Reports that the source's voxels of these bricks have changed: drops stored copies, and repeats reads of these
    /// bricks that are in progress. Call this after the source has changed.
    void renew(std::span<const BrickKey> keys);
    /// Why a brick cannot be read; null if it can be read, or if reading was not tried.
    std::optional<std::string> failure_of(const BrickKey& key) const;

    /// Read failures since the last call, one sentence each.
    std::vector<std::string> take_messages();
    Counts counts() const;
    uint64_t bytes() const;
    uint64_t peak_bytes() const;

private:
    struct Kept {
        Texels texels;
        std::list<BrickKey>::iterator place;  ///< in `by_age_`
    };
    void start_loaders(int count);
    void load(std::stop_token stop);
    std::optional<BrickKey> next();
    Texels make(BrickMaker& maker, const BrickKey& key);
    void keep(const BrickKey& key, Texels texels);
    bool make_room();
    void note_failure(const BrickKey& key, const std::string& message);

    const VolumeSource& source_;
    IntensityWindow window_;
    uint64_t max_bricks_;
    BrickMaker own_maker_;

    mutable std::mutex mutex_;
    std::condition_variable_any work_, finished_;
    std::vector<BrickKey> wanted_;
    size_t next_wanted_ = 0;                              ///< index of the next wanted brick for a loader
    std::unordered_set<BrickKey, BrickKeyHash> untaken_;  ///< wanted, but not yet returned
    std::list<BrickKey> ready_;                           ///< in order of arrival
    std::unordered_map<BrickKey, Kept, BrickKeyHash> kept_;
    std::list<BrickKey> by_age_;  ///< keys of `kept_`, least recently used first
    std::unordered_set<BrickKey, BrickKeyHash> loading_;
    std::unordered_set<BrickKey, BrickKeyHash> outdated_;  ///< keys in `loading_` that must be read again
    std::unordered_map<BrickKey, std::string, BrickKeyHash> failed_;
    std::atomic<bool> has_failures_ = false;  ///< avoids locking the mutex for each brick of a picture
    std::unordered_set<std::string> known_messages_;
    std::vector<std::string> messages_;
    Counts counts_;
    uint64_t peak_bricks_ = 0;
    bool is_ending_ = false;
    std::vector<std::jthread> loaders_;  ///< declared last, so loaders stop before the members they use are destroyed
};

}  // namespace shvr
