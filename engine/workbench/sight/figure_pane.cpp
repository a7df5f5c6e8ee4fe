#include "engine/workbench/sight/figure_pane.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/workbench/sight/figure_texts.h"

namespace shvr::ui {

namespace {

constexpr glm::dvec3 BLACK(0.0), WHITE(1.0);
constexpr uint8_t OPAQUE = 255;

}  // namespace

FigurePane::FigurePane(const Pane& pane, const VolumeInfo& volume, const glm::dvec4& background, double line,
                       const TextDrawer& draw_texts)
    : pane_(pane),
      volume_(volume),
      background_(background),
      size_(pane.pixels()),
      line_(line),
      draw_texts_(draw_texts),
      part_{.box = pane.box, .strokes = {}, .stamps = {}}
{}

FigurePane::Ink FigurePane::ink_at(const glm::dvec2& pixel) const
{
    return is_light_at(pixel, pane_, volume_, background_) ? Ink{BLACK, WHITE} : Ink{WHITE, BLACK};
}

double FigurePane::rim_width() const
{
    return ui::rim_width(line_);
}

bool FigurePane::is_free(const Box& box) const
{
    const auto overlaps = [&](const Box& other) {
        return glm::all(glm::lessThan(box.begin, other.end)) && glm::all(glm::lessThan(other.begin, box.end));
    };
    return glm::all(glm::greaterThanEqual(box.begin, glm::dvec2(0.0))) &&
           glm::all(glm::lessThanEqual(box.end, size_)) && std::ranges::none_of(taken_, overlaps);
}

void FigurePane::rectangle(const glm::dvec2& begin, const glm::dvec2& end, const glm::dvec3& color)
{
    Stamp stamp{.begin = glm::ivec2(glm::floor(begin)), .pixels{}, .coverage{}, .color = color};
    stamp.pixels = glm::ivec2(glm::ceil(end)) - stamp.begin;
    const auto overlap = [](double pixel, double from, double to) {
        return std::max(std::min(pixel + 1.0, to) - std::max(pixel, from), 0.0);
    };
    for (int y = 0; y < stamp.pixels.y; ++y)
        for (int x = 0; x < stamp.pixels.x; ++x) {
            const double covered =
                overlap(stamp.begin.x + x, begin.x, end.x) * overlap(stamp.begin.y + y, begin.y, end.y);
            stamp.coverage.push_back(uint8_t(std::lround(OPAQUE * covered)));
        }
    part_.stamps.push_back(std::move(stamp));
}

void FigurePane::line(const glm::dvec2& from, const glm::dvec2& to, const glm::dvec3& color, double width)
{
    part_.strokes.push_back({from, to, ink_at(0.5 * (from + to)).rim, width + 2.0 * rim_width()});
    part_.strokes.push_back({from, to, color, width});
}

void FigurePane::lines(std::span<const LabelLine> drawn, double width)
{
    const auto ink_of = [&](const LabelLine& each) { return ink_at(0.5 * (each.from + each.to)); };
    for (const LabelLine& each : drawn)
        part_.strokes.push_back({each.from, each.to, ink_of(each).rim, width + 2.0 * rim_width()});
    for (const LabelLine& each : drawn) part_.strokes.push_back({each.from, each.to, ink_of(each).color, width});
}

void FigurePane::dot(const glm::dvec2& middle, double radius)
{
    const LabelLine drawn{middle, middle + glm::dvec2(0.01, 0.0)};
    lines(std::span(&drawn, 1), 2.0 * radius);
}

void FigurePane::write(const std::vector<Words>& words, double height)
{
    std::vector<std::string> texts;
    for (const Words& each : words) texts.push_back(each.text);
    std::vector<TextImage> images = draw_texts_(texts, height);
    for (size_t i = 0; i < words.size(); ++i) {
        const glm::dvec2 begin = words[i].at - words[i].anchor * glm::dvec2(images[i].pixels);
        const Ink ink = ink_at(begin + 0.5 * glm::dvec2(images[i].pixels));
        Stamp text{.begin = glm::ivec2(glm::round(begin)),
                   .pixels = images[i].pixels,
                   .coverage = std::move(images[i].coverage),
                   .color = ink.color};
        part_.stamps.push_back(rim_of(text, int(rim_width()), ink.rim));
        part_.stamps.push_back(std::move(text));
    }
}

double FigurePane::widest_of(std::span<const std::string> texts, double height) const
{
    double widest = 0.0;
    for (const double width : widths_of(texts, height, draw_texts_)) widest = std::max(widest, width);
    return widest;
}

}  // namespace shvr::ui
