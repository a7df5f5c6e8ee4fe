#pragma once
// Looks for haptic devices and opens them on a thread of its own, since looking and opening may wait for hardware or a
// service. The functions here are for the main thread; only the destructor waits for the watch's thread.

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "haptics/devices/device_list.h"

namespace shvr::ui {

/// Functions that list and open devices; tests provide their own. Called on the watch's thread.
struct DeviceSource {
    std::function<std::vector<DeviceListing>()> list;
    /// Opens the device; returns null for the mouse. Fails with a one-sentence reason.
    std::function<std::unique_ptr<HapticDevice>(const std::string& id)> open;
};
/// Returns the source for this machine, with the profiles that ship.
DeviceSource devices_of_machine(bool allow_force);

class DeviceWatch {
public:
    explicit DeviceWatch(DeviceSource source);
    /// Waits until an opening in progress has ended.
    ~DeviceWatch();
    DeviceWatch(const DeviceWatch&) = delete;

    void look();
    void open(const std::string& id);
    bool is_busy() const;

    struct Opened {
        std::string id;
        std::unique_ptr<HapticDevice> device;
        std::string failure;  ///< a sentence; empty: the device is open
    };
    struct News {
        std::optional<std::vector<DeviceListing>> devices;
        std::optional<Opened> opened;
        std::string failure;  ///< failure of the search
    };
    /// Returns results since the last call.
    News take();

private:
    void run();
    DeviceSource source_;
    mutable std::mutex mutex_;
    std::condition_variable wanted_;
    bool wants_look_ = false, is_working_ = false, ends_ = false;
    std::optional<std::string> wants_open_;
    News news_;
    std::thread thread_;
};

}  // namespace shvr::ui
