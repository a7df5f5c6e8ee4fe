#include "ui/panels/dialogs/figure_preview.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <imgui/imgui.h>

#include "engine/session/words/number_words.h"
#include "engine/workbench/actions/action_rows.h"
#include "engine/workbench/forms/figure_form.h"
#include "engine/workbench/lists/group_list.h"
#include "ui/panels/dialogs/field_widgets.h"
#include "ui/panels/style.h"
#include "ui/panels/widgets.h"

namespace shvr::ui {

namespace {

/// The page as last drawn. Each is made again only if what it is made of has changed.
struct Preview {
    std::vector<Image8> shown;  ///< the window's panes
    uint64_t revision = 0;      ///< number of times that they were taken
    bool is_sharp = false;
    std::string made_of;  ///< what the members below are made of
    Image8 page;
    Figure figure;
    std::vector<std::string> left_out;  ///< sentences about elements
    bool has_unseen = false;            ///< parts that the window does not show
};
Preview shown_page;

/// Takes the window's picture as the dialog begins, and once more when it is sharp.
void follow_picture(const Model& model, bool begins)
{
    const bool is_wanted = begins || shown_page.shown.empty() || (!shown_page.is_sharp && model.view_is_complete);
    if (!is_wanted) return;
    shown_page.shown.clear();
    for (const Screen::Part& part : model.panes)
        shown_page.shown.push_back(part.view && part.view->shown_camera() ? part.view->read_back() : Image8{});
    shown_page.is_sharp = model.view_is_complete;
    ++shown_page.revision;
}

/// If a stamp is a rectangle, whose borders may cover parts of pixels, returns its corners; otherwise null.
std::optional<std::pair<glm::dvec2, glm::dvec2>> rectangle_of(const Stamp& stamp)
{
    constexpr double OPAQUE = 255.0;
    const glm::ivec2 last = stamp.pixels - 1;
    if (last.x < 0 || last.y < 0) return std::nullopt;
    const auto covered = [&](int x, int y) { return stamp.coverage[size_t(y * stamp.pixels.x + x)] / OPAQUE; };
    for (int y = 0; y <= last.y; ++y)
        for (int x = 0; x <= last.x; ++x) {
            const bool is_inside = x > 0 && x < last.x && y > 0 && y < last.y;
            if (covered(x, y) < (is_inside ? 1.0 : 1.0 / OPAQUE)) return std::nullopt;
        }
    const glm::ivec2 middle = stamp.pixels / 2;
    const double most = covered(middle.x, middle.y);
    const glm::dvec2 first_part(covered(0, middle.y) / most, covered(middle.x, 0) / most);
    const glm::dvec2 last_part(covered(last.x, middle.y) / most, covered(middle.x, last.y) / most);
    return std::pair{glm::dvec2(stamp.begin) + 1.0 - first_part, glm::dvec2(stamp.begin + last) + last_part};
}

/// Returns a smaller stamp: each of its pixels covers what those that it stands for cover on average. Rectangles end at
/// whole pixels, so that those that touch leave no gap.
Stamp smaller(const Stamp& stamp, double scale)
{
    if (const auto rectangle = rectangle_of(stamp)) {
        const glm::ivec2 from(glm::round(scale * rectangle->first)), to(glm::round(scale * rectangle->second));
        if (glm::all(glm::lessThan(from, to)))
            return {.begin = from,
                    .pixels = to - from,
                    .coverage = std::vector<uint8_t>(size_t(to.x - from.x) * size_t(to.y - from.y), 255),
                    .color = stamp.color};
    }
    const glm::ivec2 begin(glm::floor(scale * glm::dvec2(stamp.begin)));
    const glm::ivec2 end(glm::ceil(scale * glm::dvec2(stamp.begin + stamp.pixels)));
    Stamp small{.begin = begin, .pixels = end - begin, .coverage{}, .color = stamp.color};
    std::vector<double> sums(size_t(small.pixels.x) * size_t(small.pixels.y), 0.0);
    for (int y = 0; y < stamp.pixels.y; ++y)
        for (int x = 0; x < stamp.pixels.x; ++x) {
            const glm::ivec2 at =
                glm::ivec2(glm::floor(scale * (glm::dvec2(stamp.begin + glm::ivec2(x, y)) + 0.5))) - begin;
            sums[size_t(at.y) * size_t(small.pixels.x) + size_t(at.x)] +=
                stamp.coverage[size_t(y) * size_t(stamp.pixels.x) + size_t(x)];
        }
    for (const double sum : sums) small.coverage.push_back(uint8_t(std::lround(std::min(scale * scale * sum, 255.0))));
    return small;
}

/// Lays out the elements and the lines of slices and maps over the page as large as it will be, so that they are where
/// they will be, and returns them as small as the preview.
Figure elements_over(const FigureTask& task, const Model& model, Session session, double scale,
                     std::vector<std::string>& left_out)
{
    const glm::uvec2 pixels(task.pixels);
    session.render.size = pixels;
    const std::vector<Pane> panes = panes_of(session.view, model.camera, pixels, model.volume, model.probe_voxel);
    const std::vector<uint8_t> groups = drawn_groups(session, model.voxels_by_group, model.trace);
    Figure figure = figure_of(task.elements, {session, model.volume, panes, groups}, draw_texts, left_out);
    const OverlayScene lines =
        overlay_of(session.view, session.cut, model.camera, panes[0].pixels(), model.probe_voxel, model.volume);
    for (size_t i = 0; i < panes.size(); ++i) {
        const std::vector<Stroke> strokes = strokes_of(panes[i], lines, model.volume);
        figure.parts[i].strokes.insert(figure.parts[i].strokes.begin(), strokes.begin(), strokes.end());
    }
    for (Figure::Part& part : figure.parts) {
        part.box = {glm::uvec2(scale * glm::dvec2(part.box.begin)), glm::uvec2(scale * glm::dvec2(part.box.end))};
        for (Stroke& stroke : part.strokes) {
            stroke.from *= scale;
            stroke.to *= scale;
            stroke.width *= scale;
        }
        for (Stamp& stamp : part.stamps)
            if (scale < 1.0) stamp = smaller(stamp, scale);
    }
    return figure;
}

/// Shows where the background will be transparent.
void draw_checkers(Image8& page, const glm::dvec3& background)
{
    constexpr double ALIKE = 3.0;  // of 255
    for (int y = 0; y < page.height; ++y)
        for (int x = 0; x < page.width; ++x) {
            uint8_t* const color = &page.rgba[4 * (size_t(y) * size_t(page.width) + size_t(x))];
            bool is_background = true;
            for (int c = 0; c < 3; ++c)
                is_background =
                    is_background && std::abs(double(color[c]) - 255.0 * srgb_encode(background[c])) < ALIKE;
            if (is_background) std::fill(color, color + 3, uint8_t((x / 4 + y / 4) % 2 == 0 ? 255 : 200));
        }
}

void follow_task(const FigureTask& task, const Model& model, const glm::uvec2& pixels)
{
    constexpr double MAX_CORNERS = 20'000.0;  // of the mesh that draws the picture; ImGui's indices may have 16 bits
    std::string made_of = sentence(line_of(Action(task)), pixels.x, "x", pixels.y, " ", shown_page.revision);
    if (shown_page.made_of == made_of) return;
    shown_page.made_of = std::move(made_of);
    Session session = model.session;
    session.render.size = pixels;
    session.render.background.a = task.is_transparent ? 0.0 : 1.0;
    session.view.cut_box = false;  // as in the figure
    const auto panes = [&](const glm::uvec2& size) {
        return panes_of(session.view, model.camera, size, model.volume, model.probe_voxel);
    };
    const double side = std::max(2.0, std::sqrt(double(pixels.x) * pixels.y / MAX_CORNERS));
    const glm::uvec2 coarse = glm::max(glm::uvec2(glm::dvec2(pixels) / side), glm::uvec2(2));
    const glm::dvec3 background = glm::clamp(glm::dvec3(session.render.background), glm::dvec3(0.0), glm::dvec3(1.0));
    shown_page.page = page_of(panes(coarse), coarse, shown_page.shown, background, &shown_page.has_unseen);
    if (task.is_transparent) draw_checkers(shown_page.page, background);
    shown_page.left_out.clear();
    const double scale = double(pixels.x) / double(task.pixels.x);
    shown_page.figure = elements_over(task, model, session, scale, shown_page.left_out);
}

/// Draws the picture as a mesh with a colour at each corner: it needs no texture.
void draw_page(ImDrawList& list, const Image8& page, const ImVec2& begin, const ImVec2& size)
{
    const int width = page.width, height = page.height;
    if (width < 2 || height < 2) return;
    list.PrimReserve(6 * (width - 1) * (height - 1), width * height);
    const auto first = uint32_t(list._VtxCurrentIdx);
    const ImVec2 white = ImGui::GetFontTexUvWhitePixel();
    for (int y = 0; y + 1 < height; ++y)
        for (int x = 0; x + 1 < width; ++x)
            for (const auto& [right, below] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}})
                list.PrimWriteIdx(ImDrawIdx(first + uint32_t((y + below) * width + x + right)));
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const uint8_t* const color = &page.rgba[4 * (size_t(y) * size_t(width) + size_t(x))];
            const ImVec2 at{begin.x + size.x * float(x) / float(width - 1),
                            begin.y + size.y * float(y) / float(height - 1)};
            list.PrimWriteVtx(at, white, IM_COL32(color[0], color[1], color[2], 255));
        }
}

