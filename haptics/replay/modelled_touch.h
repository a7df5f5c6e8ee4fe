#pragma once
// A model of a Touch in a hand, for tests and replay: an arm with mass and friction, held by a hand that is drawn
// towards a target position (the wish).
//
//   (m_arm + m_hand) x'' = k_hand (wish - x) - (b_hand + b_arm) x' + F - friction
//
// The servo sees its position quantized to counts, delayed, and at jittered times. Figures:
//   arm      45 g, 0.26 N friction when moved by hand, 0.055 mm per count, 3.3 N peak, 0.88 N continuous: from the
//            maker's data sheet of the Touch, not measured by us. 0.05 N s/m viscous is a guess that changes little.
//   delay    2 ticks: a report in and a report out over USB, each up to 1 ms; jitter 0.5 ms either way
//   hand     100 g, 150 N/m, 3 N s/m: a hand that holds a pen loosely
// Between two reads the arm moves in steps of 0.05 ms; friction blocks motion up to its limit. The same seed and writes
// give the same positions, bit for bit.
//
// read() and write(): one thread. Another thread may write `wish()`. Never allocates.

#include <array>
#include <cstdint>
#include <random>

#include "engine/base/latest.h"
#include "haptics/device.h"
#include "haptics/simulated_device.h"

namespace shvr {

struct TouchModel {
    double arm_kg = 0.045;
    double coulomb_n = 0.26;
    double viscous = 0.05;   ///< N s/m
    double count_m = 55e-6;  ///< 0: not rounded
    double peak_n = 3.3;
    int delay_ticks = 2;       ///< 0 ... 8
    double jitter_s = 0.0005;  ///< jitter in either direction, at most half a tick
    double tick_s = 0.001;
    double hand_kg = 0.1;
    double hand_stiffness = 150.0;  ///< N/m; 0: not held
    double hand_damping = 3.0;      ///< N s/m
    uint32_t seed = 1;
};

class ModelledTouch : public HapticDevice {
public:
    explicit ModelledTouch(const TouchModel& model = {});
    Latest<HandWish>& wish() { return wish_; }
    /// Sets the arm's velocity, for tests that throw the arm at objects.
    void set_velocity(const glm::dvec3& velocity) { velocity_ = velocity; }
    const glm::dvec3& true_position_m() const { return position_m_; }
    /// Work done on hand and arm by the device's force, in J. Positive if the force added energy.
    double work_j() const { return work_j_; }

    DeviceCaps caps() const noexcept override;
    /// Advances the model by one tick. The result is always `fresh`.
    ReadResult read(DeviceState& state) noexcept override;
    bool write(const glm::dvec3& force_n, uint32_t sequence) noexcept override;

private:
    void move_on(double seconds, const glm::dvec3& wish_m, const glm::dvec3& force_n);
    double rounded(double metres) const;

    TouchModel model_;
    Latest<HandWish> wish_;
    glm::dvec3 position_m_{0.0}, velocity_{0.0};
    double work_j_ = 0.0;
    uint32_t jump_ = 0;
    uint64_t ticks_ = 0;
    double time_s_ = 0.0;  ///< time of the last read
    std::mt19937 random_;
    struct Written {
        glm::dvec3 force_n{0.0};
        uint32_t sequence = 0;
    };
    std::array<Written, 9> in_flight_{};  ///< ring of delayed forces
};

}  // namespace shvr
