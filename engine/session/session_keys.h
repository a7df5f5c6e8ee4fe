#pragma once
// The keys of a session file, each stated once: its name, the value it stands for, its range, unit and meaning. Its
// default is the value of a new `Session`. `fields` visits them in the order in which they are written; reading,
// writing, --set and the table of README.md are visitors:
//
//   void fields(Fields& f, Light& light)
//   {
//       f.number("ambient", light.ambient, {0.0, 10.0}, {"share of the colour that is always seen"});
//       ...
//
// To add a key: a member with its default, a line in session_keys*.cpp, and its row in README.md, which the test of
// this table prints. Any thread.

#include <concepts>
#include <functional>
#include <map>
#include <string_view>

#include "engine/base/json.h"
#include "engine/session/session.h"

namespace shvr {

/// The documentation of a key.
struct About {
    const char* meaning = "";   ///< one line; empty for sections that need none
    const char* unit = "";      ///< stands before the range
    const char* allowed = "";   ///< printed instead of unit and range
    const char* standard = "";  ///< the default, if it is not a plain value
    bool is_required = false;
};

/// Visits values by their keys. Unset optional values and empty texts and paths are not written; a value whose key is
/// missing from a file stays unchanged.
class Fields {
public:
    using Visit = std::function<void(Fields&)>;
    using VisitItem = std::function<void(Fields&, size_t index, size_t count)>;
    using VisitEntry = std::function<void(Fields&, const std::string& key)>;
    virtual ~Fields() = default;

    void flag(std::string_view name, bool& value, const About& about);
    void number(std::string_view name, double& value, const NumberRange& range, const About& about);
    virtual void number(std::string_view name, std::optional<double>& value, const NumberRange& range,
                        const About& about) = 0;
    template <std::integral Whole>
    void whole(std::string_view name, Whole& value, int64_t lower, int64_t upper, const About& about)
    {
        std::optional<int64_t> number = int64_t{value};
        any_whole(name, number, lower, upper, about);
        value = Whole(number.value_or(int64_t{value}));
    }
    /// An enumeration that has `spellings_of`.
    template <class Value>
    void choice(std::string_view name, Value& value, const About& about)
    {
        const std::span<const Spelling<Value>> spellings = spellings_of(value);
        std::string chosen(spelled(value));
        choice(name, chosen, names_of(spellings), about);
        for (const Spelling<Value>& each : spellings)
            if (each.name == chosen) value = each.value;
    }
    virtual void choice(std::string_view name, std::string& value, const std::vector<std::string_view>& names,
                        const About& about) = 0;
    virtual void text(std::string_view name, std::string& value, const About& about) = 0;
    virtual void path(std::string_view name, std::filesystem::path& value, const About& about) = 0;
    void color(std::string_view name, glm::dvec3& value, const About& about);
    void color(std::string_view name, std::optional<glm::dvec3>& value, const About& about);
    /// Linear light; with alpha, if `has_alpha`.
    virtual void color(std::string_view name, std::optional<glm::dvec4>& value, bool has_alpha, const About& about) = 0;
    void vector(std::string_view name, glm::dvec3& value, const NumberRange& range, const About& about);
    virtual void vector(std::string_view name, std::optional<glm::dvec3>& value, const NumberRange& range,
                        const About& about) = 0;
    /// As many numbers as `value` has.
    virtual void numbers(std::string_view name, std::optional<glm::dvec2>& value, const NumberRange& range,
                         const About& about) = 0;
    virtual void wholes(std::string_view name, std::vector<int64_t>& value, int64_t lower, int64_t upper,
                        const About& about) = 0;
    virtual void any_flag(std::string_view name, std::optional<bool>& value, const About& about) = 0;
    virtual void any_whole(std::string_view name, std::optional<int64_t>& value, int64_t lower, int64_t upper,
                           const About& about) = 0;
    /// A value with its own format: `read` parses it; `written` returns its JSON, or nothing.
    virtual void other(std::string_view name, const std::function<void(const JsonNode&)>& read,
                       const std::function<std::optional<std::string>()>& written, const About& about) = 0;

