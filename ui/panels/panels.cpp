#include "ui/panels/panels.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <optional>
#include <utility>

#include <imgui/imgui.h>

#include "engine/workbench/appearance/panel_rows.h"
#include "engine/workbench/bindings/preferences_file.h"
#include "ui/panels/signs/signs.h"
#include "ui/panels/style.h"
#include "ui/panels/widgets.h"

namespace shvr::ui {

namespace {

constexpr bool has_body(const PanelRow& row)
{
    return std::ranges::any_of(PANEL_BODIES, [&](const PanelBody& each) { return each.id == row.id; });
}
static_assert(std::ranges::all_of(PANELS, has_body), "panels.h lacks the function of a panel");
static_assert(std::size(PANEL_BODIES) == std::size(PANELS), "panel_rows.h lacks the row of a panel");

constexpr float SPLITTER = 6.0f / 14.0f;  ///< width of the splitter, in font sizes

void draw_body(const PanelRow& row, const Model& model, Actions& actions)
{
    const auto body = std::ranges::find_if(PANEL_BODIES, [&](const PanelBody& each) { return each.id == row.id; });
    ImGui::PushID(row.id);
    body->draw(model, actions);
    ImGui::PopID();
}

void change(const PanelRow& row, const PanelLayout& changed, Actions& actions)
{
    actions.push_back(Prefer{patch_of_panel(row.id, changed)});
}

/// Returns the user's choice; without a choice, the panels of traces and of measurements unfold once there is one, or
/// one is being made.
bool is_folded(const PanelRow& row, const Model& model)
{
    const WindowLayout& layout = model.preferences.layout;
    const auto found = layout.panels.find(row.id);
    const bool is_chosen = found != layout.panels.end() && found->second.folded;
    if (!is_chosen && std::strcmp(row.id, "trace") == 0)
        return model.trace.nodes().empty() && model.tool() != Tool::trace;
    if (!is_chosen && std::strcmp(row.id, "measurements") == 0)
        return model.measurements.empty() && model.tool() != Tool::measure;
    return layout.is_folded(row);
}

// ---- At the side

enum class HeaderSign { float_out, close };

/// Draws a small button in the panel's heading.
bool header_button(HeaderSign sign, float right, const char* text)
{
    const float size = ImGui::GetFrameHeight();
    ImGui::SameLine(right - size);
    ImGui::PushID(int(sign));
    const bool is_clicked = ImGui::InvisibleButton("sign", {size, size});
    const ImU32 color =
        shade_of(ImGui::IsItemHovered() || ImGui::IsItemFocused() ? ColorRole::text : ColorRole::faint_text);
    const ImVec2 begin = ImGui::GetItemRectMin();
    const float a = 0.32f * size, b = 0.68f * size, stroke = std::max(1.0f, 0.07f * size);
    const auto at = [&](float x, float y) { return ImVec2(begin.x + x, begin.y + y); };
    ImDrawList& list = *ImGui::GetWindowDrawList();
    if (sign == HeaderSign::close) {
        list.AddLine(at(a, a), at(b, b), color, stroke);
        list.AddLine(at(a, b), at(b, a), color, stroke);
    } else {
        list.AddRect(at(a, 0.42f * size), at(0.58f * size, b), color, 0.0f, 0, stroke);
        list.AddLine(at(0.5f * size, a), at(b, a), color, stroke);
        list.AddLine(at(b, a), at(b, 0.5f * size), color, stroke);
        list.AddLine(at(0.5f * size, 0.5f * size), at(b, a), color, stroke);
    }
    hint(text);
    ImGui::PopID();
    return is_clicked;
}

/// Draws the sign and the title of a panel over its header, after the header's arrow.
void panel_title(const PanelRow& row)
{
    const TextIn heading(TextRole::heading);
    const ImGuiStyle& style = ImGui::GetStyle();
    const ImVec2 begin = ImGui::GetItemRectMin();
    const float size = ImGui::GetFontSize();
    const ImVec2 at{begin.x + 2.0f * style.FramePadding.x + 1.25f * size, begin.y + style.FramePadding.y};
    ImDrawList& list = *ImGui::GetWindowDrawList();
    draw_sign(row.id, {list, at, size, shade_of(ColorRole::faint_text)});
    list.AddText({at.x + size + style.ItemInnerSpacing.x, at.y}, shade_of(ColorRole::text), row.title);
}

void section(const PanelRow& row, const Model& model, Actions& actions)
{
    const bool was_open = !is_folded(row, model);
    ImGui::PushID(row.id);
    ImGui::SetNextItemOpen(was_open, ImGuiCond_Always);
    const float right = ImGui::GetContentRegionMax().x;
    const bool is_open = ImGui::CollapsingHeader("##open", ImGuiTreeNodeFlags_AllowItemOverlap);
    panel_title(row);
    if (is_open != was_open) change(row, {.folded = !is_open}, actions);
    const float size = ImGui::GetFrameHeight();
    if (header_button(HeaderSign::float_out, right - size, "A window of its own"))
        change(row, {.place = PanelPlace::floating}, actions);
    if (header_button(HeaderSign::close, right, "Close; the menu View, Panels, brings it back"))
        change(row, {.place = PanelPlace::hidden}, actions);
    ImGui::PopID();
    if (!is_open) return;
    draw_body(row, model, actions);
    ImGui::Spacing();
}

void side_panel(const ImVec2& at, const ImVec2& size, const Model& model, Actions& actions)
{
    ImGui::SetNextWindowPos(at);
    ImGui::SetNextWindowSize(size);
    ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, 0.0f);
    ImGui::PushStyleVar(ImGuiStyleVar_WindowBorderSize, 0.0f);
    const ImGuiWindowFlags flags = ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize |
                                   ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoBringToFrontOnFocus |
                                   ImGuiWindowFlags_AlwaysVerticalScrollbar;
    ImGui::Begin(SIDE_PANEL, nullptr, flags);
    for (const PanelRow& row : panel_rows())
        if (model.preferences.layout.place_of(row) == PanelPlace::side) section(row, model, actions);
    ImGui::End();
    ImGui::PopStyleVar(2);
}

/// Draws the splitter between picture and panels. A drag resizes the panels, a double click restores their default
/// width. Returns the new width during a drag.
std::optional<double> splitter(const ImVec2& at, float height, float window_width, Actions& actions)
{
    static std::optional<double> dragged;  // in font sizes
    const float font = ImGui::GetFontSize(), width = SPLITTER * font;
    ImGui::SetNextWindowPos({at.x - 0.5f * width, at.y});
    ImGui::SetNextWindowSize({width, height});
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {0.0f, 0.0f});
    ImGui::PushStyleVar(ImGuiStyleVar_WindowMinSize, {1.0f, 1.0f});
    ImGui::PushStyleVar(ImGuiStyleVar_WindowBorderSize, 0.0f);
    ImGui::Begin("##splitter", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                     ImGuiWindowFlags_NoBackground | ImGuiWindowFlags_NoNav | ImGuiWindowFlags_NoFocusOnAppearing);
    ImGui::InvisibleButton("edge", {width, std::max(height, 1.0f)});
    const bool is_held = ImGui::IsItemActive();
    if (ImGui::IsItemHovered() || is_held) {
        ImGui::SetMouseCursor(ImGuiMouseCursor_ResizeEW);
        ImGui::GetWindowDrawList()->AddRectFilled(ImGui::GetItemRectMin(), ImGui::GetItemRectMax(),
                                                  shade_of(ColorRole::accent, 0.7f));
    }
    const bool is_reset = ImGui::IsItemHovered() && ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left);
    ImGui::End();
    ImGui::PopStyleVar(3);
    if (is_held && ImGui::IsMouseDragging(ImGuiMouseButton_Left, 1.0f))
        dragged = std::clamp(double((window_width - ImGui::GetIO().MousePos.x) / font), MIN_SIDE_WIDTH, 1000.0);
    if (is_reset) actions.push_back(Prefer{R"({"layout":{"side_width":null}})"});
    if (!is_held && dragged) {
        actions.push_back(Prefer{sentence("{\"layout\":{\"side_width\":", std::round(10.0 * *dragged) / 10.0, "}}")});
        dragged.reset();
    }
    return dragged;
}

