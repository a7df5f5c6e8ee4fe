#include "engine/session/lasting_settings.h"

#include <algorithm>

#include "engine/session/session_keys.h"

namespace shvr {

void take_picture(RenderSettings& to, const RenderSettings& from)
{
    to.background = from.background;
    to.smooth_borders = from.smooth_borders;
    to.saturation = from.saturation;
}

std::string text_of_sections(const SettingValues& values)
{
    std::string text;
    for (const auto& [name, value] : values) text += sentence(text.empty() ? "{" : ",", '"', name, "\":", value);
    return text.empty() ? "{}" : text + "}";
}

void set_lasting_settings(Session& session, const SettingValues& values)
{
    const Session read = read_lasting(session_document(text_of_sections(values), "settings"));
    const auto has = [&](const char* name) { return values.contains(name); };
    if (has("transfer_function")) session.transfer_function = read.transfer_function;
    if (has("groups")) session.groups = read.groups;
    if (has("unpainted")) session.unpainted = read.unpainted;
    if (has("light")) session.light = read.light;
    if (has("blend")) session.blend = read.blend;
    if (has("cut")) session.cut = read.cut;
    if (has("measurements")) session.measurements = read.measurements;
    if (has("meshes")) session.meshes = read.meshes;
    if (has("picture")) take_picture(session.render, read.render);
}

SettingValues normalized_settings(const SettingValues& values)
{
    Session session;
    set_lasting_settings(session, values);
    SettingValues all = lasting_settings(session);
    std::erase_if(all, [&](const auto& section) { return !values.contains(section.first); });
    return all;
}

SettingValues without_overridden(SettingValues values, const std::vector<std::string>& settings)
{
    for (const std::string& setting : settings) {
        const std::string key = setting.substr(0, setting.find('='));
        const std::string name = key.substr(0, key.find('.'));
        const bool is_of_picture = std::ranges::any_of(
            PICTURE_KEYS, [&](std::string_view each) { return key == "render." + std::string(each); });
        if (is_of_picture || key == "render") values.erase("picture");
        if (!is_of_picture) values.erase(name == "camera" ? "cameras" : name);  // "cameras" covers both keys
    }
    return values;
}

}  // namespace shvr
