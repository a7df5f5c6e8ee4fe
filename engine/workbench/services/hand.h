#pragma once
// Uses a haptic device: moves the probe, the view and the volume with it, follows its buttons, and records its motion.

#include <set>

#include "engine/workbench/desk/preference_keeper.h"
#include "engine/workbench/desk/service.h"
#include "engine/workbench/models/hand_view.h"

namespace shvr::ui {

class Hand : public Service {
public:
    /// Functions of other services that it calls.
    struct Others {
        Call<void(const Camera&)> look_from;
        Call<void(const glm::dvec3& point, bool jumps)> move_probe;
        Call<void(const PaintOp&)> paint;
        Call<void(const TraceOp&)> trace;
        Call<std::filesystem::path()> stem;  ///< returns the start of the names of files next to the session
    };
    Hand(Desk& desk, PreferenceKeeper& keeper, Others others);
    void act(const LetGo& action);
    void act(const GrabVolume& action);
    void act(const UseDevice& action);
    void act(const FindDevices& action);
    void act(const CalibrateDevice& action);
    void act(const RecordStylus& action);
    void act(const StopRecording& action);
    void act(const FollowStylus& action);

    void advance() override;
    /// Makes this device move the probe, whatever other devices are connected; its first button paints.
    void use_device(std::shared_ptr<HapticDevice> device, const std::string& name);
    TouchedModel model() const;

private:
    TouchSettings touch_settings() const;
    void follow_touch();
    void follow_devices();
    void follow_puck();
    void follow_grab();
    void follow_buttons(uint32_t buttons);
    void choose_device();
    void take_device(std::shared_ptr<HapticDevice> device, const DeviceListing& row);
    void leave_device();
    const DeviceListing* wanted_device() const;
    void note_hand();
    void finish_recording();
    void follow_points(const std::vector<StylusPoint>& points, double node_every);

    PreferenceKeeper& keeper_;
    const Others others_;
    std::unique_ptr<DeviceWatch> watch_;    ///< null: no search for devices
    std::shared_ptr<HapticDevice> device_;  ///< null: none is open
    HandView hand_;
    std::set<std::string> refused_;  ///< ids of devices that failed to open and that the user has not requested again
    bool is_given_device_ = false;   ///< the caller supplied the device
    double look_again_s_ = 0.0, puck_at_s_ = 0.0;
    std::optional<Grab> grab_;
    uint32_t buttons_ = 0;  ///< stylus buttons in the last step
    double buttons_at_s_ = 0.0;
    Attempt touching_;
};

}  // namespace shvr::ui
