#include "haptics/hid/hid_protocol.h"

#include <algorithm>
#include <cmath>

namespace shvr {
namespace {

uint32_t raw_of(const HidField& field, std::span<const uint8_t> payload)
{
    uint64_t bits = 0;  // 64 bits, since a field of 32 bits that is not byte-aligned spans 5 bytes
    const size_t first = field.bit / 8, last = (field.bit + field.bits - 1) / 8;
    for (size_t byte = first; byte <= last; ++byte) bits |= uint64_t(payload[byte]) << (8 * (byte - first));
    return uint32_t((bits >> (field.bit % 8)) & ((uint64_t{1} << field.bits) - 1));
}

double value_of(const HidField& field, std::span<const uint8_t> payload)
{
    const uint32_t raw = raw_of(field, payload);
    const bool is_negative = field.is_signed && (raw >> (field.bits - 1) & 1u);
    const double value = double(raw) - (is_negative ? std::ldexp(1.0, int(field.bits)) : 0.0);
    return value * field.scale + field.offset;
}

void put_raw(const HidField& field, uint32_t raw, std::span<uint8_t> payload)
{
    for (uint32_t i = 0; i < field.bits; ++i) {
        const uint32_t bit = field.bit + i;
        const auto flag = uint8_t(1u << (bit % 8));
        payload[bit / 8] = uint8_t(raw >> i & 1u ? payload[bit / 8] | flag : payload[bit / 8] & ~flag);
    }
}

void put_value(const HidField& field, double value, std::span<uint8_t> payload)
{
    const double span = std::ldexp(1.0, int(field.bits));
    const double least = field.is_signed ? -span / 2.0 : 0.0, most = least + span - 1.0;
    const double raw = std::clamp(std::round((value - field.offset) / field.scale), least, most);
    put_raw(field, uint32_t(int64_t(raw)), payload);
}

/// Returns the bytes after the id; empty if the id or length of `report` differs from that of `expected`.
std::span<const uint8_t> payload_of(const HidReport& expected, std::span<const uint8_t> report)
{
    const size_t id_bytes = expected.id == 0 ? 0 : 1;
    if (report.size() != expected.length + id_bytes) return {};
    if (id_bytes == 1 && report[0] != expected.id) return {};
    return report.subspan(id_bytes);
}

/// Reads fields by quantity. A field that the report lacks is replaced by a default, or returned as null.
struct Reader {
    const HidReport& report;
    std::span<const uint8_t> payload;
    bool has(HidQuantity quantity) const { return report.find(quantity) != nullptr; }
    std::optional<uint32_t> raw(HidQuantity quantity) const
    {
        const HidField* field = report.find(quantity);
        return field ? std::optional(raw_of(*field, payload)) : std::nullopt;
    }
    glm::dvec3 vector(HidQuantity x, HidQuantity y, HidQuantity z) const
    {
        return {value(x, 0.0), value(y, 0.0), value(z, 0.0)};
    }
    double value(HidQuantity quantity, double otherwise) const
    {
        const HidField* field = report.find(quantity);
        return field ? value_of(*field, payload) : otherwise;
    }
};

glm::dquat rotation_of(const Reader& reader, const glm::dmat3& axes)
{
    using enum HidQuantity;
    const glm::dquat q(reader.value(rotation_w, 1.0), reader.value(rotation_x, 0.0), reader.value(rotation_y, 0.0),
                       reader.value(rotation_z, 0.0));
    // A device that has not calibrated its angles yet sends a zero quaternion, which cannot be normalized.
    if (glm::dot(q, q) < 0.25) return {1.0, 0.0, 0.0, 0.0};
    // A rotation axis is a pseudovector: a reflection also flips the axis's sign.
    const glm::dvec3 axis = glm::determinant(axes) * (axes * glm::dvec3(q.x, q.y, q.z));
    return glm::normalize(glm::dquat(q.w, axis.x, axis.y, axis.z));
}

}  // namespace

std::optional<HidInput> decode(const HidProfile& profile, std::span<const uint8_t> report)
{
    using enum HidQuantity;
    for (const HidReport& layout : profile.inputs) {
        const Reader reader{layout, payload_of(layout, report)};
        if (reader.payload.empty()) continue;
        HidInput input;
        if (reader.has(position_x)) input.position_m = profile.axes * reader.vector(position_x, position_y, position_z);
        if (reader.has(rotation_w)) input.rotation = rotation_of(reader, profile.axes);
        if (reader.has(rate_x)) input.rate = profile.axes * reader.vector(rate_x, rate_y, rate_z);
        // An angular velocity is a pseudovector: a reflection also flips the velocity's sign.
        if (reader.has(turn_x))
            input.turn_rate = glm::determinant(profile.axes) * (profile.axes * reader.vector(turn_x, turn_y, turn_z));
        input.buttons = reader.raw(buttons);
        if (const auto flag = reader.raw(calibrated)) input.calibrated = *flag != 0;
        input.sequence = reader.raw(sequence);
        input.force_sequence = reader.raw(force_sequence);
        input.time = reader.raw(time);
        return input;
    }
    return std::nullopt;
}

bool is_ignored(const HidProfile& profile, std::span<const uint8_t> report)
{
    return !report.empty() && std::ranges::find(profile.ignored_ids, report[0]) != profile.ignored_ids.end();
}

glm::dvec3 shaped(const HidRate& rate, const glm::dvec3& deflection)
{
    const double length = glm::length(deflection);
    if (!(length > rate.dead_zone) || !std::isfinite(length)) return glm::dvec3(0.0);
    const double share = (std::min(length, 1.0) - rate.dead_zone) / (1.0 - rate.dead_zone);
    return deflection * (std::pow(share, rate.gamma) / length);
}

HidBytes encode(const HidProfile& profile, const glm::dvec3& force_n, uint32_t sequence, bool enabled)
{
    HidBytes report;
    if (!profile.output) return report;
    report.size = 1 + profile.output->length;
    report.bytes[0] = profile.output->id;
    const std::span<uint8_t> payload(report.bytes.data() + 1, profile.output->length);

    const double length = glm::length(force_n);
    const bool is_on = enabled && std::isfinite(length);
    const double peak = profile.limits.peak_force_n;
    const glm::dvec3 shortened = !is_on ? glm::dvec3(0.0) : length > peak ? force_n * (peak / length) : force_n;
    const glm::dvec3 force = glm::transpose(profile.axes) * shortened;
    for (const HidField& field : profile.output->fields) {
        switch (field.quantity) {
            case HidQuantity::enable: put_raw(field, is_on ? 1 : 0, payload); break;
            case HidQuantity::watchdog: put_value(field, profile.watchdog_ms * 1e-3, payload); break;
            case HidQuantity::sequence: put_raw(field, sequence, payload); break;
            case HidQuantity::force_x: put_value(field, force.x, payload); break;
            case HidQuantity::force_y: put_value(field, force.y, payload); break;
            case HidQuantity::force_z: put_value(field, force.z, payload); break;
            default: break;  // refused when the profile was read
        }
    }
    return report;
}

DeviceCaps decode_feature(const HidProfile& profile, std::span<const uint8_t> report)
{
    using enum HidQuantity;
    DeviceCaps caps = profile.limits;
    if (!profile.feature) return caps;
    const Reader reader{*profile.feature, payload_of(*profile.feature, report)};
    if (reader.payload.empty()) return caps;
    caps.peak_force_n = std::clamp(reader.value(peak_force, caps.peak_force_n), 0.0, caps.peak_force_n);
    caps.continuous_force_n = std::min(caps.continuous_force_n, caps.peak_force_n);
    caps.latency_s = std::max(caps.latency_s, reader.value(latency, caps.latency_s));
    // The report states full side lengths of a centred box along the device's axes; 0 means that none is stated.
    const glm::dvec3 side = glm::abs(profile.axes * glm::dvec3(reader.value(usable_x, 0.0), reader.value(usable_y, 0.0),
                                                               reader.value(usable_z, 0.0)));
    for (int i = 0; i < 3; ++i) {
        if (side[i] <= 0.0) continue;
        const double middle = 0.5 * (caps.usable_lower_m[i] + caps.usable_upper_m[i]);
        caps.usable_lower_m[i] = std::max(caps.usable_lower_m[i], middle - 0.5 * side[i]);
        caps.usable_upper_m[i] = std::min(caps.usable_upper_m[i], middle + 0.5 * side[i]);
    }
    return caps;
}

uint64_t Unwrapped::next(uint32_t raw)
{
    const uint32_t forward = (raw - uint32_t(last_)) & mask_;
    const uint32_t backward = (0u - forward) & mask_;
    const bool is_back = forward > mask_ / 2 && backward <= last_;
    last_ = !has_last_ ? raw : is_back ? last_ - backward : last_ + forward;
    has_last_ = true;
    return last_;
}

}  // namespace shvr
