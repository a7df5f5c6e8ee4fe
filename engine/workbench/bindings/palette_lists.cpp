#include "engine/workbench/bindings/palette_lists.h"

#include <charconv>

#include "engine/base/text.h"
#include "engine/session/transfer_presets.h"
#include "engine/workbench/actions/action_rows.h"
#include "engine/workbench/appearance/layout.h"
#include "engine/workbench/bindings/action_names.h"
#include "engine/workbench/bindings/preferences_file.h"
#include "engine/workbench/edits/edit.h"
#include "engine/workbench/edits/group_steps.h"
#include "engine/workbench/models/preference_rows.h"

namespace shvr::ui {

namespace {

constexpr size_t MAX_OF_A_KIND = 20;

/// Collects the entries of one kind.
class Listing {
public:
    Listing(std::vector<PaletteEntry>& entries, const Model& model, std::string_view text)
        : entries_(entries), model_(model), text_(text)
    {}
    void add(const Action& action, const std::string& group) { add(name_of(action), group, action); }
    /// `also`: further words that find it.
    void add(const std::string& name, const std::string& group, const Action& action,
             const std::optional<Action>& then = {}, const char* also = "")
    {
        if (left_ == 0 || !has_words(sentence(name, ' ', group, ' ', also), text_)) return;
        --left_;
        entries_.push_back(
            {.name = name, .group = group, .why_not = why_not(model_, action), .action = action, .then = then});
    }

private:
    std::vector<PaletteEntry>& entries_;
    const Model& model_;
    std::string_view text_;
    size_t left_ = MAX_OF_A_KIND;
};

/// Returns the action that shows a panel, unfolded. A floating panel keeps floating.
Action shown_panel(const PanelRow& row, const WindowLayout& layout)
{
    const PanelPlace place = layout.place_of(row);
    const std::string patch =
        patch_of_panel(row.id, {.place = place == PanelPlace::hidden ? PanelPlace::side : place, .folded = false});
    if (place == PanelPlace::floating || layout.shows_side) return Prefer{patch};
    return Prefer{R"({"layout":{"shows_side":true,)" + patch.substr(std::string_view(R"({"layout":{)").size())};
}

/// Adds the node whose number is the text's last word: "node 12".
void add_node(std::vector<PaletteEntry>& entries, const Model& model, std::string_view text)
{
    const std::string_view last = text.substr(text.rfind(' ') + 1);
    uint32_t number = 0;
    const auto [end, error] = std::from_chars(last.data(), last.data() + last.size(), number);
    if (error != std::errc() || end != last.data() + last.size() || !model.trace.nodes().contains(number)) return;
    Listing(entries, model, text)
        .add(sentence("Node ", number), "Trace: selects it and looks at it",
             SelectOp{.near = {}, .number = number, .within_voxels = {}},
             GoTo{model.trace.node(number).position / model.volume.spacing});
}

void add_preferences(std::vector<PaletteEntry>& entries, const Model& model, std::string_view text)
{
    Listing preferences(entries, model, text);
    for (const Spelling<Theme>& theme : THEMES)
        preferences.add(Prefer{sentence("{\"theme\":\"", theme.name, "\"}")}, "Preferences: colours of the window");
    for (const PreferenceNumber& number : PREFERENCE_NUMBERS)
        preferences.add(number.label, sentence("Preferences: ", number.hint), ShowPreferences{true});
    for (const Spelling<KeySet>& set : KEY_SETS)
        preferences.add(ChooseKeys{std::string(set.name)}, "Preferences: the set of keys");
    for (const Spelling<PuckMoves>& moved : PUCK_MOVES)
        preferences.add(Prefer{sentence("{\"puck\":\"", moved.name, "\"}")}, "Touch: a device that reports speeds");
}

/// Adds what paints: operations on groups, each in its window, brushes and groups.
void add_painting(std::vector<PaletteEntry>& entries, const Model& model, std::string_view text)
{
    Listing operations(entries, model, text);
    for (const OperationRow& row : OPERATION_ROWS)
        operations.add(row.title, sentence("Operations on groups: ", row.meaning),
                       ShowDialog{Dialog::operation, row.id}, {}, row.id);
    Listing brushes(entries, model, text);
    for (const BrushRow& row : BRUSHES)
        brushes.add(Set{sentence(R"({"probe":{"brush":")", row.key, "\"}}")},
                    row.brush == model.brush().brush ? "Brush: the present one" : "Brush");
    Listing groups(entries, model, text);
    for (const uint8_t group : known_groups(model))
        groups.add(sentence("Group ", int(group), ' ', group_of(model.session.groups, group).name),
                   "Groups: paints and traces with it", Set{sentence(R"({"probe":{"group":)", int(group), "}}")});
    Listing changes(entries, model, text);
    for (const uint8_t group : known_groups(model)) {
        const ColorGroup look = group_of(model.session.groups, group);
        const std::string name = sentence(" group ", int(group), ' ', look.name);
        const auto change = [&](const char* key, bool is_so) {
            return Set{sentence(R"({"groups":{")", int(group), R"(":{")", key, "\":", is_so ? "false" : "true", "}}}")};
        };
        const bool is_locked = locked_groups(model.session.groups)[group];
        changes.add((look.visible ? "Hide" : "Show") + name, "Groups", change("visible", look.visible));
        changes.add((is_locked ? "Unlock" : "Lock") + name, "Groups", change("locked", is_locked));
    }
}

/// Adds what gives the volume another look: transfer functions, and looks that the user saved.
void add_looks(std::vector<PaletteEntry>& entries, const Model& model, std::string_view text)
{
    Listing functions(entries, model, text);
    for (const TransferPreset& preset : model.presets)
        functions.add("Transfer function " + preset.name, "Transfer functions: fitted to the scan",
                      edited(model.session, [&](Session& s) { s.transfer_preset = preset.name; }));
    Listing looks(entries, model, text);
    for (const NamedLook& look : model.looks)
        looks.add(TakeLook{look.name}, "Looks: groups, light and transfer function");
}

}  // namespace

void add_listed(std::vector<PaletteEntry>& entries, const Model& model, std::string_view text)
{
    Listing recent(entries, model, text);
    for (const std::filesystem::path& path : model.preferences.recent)
        recent.add(Open{path}, "Recent: " + path.parent_path().string());
    add_preferences(entries, model, text);
    if (!model.is_open) return;
    Listing panels(entries, model, text);
    for (const PanelRow& row : panel_rows())
        panels.add(row.title, sentence("Panel: ", row.hint), shown_panel(row, model.preferences.layout));
    add_painting(entries, model, text);
    Listing views(entries, model, text);
    for (const std::string& camera : camera_names(model.session)) views.add(LookFrom{camera}, "Views");
    add_looks(entries, model, text);
    add_node(entries, model, text);
}

}  // namespace shvr::ui
