// Hints at the first start, in a strip above the side panel: they neither cover nor move the picture.

#include <algorithm>

#include <imgui/imgui.h>

#include "engine/base/text.h"
#include "engine/workbench/bindings/hints.h"
#include "engine/workbench/models/preferences.h"
#include "ui/panels/panels.h"

namespace shvr::ui {

float first_hints(const Model& model, const ImVec2& begin, float width, Actions& actions)
{
    const int number = model.preferences.hints_seen;
    if (number >= FIRST_HINTS || model.shows_help || model.shows_palette || model.shows_preferences) return 0.0f;
    const auto seen = [&](int count) { actions.push_back(Prefer{sentence("{\"hints_seen\":", count, "}")}); };
    ImGui::SetNextWindowPos(begin);
    ImGui::SetNextWindowSize({std::max(width, 1.0f), 0.0f});
    ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, 0.0f);
    ImGui::Begin("First hints", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                     ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_NoNav);
    ImGui::TextWrapped("%s", first_hint(number, model.keymap).c_str());
    const bool is_last = number + 1 == FIRST_HINTS;
    if (ImGui::Button(is_last ? "Done" : "Next hint")) seen(number + 1);
    ImGui::SameLine();
    if (!is_last && ImGui::Button("No more hints")) seen(FIRST_HINTS);
    ImGui::SameLine();
    ImGui::TextDisabled("%d of %d", number + 1, FIRST_HINTS);
    const float height = ImGui::GetWindowHeight();
    ImGui::End();
    ImGui::PopStyleVar();
    return height;
}

}  // namespace shvr::ui
