#pragma once
// The host's tier of a volume's bricks: what somebody wants is read, decoded and cut by loader threads, most wanted
// first, and kept within a byte budget. What is no longer wanted is not begun. A brick that cannot be read is named
// once and never tried again.
//
// One thread asks (want, take, get); the loaders are its own.

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
        uint64_t loads = 0;    ///< bricks that were read and cut
        uint64_t hits = 0;     ///< bricks taken that had been kept
        uint64_t dropped = 0;  ///< wanted bricks that were no longer wanted before they were begun
        uint64_t failures = 0;
    };

    /// The source must outlive the store. The budget is raised to what the loaders need to work at all.
    BrickStore(const VolumeSource& source, const IntensityWindow& window, uint64_t budget_bytes, int threads);
    ~BrickStore();
    BrickStore(const BrickStore&) = delete;
    BrickStore& operator=(const BrickStore&) = delete;

    /// What is wanted from now on, most wanted first. Replaces the list before.
    void want(std::vector<BrickKey> keys);
    /// Of the wanted bricks those that are there, at most `most`; each is handed out once a list. Does not wait.
    std::vector<Finished> take(size_t most);
    /// Waits until there is something to take; false where nothing more will come.
    bool wait();
    /// One brick, now: read on this thread unless it is kept. Null where it cannot be read.
    Texels get(const BrickKey& key);
    /// The source hands out other voxels of these bricks from now on: what is kept of them is dropped, and what loaders
    /// hold that they read before is read again. Call it after the source has changed.
    void renew(std::span<const BrickKey> keys);
    /// Why a brick cannot be read; nothing where it can be, or nobody has tried.
    std::optional<std::string> failure_of(const BrickKey& key) const;

    /// What could not be read, one sentence each, since the last call.
    std::vector<std::string> take_messages();
    Counts counts() const;
    uint64_t bytes() const;
    uint64_t peak_bytes() const;

private:
    struct Kept {
        Texels texels;
        std::list<BrickKey>::iterator place;  ///< in `by_age_`
    };
    void load(std::stop_token stop);
    std::optional<BrickKey> next();
    Texels make(BrickMaker& maker, const BrickKey& key);
    void keep(const BrickKey& key, Texels texels);
    bool make_room();
    void note_failure(const BrickKey& key, const std::string& message);

    const VolumeSource& source_;
    IntensityWindow window_;
    uint64_t most_bricks_;
    BrickMaker own_maker_;

    mutable std::mutex mutex_;
    std::condition_variable_any work_, finished_;
    std::vector<BrickKey> wanted_;
    size_t next_wanted_ = 0;                              ///< the loaders' place in the list
    std::unordered_set<BrickKey, BrickKeyHash> untaken_;  ///< wanted and not handed out
    std::list<BrickKey> ready_;                           ///< in the order in which they came
    std::unordered_map<BrickKey, Kept, BrickKeyHash> kept_;
    std::list<BrickKey> by_age_;  ///< of `kept_`, oldest use first
    std::unordered_set<BrickKey, BrickKeyHash> loading_;
    std::unordered_set<BrickKey, BrickKeyHash> outdated_;  ///< of `loading_`, those to be read once more
    std::unordered_map<BrickKey, std::string, BrickKeyHash> failed_;
    std::unordered_set<std::string> known_messages_;
    std::vector<std::string> messages_;
    Counts counts_;
    uint64_t peak_bricks_ = 0;
    std::vector<std::jthread> loaders_;  ///< last: they end before what they use
};

}  // namespace shvr
