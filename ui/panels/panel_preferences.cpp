// The user's preferences, which apply to all scans: theme, sizes, keys.

#include <algorithm>

#include <imgui/imgui.h>

#include "engine/workbench/models/preference_rows.h"
#include "ui/panels/panels.h"
#include "ui/panels/widgets.h"

namespace shvr::ui {

namespace {

constexpr float LABELS = 9.0f;  ///< width of the label column, in font sizes

void row_label(const char* text)
{
    ImGui::AlignTextToFramePadding();
    ImGui::TextUnformatted(text);
    ImGui::SameLine(LABELS * ImGui::GetFontSize());
}

void prefer(Actions& actions, const std::string& patch)
{
    actions.push_back(Prefer{"{" + patch + "}"});
}

void theme_row(const Preferences& preferences, Actions& actions)
{
    row_label("Theme");
    for (const Spelling<Theme>& each : THEMES) {
        const char* const name = each.value == Theme::dark ? "dark" : "light";
        if (ImGui::RadioButton(name, preferences.theme == each.value))
            prefer(actions, sentence("\"theme\":\"", each.name, '"'));
        ImGui::SameLine();
    }
    ImGui::NewLine();
}

/// Draws a number, up to `most`, behind its label. A change is applied only when the mouse is released, since it may
/// move the widget under the mouse.
void number_row(const PreferenceNumber& number, double now, double most, const char* format, Actions& actions)
{
    static const char* edited_key = nullptr;
    static double edited = 0.0;
    const char* const key = number.key;
    ImGui::PushID(key);
    ImGui::SetNextItemWidth(11.0f * ImGui::GetFontSize());
    double shown = edited_key == key ? edited : now;
    const bool is_changed = slider_scalar("##value", ImGuiDataType_Double, &shown, &number.least, &most, format);
    hint(number.hint);
    if (ImGui::IsItemActive() || is_changed) {
        edited_key = key;
        edited = shown;
    } else if (edited_key == key) {
        edited_key = nullptr;
        if (edited != now) prefer(actions, sentence('"', key, "\":", edited));
    }
    if (is_double_clicked()) {
        edited_key = nullptr;
        prefer(actions, sentence('"', key, "\":null"));
    }
    ImGui::PopID();
}

void keys_row(const Model& model, Actions& actions)
{
    row_label("Keys");
    for (const auto& [set, name] : KEY_SETS) {
        if (ImGui::RadioButton(key_set_in_words(set), model.preferences.key_set == set))
            actions.push_back(ChooseKeys{std::string(name)});
        ImGui::SameLine();
    }
    if (ImGui::Button("Change single keys...")) actions.push_back(ShowHelp{true});
}

/// Draws the row of a memory limit. By default there is no fixed limit: SHVR then uses as much memory as is free.
void budget_row(const PreferenceNumber& number, const std::optional<double>& mebibytes, uint64_t present_bytes,
                Actions& actions)
{
    constexpr double MAX_BY_MOUSE = 65536.0;
    ImGui::PushID(number.key);
    bool is_automatic = !mebibytes;
    row_label(number.label);
    if (ImGui::Checkbox("as much as fits", &is_automatic))
        prefer(actions, sentence('"', number.key, "\":",
                                 is_automatic ? std::string("null")
                                              : std::to_string(std::max<uint64_t>(present_bytes >> 20, 16))));
    hint(number.hint);
    if (mebibytes) {
        row_label("");
        number_row(number, *mebibytes, MAX_BY_MOUSE, "%.0f MiB", actions);
    }
    ImGui::PopID();
}

void buttons(Actions& actions)
{
    row_label("Panels");
    if (ImGui::Button("Reset the layout")) prefer(actions, "\"layout\":null");
    hint("All panels go back to the side, in their usual width.");
    row_label("First hints");
    if (ImGui::Button("Show again")) prefer(actions, "\"hints_seen\":0");
}

}  // namespace

void preferences_window(const Model& model, Actions& actions)
{
    const Preferences& preferences = model.preferences;
    bool is_open = true;
    ImGui::SetNextWindowPos(ImGui::GetMainViewport()->GetWorkCenter(), ImGuiCond_Appearing, {0.5f, 0.5f});
    const ImGuiWindowFlags flags =
        ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_AlwaysAutoResize;
    if (ImGui::Begin("Preferences", &is_open, flags)) {
        theme_row(preferences, actions);
        row_label(TEXT_SIZE.label);
        number_row(TEXT_SIZE, preferences.font_pixels, TEXT_SIZE.most, "%.0f pixels", actions);
        bool follows = !preferences.scale;
        row_label(WINDOW_SCALE.label);
        if (ImGui::Checkbox("as the screen says", &follows))
            prefer(actions, follows ? "\"scale\":null" : "\"scale\":1");
        hint("Follows the scale of the screen that the window is on.");
        if (preferences.scale) {
            row_label("");
            number_row(WINDOW_SCALE, *preferences.scale, WINDOW_SCALE.most, "%.2f times", actions);
        }
        keys_row(model, actions);
        budget_row(DEVICE_BUDGET, preferences.budget_device_mib, model.device_budget, actions);
        budget_row(HOST_BUDGET, preferences.budget_host_mib, uint64_t{1} << 30, actions);
        buttons(actions);
        ImGui::TextDisabled("Kept for all scans. Double-click a slider to restore its default.");
    }
    ImGui::End();
    if (!is_open) actions.push_back(ShowPreferences{false});
}

}  // namespace shvr::ui
