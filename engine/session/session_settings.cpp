// "--set key=value": dotted keys into the JSON of a session.

#include <charconv>

#include <nlohmann/json.hpp>

#include "engine/session/session_json.h"

namespace shvr {
namespace {

using nlohmann::json;

constexpr size_t DEEPEST_KEY = 8;

struct Setting {
    std::vector<std::string> keys;
    json value;
};

template <class... Parts>
[[noreturn]] void refuse_setting(const std::string& setting, const Parts&... parts)
{
    throw UsageError(sentence("--set ", setting, ": ", parts...));
}

/// Messages quote keys and values, which takes valid UTF-8.
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
    const std::string value = setting.substr(equals + 1);
    parsed.value = json::accept(value) ? json_of(value, "--set " + setting) : json(value);
    return parsed;
}

/// The member or element `key` of `container`; made where an object lacks it.
json& member_of(json& container, const std::string& key, const std::string& container_key, const std::string& setting)
{
    if (container.is_object()) return container[key];
    if (!container.is_array())
        refuse_setting(setting, container_key, " is a ", container.type_name(), "; expected an object or an array");
    size_t index = 0;
    const auto result = std::from_chars(key.data(), key.data() + key.size(), index);
    if (result.ec != std::errc() || result.ptr != key.data() + key.size() || index >= container.size())
        refuse_setting(setting, container_key, " has no element ", key, "; expected a number below ", container.size());
    return container[index];
}

/// A missing array that has a default ("render.size") starts from it, so that one of its elements can be set.
json missing_container(const json* fallback)
{
    return fallback && fallback->is_array() ? *fallback : json::object();
}

}  // namespace

void apply_settings(json& document, const std::vector<std::string>& settings)
{
    if (!document.is_object()) return;  // `read_session` says what is wrong
    const json defaults = json_of(to_text(Session{}, {}), "defaults");
    for (const std::string& setting : settings) {
        const Setting parsed = parse_setting(setting);
        json* place = &document;
        const json* fallback = &defaults;
        std::string place_key;
        for (const std::string& key : parsed.keys) {
            if (place->is_null()) *place = missing_container(fallback);
            place = &member_of(*place, key, place_key, setting);
            place_key += place_key.empty() ? key : "." + key;
            fallback = fallback && fallback->is_object() && fallback->contains(key) ? &(*fallback)[key] : nullptr;
        }
        *place = parsed.value;
    }
}

}  // namespace shvr
