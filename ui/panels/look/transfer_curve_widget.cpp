#include "ui/panels/look/transfer_curve_widget.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <string>
#include <utility>

#include <imgui/imgui.h>
#include <imgui/imgui_internal.h>  // SetItemUsingMouseWheel

#include "engine/workbench/edits/edit.h"
#include "ui/panels/color_field.h"
#include "ui/panels/panels.h"
#include "ui/panels/widgets.h"

namespace shvr::ui {

namespace {

using Points = TransferCurve::Points;
using Grip = TransferCurve::Grip;

constexpr float HEIGHT = 150.0f / 14.0f;  ///< height of the curve, in font sizes
constexpr float POINT_RADIUS = 0.36f;     ///< in font sizes
constexpr float MARGIN = 0.65f;           ///< margin around the axes, so that points at the edge are drawn whole
constexpr float REACH = 0.65f;            ///< distance at which the mouse grabs a point or line, in font sizes
constexpr float COLUMN = 2.0f;            ///< width of each single-colour column of the area, in pixels
constexpr float STROKE = 0.11f;           ///< in font sizes
constexpr float FILL_BAR = 0.5f;          ///< width of the bar of a fill value, in font sizes

constexpr ThemeColor BACKGROUND{ColorRole::chart}, BARS{ColorRole::chart_bars}, LINE{ColorRole::chart_line},
    PAINT_LINE{ColorRole::chart_paint}, FELT_LINE{ColorRole::chart_felt}, FILL_BARS{ColorRole::chart_felt};

ImVec2 point(const glm::vec2& at)
{
    return {at.x, at.y};
}

// ---- Drawing

void draw_histogram(const CurveAxes& axes, const CurveState& state, ImDrawList& list)
{
    double most = 0.0;
    for (const HistogramBar& bar : state.bars.bars) most = std::max(most, bar.voxels);
    for (const HistogramBar& bar : state.bars.bars) {
        const auto height = float(height_of_bar(bar.voxels, most, state.is_logarithmic)) * (axes.end.y - axes.begin.y);
        const float left = axes.x_of(bar.lower), right = std::max(axes.x_of(bar.upper), left + 1.0f);
        list.AddRectFilled({left, axes.end.y - height}, {right, axes.end.y}, BARS);
    }
    // Fill values lie far outside the axis, so their bars are drawn at the ends of the axis.
    const float width = FILL_BAR * ImGui::GetFontSize();
    for (const HistogramBar& bar : state.bars.fill) {
        const auto height = float(height_of_bar(bar.voxels, most, state.is_logarithmic)) * (axes.end.y - axes.begin.y);
        const float left = std::clamp(axes.x_of(bar.lower), axes.begin.x, axes.end.x - width);
        list.AddRectFilled({left, axes.end.y - height}, {left + width, axes.end.y}, FILL_BARS);
    }
}

/// Draws the area below the curve, in the function's colours.
void draw_area(const CurveAxes& axes, const TransferFunction& function, ImDrawList& list)
{
    for (float x = axes.begin.x; x < axes.end.x; x += COLUMN) {
        const glm::dvec4 here = function.at(axes.intensity_at(x + 0.5f * COLUMN));
        if (here.a <= 0.0) continue;
        list.AddRectFilled({x, axes.y_of(here.a)}, {x + COLUMN, axes.end.y},
                           ImGui::GetColorU32(encoded(glm::dvec3(here), 0.55f)));
    }
}

/// Draws the line's segments. A segment is linear in opacity, so it is curved on this axis, the root of opacity.
void draw_line(const CurveAxes& axes, const Points& points, ImDrawList& list)
{
    constexpr int PIECES = 16;
    for (size_t i = 0; i + 1 < points.size(); ++i) {
        for (int piece = 0; piece <= PIECES; ++piece) {
            const double share = double(piece) / PIECES;
            list.PathLineTo({axes.x_of(std::lerp(points[i].intensity, points[i + 1].intensity, share)),
                             axes.y_of(std::lerp(points[i].opacity, points[i + 1].opacity, share))});
        }
    }
    list.PathStroke(LINE, ImDrawFlags_None, STROKE * ImGui::GetFontSize());
}

void draw_points(const CurveAxes& axes, const Points& points, size_t selected, ImDrawList& list)
{
    const float radius = POINT_RADIUS * ImGui::GetFontSize(), stroke = STROKE * ImGui::GetFontSize();
    for (size_t i = 0; i < points.size(); ++i) {
        const ImVec2 at = point(axes.place_of(points[i]));
        list.AddCircleFilled(at, radius, ImGui::GetColorU32(encoded(points[i].color)));
        list.AddCircle(at, radius, BACKGROUND, 0, 2.0f * stroke);
        list.AddCircle(at, radius, LINE, 0, stroke);
        if (i == selected)
            list.AddCircle(at, radius + 1.7f * stroke, ImGui::GetColorU32(ImGuiCol_CheckMark), 0, 1.4f * stroke);
    }
}

constexpr const char *PAINT_WORD = "paint", *FELT_WORD = "haptic";

/// Returns the extent in x of a line's label, placed on the side of the line that has room.
glm::vec2 extent_of_word(const CurveAxes& axes, double intensity, const char* word)
{
    const float x = axes.x_of(intensity), width = ImGui::CalcTextSize(word).x, gap = 0.25f * ImGui::GetFontSize();
    const float left = x + gap + width < axes.end.x ? x + gap : x - gap - width;
    return {left, left + width};
}

/// `row` 0 is the topmost.
void draw_threshold(const CurveAxes& axes, double intensity, const char* word, float row, ImU32 color, ImDrawList& list)
{
    const float x = axes.x_of(intensity), left = extent_of_word(axes, intensity, word).x;
    const ImVec2 size = ImGui::CalcTextSize(word);
    const float top = axes.begin.y + 0.25f * ImGui::GetFontSize() + row * size.y;
    list.AddLine({x, axes.begin.y}, {x, axes.end.y}, color, STROKE * ImGui::GetFontSize());
    list.AddRectFilled({left - 2.0f, top}, {left + size.x + 2.0f, top + size.y}, shade_of(ColorRole::chart, 0.75f),
                       3.0f);
    list.AddText({left, top}, color, word);
}

/// Marks how far density painting raises the values of voxels that lie at the paint threshold.
void draw_density_offset(const CurveAxes& axes, const Model& model, ImDrawList& list)
{
    const auto& density = model.brush().density;
    if (!density) return;
    const double from = model.paint_threshold();
    const double raised = density->offset.value_or(std::max(0.0, model.session.transfer_function.lower() - from));
    const float size = ImGui::GetFontSize(), y = axes.begin.y + 2.9f * size;
    const float begin = axes.x_of(from), end = std::clamp(axes.x_of(from + raised), axes.begin.x, axes.end.x);
    const char* const word = raised == 0.0 ? "raises nothing" : "raises to";
    if (raised != 0.0) {
        const float head = (end >= begin ? -0.45f : 0.45f) * size;
        list.AddLine({begin, y}, {end, y}, PAINT_LINE, 1.6f * STROKE * size);
        list.AddTriangleFilled({end, y}, {end + head, y - 0.3f * size}, {end + head, y + 0.3f * size}, PAINT_LINE);
        list.AddLine({end, y}, {end, axes.end.y}, shade_of(ColorRole::chart_paint, 0.45f), STROKE * size);
    }
    const float width = ImGui::CalcTextSize(word).x;
    const float left = std::clamp(std::max(begin, end) + 0.3f * size, axes.begin.x, axes.end.x - width);
    list.AddRectFilled({left - 2.0f, y - 0.5f * size}, {left + width + 2.0f, y + 0.5f * size},
                       shade_of(ColorRole::chart, 0.75f), 3.0f);
    list.AddText({left, y - 0.5f * size}, PAINT_LINE, word);
}

void draw(const CurveAxes& axes, const Model& model, const CurveState& state)
{
    ImDrawList& list = *ImGui::GetWindowDrawList();
    const TransferCurve curve(model.session.transfer_function);
    const float margin = MARGIN * ImGui::GetFontSize();
    list.AddRectFilled({axes.begin.x - margin, axes.begin.y - margin}, {axes.end.x + margin, axes.end.y + margin},
                       BACKGROUND, ImGui::GetStyle().FrameRounding);
    list.PushClipRect(point(axes.begin), point(axes.end), true);
    draw_histogram(axes, state, list);
    draw_area(axes, model.session.transfer_function, list);
    list.PopClipRect();
    draw_threshold(axes, model.haptic_threshold(), FELT_WORD, 1.0f, FELT_LINE, list);
    draw_threshold(axes, model.paint_threshold(), PAINT_WORD, 0.0f, PAINT_LINE, list);
    draw_density_offset(axes, model, list);
    draw_line(axes, curve.points(), list);
    draw_points(axes, curve.points(), state.selected, list);
}

// ---- The mouse

void begin_drag(const CurveAxes& axes, const TransferCurve& curve, const TransferCurve::Found& found,
                const TransferCurve::Lines& lines, const glm::vec2& mouse, CurveState& state)
{
    state.grip = ImGui::GetIO().KeyCtrl ? Grip::all_points : found.grip;
    state.grabbed_at = axes.intensity_at(mouse.x);
    glm::vec2 held = mouse;
    switch (state.grip) {
        case Grip::point:
            state.selected = found.point;
            held = axes.place_of(curve.points()[found.point]);
            break;
        case Grip::paint_threshold: held.x = axes.x_of(lines.paint_threshold); break;
        case Grip::haptic_threshold: held.x = axes.x_of(lines.haptic_threshold); break;
        case Grip::nothing:
        case Grip::all_points: break;
    }
    state.held = FineDrag(mouse, held);
}

/// Finely with Shift, as the wheel.
void drag(const CurveAxes& axes, TransferCurve& curve, const Model& model, const glm::vec2& mouse, CurveState& state,
          Actions& actions)
{
    const glm::vec2 held_at = state.held.follow(mouse, ImGui::GetIO().KeyShift);
    const auto [lowest, highest] = model.statistics.range();
    const double now = axes.intensity_at(held_at.x);
    const double held = std::clamp(now, lowest, highest);
    const double threshold = is_float(model.volume.type) ? held : std::round(held);
    switch (state.grip) {
        case Grip::nothing: return;
        case Grip::point:
            curve.move(state.selected, now, axes.opacity_at(held_at.y));
            return send(curve, model, actions);
        case Grip::all_points:
            curve.shift_all(now - std::exchange(state.grabbed_at, now), lowest, highest);
            return send(curve, model, actions);
        case Grip::paint_threshold:
            return set(actions, model, [&](Session& s) { s.probe.brush.threshold = threshold; });
        case Grip::haptic_threshold:
            return set(actions, model, [&](Session& s) { s.probe.haptic_threshold = threshold; });
    }
}

/// The wheel shifts all points (slowly with Shift). The panel itself does not scroll while the mouse is over the curve.
void use_wheel(TransferCurve& curve, const Model& model, const CurveState& state, Actions& actions)
{
    ImGuiIO& io = ImGui::GetIO();
    const float notches = io.MouseWheel + io.MouseWheelH;  // Shift turns vertical scrolling into horizontal
    if (notches == 0.0f) return;
    const auto [lowest, highest] = model.statistics.range();
    const double shift = wheel_shift(double(notches), state.range, io.KeyShift, !is_float(model.volume.type));
    if (curve.shift_all(shift, lowest, highest) != 0.0) send(curve, model, actions);
}

/// At most one action a frame.
void use_mouse(const CurveAxes& axes, const Model& model, CurveState& state, Actions& actions)
{
    const ImVec2 at = ImGui::GetIO().MousePos;
    const glm::vec2 mouse(at.x, at.y);
    TransferCurve curve(model.session.transfer_function);
    if (!ImGui::IsMouseDown(ImGuiMouseButton_Left)) state.grip = Grip::nothing;
    if (ImGui::IsMouseDragging(ImGuiMouseButton_Left, 1.0f)) return drag(axes, curve, model, mouse, state, actions);
    if (!ImGui::IsItemHovered()) return;
    const float size = ImGui::GetFontSize();
    const double paint = model.paint_threshold(), felt = model.haptic_threshold();
    const TransferCurve::Lines lines{paint, felt, extent_of_word(axes, paint, PAINT_WORD),
                                     extent_of_word(axes, felt, FELT_WORD)};
    const TransferCurve::Found found = curve.under(axes, mouse, lines, {.pixels = REACH * size, .label = 1.25f * size});
    if (ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left) && found.grip == Grip::nothing) {
        state.selected = curve.add(axes.intensity_at(mouse.x), axes.opacity_at(mouse.y));
        send(curve, model, actions);
    } else if (ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left) && found.grip == Grip::paint_threshold) {
        resets("probe.paint_threshold", actions);
    } else if (ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left) && found.grip == Grip::haptic_threshold) {
        resets("probe.haptic_threshold", actions);
    } else if (ImGui::IsMouseClicked(ImGuiMouseButton_Left)) {
        begin_drag(axes, curve, found, lines, mouse, state);
    } else if (ImGui::IsMouseClicked(ImGuiMouseButton_Right) && found.grip == Grip::point) {
        state.selected = curve.remove(found.point);
        send(curve, model, actions);
    } else {
        use_wheel(curve, model, state, actions);
    }
}