ImU32 shade_of(const glm::dvec3& linear, double coverage)
{
    const auto encoded = [](double value) { return float(srgb_encode(std::clamp(value, 0.0, 1.0))); };
    return ImGui::GetColorU32(ImVec4(encoded(linear.r), encoded(linear.g), encoded(linear.b), float(coverage)));
}

/// Draws a shape as level bars of equal coverage.
void draw_stamp(ImDrawList& list, const Stamp& stamp, const ImVec2& origin)
{
    const auto at = [&](int x, int y) {
        return ImVec2(origin.x + float(stamp.begin.x + x), origin.y + float(stamp.begin.y + y));
    };
    for (int y = 0; y < stamp.pixels.y; ++y)
        for (int x = 0, end = 0; x < stamp.pixels.x; x = end) {
            const uint8_t* const row = &stamp.coverage[size_t(y) * size_t(stamp.pixels.x)];
            for (end = x + 1; end < stamp.pixels.x && row[end] == row[x];) ++end;
            if (row[x] > 0) list.AddRectFilled(at(x, y), at(end, y + 1), shade_of(stamp.color, row[x] / 255.0));
        }
}

void draw_elements(ImDrawList& list, const Figure& figure, const ImVec2& begin)
{
    for (const Figure::Part& part : figure.parts) {
        const ImVec2 origin{begin.x + float(part.box.begin.x), begin.y + float(part.box.begin.y)};
        const auto at = [&](const glm::dvec2& pixel) {
            return ImVec2(origin.x + float(pixel.x), origin.y + float(pixel.y));
        };
        for (const Stroke& stroke : part.strokes) {
            const ImU32 color = shade_of(stroke.color, 1.0);
            list.AddLine(at(stroke.from), at(stroke.to), color, float(stroke.width));
            if (stroke.has_flat_ends) continue;
            for (const glm::dvec2& end : {stroke.from, stroke.to})
                list.AddCircleFilled(at(end), 0.5f * float(stroke.width), color);
        }
        for (const Stamp& stamp : part.stamps) draw_stamp(list, stamp, origin);
    }
}

