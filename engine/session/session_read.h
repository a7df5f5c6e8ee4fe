#pragma once
// The sections of a session file, each from its JSON; what is missing has the session's default. For the session_read*.cpp
// files only.

#include <map>
#include <optional>
#include <string>

#include "engine/session/session_json.h"

namespace shvr {

inline NumberRange range(double lower, double upper)
{
    return {lower, upper, ""};
}
/// Above 0, within what single precision and finite work allow.
inline NumberRange above_zero(double lower, double upper)
{
    return {lower, upper, sentence("a number above 0 (", lower, " ... ", upper, ")")};
}
inline const NumberRange SHARE = range(0.0, 1.0);
/// Far beyond any volume in any unit, and far below where squares overflow.
inline const NumberRange COORDINATE = range(-1e15, 1e15);

// session_read_look.cpp
TransferFunction read_transfer_function(const JsonNode& node);
Light read_light(const JsonNode& node);
DistanceBlend read_blend(const JsonNode& node);
RenderSettings read_render(const JsonNode& node);
ViewSettings read_view(const JsonNode& node);
InteractionSettings read_interaction(const JsonNode& node);
std::optional<double> read_intensity(const JsonNode& node);

// session_read_camera.cpp
std::map<std::string, CameraSpec> read_cameras(const JsonNode& node);
/// A name, checked against what there is, or the text of a camera object.
std::string read_camera_choice(const JsonNode& document, const nlohmann::json& json, const Session& session);

}  // namespace shvr
