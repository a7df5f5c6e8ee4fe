#include "ui/panels/panels.h"

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <utility>

#include <imgui/imgui.h>

#include "engine/base/image.h"
#include "ui/panels/widgets.h"
#include "ui/workbench/edit.h"

namespace shvr::ui {

namespace {

using Points = std::vector<ControlPoint>;

constexpr float HEIGHT = 150.0f / 14.0f;  ///< of the curve, in font sizes
constexpr float POINT_RADIUS = 0.36f;     ///< in font sizes
constexpr float MARGIN = 0.65f;           ///< around the axes, so that circles at the edge are whole
constexpr float REACH = 0.65f;            ///< the mouse grabs things within this distance, in font sizes
constexpr float COLUMN = 2.0f;            ///< width of one colour in the coloured area, in pixels
constexpr float STROKE = 0.11f;           ///< in font sizes

constexpr ThemeColor BACKGROUND{ColorRole::chart}, BARS{ColorRole::chart_bars}, LINE{ColorRole::chart_line},
    PAINT_LINE{ColorRole::chart_paint}, FELT_LINE{ColorRole::chart_felt};

/// What the mouse is dragging.
enum class Grip { nothing, point, all_points, paint_threshold, haptic_threshold };

/// The widget's state between frames. Everything else belongs to the session.
struct WidgetState {
    Grip grip = Grip::nothing;
    size_t selected = 0;
    double lower = 0.0, upper = 1.0;  ///< of the horizontal axis; fixed while dragging
    double grabbed_at = 0.0;          ///< intensity under the mouse when it last moved all points
    ImVec2 offset;                    ///< from the mouse to the centre of the grabbed item
};

/// The widget's rectangle: intensities from left to right, the square root of the opacity upwards.
struct Canvas {
    ImVec2 begin, end;
    double lower = 0.0, upper = 1.0;