/// Draws the numbers of the horizontal axis below it or, while the mouse is over the curve, what is under the mouse.
void axis_row(const CurveAxes& axes, const Model& model, bool is_hovered)
{
    const TextIn small(TextRole::small);
    const bool is_whole = !is_float(model.volume.type);
    const auto words_of = [&](double intensity) {
        char text[32];
        std::snprintf(text, sizeof text, is_whole ? "%.0f" : "%.5g", intensity);
        return std::string(text);
    };
    if (is_hovered) {
        const double at = std::clamp(axes.intensity_at(ImGui::GetIO().MousePos.x), axes.lower, axes.upper);
        const double intensity = is_whole ? std::round(at) : at;
        char opacity[32];
        std::snprintf(opacity, sizeof opacity, "%.4g", model.session.transfer_function.at(intensity).a);
        return ImGui::TextUnformatted(sentence("Intensity ", words_of(intensity), ": opacity ", opacity).c_str());
    }
    constexpr double TICKS[] = {0.0, 0.5, 1.0};
    const float left = ImGui::GetCursorScreenPos().x - ImGui::GetCursorPosX();
    for (const double tick : TICKS) {
        const std::string text = words_of(std::lerp(axes.lower, axes.upper, tick));
        const float width = ImGui::CalcTextSize(text.c_str()).x;
        if (tick > 0.0) ImGui::SameLine(std::lerp(axes.begin.x, axes.end.x, float(tick)) - float(tick) * width - left);
        ImGui::TextDisabled("%s", text.c_str());
    }
}

}  // namespace

