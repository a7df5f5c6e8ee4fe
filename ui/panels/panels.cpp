#include "ui/panels/panels.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <imgui/imgui.h>

namespace shvr::ui {

namespace {

/// The first that exists; otherwise Dear ImGui's own font.
constexpr const char* FONTS[] = {"/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",    // Debian, Ubuntu
                                 "/usr/share/fonts/dejavu-sans-fonts/DejaVuSans.ttf",  // Fedora
                                 "/usr/share/fonts/TTF/DejaVuSans.ttf",                // Arch
                                 "/usr/share/fonts/truetype/noto/NotoSans-Regular.ttf",
                                 "/usr/share/fonts/truetype/liberation/LiberationSans-Regular.ttf"};
constexpr double FONT_PIXELS = 14.0;           ///< at a content scale of 1
constexpr float PANEL_WIDTH = 330.0f / 14.0f;  ///< in font sizes, so that it follows the content scale

ImVec4 grey(float level, float alpha = 1.0f)
{
    return {level, level, level, alpha};
}

ImVec4 accent(float level, float alpha = 1.0f)
{
    return {0.36f * level, 0.58f * level, 0.86f * level, alpha};
}

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
    style.WindowBorderSize = style.FrameBorderSize = 0.0f;
    style.PopupBorderSize = 1.0f;
    style.DisplaySafeAreaPadding = {6.0f, 0.0f};
    style.WindowTitleAlign = {0.5f, 0.5f};
}

void set_colors(ImVec4* colors)
{
    colors[ImGuiCol_Text] = grey(0.88f);
    colors[ImGuiCol_TextDisabled] = grey(0.60f);
    colors[ImGuiCol_WindowBg] = grey(0.145f);
    colors[ImGuiCol_PopupBg] = grey(0.17f, 0.98f);
    colors[ImGuiCol_MenuBarBg] = grey(0.18f);
    colors[ImGuiCol_Border] = grey(0.30f);
    colors[ImGuiCol_Separator] = grey(0.27f);
    colors[ImGuiCol_FrameBg] = grey(0.235f);
    colors[ImGuiCol_FrameBgHovered] = grey(0.27f);
    colors[ImGuiCol_FrameBgActive] = grey(0.30f);
    colors[ImGuiCol_TitleBg] = colors[ImGuiCol_TitleBgActive] = colors[ImGuiCol_TitleBgCollapsed] = grey(0.18f);
    colors[ImGuiCol_Button] = grey(0.26f);
    colors[ImGuiCol_ButtonHovered] = grey(0.32f);
    colors[ImGuiCol_ButtonActive] = accent(0.75f);
    colors[ImGuiCol_Header] = grey(0.21f);
    colors[ImGuiCol_HeaderHovered] = grey(0.26f);
    colors[ImGuiCol_HeaderActive] = grey(0.29f);
    colors[ImGuiCol_CheckMark] = accent(1.0f);
    colors[ImGuiCol_SliderGrab] = accent(0.8f);
    colors[ImGuiCol_SliderGrabActive] = accent(1.0f);
    colors[ImGuiCol_PlotHistogram] = accent(0.85f);
    colors[ImGuiCol_TextSelectedBg] = accent(0.9f, 0.5f);
    colors[ImGuiCol_ScrollbarBg] = grey(0.145f, 0.0f);
    colors[ImGuiCol_ScrollbarGrab] = grey(0.30f);
    colors[ImGuiCol_ScrollbarGrabHovered] = grey(0.36f);
    colors[ImGuiCol_ScrollbarGrabActive] = grey(0.42f);
    colors[ImGuiCol_TableHeaderBg] = grey(0.20f);
    colors[ImGuiCol_TableRowBgAlt] = grey(1.0f, 0.025f);
    colors[ImGuiCol_ModalWindowDimBg] = grey(0.0f, 0.45f);
    colors[ImGuiCol_ResizeGrip] = grey(0.30f, 0.5f);
    colors[ImGuiCol_ResizeGripHovered] = colors[ImGuiCol_ResizeGripActive] = accent(0.9f);
}

/// Once the atlas is on the device, a font added to it would have no effect.
void load_font(double content_scale)
{
    ImGuiIO& io = ImGui::GetIO();
    if (io.Fonts->IsBuilt()) {
        io.FontGlobalScale = float(content_scale);
        return;
    }
    const float pixels = float(std::max(1.0, std::round(FONT_PIXELS * content_scale)));
    std::error_code error;
    for (const char* font : FONTS)
        if (std::filesystem::is_regular_file(font, error) && io.Fonts->AddFontFromFileTTF(font, pixels)) return;
    ImFontConfig config;
    config.SizePixels = pixels;
    io.Fonts->AddFontDefault(&config);
}

void section(const char* title, bool is_open, void (*panel)(const Model&, Actions&), const Model& model,
             Actions& actions)
{
    if (!ImGui::CollapsingHeader(title, is_open ? ImGuiTreeNodeFlags_DefaultOpen : ImGuiTreeNodeFlags_None)) return;
    ImGui::PushID(title);
    panel(model, actions);
    ImGui::PopID();
    ImGui::Spacing();
}

void side_panel(const ImVec2& at, const ImVec2& size, const Model& model, Actions& actions)
{
    ImGui::SetNextWindowPos(at);
    ImGui::SetNextWindowSize(size);
    ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, 0.0f);
    const ImGuiWindowFlags flags = ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize |
                                   ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoBringToFrontOnFocus |
                                   ImGuiWindowFlags_AlwaysVerticalScrollbar;
    ImGui::Begin("Side panel", nullptr, flags);
    section("Probe and painting", true, probe_panel, model, actions);
    // While painting, the transfer function needs the space; while tracing, this section opens even if it was folded.
    if (model.tool() == Tool::trace) ImGui::SetNextItemOpen(true);
    section("Tracing", !model.trace.nodes().empty(), trace_panel, model, actions);
    section("Tracing list", false, trace_list_panel, model, actions);
    section("Transfer function", true, transfer_function_panel, model, actions);
    section("Light and depth", false, light_panel, model, actions);
    section("Ambient occlusion", false, occlusion_panel, model, actions);
    section("Cutting planes", false, cuts_panel, model, actions);
    section("Render quality", false, quality_panel, model, actions);
    section("What is shown", false, aids_panel, model, actions);
    section("Views", false, views_panel, model, actions);
    section("Colour groups", true, groups_panel, model, actions);
    section("History", false, history_panel, model, actions);
    ImGui::End();
    ImGui::PopStyleVar();
}

}  // namespace

