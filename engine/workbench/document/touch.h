#pragma once
// Connects the hand to the volume: runs the servo, sends it the voxels near the probe, and tracks the probe's position.
//
//   mouse -> wish -> servo's device -> probe -> mirror -> relevance pass (device) or host's voxels -> bits -> servo
//                         ^-------------------------------------- force <-------------------------------------'
//
// With a haptic device, the servo always runs and only the device moves the probe: its workspace is aligned with the
// view (right, up, towards the user). Without one, the mouse acts as a device held by a hand that has no mass and
// yields to the force: the servo then runs only while assistance is on or the stylus is recorded; otherwise the probe
// is at the mouse, and nothing is computed. A device that moves the view has its own servo, which exerts no force, and
// the mouse moves the probe. Main thread; servo and mirror have their own threads, so that a stalled main thread does
// not make the force fade.

#include <memory>
#include <string>

#include "engine/annotation/work/work.h"
#include "engine/live/relevance_mirror.h"
#include "engine/workbench/touch/stylus_motion.h"
#include "engine/workbench/touch/stylus_player.h"
#include "engine/workbench/touch/stylus_recorder.h"

namespace shvr::ui {

struct TouchSettings {
    GuideSettings guide;
    Camera camera;             ///< the view's camera, to which the device's workspace is aligned
    double view_height = 1.0;  ///< height of the view in physical units, at the target
    double scale = 1.0;        ///< scale of the device's motion; at 1, its range covers the view's height
    bool lets_go = false;
    std::shared_ptr<const VolumeSource> source{};  ///< without offsets
    const DensityField* offsets = nullptr;         ///< offsets and mask are read only if `voxels` changed
    const Mask* mask = nullptr;
    uint64_t voxels = 0;  ///< counts changes of both
};

class Touch {
public:
    /// Initially, the mouse moves the probe; see use().
    explicit Touch(Renderer& renderer);
    /// Makes `device` move the probe or, if `moves_view` is set, the view. Null: the mouse moves the probe again.
    void use(std::shared_ptr<HapticDevice> device, bool moves_view = false);

    /// Moves the probe at once. `point` is in the volume's physical units.
    void place(const glm::dvec3& point);
    /// Sets the position to which the mouse asks to move the probe.
    void wish(const glm::dvec3& point);
    /// Takes new state from the servo and the device, and sends them settings, wishes and relevance.
    void advance(const TouchSettings& settings);
    /// Drops pending requests to the graphics device.
    void drop_queries() { relevance_.drop(), asked_.reset(); }

    /// Starts recording at the next frame. Restarts the servo, so that a replay can begin in the same state.
    void begin_recording(const std::filesystem::path& path);
    /// Returns null while nothing is recorded.
    const StylusRecorder* recorder() const { return recorder_.get(); }
    /// Ends the recording and returns it. Fails if it is empty.
    Trace end_recording();

    glm::dvec3 probe() const { return probe_; }
    /// Returns null while no servo is running that moves the probe.
    const ServoState* servo() const { return servo_ ? &state_ : nullptr; }
    /// Returns the state of the device that moves the view; null if no device does.
    const ServoState* puck() const { return puck_ ? &puck_state_ : nullptr; }
    const TapState& tap() const { return tap_; }
    bool is_realtime() const;
    const std::shared_ptr<HapticDevice>& device() const { return device_; }
    bool is_mouse() const { return !device_ || moves_view_; }
    /// Returns the device's buttons, as last read by the servo; 0 if the mouse moves the probe.
    uint32_t buttons() const;
    /// Returns the times, in milliseconds, from requesting relevance on the GPU until the servo had it; newest last.
    const std::vector<double>& mirror_ms() const { return mirror_ms_; }
    double relevance_age_ms() const;
    /// Returns, as a sentence, why voxels around the probe could not be read; empty if they could.
    std::string trouble() const { return mirror_ ? mirror_->trouble() : std::string(); }
    double relevance_gpu_ms() const { return relevance_gpu_ms_; }
    /// Returns the last state of the last servo that moved the probe, even if it no longer runs; for reports.
    const ServoState& last_state() const { return state_; }

private:
    void start(std::shared_ptr<HapticDevice> device);
    void start_mouse();
    void stop_mouse();
    void send_wish(bool jump);
    void send_settings(const TouchSettings& settings);
    void hold_to_plane(const TouchSettings& settings);
    void choose(const TouchSettings& settings);
    void ask();
    void stop();
    void receive();
    void follow_servo(const glm::dvec3& point);
    double finest_spacing() const;
    Workspace workspace(const TouchSettings& settings) const;

    Renderer& renderer_;
    Relevance relevance_;
    std::shared_ptr<HapticDevice> device_;  ///< null: none
    bool moves_view_ = false;
    std::unique_ptr<TappedServo> servo_, puck_;
    std::unique_ptr<RelevanceMirror> mirror_;  ///< the running servo's; ends before it
    RelevanceChoice chosen_;
    uint64_t annotation_ = 0;                       ///< TouchSettings::voxels in `chosen_`
    std::optional<RelevanceMirror::Wanted> asked_;  ///< pending request to the graphics device
    SimulatedDevice* mouse_ = nullptr;              ///< the servo's device while the mouse moves the probe; else null
    std::unique_ptr<StylusRecorder> recorder_;
    uint32_t recordings_ = 0;
    bool awaits_relevance_ = false;  ///< while recording starts, guidance waits for the first relevance
    bool was_assisting_ = false;
    uint32_t resets_ = 0;
    uint32_t jumps_ = 0;
    std::optional<TapOrder> sent_;
    TouchPlane plane_ = TouchPlane::none;
    glm::dvec3 on_plane_{0.0};  ///< a point in the plane that constrains the probe, in physical units
    uint32_t planes_ = 0;
    glm::dvec3 wish_{0.0}, probe_{0.0};
    ServoState state_, puck_state_;
    TapState tap_;
    double relevance_gpu_ms_ = 0.0;
    std::vector<double> mirror_ms_;
};

}  // namespace shvr::ui
