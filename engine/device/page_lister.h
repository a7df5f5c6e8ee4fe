#pragma once
// Lists the bricks that a view needs, on its own thread: for 10^5 bricks this takes 10 ms, too long for the drawing
// thread to wait while a camera moves. The lister has its own copy of the table of bricks, and is notified of every
// change. A list reflects the changes noted before the request; the caller applies later changes to it (changes_since).
// A few lists are cached, because panes alternate.
//
// One thread calls the lister and never notes changes during a request. The lister owns the other thread.

#include <condition_variable>
#include <deque>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <thread>
#include <vector>

#include "engine/bricks/brick_builder.h"
#include "engine/bricks/brick_map.h"
#include "engine/bricks/page_tree.h"
#include "engine/passes/brick_leap.h"

namespace shvr {

/// The parts of a look on which a picture's bricks depend.
struct PageSight {
    PageView view;
    Visibility visibility;
};

struct BrickEvent {
    enum class Kind : uint8_t {
        placed,   ///< the brick was uploaded; `number` is its packed slot
        gone,     ///< is no longer on the device
        read,     ///< the brick was read; `number` is its range, encoded as in KnownBricks
        unread,   ///< the brick's voxels have changed, so its range is unknown
        painted,  ///< the brick's paint changed; `number` is its count of painted level 0 bricks
        other,    ///< another property of this brick changed; the event does not say which
    };
    BrickKey key;
    Kind kind = Kind::other;
    uint32_t number = 0;
};

/// The known state of a volume's paged bricks: which are on the device and where, the ranges of those that were read,
/// and which are painted. It determines the bricks that a view needs and the stand-in drawn for a missing brick.
/// Changes are plain data, so that two threads can each have a copy. Each copy is used by one thread.
class KnownBricks {
public:
    KnownBricks(const VolumeInfo& info, int levels, const IntensityWindow& window,
                std::shared_ptr<const VolumeSource> source)
        : info_(info), levels_(levels), window_(window), source_(std::move(source))
    {}

    const VolumeInfo& info() const { return info_; }
    int levels() const { return levels_; }
    void apply(const BrickEvent& change);

    static BrickEvent placed(const BrickKey& key, uint32_t packed_slot)
    {
        return {key, BrickEvent::Kind::placed, packed_slot};
    }
    static BrickEvent read(const BrickKey& key, const BrickTexels::Range& range)
    {
        return {key, BrickEvent::Kind::read, range.minimum | uint32_t{range.maximum} << 16};
    }
    std::optional<BrickTexels::Range> range_of(const BrickKey& key) const;
    /// Number of painted level 0 bricks in a brick.
    uint32_t painted_in(const BrickKey& key) const { return painted_.find(key).value_or(0); }

    /// Whether paint may be visible in a brick, including paint of neighbouring bricks.
    bool is_painted(const PageSight& sight, const BrickKey& key) const;
    /// Whether the file's densities in a brick, or in any finer brick below it, may be visible.
    bool may_show(const PageSight& sight, const BrickKey& key) const;
    /// Whether the brick has been read and shows nothing.
    bool is_empty(const PageSight& sight, const BrickKey& key) const;
    /// The directory's entry for a leaf (shaders/pages.h): nothing if the leaf shows nothing, otherwise the leaf's
    /// brick or, if missing, its finest ancestor on the device.
    uint32_t entry_of(const PageSight& sight, const BrickKey& leaf) const;
    /// The entry of a leaf whose finest brick on the device is `key` or an ancestor of it.
    uint32_t finest_entry(BrickKey key) const;

private:
    static constexpr uint32_t NO_BRICK = 1u << gpu::PAGE_DISTANCE_SHIFT;

    bool is_always_shown(const PageView& view, const BrickKey& key) const;

    VolumeInfo info_;
    int levels_;
    IntensityWindow window_;
    std::shared_ptr<const VolumeSource> source_;
    BrickMap slots_, ranges_, painted_;
};

/// The result of listing a view, ready for drawing.
struct PageList {
    PageSight sight;
    std::shared_ptr<const PageTree> tree;
    BrickMap leaves;                ///< indices of the tree's leaves, by their keys
    std::vector<uint32_t> entries;  ///< the directory of shaders/pages.h
    uint64_t changes = 0;           ///< it reflects the first `changes` changes
    bool has_entries = true;        ///< false: its entries must still be made
};

class PageLister {
public:
    /// `known` is the initial state, in which no brick is known. Its source must be readable from any thread.
    explicit PageLister(KnownBricks known);
    ~PageLister();
    PageLister(const PageLister&) = delete;

    void note(const BrickEvent& change);
    /// changes(): number of changes so far. changes_since(): all but the first `changes`; null if they were dropped.
    uint64_t changes() const { return first_ + log_.size(); }
    std::optional<std::span<const BrickEvent>> changes_since(uint64_t changes) const;

    /// Whether take() would return without waiting. If not, starts making the list, unless another is being made.
    bool get_ready(const PageView& view, const Visibility& visibility);
    /// Waits for the list and returns it. Fails if the source failed while the list was made.
    std::shared_ptr<PageList> take(const PageView& view, const Visibility& visibility);
    /// Puts a list that take() returned back into the cache.
    void keep(std::shared_ptr<PageList> list);
    /// Marks all lists as out of date, because the source or the paint has changed.
    void forget();

    /// Number of calls of take() that had to wait for a list.
    uint64_t waits() const { return waits_; }

private:
    static constexpr size_t MAX_LISTS = 3;  ///< each takes up to 10 MB
    static constexpr size_t MAX_CHANGES = size_t{1} << 16;
    struct Asked {
        PageSight sight;
        uint64_t changes = 0;
        uint64_t outdated = 0;
    };
    struct Made {
        std::shared_ptr<PageList> list;
        std::exception_ptr failure;
        uint64_t outdated = 0;
    };
    std::shared_ptr<PageList> find(const PageView& view, const Visibility& visibility) const;
    void hand_over();
    void collect();
    void begin(const PageView& view, const Visibility& visibility);
    void work(std::stop_token stop);

    std::vector<BrickEvent> log_;
    uint64_t first_ = 0;                           ///< changes before the log
    uint64_t handed_over_ = 0;                     ///< changes already passed to the lister's thread
    uint64_t outdated_ = 0;                        ///< calls of forget()
    std::deque<std::shared_ptr<PageList>> lists_;  ///< most recent last
    bool is_busy_ = false;
    uint64_t waits_ = 0;

    KnownBricks known_;  ///< owned by the lister's thread

    std::mutex mutex_;  ///< guards the next three members
    std::vector<BrickEvent> told_;
    std::optional<Asked> asked_;
    std::optional<Made> made_;
    std::condition_variable_any work_, finished_;
    std::jthread thread_;  ///< declared last: the thread stops before the members it uses are destroyed
};

}  // namespace shvr
