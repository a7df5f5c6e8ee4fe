// KEYS.md lists every shortcut with its keys in both sets and the action it makes.

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "engine/base/file.h"
#include "engine/workbench/actions/action_rows.h"
#include "engine/workbench/bindings/shortcuts.h"
#include "tests/support/model_world.h"

using namespace shvr;
using namespace shvr::test;
using namespace shvr::ui;

namespace {

/// "probe.brush", "light.ambient": the settings that a patch names.
void name_settings(const nlohmann::json& patch, const std::string& prefix, std::string& names)
{
    for (const auto& [key, value] : patch.items()) {
        const std::string name = prefix.empty() ? key : prefix + '.' + key;
        if (value.is_object() && !value.empty())
            name_settings(value, name, names);
        else
            names += (names.empty() ? "" : ", ") + name;
    }
}

/// "orbit", "set probe.brush"
std::string in_short(const Action& action)
{
    std::string text = row_of(action).id;
    if (const auto* const set = action.as<Set>()) {
        std::string names;
        if (!set->patch.empty()) name_settings(nlohmann::json::parse(set->patch), "", names);
        text += ' ' + names;
    }
    return text;
}

std::string in_code(const char* keys)
{
    return *keys ? sentence('`', keys, '`') : std::string();
}

}  // namespace

TEST_CASE("KEYS.md says of each shortcut what the program does")
{
    std::string expected =
        "# Keys\n\nEvery shortcut, its keys in today's set and in the thesis's, and the action that it makes. Chords "
        "are\n"
        "separated by spaces. `tests/unit/ui/keys_table_test.cpp` prints this file where it differs.\n";
    const World world;
    std::string group;
    for (const Shortcut& shortcut : shortcuts()) {
        if (std::exchange(group, shortcut.group) != shortcut.group)
            expected +=
                sentence("\n## ", group, "\n\n| shortcut | does | today | thesis | action |\n|---|---|---|---|---|\n");
        expected += sentence("| `", shortcut.id, "` | ", shortcut.name, " | ", in_code(shortcut.keys[0]), " | ",
                             in_code(shortcut.keys[1]), " | ", in_short(shortcut.action(world.model, 1.0)), " |\n");
    }
    const std::string written = read_text("engine/workbench/bindings/KEYS.md", int64_t{1} << 20);
    if (written != expected) std::puts(expected.c_str());
    CHECK((written == expected));
}