/// Returns one pixel of a pane of the page: the mean of the pixels that it covers in the window's pane; null if it
/// covers none.
std::optional<glm::dvec3> pixel_of(const glm::uvec2& pixel, const glm::uvec2& pane, const Image8& shown)
{
    const double scale = double(shown.height) / pane.y;
    const auto across = [&](double x) { return 0.5 * shown.width + (x - 0.5 * pane.x) * scale; };
    const double left = across(pixel.x), right = across(pixel.x + 1.0);
    if (right <= 0.0 || left >= shown.width || shown.height < 1) return std::nullopt;
    const int x0 = std::clamp(int(left), 0, shown.width - 1), x1 = std::clamp(int(right), x0 + 1, shown.width);
    const int y0 = std::clamp(int(pixel.y * scale), 0, shown.height - 1);
    const int y1 = std::clamp(int((pixel.y + 1) * scale), y0 + 1, shown.height);
    glm::dvec3 sum(0.0);
    for (int y = y0; y < y1; ++y)
        for (int x = x0; x < x1; ++x)
            for (int c = 0; c < 3; ++c)
                sum[c] += shown.rgba[4 * (size_t(y) * size_t(shown.width) + size_t(x)) + size_t(c)];
    return sum / (double(x1 - x0) * (y1 - y0));
}

}  // namespace

