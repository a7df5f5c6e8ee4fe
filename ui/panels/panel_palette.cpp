// A search box for everything that the user can do or open (engine/workbench/bindings/palette.h).

#include <algorithm>
#include <string>
#include <utility>

#include <imgui/imgui.h>
#include <imgui/imgui_stdlib.h>

#include "engine/workbench/bindings/palette.h"
#include "ui/panels/field_keys.h"
#include "ui/panels/panels.h"
#include "ui/panels/widgets.h"

namespace shvr::ui {

namespace {

constexpr int MAX_PALETTE_LINES = 16;
constexpr ImGuiHoveredFlags HOVERED_AT_ALL =
    ImGuiHoveredFlags_ChildWindows | ImGuiHoveredFlags_AllowWhenBlockedByActiveItem;

struct Palette {
    std::string text;
    int chosen = 0;
    int shown_frame = -1;      ///< the last frame in which the box was drawn
    bool takes_keys = true;    ///< the search box gets the keyboard in the next frame
    bool ends_at_end = false;  ///< in the next frame, the cursor is also put behind the text
};
Palette palette;

int put_cursor_behind(ImGuiInputTextCallbackData* data)
{
    if (std::exchange(palette.ends_at_end, false))
        data->CursorPos = data->SelectionStart = data->SelectionEnd = data->BufTextLen;
    return 0;
}

void choose(const PaletteEntry& entry, Actions& actions)
{
    if (!entry.completion.empty()) {
        palette.text = entry.completion;
        palette.takes_keys = palette.ends_at_end = true;
        palette.chosen = 0;
    } else if (entry.action && entry.why_not.empty()) {
        actions.push_back(ShowPalette{false});
        actions.push_back(*entry.action);
        if (entry.then) actions.push_back(*entry.then);
    } else {
        palette.takes_keys = palette.ends_at_end = true;
    }
}

bool was_pressed(ImGuiKey key)
{
    return ImGui::IsKeyPressed(ImGui::GetKeyIndex(key));
}

/// Returns a text as it fits into the cell that begins here.
std::string in_cell(const std::string& text)
{
    return shortened(text, ImGui::GetContentRegionAvail().x);
}

/// Draws the next cell; a pointer over the line shows the whole of a cut text.
void cell(const std::string& text)
{
    ImGui::TableNextColumn();
    const std::string shown = in_cell(text);
    ImGui::TextDisabled("%s", shown.c_str());
    if (shown != text) hint(text.c_str());
}

/// Draws a line: the entry's name, its group or the reason why it is unavailable, and its keys.
bool line(PaletteEntry entry, bool is_chosen, int number)
{
    const bool is_grey = !entry.why_not.empty();
    ImGui::PushID(number);
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    const std::string name = std::exchange(entry.name, in_cell(entry.name));
    if (is_grey) ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled));
    const bool is_clicked =
        ImGui::Selectable(verbatim(entry.name).c_str(), is_chosen, ImGuiSelectableFlags_SpanAllColumns);
    if (is_grey) ImGui::PopStyleColor();
    if (name != entry.name) hint(name.c_str());
    if (is_chosen && !ImGui::IsItemVisible()) ImGui::SetScrollHereY();
    cell(is_grey ? entry.why_not : entry.group);
    cell(entry.keys);
    ImGui::PopID();
    return is_clicked;
}

void list(const std::vector<PaletteEntry>& entries, Actions& actions)
{
    const float height = ImGui::GetTextLineHeight() + 2.0f * ImGui::GetStyle().CellPadding.y;
    if (!ImGui::BeginTable("found", 3, ImGuiTableFlags_ScrollY, {0.0f, height * MAX_PALETTE_LINES})) return;
    ImGui::TableSetupColumn("name", ImGuiTableColumnFlags_WidthStretch, 0.42f);
    ImGui::TableSetupColumn("group", ImGuiTableColumnFlags_WidthStretch, 0.4f);
    ImGui::TableSetupColumn("keys", ImGuiTableColumnFlags_WidthStretch, 0.18f);
    for (int i = 0; i < int(entries.size()); ++i)
        if (line(entries[size_t(i)], i == palette.chosen, i)) choose(entries[size_t(i)], actions);
    ImGui::EndTable();
}

}  // namespace

