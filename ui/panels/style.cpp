#include "ui/panels/style.h"

namespace shvr::ui {

namespace {

Theme present_theme = Theme::dark;

struct Use {
    ImGuiCol color;
    ColorRole role;
    float alpha = 1.0f;
};
constexpr Use USES[] = {
    {ImGuiCol_Text, ColorRole::text},
    {ImGuiCol_TextDisabled, ColorRole::faint_text},
    {ImGuiCol_WindowBg, ColorRole::window},
    {ImGuiCol_PopupBg, ColorRole::popup},
    {ImGuiCol_MenuBarBg, ColorRole::bar},
    {ImGuiCol_Border, ColorRole::border},
    {ImGuiCol_Separator, ColorRole::separator},
    {ImGuiCol_SeparatorHovered, ColorRole::accent},
    {ImGuiCol_SeparatorActive, ColorRole::accent_strong},
    {ImGuiCol_FrameBg, ColorRole::frame},
    {ImGuiCol_FrameBgHovered, ColorRole::frame_hovered},
    {ImGuiCol_FrameBgActive, ColorRole::frame_active},
    {ImGuiCol_TitleBg, ColorRole::bar},
    {ImGuiCol_TitleBgActive, ColorRole::header},
    {ImGuiCol_TitleBgCollapsed, ColorRole::bar},
    {ImGuiCol_Button, ColorRole::button},
    {ImGuiCol_ButtonHovered, ColorRole::button_hovered},
    {ImGuiCol_ButtonActive, ColorRole::button_active},
    {ImGuiCol_Header, ColorRole::header},
    {ImGuiCol_HeaderHovered, ColorRole::header_hovered},
    {ImGuiCol_HeaderActive, ColorRole::header_active},
    {ImGuiCol_CheckMark, ColorRole::accent_text},
    {ImGuiCol_SliderGrab, ColorRole::accent},
    {ImGuiCol_SliderGrabActive, ColorRole::accent_strong},
    {ImGuiCol_PlotLines, ColorRole::chart_line},
    {ImGuiCol_PlotLinesHovered, ColorRole::accent_strong},
    {ImGuiCol_PlotHistogram, ColorRole::accent},
    {ImGuiCol_PlotHistogramHovered, ColorRole::accent_strong},
    {ImGuiCol_TextSelectedBg, ColorRole::selection},
    {ImGuiCol_ScrollbarBg, ColorRole::window, 0.0f},
    {ImGuiCol_ScrollbarGrab, ColorRole::scrollbar},
    {ImGuiCol_ScrollbarGrabHovered, ColorRole::scrollbar_hovered},
    {ImGuiCol_ScrollbarGrabActive, ColorRole::scrollbar_active},
    {ImGuiCol_Tab, ColorRole::button},
    {ImGuiCol_TabHovered, ColorRole::button_hovered},
    {ImGuiCol_TabActive, ColorRole::chosen},
    {ImGuiCol_TabUnfocused, ColorRole::button},
    {ImGuiCol_TabUnfocusedActive, ColorRole::chosen},
    {ImGuiCol_TableHeaderBg, ColorRole::table_header},
    {ImGuiCol_TableBorderLight, ColorRole::separator},
    {ImGuiCol_TableBorderStrong, ColorRole::border},
    {ImGuiCol_TableRowBgAlt, ColorRole::text, 0.025f},
    {ImGuiCol_NavHighlight, ColorRole::accent_strong},
    {ImGuiCol_NavWindowingHighlight, ColorRole::accent_strong},
    {ImGuiCol_DragDropTarget, ColorRole::warning},
    {ImGuiCol_ResizeGrip, ColorRole::scrollbar, 0.6f},
    {ImGuiCol_ResizeGripHovered, ColorRole::accent},
    {ImGuiCol_ResizeGripActive, ColorRole::accent_strong},
};

void set_shapes(ImGuiStyle& style)
{
    style.WindowRounding = style.ChildRounding = style.PopupRounding = 4.0f;
    style.FrameRounding = style.GrabRounding = style.TabRounding = style.ScrollbarRounding = 3.0f;
    style.WindowPadding = {10.0f, 8.0f};
    style.FramePadding = {6.0f, 3.0f};
    style.ItemSpacing = {8.0f, 5.0f};
    style.ItemInnerSpacing = {6.0f, 4.0f};
    style.CellPadding = {4.0f, 3.0f};
    style.ScrollbarSize = 12.0f;
    style.GrabMinSize = 10.0f;
    style.WindowBorderSize = style.PopupBorderSize = 1.0f;
    style.DisplaySafeAreaPadding = {6.0f, 0.0f};
    style.WindowTitleAlign = {0.5f, 0.5f};
    style.DisabledAlpha = DISABLED_SHARE;
}

void set_colors(ImGuiStyle& style)
{
    for (const Use& use : USES) style.Colors[use.color] = color_of(use.role, use.alpha);
    // In the light theme, input fields are white on an almost white window, so they need an outline.
    style.FrameBorderSize = present_theme == Theme::light ? 1.0f : 0.0f;
    style.Colors[ImGuiCol_ModalWindowDimBg] = ImVec4(0.0f, 0.0f, 0.0f, present_theme == Theme::light ? 0.3f : 0.45f);
    style.Colors[ImGuiCol_NavWindowingDimBg] = style.Colors[ImGuiCol_ModalWindowDimBg];
}

}  // namespace

ImVec4 color_of(ColorRole role, float alpha)
{
    const Shade shade = shade_of(role, present_theme);
    return {shade[0], shade[1], shade[2], alpha};
}

ImU32 shade_of(ColorRole role, float alpha)
{
    return ImGui::ColorConvertFloat4ToU32(color_of(role, alpha));
}

void set_style(const Appearance& appearance)
{
    present_theme = appearance.theme;
    ImGuiStyle& style = ImGui::GetStyle();
    style = ImGuiStyle();
    if (present_theme == Theme::light)
        ImGui::StyleColorsLight();
    else
        ImGui::StyleColorsDark();
    set_shapes(style);
    set_colors(style);
    style.ScaleAllSizes(float(appearance.scale));
    load_fonts(appearance.font_pixels * appearance.scale);
}

}  // namespace shvr::ui