Image8 page_of(std::span<const Pane> panes, const glm::uvec2& pixels, std::span<const Image8> shown,
               const glm::dvec3& background, bool* has_unseen)
{
    constexpr double STRIPE = 128.0;
    bool is_any_unseen = false;
    Image8 page{int(pixels.x), int(pixels.y), std::vector<uint8_t>(size_t(pixels.x) * pixels.y * 4, 255)};
    glm::dvec3 behind;
    for (int c = 0; c < 3; ++c) behind[c] = 255.0 * srgb_encode(std::clamp(background[c], 0.0, 1.0));
    for (size_t i = 0; i < panes.size(); ++i) {
        const PixelBox& box = panes[i].box;
        for (uint32_t y = box.begin.y; y < box.end.y; ++y)
            for (uint32_t x = box.begin.x; x < box.end.x; ++x) {
                std::optional<glm::dvec3> color;
                if (i < shown.size()) color = pixel_of({x - box.begin.x, y - box.begin.y}, panes[i].pixels(), shown[i]);
                is_any_unseen = is_any_unseen || !color;
                if (!color) color = (x + y) / 2 % 4 == 0 ? glm::mix(behind, glm::dvec3(STRIPE), 0.5) : behind;
                for (int c = 0; c < 3; ++c)
                    page.rgba[4 * (size_t(y) * pixels.x + x) + size_t(c)] = uint8_t(std::lround((*color)[c]));
            }
    }
    if (has_unseen) *has_unseen = is_any_unseen;
    return page;
}

void figure_preview(const FigureTask& task, const Model& model, bool begins)
{
    if (task.pixels.x < 1 || task.pixels.y < 1) return;  // the dialog says what is wrong with the size
    const double font = ImGui::GetFontSize();
    const glm::dvec2 room(26.0 * font, std::min(15.0 * font, 0.3 * double(ImGui::GetMainViewport()->WorkSize.y)));
    const glm::dvec2 wanted(task.pixels), fitted = wanted * std::min(room.x / wanted.x, room.y / wanted.y);
    const glm::uvec2 pixels = glm::max(glm::uvec2(glm::round(fitted)), glm::uvec2(4));
    follow_picture(model, begins);
    follow_task(task, model, pixels);
    field_name("Preview");
    const ImVec2 begin = ImGui::GetCursorScreenPos(), size{float(pixels.x), float(pixels.y)};
    const ImVec2 end{begin.x + size.x, begin.y + size.y};
    ImGui::Dummy(size);
    ImDrawList& list = *ImGui::GetWindowDrawList();
    list.PushClipRect(begin, end, true);
    draw_page(list, shown_page.page, begin, size);
    draw_elements(list, shown_page.figure, begin);
    list.PopClipRect();
    list.AddRect(begin, end, ui::shade_of(ColorRole::faint_text));
    hint(
        "A coarse copy of the window's picture, with the elements where they will be. The file shows the volume "
        "sharp, and without the probe.");
    ImGui::PushTextWrapPos(begin.x - ImGui::GetWindowPos().x + float(room.x));
    if (shown_page.has_unseen) ImGui::TextDisabled("Striped: not seen in the window; the figure shows the scan there.");
    for (const std::string& each : shown_page.left_out) {
        const std::string words = capitalised(each);
        want_glyphs(words);
        ImGui::PushStyleColor(ImGuiCol_Text, color_of(ColorRole::warning));
        ImGui::TextUnformatted(words.c_str());
        ImGui::PopStyleColor();
    }
    ImGui::PopTextWrapPos();
}

}  // namespace shvr::ui
