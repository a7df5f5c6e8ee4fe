#pragma once
// A device without hardware: a hand that is drawn towards a target position (the wish) and yields to forces. The mouse
// is such a device (the wish is where it points, and the hand has no mass), as is the modelled hand of the tests (100
// g, 150 N/m, 3 N s/m).
//
//   m x'' = k_hand (wish - x) - b_hand x' + F
//
// With mass 0 the hand settles at wish + F / k_hand with the time constant b_hand / k_hand: assistance eases the probe
// towards the proxy and never throws it. Forces take effect `delay_ticks` reads after they were written, as on a real
// link.
//
// read() and write(): the servo's thread. One other thread may write `wish()`.

#include <array>
#include <cstdint>

#include <glm/glm.hpp>

#include "engine/base/latest.h"
#include "haptics/device.h"

namespace shvr {

struct HandWish {
    glm::dvec3 position_m{0.0};
    uint32_t buttons = 0;
    uint32_t jump = 0;  ///< a change moves the hand to the wish at once; this is no motion of the user
};

struct HandModel {
    double mass_kg = 0.0;
    double stiffness = 75.0;  ///< N/m
    double damping = 0.75;    ///< N s/m
    int delay_ticks = 0;      ///< 0 ... 8
    double tick_s = 0.001;
};
inline constexpr HandModel MOUSE_HAND{};
inline constexpr HandModel MODELLED_HAND{.mass_kg = 0.1, .stiffness = 150.0, .damping = 3.0, .delay_ticks = 2};

class SimulatedDevice : public HapticDevice {
public:
    explicit SimulatedDevice(const HandModel& model = MOUSE_HAND);
    Latest<HandWish>& wish() { return wish_; }

    /// A hand with a mass stands for a device with motors. The mouse has no motors, although forces move its hand.
    DeviceCaps caps() const noexcept override;
    /// Advances the hand by one tick. The result is always `fresh`; `time_ns` counts ticks.
    ReadResult read(DeviceState& state) noexcept override;
    bool write(const glm::dvec3& force_n, uint32_t sequence) noexcept override;

private:
    HandModel model_;
    Latest<HandWish> wish_;
    glm::dvec3 position_m_{0.0}, velocity_{0.0};
    uint32_t jump_ = 0;
    uint64_t ticks_ = 0;
    struct Written {
        glm::dvec3 force_n{0.0};
        uint32_t sequence = 0;
    };
    /// Maps the hand's offset from its rest position, and the hand's velocity, to their values one tick later.
    glm::dmat2 propagator_{1.0};
    std::array<Written, 9> in_flight_{};  ///< ring of delayed forces
};

}  // namespace shvr
