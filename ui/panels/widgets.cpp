#include "ui/panels/widgets.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <imgui/imgui.h>
#include <imgui/imgui_internal.h>
#include <imgui/imgui_stdlib.h>

#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/session/session_patch.h"
#include "engine/workbench/curves/fine_drag.h"
#include "ui/panels/number_field.h"
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

void row(const char* text)
{
    label(text);
    ImGui::SetNextItemWidth(-FLT_MIN);
}

bool slider(const char* label, double& value, double lower, double upper, const char* format, ImGuiSliderFlags flags)
{
    row(label);
    return slider_scalar(sentence("##", label).c_str(), ImGuiDataType_Double, &value, &lower, &upper, format, flags);
}

namespace {

/// While the mouse drags a slider with Shift, replaces the mouse position by one that moves more slowly.
class HeldSlider {
public:
    explicit HeldSlider(ImGuiID slider) : slider_(slider)
    {
        ImGuiIO& io = ImGui::GetIO();
        const bool is_held = slider == held_slider_ && ImGui::GetActiveID() == slider && io.MouseDown[0];
        if (!is_held) return;
        const glm::vec2 at = drag_.follow({mouse_.x, mouse_.y}, io.KeyShift);
        io.MousePos = {at.x, at.y};
    }
    ~HeldSlider()
    {
        ImGui::GetIO().MousePos = mouse_;
        if (!ImGui::IsItemActivated()) return;
        held_slider_ = slider_;
        drag_ = FineDrag({mouse_.x, mouse_.y}, {mouse_.x, mouse_.y});
    }
    HeldSlider(const HeldSlider&) = delete;
    HeldSlider& operator=(const HeldSlider&) = delete;

private:
    static inline ImGuiID held_slider_ = 0;
    static inline FineDrag drag_;
    ImGuiID slider_;
    ImVec2 mouse_ = ImGui::GetIO().MousePos;
};

}  // namespace

/// Draws the number over the handle, on a background in the frame's colour; the handle stays visible above and below.
bool slider_scalar(const char* id, ImGuiDataType type, void* value, const void* lower, const void* upper,
                   const char* format, ImGuiSliderFlags flags)
{
    if (is_typed_over(id)) return typed_over(id, type, value, lower, upper, format);
    ImGui::PushStyleColor(ImGuiCol_Text, IM_COL32_BLACK_TRANS);
    const bool is_changed = [&] {
        const TypedLater typed_later(id);
        const HeldSlider held(ImGui::GetID(id));
        return ImGui::SliderScalar(id, type, value, lower, upper, format, ImGuiSliderFlags_AlwaysClamp | flags);
    }();
    ImGui::PopStyleColor();
    if (is_typed_over(id)) return is_changed;
    constexpr float SPARE = 2.0f;  // pixels next to the number
    const ImVec2 begin = ImGui::GetItemRectMin(), end = ImGui::GetItemRectMax();
    ImDrawList& list = *ImGui::GetWindowDrawList();
    std::array<char, 64> text{};
    ImGui::DataTypeFormatString(text.data(), int(text.size()), type, value, format);
    const ImVec2 size = ImGui::CalcTextSize(text.data());
    const ImVec2 at{std::floor(0.5f * (begin.x + end.x - size.x)), begin.y + ImGui::GetStyle().FramePadding.y};
    const ImGuiCol ground = ImGui::IsItemActive()    ? ImGuiCol_FrameBgActive
                            : ImGui::IsItemHovered() ? ImGuiCol_FrameBgHovered
                                                     : ImGuiCol_FrameBg;
    list.AddRectFilled({at.x - SPARE, at.y}, {at.x + size.x + SPARE, at.y + size.y}, ImGui::GetColorU32(ground));
    list.PushClipRect(begin, end, true);
    list.AddText(at, ImGui::GetColorU32(ImGuiCol_Text), text.data());
    list.PopClipRect();
    return is_changed;
}

/// Divides the speed: with Shift, Dear ImGui changes a value ten times as fast, but a tenth of the speed is wanted.
bool drag_number(const char* id, double& value, double speed, double lower, double upper, const char* format,
                 ImGuiSliderFlags flags)
{
    if (is_typed_over(id)) return typed_over(id, ImGuiDataType_Double, &value, &lower, &upper, format);
    const TypedLater typed_later(id);
    const double by_shift = ImGui::GetIO().KeyShift ? 0.1 * double(FineDrag::SHARE) : 1.0;
    return ImGui::DragScalar(id, ImGuiDataType_Double, &value, float(by_shift * speed), &lower, &upper, format,
                             ImGuiSliderFlags_AlwaysClamp | flags);
}

