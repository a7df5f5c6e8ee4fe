#pragma once
// Connects the hand to the volume: runs the servo, tells it which voxels are relevant, and knows where the probe is.
//
//   mouse -> wish -> servo's device -> probe -> mirror -> relevance pass (device) or host's voxels -> bits -> servo
//                         ^-------------------------------------- force <-------------------------------------'
//
// With a haptic device the servo always runs, and only the device moves the probe: its workspace is aligned with the
// view (right, up, towards the user). Otherwise the mouse acts as a device whose hand has no mass and yields to the
// force: the servo runs only while assistance is on; when it is off, the probe is where the mouse puts it and nothing
// is computed. Main thread; servo and mirror have threads of their own, so that a main thread that hangs fades nothing.

#include <memory>
#include <string>

#include "engine/live/relevance_mirror.h"
#include "engine/look/camera_motion.h"
#include "haptics/servo.h"
#include "haptics/simulated_device.h"

namespace shvr::ui {

struct TouchSettings {
    bool assistance = false;
    double threshold = 0.0;     ///< intensity
    double probe_radius = 1.0;  ///< physical units
    ProxyLaw law = ProxyLaw::potential;
    CameraAxes axes;  ///< of the view: they place a device's workspace
    glm::dvec3 target{0.0};
    double view_height = 1.0;                      ///< physical units, at the target
    double scale = 1.0;                            ///< of a device's moves; 1: its reach is the height of the view
    std::shared_ptr<const VolumeSource> source{};  ///< without offsets
    const DensityField* offsets = nullptr;         ///< these two are looked at where `voxels` changed
    const Mask* mask = nullptr;
    uint64_t voxels = 0;                       ///< counts changes of both
    std::optional<std::bitset<256>> groups{};  ///< only what is painted so is felt; null: all
};

class Touch {
public:
    /// The mouse moves the probe until use() is called.
    explicit Touch(Renderer& renderer);
    /// From now on `device` moves the probe, and the servo runs.
    void use(std::unique_ptr<HapticDevice> device, const std::string& name);

    /// Moves the probe at once (physical units of the volume).
    void place(const glm::dvec3& point);
    /// Sets where the hand wants the probe.
    void wish(const glm::dvec3& point);
    /// Receives from the servo and the device, and sends what they need.
    void advance(const TouchSettings& settings);
    /// Forgets what the graphics device was asked.
    void drop_queries() { relevance_.drop(), asked_.reset(); }

    glm::dvec3 probe() const { return probe_; }
    /// Null while no servo runs.
    const ServoState* servo() const { return servo_ ? &state_ : nullptr; }
    const std::string& device_name() const { return device_name_; }
    bool is_mouse() const { return is_mouse_; }
    /// Of the device, as the servo read them last; 0 for the mouse.
    uint32_t buttons() const { return is_mouse_ ? 0 : state_.device.buttons; }
    /// Milliseconds from requesting relevance on the GPU until the servo has it; newest last.
    const std::vector<double>& mirror_ms() const { return mirror_ms_; }
    double relevance_age_ms() const;
    /// Why voxels around the probe could not be read, a sentence; empty: they could.
    std::string trouble() const { return mirror_ ? mirror_->trouble() : std::string(); }
    double relevance_gpu_ms() const { return relevance_gpu_ms_; }
    /// The last state of the servo that ran, for reports.
    const ServoState& last_state() const { return state_; }

private:
    void start_mouse();
    void send_wish(bool jump);
    void send_settings(const TouchSettings& settings);
    void start_servo(std::unique_ptr<HapticDevice> device);
    void choose(const TouchSettings& settings);
    void ask();
    Workspace mouse_workspace() const;
    static Workspace device_workspace(const TouchSettings& settings);

    Renderer& renderer_;
    Relevance relevance_;
    bool is_mouse_ = true;
    std::string device_name_ = "mouse";
    std::unique_ptr<Servo> servo_;
    std::unique_ptr<RelevanceMirror> mirror_;  ///< of the servo, while it runs; ends before it
    RelevanceChoice chosen_;
    std::optional<RelevanceMirror::Wanted> asked_;  ///< of the device
    SimulatedDevice* mouse_ = nullptr;              ///< owned by the servo while it runs
    bool was_assisting_ = false;
    uint32_t resets_ = 0;
    uint32_t jumps_ = 0;
    glm::dvec3 wish_{0.0}, probe_{0.0};
    ServoState state_;
    double relevance_gpu_ms_ = 0.0;
    std::vector<double> mirror_ms_;
};

}  // namespace shvr::ui
