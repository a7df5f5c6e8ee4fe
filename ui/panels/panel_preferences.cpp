// The user's preferences, which apply to all scans: theme, sizes, keys.

#include <algorithm>

#include <imgui/imgui.h>

#include "engine/workbench/models/preferences.h"
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

/// Draws a number. A change is applied only when the mouse is released, since it may move the widget under the mouse.
void number_row(const char* label, const char* key, double now, double least, double most, const char* format,
                const char* text, Actions& actions)
{
    static const char* edited_key = nullptr;
    static double edited = 0.0;
    row_label(label);
    ImGui::PushID(key);
    ImGui::SetNextItemWidth(11.0f * ImGui::GetFontSize());
    double shown = edited_key == key ? edited : now;
    const bool is_changed = slider_scalar("##value", ImGuiDataType_Double, &shown, &least, &most, format);
    hint(text);
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
    for (const auto& [set, name] :
         {std::pair{KeySet::modern, "usual"}, std::pair{KeySet::thesis, "of the SHVR thesis"}}) {
        if (ImGui::RadioButton(name, model.preferences.key_set == set))
            actions.push_back(ChooseKeys{std::string(KEY_SETS[size_t(set)].name)});
        ImGui::SameLine();
    }
    if (ImGui::Button("Change single keys...")) actions.push_back(ShowHelp{true});
}

/// Draws the row of a memory limit. By default there is no fixed limit: SHVR then uses as much memory as is free.
void budget_row(const char* label, const char* key, const std::optional<double>& mebibytes, uint64_t present_bytes,
                const char* meaning, Actions& actions)
{
    ImGui::PushID(key);
    bool is_automatic = !mebibytes;
    row_label(label);
    if (ImGui::Checkbox("as much as fits", &is_automatic))
        prefer(actions, sentence('"', key, "\":",
                                 is_automatic ? std::string("null")
                                              : std::to_string(std::max<uint64_t>(present_bytes >> 20, 16))));
    hint(meaning);
    if (mebibytes) number_row("", key, *mebibytes, Preferences::MIN_BUDGET_MIB, 65536.0, "%.0f MiB", meaning, actions);
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
        number_row("Text", "font_pixels", preferences.font_pixels, Preferences::MIN_FONT_PIXELS,
                   Preferences::MAX_FONT_PIXELS, "%.0f pixels", "Font size at a scale of 1.", actions);
        bool follows = !preferences.scale;
        row_label("Scale");
        if (ImGui::Checkbox("as the screen says", &follows))
            prefer(actions, follows ? "\"scale\":null" : "\"scale\":1");
        hint("Follows the scale of the screen that the window is on.");
        if (preferences.scale)
            number_row("", "scale", *preferences.scale, Preferences::MIN_SCALE, Preferences::MAX_SCALE, "%.2f times",
                       "Size of everything except the picture.", actions);
        keys_row(model, actions);
        budget_row("GPU memory", "budget_device_mib", preferences.budget_device_mib, model.device_budget,
                   "Device memory for volumes, pictures and paint. Applies from the next start.", actions);
        budget_row("Memory", "budget_host_mib", preferences.budget_host_mib, uint64_t{1} << 30,
                   "Main memory for bricks on their way to the device, from the next start; imports that need more are "
                   "refused.",
                   actions);
        buttons(actions);
        ImGui::TextDisabled("Kept for all scans. Double-click a slider to restore its default.");
    }
    ImGui::End();
    if (!is_open) actions.push_back(ShowPreferences{false});
}

}  // namespace shvr::ui