bool is_double_clicked()
{
    const bool is_hovered = ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenBlockedByPopup);
    if (!is_hovered || !ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left)) return false;
    ImGui::ClearActiveID();  // otherwise, the widget would follow the mouse, or take typed digits
    return true;
}

bool resets(const char* key, Actions& actions)
{
    if (!is_double_clicked()) return false;
    actions.push_back(Set{patch_of(sentence(key, "=null"))});
    return true;
}

bool is_window_dragged()
{
    const ImGuiWindow* const moving = ImGui::GetCurrentContext()->MovingWindow;
    return moving && moving->RootWindow == ImGui::GetCurrentWindowRead()->RootWindow;
}

bool begin_menu(const char* label, bool is_enabled)
{
    const float height = ImGui::GetMainViewport()->WorkSize.y - 2.0f * ImGui::GetStyle().DisplaySafeAreaPadding.y;
    ImGui::SetNextWindowSizeConstraints({0.0f, 0.0f}, {FLT_MAX, std::max(height, ImGui::GetFontSize())});
    const bool is_open = ImGui::BeginMenu(label, is_enabled);
    if (!is_open) ImGui::GetCurrentContext()->NextWindowData.ClearFlags();  // otherwise the next window would use them
    return is_open;
}

void close_menus_by_escape()
{
    const ImGuiContext& context = *ImGui::GetCurrentContext();
    const bool is_menu = !context.OpenPopupStack.empty() &&
                         context.OpenPopupStack[0].OpenParentId == context.CurrentWindow->IDStack.back();
    if (is_menu && ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape))) ImGui::ClosePopupToLevel(0, true);
}

bool begin_dialog(const char* title, ImGuiWindowFlags flags)
{
    const bool is_open = ImGui::BeginPopupModal(title, nullptr, flags);
    if (is_open) ImGui::GetCurrentWindow()->WasActive = true;
    return is_open;
}

void end_popup()
{
    if (ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape))) ImGui::CloseCurrentPopup();
    ImGui::EndPopup();
}

namespace {

/// The name that is being typed. One field at a time has the keyboard.
struct TypedName {
    ImGuiID field = 0;
    std::string text;
    int frame = -1;  ///< in which the field was drawn last
};
TypedName typed_name;

}  // namespace

std::optional<std::string> name_field(const char* id, const std::string& name)
{
    const ImGuiID field = ImGui::GetID(id);
    const int frame = ImGui::GetFrameCount();
    const bool was_typed = typed_name.field == field && typed_name.frame + 1 >= frame;
    std::string text = was_typed ? typed_name.text : name;
    ImGui::InputText(id, &text, ImGuiInputTextFlags_AutoSelectAll);
    if (ImGui::IsItemActive()) {
        typed_name = {field, text, frame};
        return std::nullopt;
    }
    if (!was_typed) return std::nullopt;
    typed_name = {};
    const std::string_view typed = trimmed(text);
    if (!ImGui::IsItemDeactivatedAfterEdit() || typed.empty() || typed == name) return std::nullopt;
    return std::string(typed);
}

std::string verbatim(std::string_view text)
{
    std::string label;
    for (const char character : text) {
        label += character;
        if (character == '#') label += '\r';
    }
    return label;
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

namespace {

/// Wrapped to a readable width.
void tooltip(const char* text)
{
    ImGui::BeginTooltip();
    ImGui::PushTextWrapPos(24.0f * ImGui::GetFontSize());
    ImGui::TextUnformatted(text);
    ImGui::PopTextWrapPos();
    ImGui::EndTooltip();
}

}  // namespace

void hint(const char* text)
{
    if (!ImGui::IsItemHovered() || ImGui::IsItemActive()) return;  // a tooltip would cover the item being dragged
    tooltip(text);
}

void hint_beside(const char* text)
{
    if (!ImGui::IsItemHovered() || ImGui::IsItemActive()) return;
    const ImVec2 lower = ImGui::GetItemRectMin(), upper = ImGui::GetItemRectMax();
    const ImGuiViewport& screen = *ImGui::GetMainViewport();
    const bool is_left = lower.x - screen.Pos.x > screen.Pos.x + screen.Size.x - upper.x;
    const float gap = 0.5f * ImGui::GetFontSize();
    ImGui::SetNextWindowPos({is_left ? lower.x - gap : upper.x + gap, lower.y}, ImGuiCond_Always,
                            {is_left ? 1.0f : 0.0f, 0.0f});
    tooltip(text);
}

}  // namespace shvr::ui
