#include "engine/volume/held_source.h"

#include <algorithm>
#include <utility>

#include "engine/base/error.h"
#include "engine/base/progress.h"
#include "engine/base/waits/waits.h"

namespace shvr {

namespace {

/// Number of parts read at once.
constexpr size_t READERS = 16;

}  // namespace

HeldSource::HeldSource(std::shared_ptr<const VolumeSource> base) : VolumeSource(base->info()), base_(std::move(base)) {}

HeldSource::~HeldSource()
{
    for (std::jthread& thread : threads_) thread.request_stop();
}

HeldSource::Key HeldSource::key_of(int level, const VoxelBox& box)
{
    return {level, box.lower.x, box.lower.y, box.lower.z, box.upper.x, box.upper.y, box.upper.z};
}

bool HeldSource::hold(std::span<const Part> parts)
{
    const std::scoped_lock lock(mutex_);
    std::map<Key, Held> held;
    for (const Part& part : parts) {
        const Key key = key_of(part.level, part.box);
        const auto before = held_.find(key);
        held.emplace(key, before == held_.end() ? Held{} : std::move(before->second));
    }
    held_ = std::move(held);
    holds_any_ = !held_.empty();
    const auto unread = size_t(std::ranges::count_if(held_, [](const auto& part) { return !part.second.is_read; }));
    while (threads_.size() < std::min(unread, READERS))
        threads_.emplace_back([this](const std::stop_token& stop) { work(stop); });
    asked_.notify_all();
    return unread == 0;
}

void HeldSource::work(const std::stop_token& stop)
{
    std::unique_lock lock(mutex_);
    auto next = held_.end();
    const auto is_asked = [&] {
        next = std::ranges::find_if(held_, [](const auto& part) { return !part.second.is_begun; });
        return next != held_.end();
    };
    while (asked_.wait(lock, stop, is_asked)) {
        const Key key = next->first;
        next->second.is_begun = true;
        lock.unlock();
        Held read = read_part(key, stop);
        lock.lock();
        const auto asked = held_.find(key);
        if (read.is_read && asked != held_.end()) asked->second = std::move(read);
    }
}

/// The result is not read if the part is no longer wanted.
HeldSource::Held HeldSource::read_part(const Key& key, const std::stop_token& stop) const
{
    const WaitsUntil waits([&] {
        const std::scoped_lock lock(mutex_);
        return stop.stop_requested() || !held_.contains(key);
    });
    const VoxelBox box{{key[1], key[2], key[3]}, {key[4], key[5], key[6]}};
    const Size3 size = box.size();
    Held held{.is_begun = true, .is_read = true};
    held.voxels.resize(size_t(size.x * size.y * size.z) * bytes_of(info().type));
    try {
        base_->read_level(int(key[0]), box, held.voxels);
    } catch (const Stopped&) {
        return {};
    } catch (const std::exception& error) {
        held.failure = error.what();
    }
    return held;
}

void HeldSource::read_level(int level, const VoxelBox& box, std::span<std::byte> voxels) const
{
    if (holds_any_) {
        const std::scoped_lock lock(mutex_);
        const auto held = held_.find(key_of(level, box));
        if (held != held_.end() && held->second.is_read) {
            if (!held->second.failure.empty()) throw Error(held->second.failure);
            std::ranges::copy(held->second.voxels, voxels.begin());
            return;
        }
    }
    base_->read_level(level, box, voxels);
}

}  // namespace shvr
