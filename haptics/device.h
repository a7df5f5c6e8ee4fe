#pragma once
// What every haptic device is to the servo: a place that is read and a force that is written, in SI units and in the
// device's own frame (+x right, +y up, +z towards the user). Units of reports and of models are converted behind it.
//
// The servo's thread calls read() and write(), and nothing else does. Both return at once (a device that blocks has
// threads of its own), neither throws, allocates, locks or logs.

#include <cstdint>

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

#include "engine/base/finite.h"

namespace shvr {

inline constexpr uint32_t PAINT_BUTTON = 1u << 0;
inline constexpr uint32_t MOVE_BUTTON = 1u << 1;  ///< moves the volume

struct DeviceState {
    uint64_t time_ns = 0;         ///< when the device was there, by its own steady clock: only differences count
    uint32_t sequence = 0;        ///< of this state, counting up; a gap means lost states
    uint32_t force_sequence = 0;  ///< of the force in effect then
    glm::dvec3 position_m{0.0};
    glm::dquat rotation{1.0, 0.0, 0.0, 0.0};
    uint32_t buttons = 0;  ///< a set of PAINT_BUTTON and MOVE_BUTTON
    uint32_t jump = 0;     ///< when it changes the device was put there at once (simulated ones): no glitch
    bool calibrated = true;
};

struct DeviceCaps {
    glm::dvec3 usable_lower_m{-0.08, -0.06, -0.035};  ///< the workspace
    glm::dvec3 usable_upper_m{0.08, 0.06, 0.035};
    double peak_force_n = 3.3;
    double continuous_force_n = 0.88;
    double stiffness_limit = 400.0;  ///< N/m, stable at the device's latency (two ticks)
    double latency_s = 0.002;
    bool senses_rotation = false;
    bool outputs_force = false;
};

enum class ReadResult : uint8_t {
    fresh,      ///< a new state
    stale,      ///< nothing new since the last read; the state is left alone
    lost,       ///< the device is gone
    malformed,  ///< it sent what its profile does not describe; the state is left alone
};

class HapticDevice {
public:
    virtual ~HapticDevice() = default;
    virtual DeviceCaps caps() const noexcept = 0;
    virtual ReadResult read(DeviceState& state) noexcept = 0;
    /// The force on the hand from now on. False where the device is gone.
    virtual bool write(const glm::dvec3& force_n, uint32_t sequence) noexcept = 0;
};

}  // namespace shvr
