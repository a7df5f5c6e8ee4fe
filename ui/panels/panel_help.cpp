#include "ui/panels/panels.h"

#include <algorithm>
#include <cstring>
#include <string>
#include <utility>

#include <imgui/imgui.h>
#include <imgui/imgui_stdlib.h>

#include "engine/base/error.h"
#include "engine/workbench/bindings/keymap.h"
#include "engine/workbench/bindings/palette.h"
#include "engine/workbench/models/preference_rows.h"
#include "ui/panels/widgets.h"

namespace shvr::ui {

namespace {

constexpr float KEY_COLUMN = 12.5f;  ///< in font sizes: two chords fit

struct Gesture {
    const char* what;
    const char* meaning;
};
constexpr Gesture GESTURES[] = {
    {"Left button", "Use the tool of the tool bar: turn, paint, erase, trace, select or measure"},
    {"Alt + left drag", "Turn the volume with any tool"},
    {"Shift + left or middle drag", "Move the volume; in a slice, the slices"},
    {"Middle drag", "Turn the volume; with the tool that turns, move it; in a slice, move the slices"},
    {"Wheel", "Zoom; in a slice, the next one"},
    {"Shift + wheel", "Size of the brush and the probe"},
    {"Ctrl + wheel", "Push the probe away or pull it closer; in a slice, zoom"},
    {"Mouse without buttons", "The probe follows: in its plane with the tool that turns, else on what you see"},
    {"Double click, with the tool that turns", "Put the probe onto what you see there"},
    {"Right drag",
     "Turn the volume, in a slice change the contrast; with the tool that turns, zoom (thesis keys: paint)"},
    {"Double click on a setting", "Restore its default"},
    {"Shift while dragging a setting", "A tenth as far, for fine steps; so with the wheel over the curve"},
    {"Double click on the panels' edge", "Restore their default width"},
    {"Drop files", "Open them: scans, sessions, projects, masks, traces, transfer functions"},
    {"Click, with the tool that turns", "Select the node, or take the group, under the pointer; slices go there"},
    {"Click or drag in a slice", "Set the cross-hairs, and with them the other slices (tool that turns)"},
    {"Shift + move", "Slices follow the pointer; without Shift they stay where they are"},
    {"Ctrl + drag in a slice", "Contrast: sideways how much, up and down how bright"},
};

void heading(const char* text)
{
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImGui::Spacing();
    ImGui::TextColored(ImGui::GetStyleColorVec4(ImGuiCol_CheckMark), "%s", text);
    ImGui::TableNextColumn();
}

void row(const char* left, const char* right)
{
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImGui::TextWrapped("%s", left);
    ImGui::TableNextColumn();
    ImGui::TextWrapped("%s", right);
}

bool begin_list(const char* id)
{
    if (!ImGui::BeginTable(id, 2, ImGuiTableFlags_SizingFixedFit)) return false;
    ImGui::TableSetupColumn("keys", ImGuiTableColumnFlags_WidthFixed, KEY_COLUMN * ImGui::GetFontSize());
    ImGui::TableSetupColumn("meaning", ImGuiTableColumnFlags_WidthStretch);
    return true;
}

std::string in_words(const std::vector<Chord>& chords)
{
    std::string text;
    for (const Chord& chord : chords) text += (text.empty() ? "" : ", ") + in_words(chord);
    return text;
}

/// Draws a button with the keys of a shortcut's id, or of an action as text. After a click on it, the next key pressed
/// is bound to that.
void keys_of(const std::string& id, const std::vector<Chord>& chords, const Model& model, Actions& actions)
{
    const bool waits = model.awaits_key == id;
    const std::string keys = in_words(chords);
    const std::string label = waits ? "press a key ..." : keys.empty() ? "(no key)" : keys;
    ImGui::PushStyleVar(ImGuiStyleVar_ButtonTextAlign, {0.0f, 0.5f});
    if (waits) ImGui::PushStyleColor(ImGuiCol_Button, ImGui::GetStyleColorVec4(ImGuiCol_ButtonActive));
    if (ImGui::Button(label.c_str(), {KEY_COLUMN * ImGui::GetFontSize(), 0.0f}))
        actions.push_back(AwaitKey{waits ? "" : id});
    if (waits) ImGui::PopStyleColor();
    ImGui::PopStyleVar();
    hint(waits ? "Escape leaves it as it is; Delete takes the key away."
               : "Click, then press another key for it. Escape leaves it as it is; Delete takes the key away.");
}

/// Draws a text that needs the user's attention.
void warn(const std::string& text)
{
    ImGui::PushStyleColor(ImGuiCol_Text, WARNING);
    ImGui::TextWrapped("%s", text.c_str());
    ImGui::PopStyleColor();
}

/// Draws the question whether a key is taken over, in the row that waits for it.
void question(const std::string& id, const Model& model)
{
    if (model.awaits_key == id && !model.key_question.empty()) warn(std::string(model.key_question));
}

/// Shows the meaning of a shortcut, other shortcuts that have the same keys, and how to restore the default.
void meaning_of(const Shortcut& shortcut, const Model& model, Actions& actions)
{
    ImGui::AlignTextToFramePadding();
    ImGui::TextWrapped("%s", shortcut.name);
    if (model.preferences.keys.contains(shortcut.id)) {
        ImGui::SameLine();
        const char* const shipped = shortcut.keys[size_t(model.preferences.key_set)];
        if (ImGui::SmallButton("Reset")) actions.push_back(BindKeys{shortcut.id, shipped});
        hint(sentence("Default: ", *shipped ? shipped : "no key").c_str());
    }
    for (const Shortcut* rival : model.keymap.rivals_of(shortcut))
        warn(sentence("shares its key with: ", rival->name, "; only one of them acts"));
    question(shortcut.id, model);
}

bool is_found(const Shortcut& shortcut, const Model& model, const std::string& text)
{
    return has_words(
        sentence(shortcut.name, ' ', shortcut.group, ' ', shortcut.id, ' ', in_words(model.keymap.chords_of(shortcut))),
        text);
}

/// Draws the shortcuts under headings, one per group; `listed` is ordered by group.
void key_list(std::span<const Shortcut> listed, const Model& model, const std::string& text, Actions& actions)
{
    const char* group = "";
    for (const Shortcut& shortcut : listed) {
        if (!is_found(shortcut, model, text)) continue;
        if (std::strcmp(group, shortcut.group) != 0) heading(group = shortcut.group);
        ImGui::PushID(shortcut.id);
        ImGui::TableNextRow();
        ImGui::TableNextColumn();
        keys_of(shortcut.id, model.keymap.chords_of(shortcut), model, actions);
        ImGui::TableNextColumn();
        meaning_of(shortcut, model, actions);
        ImGui::PopID();
    }
}

/// Draws the entries of the palette to which the user bound keys.
void bound_list(const Model& model, const std::string& text, Actions& actions)
{
    constexpr const char* HEADING = "Entries of Find anything";
    bool is_first = true;
    for (const Keymap::Bound& bound : model.keymap.bound()) {
        if (!has_words(sentence(bound.name, ' ', HEADING, ' ', in_words(bound.chords)), text)) continue;
        if (std::exchange(is_first, false)) heading(HEADING);
        ImGui::PushID(bound.text.c_str());
        ImGui::TableNextRow();
        ImGui::TableNextColumn();
        keys_of(bound.text, bound.chords, model, actions);
        ImGui::TableNextColumn();
        ImGui::AlignTextToFramePadding();
        ImGui::TextWrapped("%s", bound.name.c_str());
        question(bound.text, model);
        ImGui::PopID();
    }
}

void mouse_list(const std::string& text)
{
    bool is_first = true;
    for (const Gesture& gesture : GESTURES) {
        if (!has_words(sentence("Mouse ", gesture.what, ' ', gesture.meaning), text)) continue;
        if (std::exchange(is_first, false)) heading("Mouse");
        row(gesture.what, gesture.meaning);
    }
}

/// Returns the index of a group's first shortcut near the middle, so that both columns are about equally long.
size_t middle(std::span<const Shortcut> listed)
{
    size_t at = listed.size() / 2 + std::size(GESTURES) / 2;
    while (at < listed.size() && std::strcmp(listed[at - 1].group, listed[at].group) == 0) ++at;
    return std::min(at, listed.size());
}

void both_columns(const Model& model, const std::string& text, Actions& actions)
{
    const std::span<const Shortcut> listed = shortcuts();
    const size_t split = text.empty() ? middle(listed) : listed.size();
    ImGui::TableNextColumn();
    if (begin_list("left")) {
        bound_list(model, text, actions);
        key_list(listed.first(split), model, text, actions);
        ImGui::EndTable();
    }
    ImGui::TableNextColumn();
    if (begin_list("right")) {
        mouse_list(text);
        key_list(listed.subspan(split), model, text, actions);
        ImGui::EndTable();
    }
}

void head(const Model& model, std::string& text, Actions& actions)
{
    ImGui::SetNextItemWidth(16.0f * ImGui::GetFontSize());
    ImGui::InputTextWithHint("##search", "search: a name or a key", &text);
    ImGui::SameLine(0.0f, 2.0f * ImGui::GetFontSize());
    ImGui::TextUnformatted("Keys");
    for (const auto& [set, name] : KEY_SETS) {
        ImGui::SameLine();
        if (ImGui::RadioButton(key_set_in_words(set), model.preferences.key_set == set))
            actions.push_back(ChooseKeys{std::string(name)});
    }
    ImGui::TextDisabled("Keys for turning, moving and cutting repeat while held; with Shift slowly.");
}

}  // namespace

void help_window(const Model& model, Actions& actions)
{
    static std::string text;
    bool is_open = model.shows_help;
    place_kept_window("help", {64.0, 54.0}, model);
    if (ImGui::Begin("Keys and mouse", &is_open, ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoSavedSettings)) {
        keep_window("help", model, actions);
        head(model, text, actions);
        if (ImGui::BeginTable("columns", 2, ImGuiTableFlags_ScrollY)) {
            ImGui::TableSetupColumn("left", ImGuiTableColumnFlags_WidthStretch, 0.42f);
            ImGui::TableSetupColumn("right", ImGuiTableColumnFlags_WidthStretch, 0.58f);
            both_columns(model, text, actions);
            ImGui::EndTable();
        }
    }
    ImGui::End();
    if (!is_open) actions.push_back(ShowHelp{false});
}

}  // namespace shvr::ui
