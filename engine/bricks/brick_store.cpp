#include "engine/bricks/brick_store.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <utility>

#include "engine/base/error.h"
#include "engine/base/waits/waits.h"

namespace shvr {

namespace {

constexpr uint64_t BRICK_BYTES = sizeof(BrickTexels);
/// Maximum number of stored messages, more than users read; later failures are still counted.
constexpr size_t MAX_MESSAGES = 20;

/// Lowers the priority of a loader thread below that of rendering: on two cores, loaders of equal priority delay the
/// first picture. On Linux, each thread has a priority. Elsewhere (POSIX has one priority per process), or if the call
/// fails, the priority stays unchanged, which costs only speed.
void give_way()
{
    constexpr int NICENESS = 5;
    ::setpriority(PRIO_PROCESS, static_cast<id_t>(::gettid()), NICENESS);
}

}  // namespace

BrickStore::BrickStore(const VolumeSource& source, const IntensityWindow& window, uint64_t budget_bytes, int threads)
    : source_(source), window_(window), own_maker_(source, window)
{
    max_bricks_ = budget_bytes / BRICK_BYTES;
    const std::scoped_lock lock(mutex_);
    start_loaders(std::max(1, threads));
}

BrickStore::~BrickStore()
{
    const std::scoped_lock lock(mutex_);
    is_ending_ = true;
    for (std::jthread& loader : loaders_) loader.request_stop();
    work_.notify_all();
}

/// Starts loaders until there are `count`. The caller holds the mutex.
void BrickStore::start_loaders(int count)
{
    // At least two bricks per loader: one being loaded, and one waiting to be taken.
    max_bricks_ = std::max<uint64_t>(max_bricks_, 2 * uint64_t(count));
    while (!is_ending_ && int(loaders_.size()) < count)
        loaders_.emplace_back([this](std::stop_token stop) {
            give_way();
            load(std::move(stop));
        });
}

void BrickStore::want(std::vector<BrickKey> keys)
{
    const std::scoped_lock lock(mutex_);
    std::unordered_set<BrickKey, BrickKeyHash> untaken(keys.begin(), keys.end());
    for (size_t i = next_wanted_; i < wanted_.size(); ++i)
        counts_.dropped += !untaken.contains(wanted_[i]) && !kept_.contains(wanted_[i]);
    wanted_ = std::move(keys);
    next_wanted_ = 0;
    untaken_ = std::move(untaken);
    ready_.clear();
    for (const BrickKey& key : wanted_) {
        const auto kept = kept_.find(key);
        if (failed_.contains(key)) {
            ready_.push_back(key);
        } else if (kept != kept_.end()) {
            by_age_.splice(by_age_.end(), by_age_, kept->second.place);
            ready_.push_back(key);
            ++counts_.hits;
        }
    }
    work_.notify_all();
}

std::vector<BrickStore::Finished> BrickStore::take(size_t most)
{
    const std::scoped_lock lock(mutex_);
    std::vector<Finished> finished;
    while (finished.size() < most && !ready_.empty()) {
        const BrickKey key = ready_.front();
        ready_.pop_front();
        if (untaken_.erase(key) == 0) continue;
        const auto kept = kept_.find(key);
        finished.push_back({key, kept == kept_.end() ? nullptr : kept->second.texels});
    }
    if (!finished.empty()) work_.notify_all();  // taking may have made room
    return finished;
}

bool BrickStore::wait()
{
    std::unique_lock lock(mutex_);
    finished_.wait(lock, [&] { return !ready_.empty() || untaken_.empty(); });
    return !ready_.empty();
}

BrickStore::Texels BrickStore::get(const BrickKey& key)
{
    {
        std::unique_lock lock(mutex_);
        finished_.wait(lock, [&] { return !loading_.contains(key); });
        if (failed_.contains(key)) return nullptr;
        if (const auto kept = kept_.find(key); kept != kept_.end()) {
            by_age_.splice(by_age_.end(), by_age_, kept->second.place);
            ++counts_.hits;
            return kept->second.texels;
        }
        loading_.insert(key);
    }
    Texels texels = make(own_maker_, key);
    const std::scoped_lock lock(mutex_);
    loading_.erase(key);
    if (texels && make_room()) keep(key, texels);
    if (untaken_.contains(key) && (kept_.contains(key) || failed_.contains(key))) ready_.push_back(key);
    finished_.notify_all();
    work_.notify_all();
    return texels;
}

void BrickStore::renew(std::span<const BrickKey> keys)
{
    const std::scoped_lock lock(mutex_);
    bool is_wanted = false;
    for (const BrickKey& key : keys) {
        if (loading_.contains(key)) outdated_.insert(key);
        const auto kept = kept_.find(key);
        if (kept == kept_.end()) continue;
        by_age_.erase(kept->second.place);
        kept_.erase(kept);
        if (!untaken_.contains(key)) continue;
        std::erase(ready_, key);
        is_wanted = true;
    }
    if (is_wanted) next_wanted_ = 0;
    work_.notify_all();
}

std::optional<std::string> BrickStore::failure_of(const BrickKey& key) const
{
    if (!has_failures_) return std::nullopt;
    const std::scoped_lock lock(mutex_);
    const auto found = failed_.find(key);
    return found == failed_.end() ? std::nullopt : std::optional(found->second);
}

/// Returns the next wanted brick that is neither stored nor being loaded. The caller holds the mutex.
std::optional<BrickKey> BrickStore::next()
{
    while (next_wanted_ < wanted_.size()) {
        const BrickKey key = wanted_[next_wanted_];
        if (kept_.contains(key) || loading_.contains(key) || failed_.contains(key)) {
            ++next_wanted_;
            continue;
        }
        if (!make_room()) return std::nullopt;
        ++next_wanted_;
        return key;
    }
    return std::nullopt;
}

/// Evicts the least recently used bricks, except those waiting to be taken, until there is room for one more brick. The
/// caller holds the mutex.
bool BrickStore::make_room()
{
    const auto is_full = [&] { return kept_.size() + loading_.size() >= max_bricks_; };
    for (auto oldest = by_age_.begin(); is_full() && oldest != by_age_.end();) {
        if (untaken_.contains(*oldest)) {
            ++oldest;
            continue;
        }
        kept_.erase(*oldest);
        oldest = by_age_.erase(oldest);
    }
    return !is_full();
}

void BrickStore::keep(const BrickKey& key, Texels texels)
{
    const auto place = by_age_.insert(by_age_.end(), key);
    if (!kept_.emplace(key, Kept{std::move(texels), place}).second) by_age_.erase(place);
    peak_bricks_ = std::max<uint64_t>(peak_bricks_, kept_.size() + loading_.size());
}

BrickStore::Texels BrickStore::make(BrickMaker& maker, const BrickKey& key)
{
    try {
        auto texels = std::make_shared_for_overwrite<BrickTexels>();
        maker.make(key, *texels);
        const std::scoped_lock lock(mutex_);
        ++counts_.loads;
        return texels;
    } catch (const std::exception& error) {
        note_failure(key, error.what());
        return nullptr;
    }
}

void BrickStore::note_failure(const BrickKey& key, const std::string& message)
{
    const std::scoped_lock lock(mutex_);
    ++counts_.failures;
    failed_.emplace(key, message);
    has_failures_ = true;
    // One broken chunk may affect several bricks.
    if (known_messages_.size() < MAX_MESSAGES && known_messages_.insert(message).second) messages_.push_back(message);
}

void BrickStore::load(std::stop_token stop)
{
    bool is_near = true;  // as far as this thread knows
    const WaitsUntil waits([&] {
        if (std::exchange(is_near, false)) {
            const std::scoped_lock lock(mutex_);
            start_loaders(FAR_LOADERS);
        }
        return stop.stop_requested();
    });
    BrickMaker maker(source_, window_);
    std::unique_lock lock(mutex_);
    while (!stop.stop_requested()) {
        const std::optional<BrickKey> key = next();
        if (!key) {
            work_.wait(lock);
            continue;
        }
        loading_.insert(*key);
        peak_bricks_ = std::max<uint64_t>(peak_bricks_, kept_.size() + loading_.size());
        Texels texels;
        do {
            lock.unlock();
            texels = make(maker, *key);
            lock.lock();
        } while (outdated_.erase(*key) > 0);
        loading_.erase(*key);
        if (texels) keep(*key, std::move(texels));
        if (untaken_.contains(*key)) ready_.push_back(*key);
        finished_.notify_all();
    }
}

std::vector<std::string> BrickStore::take_messages()
{
    const std::scoped_lock lock(mutex_);
    return std::exchange(messages_, {});
}

BrickStore::Counts BrickStore::counts() const
{
    const std::scoped_lock lock(mutex_);
    return counts_;
}

uint64_t BrickStore::bytes() const
{
    const std::scoped_lock lock(mutex_);
    return (kept_.size() + loading_.size()) * BRICK_BYTES;
}

uint64_t BrickStore::peak_bytes() const
{
    const std::scoped_lock lock(mutex_);
    return peak_bricks_ * BRICK_BYTES;
}

}  // namespace shvr
