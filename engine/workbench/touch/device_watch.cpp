#include "engine/workbench/touch/device_watch.h"

#include <utility>

#include "engine/base/assets.h"
#include "engine/base/error.h"

namespace shvr::ui {

DeviceSource devices_of_machine(bool allow_force)
{
    const auto options = [allow_force] {
        const std::filesystem::path folder = asset_folder("devices");
        DeviceOptions found{.profiles = {}, .allow_force = allow_force, .inverse3 = {}, .openhaptics = {}};
        if (!folder.empty()) found.profiles = load_hid_profiles(folder);
        return found;
    };
    return {.list = [options] { return list_devices(options()); },
            .open = [options](const std::string& id) { return open_device(options(), id); }};
}

DeviceWatch::DeviceWatch(DeviceSource source) : source_(std::move(source))
{
    thread_ = std::thread(&DeviceWatch::run, this);
}

DeviceWatch::~DeviceWatch()
{
    {
        const std::lock_guard lock(mutex_);
        ends_ = true;
    }
    wanted_.notify_one();
    thread_.join();
}

void DeviceWatch::look()
{
    {
        const std::lock_guard lock(mutex_);
        wants_look_ = true;
    }
    wanted_.notify_one();
}

void DeviceWatch::open(const std::string& id)
{
    {
        const std::lock_guard lock(mutex_);
        wants_open_ = id;
    }
    wanted_.notify_one();
}

bool DeviceWatch::is_busy() const
{
    const std::lock_guard lock(mutex_);
    return is_working_ || wants_look_ || wants_open_;
}

DeviceWatch::News DeviceWatch::take()
{
    const std::lock_guard lock(mutex_);
    return std::exchange(news_, {});
}

void DeviceWatch::run()
{
    std::unique_lock lock(mutex_);
    for (;;) {
        wanted_.wait(lock, [&] { return ends_ || wants_look_ || wants_open_; });
        if (ends_) return;
        is_working_ = true;
        if (std::optional<std::string> id = std::exchange(wants_open_, std::nullopt)) {
            lock.unlock();
            Opened opened{.id = *id, .device = nullptr, .failure = {}};
            try {
                opened.device = source_.open(*id);
            } catch (const std::exception& error) {
                opened.failure = error.what();
            }
            lock.lock();
            news_.opened = std::move(opened);
        } else {
            wants_look_ = false;
            lock.unlock();
            std::optional<std::vector<DeviceListing>> devices;
            std::string failure;
            try {
                devices = source_.list();
            } catch (const std::exception& error) {
                failure = error.what();
            }
            lock.lock();
            news_.devices = std::move(devices);
            news_.failure = std::move(failure);
        }
        is_working_ = false;
    }
}

}  // namespace shvr::ui
