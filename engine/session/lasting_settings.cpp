#include "engine/session/lasting_settings.h"

#include "engine/session/session_keys.h"

namespace shvr {

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
        const std::string name = setting.substr(0, setting.find_first_of(".="));
        values.erase(name == "camera" ? "cameras" : name);  // which holds both (kept_settings.h)
    }
    return values;
}

}  // namespace shvr
