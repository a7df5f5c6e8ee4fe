#pragma once
// Looks for haptic devices and opens them, on a thread of its own, since both may wait for hardware or for a service.
// The functions here are for the main thread. None of them waits, except the destructor.

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

/// Functions that list devices and open them, called on the watch's thread. Tests provide their own.
struct DeviceSource {
    std::function<std::vector<DeviceListing>()> list;
    /// Opens the device with this id; returns null for the mouse. Fails with the reason, in one sentence.
    std::function<std::unique_ptr<HapticDevice>(const std::string& id)> open;
};
/// Returns functions for this machine's devices, with the device profiles that ship with the program.
DeviceSource devices_of_machine(bool allow_force);

class DeviceWatch {
public:
    explicit DeviceWatch(DeviceSource source);
    /// Waits until the opening of a device in progress has ended.
    ~DeviceWatch();
    DeviceWatch(const DeviceWatch&) = delete;

    void look();
    void open(const std::string& id);
    bool is_busy() const;

    struct Opened {
        std::string id;
        std::unique_ptr<HapticDevice> device;
        std::string failure;  ///< reason, as a sentence, why the device could not be opened; empty: it is open
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
