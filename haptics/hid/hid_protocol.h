#pragma once
// Decodes and encodes reports as a profile describes them. Pure, without allocation; any thread.
//
// Bytes are laid out as in hidapi: a numbered report begins with its id; an unnumbered one (id 0) is read without an id
// byte and written with a leading 0.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "haptics/hid/hid_profile.h"

namespace shvr {

/// The contents of an input report, in the axes of `HapticDevice`; values that the report does not contain are null.
/// Counters are raw: `Unwrapped` extends them.
struct HidInput {
    std::optional<glm::dvec3> position_m;
    std::optional<glm::dquat> rotation;
    std::optional<glm::dvec3> rate, turn_rate;  ///< fractions of full deflection, before dead zone, gain and curve
    std::optional<uint32_t> buttons;
    std::optional<bool> calibrated;
    std::optional<uint32_t> sequence, force_sequence, time;
};
/// Returns null if id and length of the report match none of the profile's input reports.
std::optional<HidInput> decode(const HidProfile& profile, std::span<const uint8_t> report);
/// Returns whether the profile lists this kind of report among those to ignore.
bool is_ignored(const HidProfile& profile, std::span<const uint8_t> report);
/// Applies dead zone, gain and curve to a deflection. Returns the speed as a fraction of full speed, length at most 1.
glm::dvec3 shaped(const HidRate& rate, const glm::dvec3& deflection);

struct HidBytes {
    std::array<uint8_t, 1 + MAX_REPORT_BYTES> bytes{};
    size_t size = 0;
    std::span<const uint8_t> span() const { return {bytes.data(), size}; }
};
/// Returns the output report for a force in the axes of `HapticDevice`, clamped to the profile's peak. The force is 0
/// and the enable flag off if not `enabled` or if the force is not finite. Empty if the profile has no output report.
HidBytes encode(const HidProfile& profile, const glm::dvec3& force_n, uint32_t sequence, bool enabled);

/// Returns the profile's limits, except where the device's feature report states a weaker force, a smaller workspace or
/// a longer latency. Returns the profile's own limits if `report` is not the profile's feature report.
DeviceCaps decode_feature(const HidProfile& profile, std::span<const uint8_t> report);

/// Extends a counter of 1 to 32 bits past its overflows. A step of more than half the counter's range counts as a step
/// backwards, such as a restart.
class Unwrapped {
public:
    explicit Unwrapped(uint32_t bits) : mask_(bits >= 32 ? ~uint32_t{0} : (uint32_t{1} << bits) - 1) {}
    uint64_t next(uint32_t raw);

private:
    uint32_t mask_;
    bool has_last_ = false;
    uint64_t last_ = 0;
};

}  // namespace shvr
