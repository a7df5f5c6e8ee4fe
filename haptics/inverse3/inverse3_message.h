#pragma once
// Messages to and from the Inverse service, as JSON texts (Inverse SDK 3.5, according to its public documentation). A
// thousand messages a second are parsed without building a tree, by a strict scan that keeps only the few numbers
// needed. Pure; any thread.
//
// Positions, velocities and forces are in the service's frame (+x right, +y forward, +z up), metres and newtons;
// `from_inverse3` and `to_inverse3` convert them.

#include <cstdint>
#include <string>
#include <string_view>

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

namespace shvr {

inline glm::dvec3 from_inverse3(const glm::dvec3& v)
{
    return {v.x, v.z, -v.y};
}
inline glm::dvec3 to_inverse3(const glm::dvec3& v)
{
    return {v.x, -v.z, v.y};
}

struct Inverse3State {
    std::string device_id;  ///< id: letters, digits, - and _; empty: there is no device (with the requested id)
    bool has_position = false;
    glm::dvec3 position_m{0.0};
    bool has_rotation = false;  ///< rotation of the grip
    glm::dquat rotation{1.0, 0.0, 0.0, 0.0};
    uint32_t buttons = 0;  ///< buttons of the grip: bit 0 is a, bit 1 is b
};
/// Reads an inventory or a state into `state`: the device with the id `device_id`, or the first device if the id is
/// empty. Returns null, or a description of the message's defect; `state` is then unspecified.
const char* read_inverse3_state(std::string_view text, std::string_view device_id, Inverse3State& state);

enum class Inverse3Event : uint8_t {
    other,
    ebrake_on,
    ebrake_off,
    stall,    ///< a motor stalled
    ceiling,  ///< the controller reached its stability limit
    connected,
    disconnected,
};
struct Inverse3Notice {
    Inverse3Event event = Inverse3Event::other;
    std::string device_id;  ///< empty: not stated
};
/// Reads a message of the event channel; returns null, or a description of the message's defect.
const char* read_inverse3_notice(std::string_view text, Inverse3Notice& notice);

/// Appends the message that sets a force, with enough digits to parse back to the same bits. The first message of a
/// connection also names the program. `force_n` must be finite.
void append_inverse3_command(std::string& text, std::string_view device_id, const glm::dvec3& force_n, bool is_first);

}  // namespace shvr
