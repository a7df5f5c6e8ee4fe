#pragma once
// Haply's Inverse3, through its maker's service on the local machine: states and forces on one WebSocket, safety events
// on another.
//
//   servo --Latest--> link thread <--socket--> service          servo <--Latest-- link thread
//
// The service answers each message with one state: the link sends when the servo has written, and at most one message
// is in flight. The servo never waits: its side exchanges latest values and wakes the link.
//
// No force is sent unless all of these hold: force is allowed; the event channel is connected; the servo wrote within
// `write_timeout`; the last message was answered within `answer_timeout`; no e-brake, stall or ceiling event was
// received within `hold`. Otherwise a zero force is sent at once. A message that violates the documentation ends the
// connection; `trouble()` says why. A lost connection is retried every 20 ms.

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <string>

#include "haptics/device.h"

namespace shvr {

struct Inverse3Options {
    uint16_t port = 10001, event_port = 10020;
    std::string device_id;  ///< empty: the first one
    bool allow_force = false;
    bool realtime = true;                            ///< SCHED_FIFO for the link's thread, if the system allows it
    std::chrono::milliseconds connect_timeout{300};  ///< timeout of each connection and of the first inventory
    std::chrono::milliseconds write_timeout{12};     ///< short enough for zero force within 20 ms in total
    std::chrono::milliseconds answer_timeout{12};
    std::chrono::milliseconds keep_alive{10};  ///< interval of messages while the servo does not write
    std::chrono::milliseconds hold{1000};      ///< duration of zero force after a stall or a refused message
    uint64_t (*now_ns)() = nullptr;            ///< clock for time stamps of states; null: the steady clock
};

/// Message counts since the link was opened; any thread.
struct Inverse3Counts {
    uint64_t sent = 0, answered = 0, refused = 0, connections = 0;
};

class Inverse3 : public HapticDevice {
public:
    virtual const std::string& device_id() const = 0;
    virtual Inverse3Counts counts() const noexcept = 0;
};

/// Returns null if nothing listens on the port. Fails if the listener is not this service or has no such device. Waits
/// for at most three times `connect_timeout`.
std::unique_ptr<Inverse3> open_inverse3(const Inverse3Options& options);

struct Inverse3Found {
    bool is_service = false;  ///< something listens on the port
    std::string device_id, trouble;
};
/// Returns the device that would be opened, or why there is none. Sends nothing to the device.
Inverse3Found find_inverse3(const Inverse3Options& options);

}  // namespace shvr