    /// An object with the fields that `visit` visits; `visit` may be called more than once.
    virtual void section(std::string_view name, const Visit& visit, const About& about = {}) = 0;
    template <class Value>
    void section(std::string_view name, Value& value, const About& about = {})
    {
        section(
            name, [&](Fields& f) { fields(f, value); }, about);
    }
    /// An array of objects, at most `most`.
    virtual void items(std::string_view name, size_t count, size_t most, const VisitItem& visit,
                       const About& about) = 0;
    template <class Value>
    void list(std::string_view name, std::vector<Value>& values, size_t most, const About& about)
    {
        const auto visit = [&](Fields& f, size_t index, size_t count) {
            values.resize(count);
            fields(f, values[index]);
        };
        items(name, values.size(), most, visit, about);
    }
    /// An object of objects. `about` is about each; `placeholder` stands for its key in the table.
    virtual void entries(std::string_view name, std::vector<std::string> keys, std::string_view placeholder,
                         const VisitEntry& visit, const About& about) = 0;

    /// Whether a key is present: when reading, in the file; when writing, `is_set`.
    virtual bool has(std::string_view name, bool is_set) = 0;
    /// A key that is valid here, but not visited this time.
    virtual void mention(std::string_view name, const About& about) = 0;
    /// Refuses the input unless the condition holds; an empty `name` means the section itself.
    virtual void check(std::string_view /*name*/, bool /*holds*/, const std::string& /*expected*/) {}
    /// Runs a check that throws its own errors; the section's key is put in front of their messages.
    virtual void checked(const std::function<void()>&) {}
};

// session_keys.cpp, session_keys_look.cpp, session_keys_camera.cpp
void fields(Fields& f, Session& session);
/// The sections of lasting_settings.h.
void lasting_fields(Fields& f, Session& session);
void fields(Fields& f, Groups& groups);
void fields(Fields& f, SurfaceLook& surface);
void fields(Fields& f, ProbeSettings& probe);
void fields(Fields& f, CutBox& cut);
void fields(Fields& f, InteractionSettings& interaction);
void fields(Fields& f, ControlPoint& point);
void fields(Fields& f, Light& light);
void fields(Fields& f, OcclusionSettings& occlusion);
void fields(Fields& f, DistanceBlend& blend);
void fields(Fields& f, RenderSettings& render);
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
    bool is_text = false;  ///< --set takes the value verbatim
    /// Whether this row describes the key of that name.
    bool covers(std::string_view key) const;
};
std::vector<SessionKey> session_keys();

// ---- Options that are no part of a session, stated by the same visitors (engine/tasks) ----

/// Reads an object of such options; unknown keys are refused by name. Paths are relative to `folder`.
void read_fields(const JsonDocument& document, const std::filesystem::path& folder, const Fields::Visit& visit);
/// Their JSON, on one line. Fails where a path is not UTF-8.
std::string fields_text(const std::filesystem::path& folder, const Fields::Visit& visit);
/// What is documented of them, in their order.
std::vector<SessionKey> keys_of(const Fields::Visit& visit);

inline const NumberRange SHARE{0.0, 1.0};
/// Far beyond any volume in any unit, and far below where squares overflow.
inline const NumberRange COORDINATE{-1e15, 1e15};
/// The range of voxels.
inline const NumberRange INTENSITY{-3.4e38, 3.4e38};

// session_read.cpp
JsonDocument session_document(std::string_view text, const std::string& origin);
Session read_session(const JsonDocument& document, const std::filesystem::path& folder);
CameraSpec read_camera(const JsonNode& node);
/// Reads the sections that `lasting_fields` visits into a new session; the others keep their defaults.
Session read_lasting(const JsonDocument& document);
/// Whether a camera is given as an object, not by name.
bool is_camera_object(const std::string& name_or_json);
glm::dvec3 read_color(const JsonNode& node);

// session_settings.cpp
/// Applies "key=value" settings; does nothing if the document is not an object, which `read_session` refuses.
void apply_settings(JsonDocument& document, const std::vector<std::string>& settings);

}  // namespace shvr
