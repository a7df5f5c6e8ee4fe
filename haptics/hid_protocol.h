#pragma once
// Reports as bytes, both ways, by a profile. Pure, without allocation; any thread.
//
// Bytes are as hidapi has them: a numbered report begins with its id; one without a number (id 0) is read without and
// written with a leading 0.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "haptics/hid_profile.h"

namespace shvr {

/// What an input report says. Counters are raw: `Unwrapped` continues them.
struct HidInput {
    glm::dvec3 position_m{0.0};  ///< in our axes
    glm::dquat rotation{1.0, 0.0, 0.0, 0.0};
    uint32_t buttons = 0;
    bool calibrated = true;
    uint32_t sequence = 0, force_sequence = 0, time = 0;
};
/// Nothing where the report is not the profile's input report: another id, or another length.
std::optional<HidInput> decode(const HidProfile& profile, std::span<const uint8_t> report);

struct HidBytes {
    std::array<uint8_t, 1 + MOST_REPORT_BYTES> bytes{};
    size_t size = 0;
    std::span<const uint8_t> span() const { return {bytes.data(), size}; }
};
/// The output report of a force in our axes; longer ones are shortened to the profile's peak. Not enabled, or not a
/// number: zero force with the enable flag off. Empty where the profile has no output report.
HidBytes encode(const HidProfile& profile, const glm::dvec3& force_n, uint32_t sequence, bool enabled);

/// The profile's limits, where the device's feature report names a weaker force, a smaller space or a longer latency
/// those. The profile's own where the report is not the profile's feature report.
DeviceCaps decode_feature(const HidProfile& profile, std::span<const uint8_t> report);

/// A counter of 1 to 32 bits, continued over its overflows. Half of its range back is back, as after a restart.
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
