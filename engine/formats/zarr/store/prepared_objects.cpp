#include "engine/formats/zarr/store/prepared_objects.h"

#include <chrono>

#include "engine/base/waits/waits.h"

namespace shvr {

namespace {

/// Bytes counted for an object in addition to its content.
constexpr int64_t OBJECT_OVERHEAD_BYTES = 512;
constexpr std::chrono::milliseconds TICK{20};

int64_t cost_of(const RemoteObject& object)
{
    return int64_t(object.bytes.capacity()) + OBJECT_OVERHEAD_BYTES;
}

}  // namespace

bool PreparedObjects::announce(const Place& place)
{
    const std::scoped_lock lock(mutex_);
    return entries_.try_emplace(place).second;
}

void PreparedObjects::provide(const Place& place, RemoteObject object)
{
    const std::scoped_lock lock(mutex_);
    const auto entry = entries_.find(place);
    if (entry == entries_.end() || entry->second.object) return;
    bytes_ += cost_of(object);
    entry->second.object = std::move(object);
    entry->second.age = ages_.insert(ages_.end(), place);
    while (bytes_ > budget_bytes_ && ages_.size() > 1) remove_oldest();
    provided_.notify_all();
}

void PreparedObjects::withdraw(const Place& place)
{
    const std::scoped_lock lock(mutex_);
    const auto entry = entries_.find(place);
    if (entry != entries_.end() && !entry->second.object) entries_.erase(entry);
    provided_.notify_all();
}

std::optional<RemoteObject> PreparedObjects::take(const Place& place)
{
    std::unique_lock lock(mutex_);
    for (;;) {
        const auto entry = entries_.find(place);
        if (entry == entries_.end()) return std::nullopt;
        if (entry->second.object) {
            bytes_ -= cost_of(*entry->second.object);
            std::optional<RemoteObject> object = std::move(entry->second.object);
            ages_.erase(entry->second.age);
            entries_.erase(entry);
            return object;
        }
        provided_.wait_for(lock, TICK);
        stop_if_wait_is_over();
    }
}

void PreparedObjects::remove_oldest()
{
    const auto entry = entries_.find(ages_.front());
    bytes_ -= cost_of(*entry->second.object);
    ages_.pop_front();
    entries_.erase(entry);
}

}  // namespace shvr