void set_style(double content_scale)
{
    ImGui::StyleColorsDark();
    ImGuiStyle& style = ImGui::GetStyle();
    set_shapes(style);
    set_colors(style.Colors);
    style.ScaleAllSizes(float(content_scale));
    load_font(content_scale);
}

Layout draw_panels(const Model& model, const glm::uvec2& window, Actions& actions)
{
    const ImVec2 scale = ImGui::GetIO().DisplayFramebufferScale;
    const glm::vec2 pixels_per_unit(scale.x > 0.0f ? scale.x : 1.0f, scale.y > 0.0f ? scale.y : 1.0f);
    const glm::vec2 size = glm::vec2(window) / pixels_per_unit;
    const float bar = ImGui::GetFrameHeight();
    const float panel = model.is_open ? std::min(PANEL_WIDTH * ImGui::GetFontSize(), size.x) : 0.0f;

    menu_bar(model, actions);
    if (model.is_open)
        side_panel({size.x - panel, bar}, {panel, std::max(size.y - 2.0f * bar, 1.0f)}, model, actions);
    else
        start_page(model, actions);
    status_bar(model, window, actions);
    notices(model, {0.0f, bar}, size.x - panel, actions);
    if (model.shows_help) help_window(model, actions);
    if (model.shows_palette) palette_window(model, actions);
    if (model.shows_messages) messages_window(model, actions);
    if (model.shows_passes) passes_window(model, actions);
    jobs_window(model, {0.0f, size.y - bar}, actions);

    const glm::vec2 begin(0.0f, bar);
    const glm::vec2 end = glm::max(begin, size - glm::vec2(panel, bar));
    const auto in_pixels = [&](const glm::vec2& at) {
        return glm::min(glm::uvec2(glm::round(at * pixels_per_unit)), window);
    };
    return {in_pixels(begin), in_pixels(end)};
}

}  // namespace shvr::ui
