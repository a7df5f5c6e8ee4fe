#pragma once
// Connects the hand to the volume: runs the servo, sends it the voxels near the probe, and tracks the probe's position.
//
//   mouse -> wish -> servo's device -> probe -> mirror -> relevance pass (device) or host's voxels -> bits -> servo
//                         ^-------------------------------------- force <-------------------------------------'
//
// With a haptic device, the servo always runs and only the device moves the probe: its workspace is aligned with the
// view (right, up, towards the user). Without one, the mouse acts as a device held by a hand that has no mass and
// yields to the force: the servo then runs only while assistance is on or the stylus is recorded; otherwise the probe
// is at the mouse, and nothing is computed. A device that moves the view has its own servo, which gives no force, and
// the mouse moves the probe. Main thread; servo and mirror have their own threads, so that a stalled main thread does
// not fade the force.

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
    Camera camera;             ///< the view's camera, with which a device's workspace is aligned
    double view_height = 1.0;  ///< height in physical units, at the target
    double scale = 1.0;        ///< scale of a device's motion; at 1, its reach is the height of the view
    bool lets_go = false;
    std::shared_ptr<const VolumeSource> source{};  ///< without offsets
    const DensityField* offsets = nullptr;         ///< offsets and mask are read only if `voxels` changed
    const Mask* mask = nullptr;
    uint64_t voxels = 0;  ///< counts changes of both
};

class Touch {
public:
    /// The mouse moves the probe until use() is called.
    explicit Touch(Renderer& renderer);
    /// Makes `device` move the probe or, if `moves_view`, the view; null: the mouse moves the probe.
    void use(std::shared_ptr<HapticDevice> device, bool moves_view = false);

    /// Moves the probe at once; `point` is in physical units of the volume.
    void place(const glm::dvec3& point);
    /// Sets the position to which the hand wants to move the probe.
    void wish(const glm::dvec3& point);
    /// Receives state from the servo and the device, and sends settings, wishes and relevance.
    void advance(const TouchSettings& settings);
    /// Drops pending requests to the graphics device.
    void drop_queries() { relevance_.drop(), asked_.reset(); }

    /// Starts recording with the next frame. Restarts the servo, so that a replay starts in the same state.
    void begin_recording(const std::filesystem::path& path);
    /// Returns null while nothing is recorded.
    const StylusRecorder* recorder() const { return recorder_.get(); }
    /// Ends the recording and returns it. Fails if nothing was recorded.
    Trace end_recording();

    glm::dvec3 probe() const { return probe_; }
    /// Returns null while no servo moves the probe.
    const ServoState* servo() const { return servo_ ? &state_ : nullptr; }
    /// Returns the state of the device that moves the view; null if there is no such device.
    const ServoState* puck() const { return puck_ ? &puck_state_ : nullptr; }
    const TapState& tap() const { return tap_; }
    bool is_realtime() const;
    const std::shared_ptr<HapticDevice>& device() const { return device_; }
    bool is_mouse() const { return !device_ || moves_view_; }
    /// Returns the device's buttons, as the servo last read them; 0 for the mouse.
    uint32_t buttons() const;
    /// Milliseconds from requesting relevance on the GPU until the servo receives it; newest last.
    const std::vector<double>& mirror_ms() const { return mirror_ms_; }
    double relevance_age_ms() const;
    /// Returns why voxels around the probe could not be read, in a sentence; empty: no failure.
    std::string trouble() const { return mirror_ ? mirror_->trouble() : std::string(); }
    double relevance_gpu_ms() const { return relevance_gpu_ms_; }
    /// Returns the last state of the most recent servo that moved the probe, for reports.
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
    bool awaits_relevance_ = false;  ///< in a recording, guidance starts once relevance has arrived
    bool was_assisting_ = false;
    uint32_t resets_ = 0;
    uint32_t jumps_ = 0;
    std::optional<TapOrder> sent_;
    TouchPlane plane_ = TouchPlane::none;
    glm::dvec3 on_plane_{0.0};  ///< a point on the plane that constrains the probe, in physical units
    uint32_t planes_ = 0;
    glm::dvec3 wish_{0.0}, probe_{0.0};
    ServoState state_, puck_state_;
    TapState tap_;
    double relevance_gpu_ms_ = 0.0;
    std::vector<double> mirror_ms_;
};

}  // namespace shvr::ui