// ---- Windows of their own

/// Places a window at its last position or, without one, cascaded over the picture.
void place_window(const PanelRow& row, size_t number, const Model& model, const ImVec2& window)
{
    const double font = ImGui::GetFontSize();
    const auto found = model.preferences.layout.panels.find(row.id);
    const PanelLayout kept = found == model.preferences.layout.panels.end() ? PanelLayout{} : found->second;
    const glm::dvec2 size = font * kept.size.value_or(FLOATING_SIZE);
    const glm::dvec2 first = glm::dvec2(3.0, 6.0) + double(number) * glm::dvec2(3.0, 2.0);
    const glm::dvec2 at = within_reach(font * kept.at.value_or(first), size, {window.x, window.y});
    ImGui::SetNextWindowSize({float(size.x), float(size.y)}, ImGuiCond_Appearing);
    ImGui::SetNextWindowPos({float(at.x), float(at.y)}, ImGuiCond_Appearing);
}

/// Stores the window's position once the mouse is released.
void keep_place(const PanelRow& row, const Model& model, Actions& actions)
{
    if (ImGui::IsAnyMouseDown() || ImGui::IsWindowAppearing()) return;
    const double font = ImGui::GetFontSize();
    const auto rounded = [&](const ImVec2& pixels) {
        return glm::dvec2(std::round(10.0 * double(pixels.x) / font) / 10.0,
                          std::round(10.0 * double(pixels.y) / font) / 10.0);
    };
    const glm::dvec2 at = rounded(ImGui::GetWindowPos()), size = rounded(ImGui::GetWindowSize());
    const auto found = model.preferences.layout.panels.find(row.id);
    if (found == model.preferences.layout.panels.end()) return;
    if (found->second.at == at && found->second.size == size) return;
    change(row, {.at = at, .size = size}, actions);
}

