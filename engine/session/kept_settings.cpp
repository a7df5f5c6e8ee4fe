#include "engine/session/kept_settings.h"

#include "engine/session/lasting_settings.h"
#include "engine/session/session_keys.h"

namespace shvr {

void take_kept_sections(Session& to, const Session& from)
{
    to.cameras = from.cameras;
    to.camera_name = from.camera_name;
    to.key_looks = from.key_looks;
    to.render = from.render;
    to.view = from.view;
    to.interaction = from.interaction;
    to.probe = from.probe;
}

void set_kept_settings(Session& session, const SettingValues& values)
{
    const Session read = read_kept(session_document(text_of_sections(values), "settings"));
    const auto has = [&](const char* name) { return values.contains(name); };
    if (has("cameras")) {
        session.cameras = read.cameras;
        session.camera_name = read.camera_name;
    }
    if (has("key_looks")) session.key_looks = read.key_looks;
    if (has("render")) {
        const RenderSettings before = session.render;
        session.render = read.render;
        take_picture(session.render, before);
    }
    if (has("view")) session.view = read.view;
    if (has("interaction")) session.interaction = read.interaction;
    if (has("probe")) session.probe = read.probe;
}

SettingValues normalized_kept_settings(const SettingValues& values)
{
    Session session;
    set_kept_settings(session, values);
    SettingValues all = kept_settings(session);
    std::erase_if(all, [&](const auto& section) { return !values.contains(section.first); });
    return all;
}

}  // namespace shvr
