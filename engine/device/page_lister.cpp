#include "engine/device/page_lister.h"

#include <algorithm>
#include <bit>
#include <utility>

namespace shvr {

// ---- What is known --------------------------------------------------------------------------------------------------

void KnownBricks::apply(const BrickEvent& change)
{
    using Kind = BrickEvent::Kind;
    switch (change.kind) {
        case Kind::placed: return slots_.set(change.key, change.number);
        case Kind::gone: return slots_.erase(change.key);
        case Kind::read: return ranges_.set(change.key, change.number);
        case Kind::unread: return ranges_.erase(change.key);
        case Kind::painted:
            return change.number > 0 ? painted_.set(change.key, change.number) : painted_.erase(change.key);
        case Kind::other: return;
    }
}

std::optional<BrickTexels::Range> KnownBricks::range_of(const BrickKey& key) const
{
    const std::optional<uint32_t> range = ranges_.find(key);
    if (!range) return std::nullopt;
    return BrickTexels::Range{uint16_t(*range & 0xffffu), uint16_t(*range >> 16)};
}

bool KnownBricks::is_painted(const PageSight& sight, const BrickKey& key) const
{
    if (painted_.size() == 0) return false;
    if (sight.visibility.params.paint_reach == 0) return painted_.contains(key);
    bool is = false;
    for_each_around(key, [&](const BrickKey& around) {
        is = is || (glm::all(glm::greaterThanEqual(around.brick, glm::ivec3(0))) && painted_.contains(around));
    });
    return is;
}

/// Whether the brick is shown even if the transfer function hides it.
bool KnownBricks::is_always_shown(const PageView& view, const BrickKey& key) const
{
    if (view.shows_all || !view.shown) return view.shows_all;
    const VoxelBox voxels = voxels_of(key, info_.size);
    return glm::all(glm::lessThan(voxels.lower, view.shown->upper)) &&
           glm::all(glm::lessThan(view.shown->lower, voxels.upper));
}

bool KnownBricks::may_show(const PageSight& sight, const BrickKey& key) const
{
    if (is_painted(sight, key) || is_always_shown(sight.view, key)) return true;
    const std::optional<ValueRange> range = source_->brick_range(key.level, Size3(key.brick));
    if (!range) return true;
    return range->lower <= range->upper &&
           sight.visibility.shows(window_.code_of(range->lower), window_.code_of(range->upper));
}

bool KnownBricks::is_empty(const PageSight& sight, const BrickKey& key) const
{
    const std::optional<BrickTexels::Range> range = range_of(key);
    return range && !sight.visibility.shows(range->minimum, range->maximum) && !is_painted(sight, key) &&
           !is_always_shown(sight.view, key);
}

uint32_t KnownBricks::finest_entry(BrickKey key) const
{
    for (; key.level < levels_; key = parent_of(key))
        if (const std::optional<uint32_t> slot = slots_.find(key))
            return uint32_t(key.level) << gpu::PAGE_LEVEL_SHIFT | *slot;
    return NO_BRICK;
}

uint32_t KnownBricks::entry_of(const PageSight& sight, const BrickKey& leaf) const
{
    return !slots_.contains(leaf) && is_empty(sight, leaf) ? NO_BRICK : finest_entry(leaf);
}

// ---- Lists ----------------------------------------------------------------------------------------------------------

namespace {

bool is_of(const PageSight& sight, const PageView& view, const Visibility& visibility)
{
    return sight.view == view && sight.visibility == visibility;
}

std::shared_ptr<PageList> list_of(const KnownBricks& known, PageSight sight, uint64_t changes)
{
    auto list = std::make_shared<PageList>();
    const auto tree = std::make_shared<const PageTree>(make_page_tree(
        known.info(), known.levels(), sight.view, [&](const BrickKey& key) { return known.may_show(sight, key); }));
    list->leaves.clear(tree->leaves.size());
    list->entries.reserve(std::bit_ceil(tree->entries.size()));
    list->entries = tree->entries;
    // Rounds the size up to a power of two: the sizes of views differ, and frames reuse only buffers of equal size.
    list->entries.resize(std::bit_ceil(tree->entries.size()));
    for (uint32_t leaf = 0; leaf < tree->leaves.size(); ++leaf) {
        const BrickKey& key = tree->leaves[leaf].key;
        list->leaves.set(key, leaf);
        const uint32_t entry = known.entry_of(sight, key);
        for (uint32_t i = tree->begin_of_leaf[leaf]; i < tree->begin_of_leaf[leaf + 1]; ++i)
            list->entries[tree->entries_of_leaves[i]] = entry;
    }
    list->tree = tree;
    list->sight = std::move(sight);
    list->changes = changes;
    return list;
}

}  // namespace

PageLister::PageLister(KnownBricks known) : known_(std::move(known))
{
    thread_ = std::jthread([this](std::stop_token stop) { work(std::move(stop)); });
}

PageLister::~PageLister()
{
    thread_.request_stop();
}

void PageLister::note(const BrickEvent& change)
{
    log_.push_back(change);
    if (log_.size() < MAX_CHANGES) return;
    hand_over();
    work_.notify_one();
    constexpr size_t FORGOTTEN = MAX_CHANGES / 2;
    log_.erase(log_.begin(), log_.begin() + FORGOTTEN);
    first_ += FORGOTTEN;
}

std::optional<std::span<const BrickEvent>> PageLister::changes_since(uint64_t changes) const
{
    if (changes < first_) return std::nullopt;
    return std::span(log_).subspan(size_t(changes - first_));
}

/// Passes all changes to the lister's thread.
void PageLister::hand_over()
{
    const std::scoped_lock lock(mutex_);
    told_.insert(told_.end(), log_.begin() + std::ptrdiff_t(handed_over_ - first_), log_.end());
    handed_over_ = changes();
}

std::shared_ptr<PageList> PageLister::find(const PageView& view, const Visibility& visibility) const
{
    const auto found =
        std::ranges::find_if(lists_, [&](const auto& list) { return is_of(list->sight, view, visibility); });
    return found == lists_.end() ? nullptr : *found;
}

void PageLister::keep(std::shared_ptr<PageList> list)
{
    lists_.push_back(std::move(list));
    if (lists_.size() > MAX_LISTS) lists_.pop_front();
}

void PageLister::forget()
{
    ++outdated_;
    lists_.clear();
}

/// Takes the finished list, if there is one.
void PageLister::collect()
{
    std::optional<Made> made;
    {
        const std::scoped_lock lock(mutex_);
        made = std::exchange(made_, std::nullopt);
    }
    if (!made) return;
    is_busy_ = false;
    if (made->failure) std::rethrow_exception(made->failure);
    if (made->outdated == outdated_) keep(std::move(made->list));
}

void PageLister::begin(const PageView& view, const Visibility& visibility)
{
    hand_over();
    is_busy_ = true;
    {
        const std::scoped_lock lock(mutex_);
        asked_ = Asked{{view, visibility}, changes(), outdated_};
    }
    work_.notify_one();
}

bool PageLister::get_ready(const PageView& view, const Visibility& visibility)
{
    collect();
    if (find(view, visibility)) return true;
    if (!is_busy_) begin(view, visibility);
    return false;
}

std::shared_ptr<PageList> PageLister::take(const PageView& view, const Visibility& visibility)
{
    for (bool has_waited = false; !get_ready(view, visibility);) {
        if (!std::exchange(has_waited, true)) ++waits_;
        std::unique_lock lock(mutex_);
        finished_.wait(lock, [&] { return made_.has_value(); });
    }
    std::shared_ptr<PageList> list = find(view, visibility);
    std::erase(lists_, list);
    return list;
}

void PageLister::work(std::stop_token stop)
{
    std::unique_lock lock(mutex_);
    while (work_.wait(lock, stop, [&] { return asked_ || !told_.empty(); })) {
        const std::vector<BrickEvent> changes = std::exchange(told_, {});
        std::optional<Asked> asked = std::exchange(asked_, std::nullopt);
        lock.unlock();
        for (const BrickEvent& change : changes) known_.apply(change);
        Made made;
        if (asked) try {
                made.outdated = asked->outdated;
                made.list = list_of(known_, std::move(asked->sight), asked->changes);
            } catch (...) {
                made.failure = std::current_exception();
            }
        lock.lock();
        if (!asked) continue;
        made_ = std::move(made);
        finished_.notify_all();
    }
}

}  // namespace shvr