void floating_panel(const PanelRow& row, size_t number, const Model& model, const ImVec2& window, Actions& actions)
{
    place_window(row, number, model, window);
    bool is_open = true;
    const ImGuiWindowFlags flags =
        ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoFocusOnAppearing;
    if (ImGui::Begin(sentence(row.title, "###panel ", row.id).c_str(), &is_open, flags)) {
        keep_place(row, model, actions);
        if (ImGui::SmallButton("Back to the side")) change(row, {.place = PanelPlace::side}, actions);
        ImGui::Separator();
        draw_body(row, model, actions);
    }
    ImGui::End();
    if (!is_open) change(row, {.place = PanelPlace::hidden}, actions);
}

void floating_panels(const Model& model, const ImVec2& window, Actions& actions)
{
    size_t number = 0;
    for (const PanelRow& row : panel_rows())
        if (model.preferences.layout.place_of(row) == PanelPlace::floating)
            floating_panel(row, number++, model, window, actions);
}

}  // namespace

void place_kept_window(const char* id, const glm::dvec2& usual_size, const Model& model)
{
    const double font = ImGui::GetFontSize();
    const ImGuiViewport& viewport = *ImGui::GetMainViewport();
    const glm::dvec2 room(viewport.WorkSize.x, viewport.WorkSize.y);
    const auto& windows = model.preferences.layout.windows;
    const auto found = windows.find(id);
    const WindowPlace kept = found == windows.end() ? WindowPlace{} : found->second;
    const glm::dvec2 size = glm::min(font * kept.size.value_or(usual_size), room);
    const glm::dvec2 middle = 0.5 * (room - size) / font;
    const glm::dvec2 at = within_reach(font * kept.at.value_or(middle), size, room);
    ImGui::SetNextWindowSize({float(size.x), float(size.y)}, ImGuiCond_Appearing);
    ImGui::SetNextWindowPos({float(at.x), float(at.y)}, ImGuiCond_Appearing);
}

namespace {

/// In font sizes.
struct Place {
    glm::dvec2 at{0.0}, size{0.0};
    bool operator==(const Place&) const = default;
};

Place place_of_window()
{
    const double font = ImGui::GetFontSize();
    const auto rounded = [&](const ImVec2& pixels) {
        return glm::round(10.0 * glm::dvec2(pixels.x, pixels.y) / font) / 10.0;
    };
    return {rounded(ImGui::GetWindowPos()), rounded(ImGui::GetWindowSize())};
}

}  // namespace