    float x_of(double intensity) const
    {
        const double share = std::clamp((intensity - lower) / (upper - lower), -1.0, 2.0);
        return begin.x + float(share) * (end.x - begin.x);
    }
    float y_of(double opacity) const { return end.y - float(std::sqrt(opacity)) * (end.y - begin.y); }
    double intensity_at(float x) const
    {
        const double share = double(x - begin.x) / double(end.x - begin.x);
        return lower + std::clamp(share, 0.0, 1.0) * (upper - lower);
    }
    double opacity_at(float y) const
    {
        const double root = std::clamp(double(end.y - y) / double(end.y - begin.y), 0.0, 1.0);
        return root * root;
    }
    ImVec2 place_of(const ControlPoint& point) const { return {x_of(point.intensity), y_of(point.opacity)}; }
};

/// sRGB, as Dear ImGui shows and edits colours.
ImVec4 encoded(const glm::dvec3& linear, float alpha)
{
    const auto encode = [](double value) { return float(srgb_encode(std::clamp(value, 0.0, 1.0))); };
    return {encode(linear.x), encode(linear.y), encode(linear.z), alpha};
}

Points points_of(const Model& model)
{
    const auto points = model.session.transfer_function.points();
    return {points.begin(), points.end()};
}

/// Clamps points first: a transfer function refuses values outside its limits.
void send(Points points, const Model& model, Actions& actions)
{
    for (ControlPoint& point : points) {
        point.intensity = std::clamp(point.intensity, -double(FLT_MAX), double(FLT_MAX));
        point.opacity = std::clamp(point.opacity, 0.0, 1.0);
        point.color = glm::clamp(point.color, glm::dvec3(0.0), glm::dvec3(1.0));
    }
    set(actions, model, [&](Session& s) { s.transfer_function = TransferFunction(std::move(points)); });
}

/// The axis covers both the volume's and the function's intensities.
void choose_axis(const Model& model, WidgetState& state)
{
    const TransferFunction& function = model.session.transfer_function;
    state.lower = std::min(model.statistics.range().lower, function.lower());
    state.upper = std::max(model.statistics.range().upper, function.upper());
    if (!(state.upper > state.lower)) state.upper = state.lower + std::max(1.0, std::abs(state.lower));
}

// ---- Drawing

void draw_histogram(const Canvas& canvas, const VolumeStatistics& statistics, ImDrawList& list)
{
    const auto& counts = statistics.histogram;
    if (counts.empty()) return;
    const double most = std::log1p(double(*std::max_element(counts.begin(), counts.end())));
    const ValueRange range = statistics.range();
    const double width = (range.upper - range.lower) / double(counts.size());
    for (size_t bin = 0; bin < counts.size() && most > 0.0; ++bin) {
        const float height = float(std::log1p(double(counts[bin])) / most) * (canvas.end.y - canvas.begin.y);
        const double lower = range.lower + double(bin) * width;
        const float left = canvas.x_of(lower), right = std::max(canvas.x_of(lower + width), left + 1.0f);
        list.AddRectFilled({left, canvas.end.y - height}, {right, canvas.end.y}, BARS);
    }
}

/// The area below the curve, in the function's colours.
void draw_area(const Canvas& canvas, const TransferFunction& function, ImDrawList& list)
{
    for (float x = canvas.begin.x; x < canvas.end.x; x += COLUMN) {
        const glm::dvec4 here = function.at(canvas.intensity_at(x + 0.5f * COLUMN));
        if (here.a <= 0.0) continue;
        list.AddRectFilled({x, canvas.y_of(here.a)}, {x + COLUMN, canvas.end.y},
                           ImGui::GetColorU32(encoded(glm::dvec3(here), 0.55f)));
    }
}

/// Segments are linear in opacity, and so curved on this axis.
void draw_line(const Canvas& canvas, const Points& points, ImDrawList& list)
{
    constexpr int PIECES = 16;
    for (size_t i = 0; i + 1 < points.size(); ++i) {
        for (int piece = 0; piece <= PIECES; ++piece) {
            const double share = double(piece) / PIECES;
            list.PathLineTo({canvas.x_of(std::lerp(points[i].intensity, points[i + 1].intensity, share)),
                             canvas.y_of(std::lerp(points[i].opacity, points[i + 1].opacity, share))});
        }
    }
    list.PathStroke(LINE, ImDrawFlags_None, STROKE * ImGui::GetFontSize());
}

void draw_points(const Canvas& canvas, const Points& points, size_t selected, ImDrawList& list)
{
    const float radius = POINT_RADIUS * ImGui::GetFontSize(), stroke = STROKE * ImGui::GetFontSize();
    for (size_t i = 0; i < points.size(); ++i) {
        const ImVec2 at = canvas.place_of(points[i]);
        list.AddCircleFilled(at, radius, ImGui::GetColorU32(encoded(points[i].color, 1.0f)));
        list.AddCircle(at, radius, BACKGROUND, 0, 2.0f * stroke);
        list.AddCircle(at, radius, LINE, 0, stroke);
        if (i == selected)
            list.AddCircle(at, radius + 1.7f * stroke, ImGui::GetColorU32(ImGuiCol_CheckMark), 0, 1.4f * stroke);
    }
}

/// The label is beside the line, on the side with room; `row` 0 is the topmost.
void draw_threshold(const Canvas& canvas, double intensity, const char* word, float row, ImU32 color, ImDrawList& list)
{
    const float x = canvas.x_of(intensity);
    const ImVec2 size = ImGui::CalcTextSize(word);
    const float gap = 0.25f * ImGui::GetFontSize();
    const float left = x + gap + size.x < canvas.end.x ? x + gap : x - gap - size.x;
    const float top = canvas.begin.y + gap + row * size.y;
    list.AddLine({x, canvas.begin.y}, {x, canvas.end.y}, color, STROKE * ImGui::GetFontSize());
    list.AddRectFilled({left - 2.0f, top}, {left + size.x + 2.0f, top + size.y}, shade_of(ColorRole::chart, 0.75f),
                       3.0f);
    list.AddText({left, top}, color, word);
}

void draw(const Canvas& canvas, const Model& model, size_t selected)
{
    ImDrawList& list = *ImGui::GetWindowDrawList();
    const Points points = points_of(model);
    const float margin = MARGIN * ImGui::GetFontSize();
    list.AddRectFilled({canvas.begin.x - margin, canvas.begin.y - margin},
                       {canvas.end.x + margin, canvas.end.y + margin}, BACKGROUND, ImGui::GetStyle().FrameRounding);
    list.PushClipRect(canvas.begin, canvas.end, true);
    draw_histogram(canvas, model.statistics, list);
    draw_area(canvas, model.session.transfer_function, list);
    list.PopClipRect();
    draw_threshold(canvas, model.haptic_threshold(), "feel", 1.0f, FELT_LINE, list);
    draw_threshold(canvas, model.paint_threshold(), "paint", 0.0f, PAINT_LINE, list);
    draw_line(canvas, points, list);
    draw_points(canvas, points, selected, list);
}

// ---- Grabbing and dragging

struct Found {
    Grip grip = Grip::nothing;
    size_t point = 0;
};

Found under_mouse(const Canvas& canvas, const Model& model, const ImVec2& mouse)
{
    const float reach = REACH * ImGui::GetFontSize();
    const auto points = model.session.transfer_function.points();
    Found found;
    float nearest = reach;
    for (size_t i = 0; i < points.size(); ++i) {
        const ImVec2 at = canvas.place_of(points[i]);
        const float distance = std::hypot(at.x - mouse.x, at.y - mouse.y);
        if (distance <= nearest) found = {Grip::point, i}, nearest = distance;
    }
    if (found.grip == Grip::point) return found;
    const float to_paint = std::abs(canvas.x_of(model.paint_threshold()) - mouse.x);
    const float to_felt = std::abs(canvas.x_of(model.haptic_threshold()) - mouse.x);
    if (std::min(to_paint, to_felt) > 0.6f * reach) return found;
    // If both lines coincide, the one whose label is hit.
    const bool is_felt_row = mouse.y > canvas.begin.y + 1.25f * ImGui::GetFontSize();
    const bool is_paint = to_paint == to_felt ? !is_felt_row : to_paint < to_felt;
    return {is_paint ? Grip::paint_threshold : Grip::haptic_threshold, 0};
}

void add_point(const Canvas& canvas, const ImVec2& mouse, const Model& model, WidgetState& state, Actions& actions)
{
    Points points = points_of(model);
    const double intensity = canvas.intensity_at(mouse.x);
    const TransferFunction function(points);
    ControlPoint added{.intensity = intensity, .opacity = canvas.opacity_at(mouse.y)};
    // The function has no colour outside its points, so the end's colour continues.
    added.color = glm::dvec3(function.at(std::clamp(intensity, function.lower(), function.upper())));
    const auto after = std::upper_bound(points.begin(), points.end(), intensity,
                                        [](double value, const ControlPoint& p) { return value < p.intensity; });
    state.selected = size_t(after - points.begin());
    points.insert(after, added);
    send(std::move(points), model, actions);
}

void remove_point(size_t point, const Model& model, WidgetState& state, Actions& actions)
{
    Points points = points_of(model);
    if (points.size() <= 2) return;
    points.erase(points.begin() + std::ptrdiff_t(point));
    state.selected = std::min(point, points.size() - 1);
    send(std::move(points), model, actions);
}

/// Clamped between its neighbours, so that its index stays the same.
double held_between_neighbors(const Points& points, size_t index, double intensity)
{
    const double lower = index > 0 ? points[index - 1].intensity : -double(FLT_MAX);
    const double upper = index + 1 < points.size() ? points[index + 1].intensity : double(FLT_MAX);
    return std::clamp(intensity, lower, upper);
}

void move_point(const Canvas& canvas, const ImVec2& mouse, const Model& model, size_t index, Actions& actions)
{
    Points points = points_of(model);
    const ControlPoint was = points[index];
    points[index].intensity = held_between_neighbors(points, index, canvas.intensity_at(mouse.x));
    points[index].opacity = canvas.opacity_at(mouse.y);
    if (!(points[index] == was)) send(std::move(points), model, actions);
}

/// Keeps part of the function within the volume's intensities.
void move_all(const Model& model, double shift, Actions& actions)
{
    Points points = points_of(model);
    const double least = model.statistics.range().lower - points.back().intensity;
    const double most = model.statistics.range().upper - points.front().intensity;
    const double held = std::clamp(shift, std::min(least, 0.0), std::max(most, 0.0));
    if (held == 0.0) return;
    for (ControlPoint& point : points) point.intensity += held;
    send(std::move(points), model, actions);
}

void begin_drag(const Canvas& canvas, const Model& model, const ImVec2& mouse, WidgetState& state)
{
    const Found found = under_mouse(canvas, model, mouse);
    state.grip = ImGui::GetIO().KeyCtrl ? Grip::all_points : found.grip;
    state.grabbed_at = canvas.intensity_at(mouse.x);
    state.offset = {};
    if (state.grip != Grip::point) return;
    const ImVec2 at = canvas.place_of(model.session.transfer_function.points()[found.point]);
    state.selected = found.point;
    state.offset = {at.x - mouse.x, at.y - mouse.y};
}

void drag(const Canvas& canvas, const Model& model, const ImVec2& mouse, WidgetState& state, Actions& actions)
{
    const double now = canvas.intensity_at(mouse.x);
    const double held = std::clamp(now, model.statistics.range().lower, model.statistics.range().upper);
    const double threshold = is_float(model.volume.type) ? held : std::round(held);
    BrushSettings brush = model.brush();
    switch (state.grip) {
        case Grip::nothing: return;
        case Grip::point: return move_point(canvas, mouse, model, state.selected, actions);
        case Grip::all_points: return move_all(model, now - std::exchange(state.grabbed_at, now), actions);
        case Grip::paint_threshold:
            if (std::exchange(brush.threshold, threshold) != threshold)
                set(actions, model, [&](Session& s) { s.probe.brush = brush; });
            return;
        case Grip::haptic_threshold:
            if (model.haptic_threshold() != threshold)
                set(actions, model, [&](Session& s) { s.probe.haptic_threshold = threshold; });
            return;
    }
}

/// At most one action a frame.
void use_mouse(const Canvas& canvas, const Model& model, WidgetState& state, Actions& actions)
{
    const ImVec2 mouse = ImGui::GetIO().MousePos;
    const ImVec2 held{mouse.x + state.offset.x, mouse.y + state.offset.y};
    if (!ImGui::IsMouseDown(ImGuiMouseButton_Left)) state.grip = Grip::nothing;
    if (ImGui::IsMouseDragging(ImGuiMouseButton_Left, 1.0f)) return drag(canvas, model, held, state, actions);
    if (!ImGui::IsItemHovered()) return;
    const Found found = under_mouse(canvas, model, mouse);
    if (ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left) && found.grip == Grip::nothing)
        add_point(canvas, mouse, model, state, actions);
    else if (ImGui::IsMouseClicked(ImGuiMouseButton_Left))
        begin_drag(canvas, model, mouse, state);
    else if (ImGui::IsMouseClicked(ImGuiMouseButton_Right) && found.grip == Grip::point)
        remove_point(found.point, model, state, actions);
}

// ---- The panel's parts

void curve(const Model& model, WidgetState& state, Actions& actions)
{
    if (state.grip == Grip::nothing) choose_axis(model, state);
    const float margin = MARGIN * ImGui::GetFontSize();
    const ImVec2 corner = ImGui::GetCursorScreenPos();
    const ImVec2 size{std::max(ImGui::GetContentRegionAvail().x, 8.0f * margin), HEIGHT * ImGui::GetFontSize()};
    const Canvas canvas{.begin = {corner.x + margin, corner.y + margin},
                        .end = {corner.x + size.x - margin, corner.y + size.y - margin},
                        .lower = state.lower,
                        .upper = state.upper};
    ImGui::InvisibleButton("curve", size, ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonRight);
    draw(canvas, model, state.selected);
    use_mouse(canvas, model, state, actions);
}

/// The line below the curve.
void shading_and_help(const Model& model, Actions& actions)
{
    Light light = model.session.light;
    if (ImGui::Checkbox("Shading", &light.shaded)) set(actions, model, [&](Session& s) { s.light = light; });
    hint("Light from over your shoulder. Without it, colours are as chosen above.");
    const RenderSettings& render = model.session.render;
    bool sees_peaks = render.preintegration;
    ImGui::SameLine();
    ImGui::BeginDisabled(render.step_voxels > 1.0);
    if (ImGui::Checkbox("Narrow peaks", &sees_peaks))
        set(actions, model, [&](Session& s) { s.render.preintegration = sees_peaks; });
    ImGui::EndDisabled();
    hint(
        "No peak or edge of the curve is missed, however narrow (pre-integration). Slower; smooth curves do not need "
        "it.");
    ImGui::SameLine(ImGui::GetContentRegionMax().x - ImGui::CalcTextSize("How to edit (?)").x);
    ImGui::TextDisabled("How to edit (?)");
    hint(
        "Left to right: the file's intensities, over how often they occur (logarithmic). Upwards: opacity, as its "
        "square root, so that small opacities can be seen and dragged.\n\n"
        "Drag a point to move it. Double click on empty space adds one, right click on a point deletes it. Ctrl + drag "
        "moves all points. The lines \"paint\" and \"feel\" are the thresholds; drag them too.");
}

/// Number fields of the point last touched.
void edit_point(const Model& model, size_t index, Actions& actions)
{
    Points points = points_of(model);
    ControlPoint& point = points[index];
    const float speed = float((model.statistics.range().upper - model.statistics.range().lower) / 500.0);
    const double least = held_between_neighbors(points, index, -DBL_MAX);
    const double most = held_between_neighbors(points, index, DBL_MAX);
    const double clear = 0.0, solid = 1.0;
    const char* format = is_float(model.volume.type) ? "%.5g" : "%.1f";
    ImGui::PushItemWidth(-5.5f * ImGui::GetFontSize());
    bool changed = ImGui::DragScalar("Intensity", ImGuiDataType_Double, &point.intensity, std::max(speed, 1e-6f),
                                     &least, &most, format, ImGuiSliderFlags_AlwaysClamp);
    hint("Of the selected point, in the file's units. Drag sideways, or Ctrl + click to type.");
    changed |= ImGui::DragScalar("Opacity", ImGuiDataType_Double, &point.opacity, 0.002f, &clear, &solid, "%.4f",
                                 ImGuiSliderFlags_AlwaysClamp | ImGuiSliderFlags_Logarithmic);
    hint("Of one voxel: 0 clear, 1 solid.");
    ImVec4 color = encoded(point.color, 1.0f);
    if (ImGui::ColorEdit3("Colour", &color.x)) {
        point.color = {srgb_decode(double(color.x)), srgb_decode(double(color.y)), srgb_decode(double(color.z))};
        changed = true;
    }
    ImGui::PopItemWidth();
    if (changed) send(std::move(points), model, actions);
}

/// Replaces the whole function by a preset fitted to the volume.
void preset_list(const Model& model, Actions& actions)
{
    ImGui::SetNextItemWidth(-1.0f);
    if (!ImGui::BeginCombo("##presets", "Start from ...")) return;
    if (ImGui::Selectable("the histogram"))
        set(actions, model, [&](Session& s) { s.transfer_function = automatic_transfer_function(model.statistics); });
    for (const TransferPreset& preset : model.presets) {
        if (ImGui::Selectable(preset.name.c_str()))
            set(actions, model,
                [&](Session& s) { s.transfer_function = transfer_function_of(preset, model.statistics); });
        if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", preset.note.c_str());
    }
    ImGui::EndCombo();
}

}  // namespace

void transfer_function_panel(const Model& model, Actions& actions)
{
    static WidgetState state;
    const TransferFunction& function = model.session.transfer_function;
    const size_t count = function.points().size();
    if (!model.statistics.histogram.empty()) preset_list(model, actions);
    if (count < 2) {
        ImGui::TextWrapped("There is no transfer function, so nothing is visible.");
    } else {
        state.selected = std::min(state.selected, count - 1);
        const size_t edited = state.selected;  // an index into this frame's points
        curve(model, state, actions);
        shading_and_help(model, actions);
        edit_point(model, edited, actions);
        if (function.draws_nothing()) ImGui::TextDisabled("Nothing is visible: no opacity is above 0.");
    }
}

}  // namespace shvr::ui
