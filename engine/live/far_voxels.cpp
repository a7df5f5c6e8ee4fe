#include "engine/live/far_voxels.h"

#include "engine/base/error.h"
#include "engine/base/waits/waits.h"

namespace shvr {

FarVoxels::~FarVoxels()
{
    thread_.request_stop();
}

std::optional<DensityBox> FarVoxels::find(const std::shared_ptr<const VolumeSource>& source, const VoxelBox& box)
{
    const std::scoped_lock lock(mutex_);
    if (is_wanted({source, box})) return read_;
    wanted_ = Wanted{source, box};
    read_.reset();
    is_done_ = false;
    if (!thread_.joinable()) thread_ = std::jthread([this](const std::stop_token& stop) { read(stop); });
    asked_.notify_one();
    return std::nullopt;
}

bool FarVoxels::is_reading() const
{
    const std::scoped_lock lock(mutex_);
    return wanted_ && !is_done_;
}

/// The caller holds the mutex.
bool FarVoxels::is_wanted(const Wanted& wanted) const
{
    return wanted_ && wanted_->source == wanted.source && wanted_->box.lower == wanted.box.lower &&
           wanted_->box.upper == wanted.box.upper;
}

void FarVoxels::read(const std::stop_token& stop)
{
    std::unique_lock lock(mutex_);
    while (asked_.wait(lock, stop, [&] { return wanted_ && !is_done_; })) {
        const Wanted wanted = *wanted_;
        lock.unlock();
        std::optional<DensityBox> read;
        try {
            const WaitsUntil waits([&] {
                const std::scoped_lock looking(mutex_);
                return stop.stop_requested() || !is_wanted(wanted);
            });
            const VolumeInfo& info = wanted.source->info();
            read = densities_in(*wanted.source, DensityField(info.size, info.type), wanted.box);
        } catch (const std::exception&) {
            // The picture reports what cannot be read.
        }
        lock.lock();
        if (!is_wanted(wanted)) continue;
        read_ = std::move(read);
        is_done_ = true;
    }
}

}  // namespace shvr
