#include "engine/session/session_patch.h"

#include <nlohmann/json.hpp>

#include "engine/session/lasting_settings.h"
#include "engine/session/quality.h"
#include "engine/session/session_keys.h"

namespace shvr {

namespace {

using nlohmann::json;

json settings_of(Session session)
{
    return json::parse(write_fields({}, [&](Fields& f) { setting_fields(f, session); }));
}

/// Replaces arrays as a whole, as JSON merge patches do.
json difference(const json& before, const json& after)
{
    json patch = json::object();
    for (const auto& [key, value] : after.items()) {
        const auto was = before.find(key);
        if (was == before.end())
            patch[key] = value;
        else if (was->is_object() && value.is_object() && *was != value)
            patch[key] = difference(*was, value);
        else if (*was != value)
            patch[key] = value;
    }
    for (const auto& [key, value] : before.items())
        if (!after.contains(key)) patch[key] = nullptr;
    return patch;
}

}  // namespace

std::string patch_between(const Session& before, const Session& after)
{
    const json patch = difference(settings_of(before), settings_of(after));
    return patch.empty() ? std::string() : patch.dump();
}

std::string patch_of(const std::string& setting)
{
    JsonDocument document = session_document("{}", "setting");
    apply_settings(document, {setting});
    return document.value().dump();
}

std::string merged(std::string_view object, std::string_view patch, const std::string& origin)
{
    const JsonLimits limits{.depth = 16, .expected = "an object"};
    JsonDocument document(object, origin, limits);
    const JsonDocument change(patch, origin, limits);
    if (!change.value().is_object()) change.root().refuse("an object");
    document.value().merge_patch(change.value());
    return document.value().dump();
}

Session patched(const Session& session, std::string_view patch)
{
    const JsonDocument change = session_document(patch, "settings");
    if (!change.value().is_object()) change.root().refuse("an object such as {\"light\": {\"ambient\": 0.4}}");
    JsonDocument document = session_document("{}", "settings");
    document.value() = settings_of(session);
    if (change.root()["render"]["quality"].exists())
        for (const std::string_view key : keys_of_quality()) document.value()["render"].erase(std::string(key));
    document.value().merge_patch(change.value());
    const Session read = read_settings(document);
    Session changed = session;
    changed.transfer_function = read.transfer_function;
    changed.transfer_preset = read.transfer_preset;
    changed.groups = read.groups;
    changed.unpainted = read.unpainted;
    changed.light = read.light;
    changed.blend = read.blend;
    changed.cut = read.cut;
    changed.measurements = read.measurements;
    changed.meshes = read.meshes;
    changed.render = read.render;
    changed.view = read.view;
    changed.interaction = read.interaction;
    changed.probe = read.probe;
    return changed;
}

}  // namespace shvr
