#include "ui/panels/banners/banner.h"

#include <algorithm>

#include <imgui/imgui.h>

#include "ui/panels/style.h"

namespace shvr::ui {

namespace {

constexpr ImGuiWindowFlags BANNER = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                                    ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_AlwaysAutoResize |
                                    ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_NoNav;

}  // namespace

void begin_banner(const char* name, const glm::vec2& begin, float width)
{
    ImGui::SetNextWindowPos({begin.x, begin.y});
    ImGui::SetNextWindowSize({std::max(width, 1.0f), 0.0f});
    ImGui::PushStyleColor(ImGuiCol_WindowBg, color_of(ColorRole::notice));
    ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, 0.0f);
    ImGui::Begin(name, nullptr, BANNER);
}

float end_banner()
{
    const float height = ImGui::GetWindowHeight();
    ImGui::End();
    ImGui::PopStyleVar();
    ImGui::PopStyleColor();
    return height;
}

}  // namespace shvr::ui
