#include "ui/panels/color_field.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstring>

#include "engine/base/image.h"
#include "ui/panels/number_field.h"
#include "ui/panels/widgets.h"

namespace shvr::ui {

namespace {

/// Draws the three channels, from 0 to 255, side by side. Returns whether one was changed.
bool channels(ImVec4& color, float width)
{
    constexpr std::array FORMATS{"R:%.0f", "G:%.0f", "B:%.0f"};
    constexpr std::array IDS{"##red", "##green", "##blue"};
    const float gap = ImGui::GetStyle().ItemInnerSpacing.x;
    bool is_changed = false;
    for (size_t i = 0; i < 3; ++i) {
        float& share = (&color.x)[i];
        double value = 255.0 * double(share);
        if (i > 0) ImGui::SameLine(0.0f, gap);
        ImGui::SetNextItemWidth((width - 2.0f * gap) / 3.0f);
        if (!drag_number(IDS[i], value, 1.0, 0.0, 255.0, FORMATS[i])) continue;
        share = float(value / 255.0);
        is_changed = true;
    }
    return is_changed;
}

/// Draws the colour as six hexadecimal digits. Returns whether others were typed.
bool hexadecimal(ImVec4& color, float width)
{
    std::array<char, 16> text{};
    const auto byte = [](float share) { return unsigned(std::clamp(share, 0.0f, 1.0f) * 255.0f + 0.5f); };
    std::snprintf(text.data(), text.size(), "#%02X%02X%02X", byte(color.x), byte(color.y), byte(color.z));
    ImGui::SetNextItemWidth(width);
    constexpr ImGuiInputTextFlags FLAGS = ImGuiInputTextFlags_CharsHexadecimal | ImGuiInputTextFlags_CharsUppercase;
    if (!ImGui::InputText("##hexadecimal", text.data(), text.size(), FLAGS)) return false;
    const char* const digits = text[0] == '#' ? text.data() + 1 : text.data();
    std::array<unsigned, 3> bytes{};
    if (std::strlen(digits) != 6 || std::sscanf(digits, "%2X%2X%2X", &bytes[0], &bytes[1], &bytes[2]) != 3)
        return false;
    for (size_t i = 0; i < 3; ++i) (&color.x)[i] = float(bytes[i]) / 255.0f;
    return true;
}

/// The picker of Dear ImGui, with number fields that take a decimal comma. Returns whether the colour was changed.
bool picker(ImVec4& color)
{
    static ImVec4 original;
    if (ImGui::IsWindowAppearing()) original = color;
    const float width = 12.0f * ImGui::GetFrameHeight();
    constexpr ImGuiColorEditFlags FLAGS =
        ImGuiColorEditFlags_NoInputs | ImGuiColorEditFlags_NoLabel | ImGuiColorEditFlags_NoAlpha;
    ImGui::SetNextItemWidth(width);
    bool is_changed = ImGui::ColorPicker4("##picker", &color.x, FLAGS, &original.x);
    is_changed |= channels(color, width);
    is_changed |= hexadecimal(color, width);
    return is_changed;
}

/// Takes a colour that is dropped onto the widget drawn last. Returns whether one was.
bool take_dropped(ImVec4& color)
{
    if (!ImGui::BeginDragDropTarget()) return false;
    const ImGuiPayload* const dropped = ImGui::AcceptDragDropPayload(IMGUI_PAYLOAD_TYPE_COLOR_3F);
    if (dropped) std::memcpy(&color.x, dropped->Data, 3 * sizeof(float));
    ImGui::EndDragDropTarget();
    return dropped != nullptr;
}

}  // namespace

ImVec4 encoded(const glm::dvec3& linear, float alpha)
{
    const auto encode = [](double value) { return float(srgb_encode(std::clamp(value, 0.0, 1.0))); };
    return {encode(linear.x), encode(linear.y), encode(linear.z), alpha};
}

glm::dvec3 decoded(const float* srgb)
{
    const auto decode = [](float value) { return std::clamp(srgb_decode(double(value)), 0.0, 1.0); };
    return {decode(srgb[0]), decode(srgb[1]), decode(srgb[2])};
}

bool color_field(const char* label, glm::dvec3& linear, bool has_numbers)
{
    ImVec4 color = encoded(linear);
    bool is_changed = false;
    ImGui::BeginGroup();
    ImGui::PushID(label);
    if (has_numbers) {
        const float gap = ImGui::GetStyle().ItemInnerSpacing.x;
        is_changed |= channels(color, ImGui::CalcItemWidth() - ImGui::GetFrameHeight() - gap);
        ImGui::SameLine(0.0f, gap);
    }
    if (ImGui::ColorButton("##colour", color, ImGuiColorEditFlags_NoAlpha)) ImGui::OpenPopup("picker");
    is_changed |= take_dropped(color);
    if (ImGui::BeginPopup("picker")) {
        is_changed |= picker(color);
        end_popup();
    }
    ImGui::PopID();
    ImGui::EndGroup();
    if (is_changed) linear = decoded(&color.x);
    return is_changed;
}

}  // namespace shvr::ui
