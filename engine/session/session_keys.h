#pragma once
// The keys of a session file (fields.h). Its default is the value of a new `Session`. Reading, writing, --set and the
// table of README.md are visitors.
//
// To add a key: a member with its default, a line in session_keys*.cpp, and its row in README.md, which the test of
// this table prints. Any thread.

#include <map>
#include <string_view>

#include "engine/annotation/settings.h"
#include "engine/session/fields.h"
#include "engine/session/session.h"

namespace shvr {

// session_keys.cpp, session_keys_look.cpp, session_keys_camera.cpp
void fields(Fields& f, Session& session);
/// The sections of lasting_settings.h.
void lasting_fields(Fields& f, Session& session);
/// The sections of session_patch.h.
void setting_fields(Fields& f, Session& session);
/// The fields of kept_settings.h; `camera` and `cameras` are one section, since `camera` names an entry of `cameras`.
void kept_fields(Fields& f, Session& session);
void fields(Fields& f, Groups& groups);
void fields(Fields& f, SurfaceLook& surface);
void fields(Fields& f, FeelSettings& touch);
void fields(Fields& f, ProbeSettings& probe);
void fields(Fields& f, CutBox& cut);
void fields(Fields& f, Measurement& measurement);
void fields(Fields& f, InteractionSettings& interaction);
void fields(Fields& f, ControlPoint& point);
void fields(Fields& f, Unpainted& unpainted);
void fields(Fields& f, Light& light);
void fields(Fields& f, OcclusionPoint& point);
void fields(Fields& f, OcclusionSettings& occlusion);
void fields(Fields& f, DistanceBlend& blend);
void fields(Fields& f, RenderSettings& render);
/// Fields of `render`: how the picture is computed, and how it looks regardless of that.
void rendering_fields(Fields& f, RenderSettings& render);
void picture_fields(Fields& f, RenderSettings& render);
inline constexpr std::string_view PICTURE_KEYS[]{"background", "smooth_borders", "saturation"};
void fields(Fields& f, ViewSettings& view);
void fields(Fields& f, StereoSettings& stereo);
void fields(Fields& f, SliceSettings& slices);
void fields(Fields& f, CameraSpec& camera);
void fields(Fields& f, Camera& camera);
void fields(Fields& f, SideView& view);
/// `session.camera_name`, a name or the text of an object, and `session.cameras`.
void camera_fields(Fields& f, Session& session);

/// A row of the table in README.md.
struct SessionKey {
    std::string name;  ///< "groups.N.color": N stands for any number or name, NAME for any name
    std::string meaning, allowed, standard;
    bool is_text = false;  ///< --set takes the value verbatim, without quotes
    /// Whether this row describes the key of that name.
    bool covers(std::string_view key) const;
};
std::vector<SessionKey> session_keys();

/// The rows of other objects, in their order.
std::vector<SessionKey> keys_of(const Fields::Visit& visit);

inline const NumberRange SHARE{0.0, 1.0};
/// Far beyond any volume in any unit, and far below where squares overflow.
inline const NumberRange COORDINATE{-1e15, 1e15};
/// The range of voxel values.
inline const NumberRange INTENSITY{-3.4e38, 3.4e38};

// session_read.cpp
JsonDocument session_document(std::string_view text, const std::string& origin);
Session read_session(const JsonDocument& document, const std::filesystem::path& folder);
/// A sentence for each key of earlier versions that `document` states and that reading ignores (Fields::retired).
std::vector<std::string> removed_keys_in(const JsonDocument& document, const std::string& origin);
CameraSpec read_camera(const JsonNode& node);
/// An object with these sections as JSON.
std::string text_of_sections(const SettingValues& values);
/// Reads the sections that `lasting_fields` visits into a new session; the others keep their defaults.
Session read_lasting(const JsonDocument& document);
/// Likewise those of `setting_fields`.
Session read_settings(const JsonDocument& document);
/// The same for `kept_fields`.
Session read_kept(const JsonDocument& document);
/// Whether a camera is given as an object, not by name.
bool is_camera_object(const std::string& name_or_json);
glm::dvec3 read_color(const JsonNode& node);

// session_settings.cpp
/// Applies "key=value" settings; does nothing if the document is not an object, which `read_session` refuses.
void apply_settings(JsonDocument& document, const std::vector<std::string>& settings);

}  // namespace shvr
