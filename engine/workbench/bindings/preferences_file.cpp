#include "engine/workbench/bindings/preferences_file.h"

#include <algorithm>

#include "engine/base/assets.h"
#include "engine/base/atomic_file.h"
#include "engine/base/file.h"
#include "engine/base/json.h"
#include "engine/base/text.h"
#include "engine/remote/address.h"
#include "engine/session/fields.h"
#include "engine/session/session_patch.h"
#include "engine/workbench/bindings/keymap.h"

namespace shvr::ui {

namespace {

constexpr int64_t MAX_BYTES = int64_t{1} << 20;

/// Moves key changes that no keymap accepts from `keys` to `unusable_keys`. Returns the reasons, one for each change.
std::vector<std::string> take_out_unusable(Preferences& preferences)
{
    std::vector<std::string> reasons;
    for (auto each = preferences.keys.begin(); each != preferences.keys.end();) {
        try {
            static_cast<void>(Keymap(preferences.key_set, {*each}));
            ++each;
        } catch (const Error& error) {
            reasons.emplace_back(error.what());
            preferences.unusable_keys.insert(*each);
            each = preferences.keys.erase(each);
        }
    }
    return reasons;
}

void key_fields(Fields& f, KeyChanges& keys)
{
    std::vector<std::string> ids;
    for (const auto& [id, chords] : keys) ids.push_back(id);
    const auto visit = [&](Fields& entry, const std::string& id) {
        std::string text;
        for (const std::string& chord : keys[id]) text += (text.empty() ? "" : " ") + chord;
        entry.text("keys", text, {});
        keys[id].clear();
        for (const std::string_view chord : words_of(text)) keys[id].emplace_back(chord);
    };
    f.entries("keys", ids, "ID", visit, {});
}

struct RecentFile {
    std::filesystem::path path;
};
void fields(Fields& f, RecentFile& recent)
{
    f.path("path", recent.path, {.allowed = PATH_OR_ADDRESS, .is_required = true});
}

void fields(Fields& f, PanelLayout& panel)
{
    const NumberRange places{-1e5, 1e5}, sizes{1.0, 1e4};
    std::string place = panel.place ? std::string(spelled(*panel.place)) : "as shipped";
    f.choice("place", place, {"as shipped", "side", "floating", "hidden"}, {});
    panel.place.reset();
    for (const Spelling<PanelPlace>& each : PANEL_PLACES)
        if (each.name == place) panel.place = each.value;
    f.any_flag("folded", panel.folded, {});
    f.numbers("at", panel.at, places, {});
    f.numbers("size", panel.size, sizes, {});
}

void fields(Fields& f, WindowPlace& window)
{
    f.numbers("at", window.at, NumberRange{-1e5, 1e5}, {});
    f.numbers("size", window.size, NumberRange{1.0, 1e4}, {});
}

void fields(Fields& f, WindowLayout& layout)
{
    std::vector<std::string> ids;
    for (const auto& [id, panel] : layout.panels) ids.push_back(id);
    f.entries("panels", ids, "ID", [&](Fields& entry, const std::string& id) { fields(entry, layout.panels[id]); }, {});
    for (const auto& [id, panel] : layout.panels)
        f.check("panels." + id, panel_named(id) != nullptr, "the id of a panel, as \"groups\"");
    ids.clear();
    for (const auto& [id, window] : layout.windows) ids.push_back(id);
    f.entries("windows", ids, "ID", [&](Fields& entry, const std::string& id) { fields(entry, layout.windows[id]); },
              {});
    for (const auto& [id, window] : layout.windows)
        f.check("windows." + id, std::ranges::find(WINDOW_IDS, id) != std::end(WINDOW_IDS),
                "main, help, messages, passes or operations");
    f.number("side_width", layout.side_width, NumberRange{MIN_SIDE_WIDTH, 1000.0}, {});
    f.flag("shows_side", layout.shows_side, {});
    f.flag("shows_tool_bar", layout.shows_tool_bar, {});
}

void fields(Fields& f, Preferences& preferences)
{
    int64_t version = 1;
    f.whole("shvr_preferences", version, 1, 1, {.is_required = true});
    f.choice("key_set", preferences.key_set, {});
    f.choice("theme", preferences.theme, {});
    f.number("font_pixels", preferences.font_pixels,
             NumberRange{Preferences::MIN_FONT_PIXELS, Preferences::MAX_FONT_PIXELS}, {});
    f.number("scale", preferences.scale, NumberRange{Preferences::MIN_SCALE, Preferences::MAX_SCALE}, {});
    const NumberRange budgets{Preferences::MIN_BUDGET_MIB, Preferences::MAX_BUDGET_MIB};
    f.number("budget_device_mib", preferences.budget_device_mib, budgets, {});
    f.number("budget_host_mib", preferences.budget_host_mib, budgets, {});
    f.section("layout", [&](Fields& inner) { fields(inner, preferences.layout); });
    f.section("device", [&](Fields& inner) {
        inner.text("name", preferences.device.name, {});
        inner.text("serial", preferences.device.serial, {});
    });
    f.choice("puck", preferences.puck, {});
    f.whole("hints_seen", preferences.hints_seen, 0, 1000, {});
    preferences.keys.merge(preferences.unusable_keys);  // if both change one shortcut, the usable change wins
    preferences.unusable_keys.clear();
    key_fields(f, preferences.keys);
    std::vector<RecentFile> recent;
    for (const std::filesystem::path& path : preferences.recent) recent.push_back({path});
    f.list("recent", recent, Preferences::MAX_RECENT, {});
    preferences.recent.clear();
    for (RecentFile& each : recent) preferences.recent.push_back(std::move(each.path));
}

}  // namespace

Preferences patched(const Preferences& preferences, std::string_view patch)
{
    Preferences written = preferences, read;
    const std::string text = write_fields({}, [&](Fields& f) { fields(f, written); });
    const JsonDocument document(merged(text, patch, "preferences"), "preferences",
                                {.depth = 8, .expected = "preferences"});
    read_fields(document.root(), {}, [&](Fields& f) { fields(f, read); });
    static_cast<void>(take_out_unusable(read));
    for (const auto& [id, chords] : read.unusable_keys) {
        const auto known = preferences.unusable_keys.find(id);
        const bool is_new = known == preferences.unusable_keys.end() || known->second != chords;
        if (is_new) static_cast<void>(Keymap(read.key_set, {{id, chords}}));  // fails, saying why
    }
    return read;
}

/// Writes only the members that changed: a patch leaves all others at their values.
std::string patch_of_panel(const std::string& id, const PanelLayout& change)
{
    std::string parts;
    const auto add = [&](const char* name, const std::string& value) {
        parts += sentence(parts.empty() ? "" : ",", '"', name, "\":", value);
    };
    if (change.place) add("place", sentence('"', spelled(*change.place), '"'));
    if (change.folded) add("folded", *change.folded ? "true" : "false");
    if (change.at) add("at", sentence('[', change.at->x, ',', change.at->y, ']'));
    if (change.size) add("size", sentence('[', change.size->x, ',', change.size->y, ']'));
    return sentence("{\"layout\":{\"panels\":{\"", id, "\":{", parts, "}}}}");
}

std::string patch_of_window(const std::string& id, const glm::dvec2& at, const glm::dvec2& size)
{
    return sentence("{\"layout\":{\"windows\":{\"", id, "\":{\"at\":[", at.x, ',', at.y, "],\"size\":[", size.x, ',',
                    size.y, "]}}}}");
}

std::filesystem::path preferences_file(const std::filesystem::path& settings)
{
    return settings.empty() ? settings : settings / "preferences.json";
}

Preferences load_preferences(const std::filesystem::path& file, std::vector<std::string>* complaints)
{
    Preferences preferences;
    std::error_code ignored;
    if (file.empty() || !std::filesystem::exists(file, ignored)) return preferences;
    const JsonDocument document = read_json(file, MAX_BYTES, {.depth = 8, .expected = "preferences"});
    read_fields(document.root(), file.parent_path(), [&](Fields& f) { fields(f, preferences); });
    for (const std::string& reason : take_out_unusable(preferences))
        if (complaints) complaints->push_back(sentence(file.string(), ": ", reason, "; the other keys are used"));
    return preferences;
}

void save_preferences(const std::filesystem::path& file, const Preferences& preferences)
{
    Preferences written = preferences;  // fields take what they may change
    const std::string text = write_fields(file.parent_path(), [&](Fields& f) { fields(f, written); }) + "\n";
    std::error_code error;
    std::filesystem::create_directories(file.parent_path(), error);
    if (error) fail(file.parent_path().string(), ": cannot be made: ", error.message());
    write_file_atomically(file, std::as_bytes(std::span(text)));
}

}  // namespace shvr::ui
