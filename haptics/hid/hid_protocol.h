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

/// The contents of an input report, in our axes; values it does not contain are null. Counters are raw: `Unwrapped`
/// extends them.
struct HidInput {
    std::optional<glm::dvec3> position_m;
    std::optional<glm::dquat> rotation;
    std::optional<glm::dvec3> rate, turn_rate;  ///< fractions of the full deflection, not yet shaped
    std::optional<uint32_t> buttons;
    std::optional<bool> calibrated;
    std::optional<uint32_t> sequence, force_sequence, time;
};
/// Returns null if the report is not one of the profile's input reports: its id or length differs.
std::optional<HidInput> decode(const HidProfile& profile, std::span<const uint8_t> report);
/// Returns whether the profile says to ignore this kind of report.
bool is_ignored(const HidProfile& profile, std::span<const uint8_t> report);
/// Converts a deflection to a fraction of full speed; finite, length at most 1.
glm::dvec3 shaped(const HidRate& rate, const glm::dvec3& deflection);

struct HidBytes {
    std::array<uint8_t, 1 + MAX_REPORT_BYTES> bytes{};
    size_t size = 0;
    std::span<const uint8_t> span() const { return {bytes.data(), size}; }
};
/// Returns the output report for a force in our axes, clamped to the profile's peak. If not enabled or not finite, the
/// report has zero force and the enable flag off. Empty if the profile has no output report.
HidBytes encode(const HidProfile& profile, const glm::dvec3& force_n, uint32_t sequence, bool enabled);

/// Returns the profile's limits; where the device's feature report states a weaker force, a smaller workspace or a
/// longer latency, that value replaces the profile's. Returns the profile's own if `report` is not its feature report.
DeviceCaps decode_feature(const HidProfile& profile, std::span<const uint8_t> report);

/// Extends a counter of 1 to 32 bits past its overflows. A step of more than half its range counts as a step backwards,
/// such as a restart.
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