void send(const TransferCurve& curve, const Model& model, Actions& actions)
{
    set(actions, model, [&](Session& s) { s.transfer_function = curve.function(); });
}

void send(Points points, const Model& model, Actions& actions)
{
    set(actions, model, [&](Session& s) { s.transfer_function = TransferFunction(std::move(points)); });
}

void follow_volume(const Model& model, CurveState& state)
{
    const VolumeStatistics& now = model.statistics;
    const bool is_same = state.bars_of.histogram == now.histogram && state.bars_of.minimum == now.minimum &&
                         state.bars_of.maximum == now.maximum;
    if (is_same) return;
    state.bars_of = now;
    state.bars = histogram_bars(model.volume.type, now);
}

void curve_widget(const Model& model, CurveState& state, Actions& actions)
{
    const auto [lowest, highest] = model.statistics.range();
    if (state.grip == Grip::nothing) state.range = range_of_curve(model.session.transfer_function, lowest, highest);
    const float margin = MARGIN * ImGui::GetFontSize();
    const ImVec2 corner = ImGui::GetCursorScreenPos();
    const ImVec2 size{std::max(ImGui::GetContentRegionAvail().x, 8.0f * margin), HEIGHT * ImGui::GetFontSize()};
    const CurveAxes axes{.begin = {corner.x + margin, corner.y + margin},
                         .end = {corner.x + size.x - margin, corner.y + size.y - margin},
                         .lower = state.range.lower,
                         .upper = state.range.upper};
    ImGui::InvisibleButton("curve", size, ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonRight);
    ImGui::SetItemUsingMouseWheel();
    const bool is_hovered = ImGui::IsItemHovered() || ImGui::IsItemActive();
    draw(axes, model, state);
    use_mouse(axes, model, state, actions);
    axis_row(axes, model, is_hovered);
}

}  // namespace shvr::ui