void keep_window(const char* id, const Model& model, Actions& actions)
{
    static std::map<std::string, Place> places;  // as they were last seen at rest
    if (ImGui::IsAnyMouseDown()) return;
    const Place now = place_of_window();
    const Place before = std::exchange(places[id], now);
    const auto& windows = model.preferences.layout.windows;
    const bool is_new = ImGui::IsWindowAppearing() || before == Place{} || before == now;
    if (is_new || (windows.contains(id) && windows.at(id) == WindowPlace{now.at, now.size})) return;
    actions.push_back(Prefer{patch_of_window(id, now.at, now.size)});
}

void place_kept_corner(const char* id, const glm::vec2& first, const Model& model)
{
    const auto& windows = model.preferences.layout.windows;
    const auto kept = windows.find(id);
    if (kept == windows.end() || !kept->second.at)
        return ImGui::SetNextWindowPos({first.x, first.y}, ImGuiCond_Appearing, {1.0f, 1.0f});
    const double font = ImGui::GetFontSize();
    const ImVec2 room = ImGui::GetMainViewport()->WorkSize;
    const glm::dvec2 title{10.0 * font, double(ImGui::GetFrameHeight())};
    const glm::dvec2 at = within_reach(font * *kept->second.at, title, {room.x, room.y});
    ImGui::SetNextWindowPos({float(at.x), float(at.y)}, ImGuiCond_Appearing);
}

void keep_corner(const char* id, Actions& actions)
{
    static std::map<std::string, glm::dvec2> at_rest;  // where they were when they were not dragged
    static std::string dragged;                        // the window that was dragged last, until that is stored
    if (is_window_dragged()) {
        dragged = id;
        return;
    }
    const Place now = place_of_window();
    const glm::dvec2 before = std::exchange(at_rest[id], now.at);
    if (dragged != id) return;
    dragged.clear();
    if (before != now.at) actions.push_back(Prefer{patch_of_window(id, now.at, now.size)});
}

Layout draw_panels(const Model& model, const glm::uvec2& window, Actions& actions)
{
    const ImVec2 scale = ImGui::GetIO().DisplayFramebufferScale;
    const glm::vec2 pixels_per_unit(scale.x > 0.0f ? scale.x : 1.0f, scale.y > 0.0f ? scale.y : 1.0f);
    const glm::vec2 size = glm::vec2(window) / pixels_per_unit;
    const float bar = ImGui::GetFrameHeight(), font = ImGui::GetFontSize();
    const bool has_tools = model.is_open && model.preferences.layout.shows_tool_bar;
    const float top = bar + (has_tools ? tool_bar_height() : 0.0f);
    const float height = std::max(size.y - top - bar, 1.0f);
    WindowLayout wanted = model.preferences.layout;
    float side = model.is_open ? float(std::round(side_units(wanted, size.x, font))) : 0.0f;

    menu_bar(model, actions);
    if (side > 0.0f)
        if (const std::optional<double> dragged = splitter({size.x - side, top}, height, size.x, actions)) {
            wanted.side_width = dragged;
            side = float(std::round(side_units(wanted, size.x, font)));
        }
    if (has_tools) tool_bar({0.0f, bar}, size.x, model, actions);
    if (side > 0.0f) {
        const float hints = std::min(first_hints(model, {size.x - side, top}, side, actions), 0.5f * height);
        side_panel({size.x - side, top + hints}, {side, height - hints}, model, actions);
    }
    if (model.is_open)
        floating_panels(model, {size.x, size.y}, actions);
    else
        start_page(model, actions);
    status_bar(model, window, actions);
    const float banners = std::min(notices(model, {0.0f, top}, size.x - side, actions), 0.5f * height);
    if (model.shows_help) help_window(model, actions);
    if (model.shows_preferences) preferences_window(model, actions);
    if (model.shows_palette) palette_window(model, actions);
    if (model.shows_messages) messages_window(model, actions);
    if (model.shows_passes) passes_window(model, actions);
    jobs_window(model, {0.5f * (size.x - side), size.y - bar}, actions);

    const glm::vec2 begin(0.0f, model.is_open ? top + banners : top);
    const glm::vec2 end = glm::max(begin, size - glm::vec2(side, bar));
    const auto in_pixels = [&](const glm::vec2& at) {
        return glm::min(glm::uvec2(glm::round(at * pixels_per_unit)), window);
    };
    return {in_pixels(begin), in_pixels(end)};
}

}  // namespace shvr::ui
