#include "ui/panels/widgets.h"

#include <algorithm>

#include <imgui/imgui.h>
#include <imgui/imgui_internal.h>

#include "engine/base/error.h"
#include "engine/session/session_patch.h"
#include "ui/panels/panels.h"

namespace shvr::ui {

namespace {

constexpr float LABEL_COLUMN = 8.6f;  ///< in font sizes: "Density painting" fits

}  // namespace

void text_label(const char* text)
{
    ImGui::TextUnformatted(text);
    ImGui::SameLine(LABEL_COLUMN * ImGui::GetFontSize());
}

void label(const char* text)
{
    ImGui::AlignTextToFramePadding();
    text_label(text);
}

bool slider(const char* label, double& value, double lower, double upper, const char* format, ImGuiSliderFlags flags)
{
    ImGui::SetNextItemWidth(-8.0f * ImGui::GetFontSize());
    return ImGui::SliderScalar(label, ImGuiDataType_Double, &value, &lower, &upper, format,
                               ImGuiSliderFlags_AlwaysClamp | flags);
}

bool resets(const char* key, Actions& actions)
{
    const bool is_hovered = ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenBlockedByPopup);
    if (!is_hovered || !ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left)) return false;
    ImGui::ClearActiveID();  // the widget would follow the mouse, or take typed digits
    actions.push_back(Set{patch_of(sentence(key, "=null"))});
    return true;
}

std::string shortened(const std::string& text, float width)
{
    constexpr const char* DOTS = "...";
    if (ImGui::CalcTextSize(text.c_str()).x <= width) return text;
    const float room = std::max(width - ImGui::CalcTextSize(DOTS).x, 0.0f);
    const char* end = nullptr;
    ImGui::GetFont()->CalcTextSizeA(ImGui::GetFontSize(), room, 0.0f, text.c_str(), text.c_str() + text.size(), &end);
    return std::string(text.c_str(), end) + DOTS;
}

const char* spelled(const std::string& unit)
{
    return unit == "um" ? "\u00b5m" : unit.c_str();
}

bool covers(const glm::dvec2& at)
{
    for (const ImGuiWindow* window : ImGui::GetCurrentContext()->Windows) {
        const bool is_seen = window->WasActive && !window->Hidden && !(window->Flags & ImGuiWindowFlags_NoMouseInputs);
        if (is_seen && !(window->Flags & ImGuiWindowFlags_Tooltip) &&
            window->OuterRectClipped.Contains({float(at.x), float(at.y)}))
            return true;
    }
    return false;
}

void hint(const char* text)
{
    if (!ImGui::IsItemHovered()) return;
    ImGui::BeginTooltip();
    ImGui::PushTextWrapPos(24.0f * ImGui::GetFontSize());
    ImGui::TextUnformatted(text);
    ImGui::PopTextWrapPos();
    ImGui::EndTooltip();
}

}  // namespace shvr::ui
