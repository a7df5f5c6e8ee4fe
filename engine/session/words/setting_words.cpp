#include "engine/session/words/setting_words.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <nlohmann/json.hpp>

#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/session/session_keys.h"
#include "engine/session/words/number_words.h"
#include "engine/session/words/setting_labels.h"

namespace shvr {

namespace {

using nlohmann::json;

/// More changes than these are summed up by the name of their section.
constexpr size_t MAX_TOLD = 3;

/// A section of a session, and the words for it as a whole.
struct SectionRow {
    std::string_view name, prefix, words;  ///< `prefix`: of its keys
};
constexpr SectionRow SECTIONS[] = {
    {"transfer_function", "transfer_function", "the transfer function"},
    {"groups", "groups", "the colour groups"},
    {"unpainted", "unpainted", "the look of unpainted voxels"},
    {"light", "light", "the light"},
    {"blend", "blend", "distance blending"},
    {"cut", "cut", "the cutting planes"},
    {"measurements", "measurements", "the measurements"},
    {"meshes", "meshes", "the meshes"},
    {"render", "render", "the rendering"},
    {"picture", "render", "the look of the picture"},
    {"view", "view", "the panes"},
    {"interaction", "interaction", "what the window shows"},
    {"probe", "probe", "brush and probe"},
    {"cameras", "cameras", "the saved views"},
    {"key_looks", "key_looks", "the looks kept with views"},
};

SectionRow section_named(std::string_view name)
{
    const auto found = std::ranges::find(SECTIONS, name, &SectionRow::name);
    return found == std::end(SECTIONS) ? SectionRow{name, name, name} : *found;
}

struct ChangedKey {
    std::string key;  ///< "light.ambient"
    json from, to;    ///< null: no value
};

/// Adds the keys that differ. An array counts as one value, and an object that is new or gone as one key.
void add_changes(const json& was, const json& is, const std::string& key, std::vector<ChangedKey>& found)
{
    if (was == is) return;
    if (!was.is_object() || !is.is_object()) return found.push_back({key, was, is});
    const auto member = [](const json& object, const std::string& name) {
        const auto at = object.find(name);
        return at == object.end() ? json() : *at;
    };
    for (const json* object : {&was, &is})
        for (const auto& item : object->items())
            if (object == &was || !was.contains(item.key()))
                add_changes(member(was, item.key()), member(is, item.key()), key + "." + item.key(), found);
}

std::string text_of(const json& value)
{
    return value.is_null() ? std::string() : value.dump();
}

/// "set ambient light from 0.2 to 0.3", "switched shading off"
std::string setting_change(const ChangedKey& changed)
{
    const SettingLabel* const known = label_of_setting(changed.key);
    std::string label = known ? std::string(known->label) : changed.key;
    if (!known)
        std::ranges::replace_if(
            label, [](char each) { return each == '.' || each == '_'; }, ' ');
    if (changed.to.is_boolean()) return sentence("switched ", label, changed.to.get<bool>() ? " on" : " off");
    if (changed.to.is_null())
        return changed.from.is_object() ? sentence("switched ", label, " off")
                                        : sentence("reset ", label, " to the default");
    if (changed.to.is_object()) return sentence("switched ", label, " on");
    const bool is_list = changed.to.is_array() && !changed.to.empty() && changed.to.front().is_object();
    std::string from = value_in_words(changed.key, text_of(changed.from)),
                to = value_in_words(changed.key, text_of(changed.to));
    if (is_list && from == to) return "changed " + label;
    if (from == to) from = text_of(changed.from), to = text_of(changed.to);  // they differ beyond four digits
    if (from.empty()) return sentence("set ", label, " to ", to);
    if (known && !known->unit.empty() && from.ends_with(known->unit)) from.erase(from.size() - known->unit.size() - 1);
    return sentence("set ", label, " from ", from, " to ", to);
}

/// "group 3 (stem)"
std::string group_in_words(const std::string& number, const json& groups)
{
    const std::string plain = "group " + number;
    const auto group = groups.find(number);
    if (group == groups.end() || !group->contains("name")) return plain;
    const std::string name = (*group)["name"].get<std::string>();
    return name == plain ? plain : plain + " (" + name + ")";
}

/// Returns groups as `was` has them, and with its default look each group that only `is` describes: what a person
/// changed is how it differs from that.
json with_default_looks(json was, const json& is)
{
    Session plain;
    plain.groups[1] = {};
    const json look = json::parse(write_fields({}, [&](Fields& f) { fields(f, plain.groups); }))["groups"]["1"];
    for (const auto& item : is.items())
        if (!was.contains(item.key())) was[item.key()] = look;
    return was;
}

/// Returns the opacity of a group, which may be a parent's.
std::string opacity_in_words(const std::string& number, const json& groups)
{
    for (std::string at = number; groups.contains(at); at = std::to_string(groups[at].value("parent", 0)))
        if (groups[at].contains("opacity"))
            return value_in_words("groups." + at + ".opacity", groups[at]["opacity"].dump());
    return "1";
}

/// `was`: without the default looks of new groups.
std::string group_change(const ChangedKey& changed, const json& was, const json& is)
{
    const std::string path = changed.key.substr(changed.key.find('.') + 1);
    const size_t dot = path.find('.');
    const std::string number = path.substr(0, dot), key = dot == std::string::npos ? "" : path.substr(dot + 1);
    const std::string group = group_in_words(number, is.contains(number) ? is : was);
    if (key.empty()) return "removed the look of " + group;
    if (key == "name") {
        if (changed.to.is_null()) return "removed the name of group " + number;
        const std::string name = changed.to.get<std::string>();
        if (!was.contains(number) && name == "group " + number)
            return "added " + group;  // as the action New group does
        if (changed.from.is_null()) return sentence("named group ", number, ' ', name);
        return sentence("renamed group ", number, " from ", changed.from.get<std::string>(), " to ", name);
    }
    if (key == "locked") return (changed.to == true ? "locked " : "unlocked ") + group;
    if (key == "visible") return (changed.to == false ? "hid " : "showed ") + group;
    if (key == "parent")
        return changed.to.is_null() || changed.to == 0
                   ? sentence("moved ", group, " to the top level")
                   : sentence("moved ", group, " below ", group_in_words(changed.to.dump(), is));
    const char* const what = key == "color" ? "colour" : "opacity";
    if (changed.to.is_null()) return sentence("reset the ", what, " of ", group);
    if (key == "color") return sentence("changed the ", what, " of ", group);
    const std::string from = opacity_in_words(number, was), to = value_in_words(changed.key, changed.to.dump());
    return sentence("set the ", what, " of ", group, from == to ? "" : " from " + from, " to ", to);
}

std::vector<std::string> group_changes(const json& was, const json& is)
{
    std::vector<ChangedKey> changes;
    add_changes(with_default_looks(was, is), is, "groups", changes);
    std::vector<std::string> told;
    for (const ChangedKey& changed : changes) told.push_back(group_change(changed, was, is));
    return told;
}

bool is_flipped(const json& was, const json& is)
{
    const auto at = [](const json& direction, size_t axis) { return direction[axis].get<double>(); };
    return at(was, 0) == -at(is, 0) && at(was, 1) == -at(is, 1) && at(was, 2) == -at(is, 2);
}

/// "moved the far x cutting plane to voxel 60"
std::vector<std::string> plane_changes(const json& was, const json& is)
{
    const Session whole;
    const auto at = [&](const json& cut, const char* end, int axis) {
        const auto corner = cut.find(end);
        if (corner != cut.end()) return (*corner)[size_t(axis)].get<double>();
        return std::string_view(end) == "lower" ? whole.cut.lower[axis] : whole.cut.upper[axis];
    };
    std::vector<std::string> told;
    bool is_whole = true;
    for (int axis = 0; axis < 3; ++axis)
        for (const char* end : {"lower", "upper"}) {
            const bool is_near = std::string_view(end) == "lower";
            const double now = at(is, end, axis), none = is_near ? whole.cut.lower[axis] : whole.cut.upper[axis];
            is_whole = is_whole && now == none;
            if (now == at(was, end, axis)) continue;
            const std::string plane = sentence("the ", is_near ? "near " : "far ", "xyz"[axis], " cutting plane");
            told.push_back(now == none ? "removed " + plane
                                       : sentence("moved ", plane, " to voxel ", number_in_words(std::round(now))));
        }
    const bool had = was.contains("plane_normal"), has = is.contains("plane_normal");
    is_whole = is_whole && !has;
    if (had != has)
        told.push_back(has ? "added an oblique cutting plane" : "removed the oblique cutting plane");
    else if (has && was["plane_normal"] != is["plane_normal"])
        told.push_back(is_flipped(was["plane_normal"], is["plane_normal"]) ? "flipped the oblique cutting plane"
                                                                           : "tilted the oblique cutting plane");
    else if (has && was.value("plane_point", json()) != is.value("plane_point", json()))
        told.push_back("moved the oblique cutting plane");
    const bool is_oblique_only = had && told.size() == 1;
    if (is_whole && !told.empty() && !is_oblique_only) return {"removed the cutting planes"};
    return told;
}

std::string text_at(const json& object, const char* key, const char* otherwise)
{
    return object.is_object() ? object.value(key, std::string(otherwise)) : otherwise;
}

std::string list_change(const json& was, const json& is)
{
    const size_t before = was.is_array() ? was.size() : 0, after = is.is_array() ? is.size() : 0;
    if (after == 0) return "removed all measurements";
    if (after == before + 1) {
        const std::string kind = text_at(is.back(), "kind", "distance");
        return sentence("measured ", kind == "angle" ? "an " : "a ", kind);
    }
    if (after > before) return sentence("added ", after - before, " measurements");
    const size_t gone = before - after;
    if (gone > 0) return sentence("removed ", gone == 1 ? "a measurement" : sentence(gone, " measurements"));
    for (size_t i = 0; i < after; ++i) {
        const std::string old_name = text_at(was[i], "name", ""), name = text_at(is[i], "name", "");
        if (old_name != name) return sentence("renamed the measurement ", in_quotes(old_name), " to ", in_quotes(name));
    }
    return "changed the measurements";
}

std::string mesh_name(const json& mesh)
{
    return "the mesh " + std::filesystem::path(text_at(mesh, "file", "")).filename().string();
}

/// "showed the mesh vein.stl"
std::string mesh_change(const json& was, const json& is)
{
    const auto without = [](const json& all, const json& others) {
        json left = json::array();
        for (const json& mesh : all)
            if (std::ranges::none_of(others, [&](const json& each) { return each["file"] == mesh["file"]; }))
                left.push_back(mesh);
        return left;
    };
    const json list = json::array(), before = was.is_array() ? was : list, after = is.is_array() ? is : list;
    const json added = without(after, before), gone = without(before, after);
    if (added.size() == 1 && gone.empty()) return "showed " + mesh_name(added[0]);
    if (gone.size() == 1 && added.empty()) return "removed " + mesh_name(gone[0]);
    if (added.size() > 1 && gone.empty()) return sentence("showed ", added.size(), " meshes");
    if (gone.size() > 1 && added.empty())
        return after.empty() ? "removed all meshes" : sentence("removed ", gone.size(), " meshes");
    std::vector<std::string> told;
    for (size_t i = 0; i < before.size() && before.size() == after.size() && added.empty(); ++i) {
        if (before[i] == after[i]) continue;
        if (before[i]["file"] != after[i]["file"]) return "changed the meshes";
        const bool is_shown = after[i].value("shown", true);
        if (before[i].value("shown", true) != is_shown)
            told.push_back((is_shown ? "showed " : "hid ") + mesh_name(after[i]));
        else
            told.push_back("changed the colour of " + mesh_name(after[i]));
    }
    return told.size() == 1 ? told[0] : "changed the meshes";
}

/// Describes the difference of one section.
std::string section_change(const std::string& name, const std::string& before, const std::string& after)
{
    const SectionRow section = section_named(name);
    const std::string as_whole = sentence("changed ", section.words);
    const auto parsed = [](const std::string& text) { return text.empty() ? json() : json::parse(text); };
    if (name == "measurements") return list_change(parsed(before), parsed(after));
    if (name == "meshes") return mesh_change(parsed(before), parsed(after));
    if (before.empty() || after.empty() || name == "transfer_function") return as_whole;
    const json was = parsed(before), is = parsed(after);
    std::vector<std::string> told;
    if (name == "cut") {
        told = plane_changes(was, is);
    } else if (name == "groups") {
        told = group_changes(was, is);
    } else {
        std::vector<ChangedKey> changes;
        add_changes(was, is, std::string(section.prefix), changes);
        if (changes.size() > MAX_TOLD) return as_whole;
        for (const ChangedKey& changed : changes) told.push_back(setting_change(changed));
    }
    if (told.empty() || told.size() > MAX_TOLD) return as_whole;
    std::string text;
    for (size_t i = 0; i < told.size(); ++i) text += (i == 0 ? "" : i + 1 < told.size() ? ", " : " and ") + told[i];
    return text;
}

SettingValues settings_of(Session session)
{
    const json settings = json::parse(write_fields({}, [&](Fields& f) { setting_fields(f, session); }));
    SettingValues values;
    for (const auto& [name, value] : settings.items()) values[name] = value.dump();
    return values;
}

}  // namespace

std::string difference_of(const SettingValues& before, const SettingValues& after)
{
    std::string text;
    for (const auto& [name, value] : after) {
        const auto was = before.find(name);
        const std::string old = was == before.end() ? std::string() : was->second;
        if (old != value) text += (text.empty() ? "" : "; ") + section_change(name, old, value);
    }
    return text;
}

std::string difference_in_words(const Session& before, const Session& after)
{
    return difference_of(settings_of(before), settings_of(after));
}

}  // namespace shvr
