#pragma once
// A haptic device as the servo sees it: it reads a position and writes a force, in SI units and in the device's own
// frame (+x right, +y up, +z towards the user). Implementations convert the units of their reports or models.
//
// Only the servo's thread calls read() and write(). Both return at once (a device with blocking calls runs them on its
// own threads); neither throws, allocates, locks or logs.

#include <cstdint>

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

#include "engine/base/finite.h"

namespace shvr {

inline constexpr uint32_t PAINT_BUTTON = 1u << 0;
inline constexpr uint32_t MOVE_BUTTON = 1u << 1;  ///< moves the volume

inline constexpr double MAX_REACH_M = 10.0;  ///< no device reaches farther from its origin along any axis

struct DeviceState {
    uint64_t time_ns = 0;         ///< position's time on the device's own steady clock; only differences are meaningful
    uint32_t sequence = 0;        ///< counts states; a gap means lost states
    uint32_t force_sequence = 0;  ///< number of the force (as passed to write()) that was in effect at `time_ns`
    glm::dvec3 position_m{0.0};
    glm::dquat rotation{1.0, 0.0, 0.0, 0.0};
    uint32_t buttons = 0;  ///< a set of PAINT_BUTTON and MOVE_BUTTON
    uint32_t jump = 0;     ///< changes when a simulated device is repositioned: such a jump is not rejected as a glitch
    bool calibrated = true;
    /// For devices that report speeds (`DeviceCaps::rate_control`): speeds along and about the axes above, as fractions
    /// of full deflection, -1 ... 1. Speeds may move the view; position and rotation are their integrals over time.
    glm::dvec3 rate{0.0}, turn_rate{0.0};
};

struct DeviceCaps {
    glm::dvec3 usable_lower_m{-0.08, -0.06, -0.035};  ///< corner of the box in which the device's forces are accurate
    glm::dvec3 usable_upper_m{0.08, 0.06, 0.035};
    double peak_force_n = 3.3;
    double continuous_force_n = 0.88;
    double stiffness_limit = 400.0;  ///< N/m, stable at the device's latency (two ticks)
    double latency_s = 0.002;
    bool senses_rotation = false;
    bool outputs_force = false;
    bool tells_force_sequence = false;  ///< states report the force in effect; if not, `latency_s` determines it
    bool rate_control = false;          ///< the device reports speeds, not positions; no report means rest
    bool operator==(const DeviceCaps&) const = default;
};

enum class ReadResult : uint8_t {
    fresh,      ///< a new state
    stale,      ///< no new state since the last read; `state` is left unchanged
    lost,       ///< the device is gone
    malformed,  ///< the device sent a report that its profile does not describe; `state` is left unchanged
};

class HapticDevice {
public:
    virtual ~HapticDevice() = default;
    virtual DeviceCaps caps() const noexcept = 0;
    virtual ReadResult read(DeviceState& state) noexcept = 0;
    /// Sets the force on the hand until the next call. Returns false if the device is gone.
    virtual bool write(const glm::dvec3& force_n, uint32_t sequence) noexcept = 0;
    /// Returns why the device is lost or gives no force, as a sentence in static storage; "" if it works. Any thread.
    virtual const char* trouble() const noexcept { return ""; }
};

}  // namespace shvr