void palette_window(const Model& model, Actions& actions)
{
    if (palette.shown_frame + 1 != ImGui::GetFrameCount()) palette = {};
    palette.shown_frame = ImGui::GetFrameCount();
    const float font = ImGui::GetFontSize();
    const ImGuiViewport& viewport = *ImGui::GetMainViewport();
    ImGui::SetNextWindowSize({std::min(50.0f * font, viewport.WorkSize.x), 0.0f});
    ImGui::SetNextWindowPos({viewport.GetWorkCenter().x, viewport.WorkPos.y + 2.0f * font}, ImGuiCond_Always,
                            {0.5f, 0.0f});
    // Arrow keys select a line while the text field keeps the keyboard.
    const ImGuiWindowFlags flags = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                                   ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_AlwaysAutoResize |
                                   ImGuiWindowFlags_NoNavInputs;
    if (palette.takes_keys) ImGui::SetNextWindowFocus();
    ImGui::Begin("Find anything", nullptr, flags);
    static FieldKeys keys;
    keys.before_field(std::exchange(palette.takes_keys, false));
    ImGui::SetNextItemWidth(-1.0f);
    const std::string before = palette.text;
    const bool is_entered = ImGui::InputTextWithHint(
        "##text",
        "words of anything: an action, a panel, a file, an address, a group, or a setting and its value (ambient 0.4)",
        &palette.text, ImGuiInputTextFlags_EnterReturnsTrue | ImGuiInputTextFlags_CallbackAlways, put_cursor_behind);
    keys.after_field();
    const bool field_is_active = ImGui::IsItemActive();
    if (before != palette.text) palette.chosen = 0;
    const std::vector<PaletteEntry> entries = palette_entries(model, palette.text);
    if (was_pressed(ImGuiKey_DownArrow)) ++palette.chosen;
    if (was_pressed(ImGuiKey_UpArrow)) --palette.chosen;
    palette.chosen = std::clamp(palette.chosen, 0, std::max(int(entries.size()) - 1, 0));
    list(entries, actions);
    if (entries.empty()) ImGui::TextDisabled("No entry has these words in its name.");
    if (!entries.empty() && !entries[size_t(palette.chosen)].why_not.empty())
        ImGui::TextWrapped("%s", entries[size_t(palette.chosen)].why_not.c_str());
    if (is_entered && entries.empty()) palette.takes_keys = true;  // Enter has made the field release the keyboard
    if (is_entered && !entries.empty()) choose(entries[size_t(palette.chosen)], actions);
    const PaletteEntry* const chosen = entries.empty() ? nullptr : &entries[size_t(palette.chosen)];
    const bool can_bind = chosen && !chosen->bound_as.empty();
    if (can_bind && (ImGui::SmallButton("Give it a key (Insert)") || was_pressed(ImGuiKey_Insert))) {
        actions.push_back(ShowPalette{false});
        actions.push_back(AwaitKey{chosen->bound_as});
    }
    // No key reaches the picture while this is shown, so a click elsewhere ends it.
    if (ImGui::IsMouseClicked(ImGuiMouseButton_Left) && !ImGui::IsWindowHovered(HOVERED_AT_ALL))
        actions.push_back(ShowPalette{false});
    if (!keys.are_awaited() && !field_is_active && !ImGui::IsAnyItemActive()) palette.takes_keys = true;
    if (was_pressed(ImGuiKey_Escape)) actions.push_back(ShowPalette{false});
    ImGui::End();
}

}  // namespace shvr::ui
