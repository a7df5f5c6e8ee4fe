#pragma once
// The keys of a session file (fields.h). The default of a key is its value in a new `Session`. Reading, writing, --set
// and the table in README.md are visitors.
//
// To add a key: add a member with its default, a line in session_keys*.cpp, and a row in README.md (the test of the
// table prints the row). Any thread.

#include <map>
#include <string_view>

#include "engine/annotation/settings.h"
#include "engine/session/fields.h"
#include "engine/session/session.h"

namespace shvr {

// session_keys.cpp, session_keys_look.cpp, session_keys_camera.cpp
void fields(Fields& f, Session& session);
/// Fields of the sections of lasting_settings.h.
void lasting_fields(Fields& f, Session& session);
/// Fields of the sections of session_patch.h.
void setting_fields(Fields& f, Session& session);
/// The fields of kept_settings.h. `camera` and `cameras` form one section, since `camera` names an entry of `cameras`.
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
/// Two parts of `render`: how pictures are computed (kept_settings.h), and their look (lasting_settings.h).
void rendering_fields(Fields& f, RenderSettings& render);
void picture_fields(Fields& f, RenderSettings& render);
inline constexpr std::string_view PICTURE_KEYS[]{"background", "smooth_borders", "saturation"};
void fields(Fields& f, ViewSettings& view);
void fields(Fields& f, StereoSettings& stereo);
void fields(Fields& f, SliceSettings& slices);
void fields(Fields& f, CameraSpec& camera);
void fields(Fields& f, Camera& camera);
void fields(Fields& f, SideView& view);
/// Fields of `session.camera_name` (a name, or an object as text) and of `session.cameras`.
void camera_fields(Fields& f, Session& session);
/// The control points of a transfer function.
void points_field(Fields& f, TransferFunction& function, const About& about);
void fields(Fields& f, KeyLook& look);
/// The field of `session.key_looks`. `writes_none`: whether it is written where there are none.
void key_look_fields(Fields& f, Session& session, bool writes_none);

/// A row of the table in README.md.
struct SessionKey {
    std::string name;  ///< "groups.N.color"; in names, N stands for any number or name, NAME for any name
    std::string meaning, allowed, standard;
    bool is_text = false;  ///< whether --set takes the value as text, without quotes
    /// Whether this row describes `key`. N and NAME in the row's name match any part of a key.
    bool covers(std::string_view key) const;
};
std::vector<SessionKey> session_keys();

/// Returns the rows of the keys that `visit` visits, in this order. For objects other than sessions.
std::vector<SessionKey> keys_of(const Fields::Visit& visit);

inline const NumberRange SHARE{0.0, 1.0};
/// The range of coordinates: wide enough for any volume and unit, without overflow in squares of coordinates.
inline const NumberRange COORDINATE{-1e15, 1e15};
/// The range of voxel values.
inline const NumberRange INTENSITY{-3.4e38, 3.4e38};

// session_read.cpp
JsonDocument session_document(std::string_view text, const std::string& origin);
Session read_session(const JsonDocument& document, const std::filesystem::path& folder);
/// Returns a message for each key of earlier versions in `document`, which reading ignores (Fields::retired).
std::vector<std::string> removed_keys_in(const JsonDocument& document, const std::string& origin);
CameraSpec read_camera(const JsonNode& node);
/// Returns the text of a JSON object with these sections.
std::string text_of_sections(const SettingValues& values);
/// Reads into a new session the sections that `lasting_fields` visits; the others have their defaults.
Session read_lasting(const JsonDocument& document);
/// Reads into a new session the sections that `setting_fields` visits.
Session read_settings(const JsonDocument& document);
/// Reads into a new session the sections that `kept_fields` visits.
Session read_kept(const JsonDocument& document);
/// Whether a camera is stated as a JSON object rather than by name.
bool is_camera_object(const std::string& name_or_json);
glm::dvec3 read_color(const JsonNode& node);

// session_settings.cpp
/// Applies "key=value" settings; does nothing if the document is not an object, because `read_session` refuses it.
void apply_settings(JsonDocument& document, const std::vector<std::string>& settings);

}  // namespace shvr
