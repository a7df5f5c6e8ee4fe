#pragma once
// A HID device made by the kernel's uhid, which the kernel, hidapi and SHVR's link take for a real one. Needs root.

#include <array>
#include <atomic>
#include <cstdint>
#include <span>
#include <thread>
#include <vector>

#include <linux/uhid.h>

namespace shvr {

class UhidDevice {
public:
    struct Identity {
        const char *name, *serial;
        uint16_t vendor, product;
        std::span<const uint8_t> descriptor;  ///< report descriptor
    };
    /// `feature`: the answer to a request for a feature report, its number first.
    UhidDevice(const Identity& identity, std::vector<uint8_t> feature);
    ~UhidDevice();  ///< it is unplugged
    bool is_there() const { return descriptor_ >= 0; }

    /// An input report, its number first.
    void send(std::span<const uint8_t> report);
    uint32_t outputs() const { return outputs_; }
    /// The last output report.
    std::array<uint8_t, 17> last() const;

private:
    void tell(const uhid_event& event);
    void run();  ///< its thread answers the kernel

    std::vector<uint8_t> feature_;
    int descriptor_;
    std::atomic<bool> is_running_{true};
    std::atomic<uint32_t> outputs_{0};
    std::array<std::atomic<uint8_t>, 17> last_{};
    std::thread thread_;
};

}  // namespace shvr
