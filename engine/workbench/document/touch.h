#pragma once
// Connects the hand to the volume: runs the servo, tells it which voxels are relevant, and knows where the probe is.
//
//   mouse -> wish -> servo's device -> probe -> mirror -> relevance pass (device) or host's voxels -> bits -> servo
//                         ^-------------------------------------- force <-------------------------------------'
//
// With a haptic device the servo always runs, and only the device moves the probe: its workspace is aligned with the
// view (right, up, towards the user). Otherwise the mouse acts as a device whose hand has no mass and yields to the
// force: the servo runs only while assistance is on or the stylus is recorded; otherwise the probe is where the mouse
// puts it and nothing is computed. A device that moves the view has a servo of its own that gives no force, and the
// mouse moves the probe. Main thread; servo and mirror have threads of their own, so that a main thread that hangs
// fades nothing.

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
    Camera camera;             ///< of the view: it places a device's workspace
    double view_height = 1.0;  ///< physical units, at the target
    double scale = 1.0;        ///< of a device's moves; 1: its reach is the height of the view
    bool lets_go = false;
    std::shared_ptr<const VolumeSource> source{};  ///< without offsets
    const DensityField* offsets = nullptr;         ///< these two are looked at where `voxels` changed
    const Mask* mask = nullptr;
    uint64_t voxels = 0;  ///< counts changes of both
};

class Touch {
public:
    /// The mouse moves the probe until use() is called.
    explicit Touch(Renderer& renderer);
    /// From now on `device` moves the probe, or the view; null: the mouse does.
    void use(std::shared_ptr<HapticDevice> device, bool moves_view = false);

    /// Moves the probe at once (physical units of the volume).
    void place(const glm::dvec3& point);
    /// Sets where the hand wants the probe.
    void wish(const glm::dvec3& point);
    /// Receives from the servo and the device, and sends what they need.
    void advance(const TouchSettings& settings);
    /// Forgets what the graphics device was asked.
    void drop_queries() { relevance_.drop(), asked_.reset(); }

    /// Records from the next turn on: the servo begins anew, so that a replay begins as it does.
    void begin_recording(const std::filesystem::path& path);
    /// Null while nothing is recorded.
    const StylusRecorder* recorder() const { return recorder_.get(); }
    /// Ends it. Fails where nothing was recorded.
    Trace end_recording();

    glm::dvec3 probe() const { return probe_; }
    /// Null while no servo moves the probe.
    const ServoState* servo() const { return servo_ ? &state_ : nullptr; }
    /// Of the device that moves the view; null without one.
    const ServoState* puck() const { return puck_ ? &puck_state_ : nullptr; }
    const TapState& tap() const { return tap_; }
    bool is_realtime() const;
    const std::shared_ptr<HapticDevice>& device() const { return device_; }
    bool is_mouse() const { return !device_ || moves_view_; }
    /// Of the device, as the servo read them last; 0 for the mouse.
    uint32_t buttons() const;
    /// Milliseconds from requesting relevance on the GPU until the servo has it; newest last.
    const std::vector<double>& mirror_ms() const { return mirror_ms_; }
    double relevance_age_ms() const;
    /// Why voxels around the probe could not be read, a sentence; empty: they could.
    std::string trouble() const { return mirror_ ? mirror_->trouble() : std::string(); }
    double relevance_gpu_ms() const { return relevance_gpu_ms_; }
    /// The last state of the servo that ran, for reports.
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
    Workspace workspace(const TouchSettings& settings) const;

    Renderer& renderer_;
    Relevance relevance_;
    std::shared_ptr<HapticDevice> device_;  ///< null: none
    bool moves_view_ = false;
    std::unique_ptr<TappedServo> servo_, puck_;
    std::unique_ptr<RelevanceMirror> mirror_;  ///< of the servo, while it runs; ends before it
    RelevanceChoice chosen_;
    std::optional<RelevanceMirror::Wanted> asked_;  ///< of the device
    SimulatedDevice* mouse_ = nullptr;              ///< the servo's device while the mouse is
    std::unique_ptr<StylusRecorder> recorder_;
    uint32_t recordings_ = 0;
    bool awaits_relevance_ = false;  ///< a recording begins to guide once there is some
    bool was_assisting_ = false;
    uint32_t resets_ = 0;
    uint32_t jumps_ = 0;
    std::optional<TapOrder> sent_;
    TouchPlane plane_ = TouchPlane::none;
    glm::dvec3 on_plane_{0.0};  ///< physical: a point of it
    uint32_t planes_ = 0;
    glm::dvec3 wish_{0.0}, probe_{0.0};
    ServoState state_, puck_state_;
    TapState tap_;
    double relevance_gpu_ms_ = 0.0;
    std::vector<double> mirror_ms_;
};

}  // namespace shvr::ui
