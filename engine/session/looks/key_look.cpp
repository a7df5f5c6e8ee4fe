#include "engine/session/looks/key_look.h"

#include <utility>

namespace shvr {

KeyLook key_look_of(const Session& session)
{
    return {session.transfer_function, session.groups, session.unpainted, session.light, session.blend, session.cut};
}

KeyLook key_look_of(const Session& session, const std::string& view)
{
    const auto kept = session.key_looks.find(view);
    if (kept == session.key_looks.end()) return key_look_of(session);
    KeyLook look = kept->second;
    for (auto& [group, settings] : look.groups) {
        settings.name.clear();
        settings.locked = false;
    }
    for (const auto& [group, now] : session.groups) {
        GroupSettings& settings = look.groups[group];
        settings.name = now.name;
        settings.locked = now.locked;
    }
    return look;
}

Session with_key_look(Session session, const std::string& view)
{
    KeyLook look = key_look_of(session, view);
    session.transfer_function = std::move(look.transfer_function);
    session.groups = std::move(look.groups);
    session.unpainted = look.unpainted;
    session.light = std::move(look.light);
    session.blend = look.blend;
    session.cut = look.cut;
    return session;
}

}  // namespace shvr
