// "--set key=value": sets values in the JSON of a session by dotted keys. The table of keys determines types: values of
// text keys are taken literally, all others are parsed as JSON.

#include <charconv>

#include <nlohmann/json.hpp>

#include "engine/session/quality.h"
#include "engine/session/session_keys.h"

namespace shvr {
namespace {

using nlohmann::json;

constexpr size_t DEEPEST_KEY = 8;

struct Setting {
    std::vector<std::string> keys;
    json value;
};

/// Returns the value of a setting. A text may also be spelled as a JSON string, with quotes.
json value_of(const std::string& key, const std::string& text, const std::string& setting)
{
    static const std::vector<SessionKey> keys = session_keys();
    const auto known = std::ranges::find_if(keys, [&](const SessionKey& each) { return each.covers(key); });
    const bool is_text = known != keys.end() && known->is_text;
    if ((is_text && !text.starts_with('"')) || !json::accept(text)) return text;
    return session_document(text, "--set " + setting).value();
}

template <class... Parts>
[[noreturn]] void refuse_setting(const std::string& setting, const Parts&... parts)
{
    throw UsageError(sentence("--set ", setting, ": ", parts...));
}

/// Whether a text is valid UTF-8. Keys and values must be, since messages quote them.
bool is_utf8(const std::string& text)
{
    try {
        return !json(text).dump().empty();
    } catch (const json::type_error&) {
        return false;
    }
}

Setting parse_setting(const std::string& setting)
{
    if (!is_utf8(setting)) throw UsageError("--set: a setting is not UTF-8; expected key=value in UTF-8");
    const size_t equals = setting.find('=');
    if (equals == std::string::npos || equals == 0)
        refuse_setting(setting, "has no key and value; expected key=value, such as render.step_voxels=0.25");
    Setting parsed;
    for (size_t begin = 0; begin <= equals;) {
        const size_t end = std::min(setting.find('.', begin), equals);
        if (end == begin) refuse_setting(setting, "the key has an empty part; expected names joined by single dots");
        if (parsed.keys.size() == DEEPEST_KEY)
            refuse_setting(setting, "the key has more than ", DEEPEST_KEY, " parts; expected a key of a session");
        parsed.keys.push_back(setting.substr(begin, end - begin));
        begin = end + 1;
    }
    parsed.value = value_of(setting.substr(0, equals), setting.substr(equals + 1), setting);
    return parsed;
}

/// Returns the member or element `key` of `container`. Creates a missing member of an object.
json& member_of(json& container, const std::string& key, const std::string& container_key, const std::string& setting)
{
    if (container.is_object()) return container[key];
    if (!container.is_array())
        refuse_setting(setting, container_key, " is a ", container.type_name(), "; expected an object or an array");
    size_t index = 0;
    const auto result = std::from_chars(key.data(), key.data() + key.size(), index);
    if (result.ec != std::errc() || result.ptr != key.data() + key.size() || index >= container.size())
        refuse_setting(setting, container_key, " has no element ", key, "; expected ",
                       container.empty() ? "" : sentence("a number below ", container.size(), ", or "),
                       "the whole list, as in --set '", container_key, "=[...]'");
    return container[index];
}

/// Returns a copy of the default if it is an array ("render.size"), so that single elements of it can be set, and an
/// empty list for keys that are lists ("meshes").
json missing_container(const std::string& key, const json* fallback)
{
    if (fallback && fallback->is_array()) return *fallback;
    static const std::vector<SessionKey> keys = session_keys();
    const auto known = std::ranges::find(keys, key, &SessionKey::name);
    return known != keys.end() && known->allowed.starts_with("array of at most") ? json::array() : json::object();
}

/// Erases the keys that a quality sets: the quality overrides keys that were set before it.
void erase_keys_of_quality(json& render)
{
    for (const std::string_view key : keys_of_quality()) render.erase(std::string(key));
}

}  // namespace

void apply_settings(JsonDocument& session, const std::vector<std::string>& settings)
{
    json& document = session.value();
    if (!document.is_object() || settings.empty()) return;
    const JsonDocument standard = session_document(to_text(Session{}, {}), "defaults");
    const json& defaults = standard.value();
    for (const std::string& setting : settings) {
        const Setting parsed = parse_setting(setting);
        json* place = &document;
        const json* fallback = &defaults;
        std::string place_key;
        for (const std::string& key : parsed.keys) {
            if (place->is_null()) *place = missing_container(place_key, fallback);
            place = &member_of(*place, key, place_key, setting);
            place_key += place_key.empty() ? key : "." + key;
            fallback = fallback && fallback->is_object() && fallback->contains(key) ? &(*fallback)[key] : nullptr;
        }
        *place = parsed.value;
        if (place_key == "render.quality") erase_keys_of_quality(document["render"]);
    }
}

}  // namespace shvr
