#include "engine/workbench/models/hand_view.h"

#include <sys/resource.h>

#include <algorithm>
#include <cmath>

#include "engine/base/error.h"

namespace shvr::ui {

namespace {

struct FlagText {
    uint32_t flag;
    Weight weight;
    const char* text;
};
// The gravest first.
constexpr FlagText FLAGS[] = {
    {FORCE_FAULT, Weight::error,
     "The device sent an impossible reading, so its force is off for safety. Switch guidance off and on again."},
    {FORCE_NO_DEVICE, Weight::error, "The device does not answer. Check its plug and its power, and its calibration."},
    {FORCE_LET_GO, Weight::warning, "Let go: no force until you switch that off."},
    {FORCE_SLOW, Weight::warning, "The device reports too rarely for a firm touch, so it is softer or off."},
    {FORCE_OUTSIDE, Weight::warning,
     "The stylus is at the edge of its reach, where its force fades. Move back to the middle."},
    {FORCE_NO_REGION, Weight::warning,
     "The region around the probe is not loaded yet, or the probe is too large for touch."},
    {FORCE_WARM, Weight::warning, "The motors are warm, so the force is limited until they have cooled."},
    {FORCE_OFF_OBJECT, Weight::done, "Off the object. The next one that is touched is followed in a moment."},
    {FORCE_CLAMPED, Weight::done, "At the strongest force that the device can give."},
    {FORCE_ENGAGING, Weight::done, "Fading in."},
};

}  // namespace

std::string name_in_words(const std::string& name, const std::string& serial)
{
    return serial.empty() ? name : sentence(name, " (serial ", serial, ")");
}

std::string state_in_words(const DeviceListing& device, const HandView& hand)
{
    const bool is_mouse = device.kind == DeviceKind::mouse;
    if (device.id == hand.opening) return "is being opened";
    if (device.id == hand.in_use) return hand.moves_probe ? "moves the probe" : "moves the view";
    if (is_mouse && !hand.moves_probe) return "moves the probe";
    if (!device.why_unusable.empty()) return device.why_unusable;
    if (is_mouse) return "always there";
    if (device.has_force) return "can push the hand";
    return device.why_no_force.empty() ? "gives no force" : "gives no force: " + device.why_no_force;
}

std::vector<Finding> findings_of(const HandView& hand, const ServoState& servo, bool is_guided)
{
    std::vector<Finding> findings;
    if (!hand.trouble.empty()) findings.push_back({Weight::error, hand.trouble});
    if (hand.moves_probe && !servo.device.calibrated)
        findings.push_back(
            {Weight::error, "The device is not calibrated: put the stylus into its holder, then press Calibrate."});
    for (const FlagText& flag : FLAGS) {
        const bool is_of_device = flag.flag == FORCE_FAULT || flag.flag == FORCE_NO_DEVICE;
        if ((servo.step.flags & flag.flag) && (is_guided || is_of_device)) findings.push_back({flag.weight, flag.text});
    }
    if (hand.moves_probe && is_guided && !servo.caps.outputs_force)
        findings.push_back({Weight::done, "This device gives no force; the probe alone shows what is touched."});
    return findings;
}

std::string rhythm_in_words(const ServoState& servo)
{
    if (servo.ticks == 0) return "not running yet";
    const double late = 100.0 * double(servo.late_ticks) / double(servo.ticks);
    return sentence(servo.ticks, " steps, ", std::round(100.0 * late) / 100.0, " % of them late");
}

Finding realtime_in_words(bool is_realtime, uint64_t allowed_priority)
{
    if (is_realtime) return {Weight::done, "real-time priority: yes"};
    if (allowed_priority == 0)
        return {Weight::warning,
                "real-time priority: no, since this system allows it only to its administrator. The force may stutter "
                "while the computer is busy; \"rtprio\" in /etc/security/limits.conf allows it."};
    return {Weight::warning,
            sentence("real-time priority: no, since this system allows priority ", allowed_priority,
                     " and the servo asked for more. The force may stutter while the computer is busy.")};
}

uint64_t allowed_realtime_priority()
{
    rlimit limit{};
    return ::getrlimit(RLIMIT_RTPRIO, &limit) == 0 ? uint64_t(limit.rlim_cur) : 0;
}

std::string heat_in_words(double heat, const DeviceCaps& caps)
{
    if (!caps.outputs_force) return {};
    const char* const word = heat < 0.5 ? "cool" : heat < 0.95 ? "warm" : "hot";
    return sentence(word, ", ", std::round(100.0 * heat), " % of the motors' continuous limit");
}

std::vector<float> plot_of(const TapState& tap)
{
    std::vector<float> bars(tap.force_n.begin(), tap.force_n.end());
    std::ranges::rotate(bars, bars.begin() + std::ptrdiff_t(tap.bars % TapState::BARS));
    return bars;
}

}  // namespace shvr::ui
