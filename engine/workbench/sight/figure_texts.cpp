#include "engine/workbench/sight/figure_texts.h"

#include <algorithm>
#include <string_view>

#include "engine/base/text.h"

namespace shvr::ui {

namespace {

constexpr const char* ELLIPSIS = "...";

/// The offsets at which characters of UTF-8 begin, and the end of the text.
std::vector<size_t> character_borders(const std::string& text)
{
    std::vector<size_t> borders;
    for (size_t i = 0; i < text.size(); ++i)
        if ((uint8_t(text[i]) & 0xC0u) != 0x80u) borders.push_back(i);
    borders.push_back(text.size());
    return borders;
}

/// Removes the words of the next line from `words`: as many as fit into `width`, and at least one.
std::string take_fitting(std::span<const std::string_view>& words, double width, double height,
                         const TextDrawer& draw_texts)
{
    std::vector<std::string> beginnings;
    std::string line;
    for (const std::string_view word : words) {
        line += (line.empty() ? "" : " ") + std::string(word);
        beginnings.push_back(line);
    }
    const std::vector<double> widths = widths_of(beginnings, height, draw_texts);
    const auto fitting = std::ranges::find_if(widths, [&](double each) { return each > width; });
    const size_t count = std::max(size_t(fitting - widths.begin()), size_t(1));
    words = words.subspan(count);
    return beginnings[count - 1];
}

}  // namespace

std::vector<double> widths_of(std::span<const std::string> texts, double height, const TextDrawer& draw_texts)
{
    std::vector<double> widths;
    for (const TextImage& image : draw_texts(texts, height)) widths.push_back(double(image.pixels.x));
    return widths;
}

std::string shortened(const std::string& text, double width, double height, const TextDrawer& draw_texts)
{
    std::vector<std::string> candidates{text};
    std::vector<size_t> borders = character_borders(text);
    std::ranges::reverse(borders);
    for (const size_t border : borders)
        if (border > 0 && border < text.size())
            candidates.push_back(std::string(trimmed(std::string_view(text).substr(0, border))) + ELLIPSIS);
    const std::vector<double> widths = widths_of(candidates, height, draw_texts);
    const auto fitting = std::ranges::find_if(widths, [&](double each) { return each <= width; });
    return fitting == widths.end() ? std::string() : candidates[size_t(fitting - widths.begin())];
}

FittedLines lines_of(const std::string& text, double width, double height, size_t most, const TextDrawer& draw_texts)
{
    FittedLines fitted;
    std::string_view rest = text;
    while (!rest.empty()) {
        const std::vector<std::string_view> all = words_of(take_line(rest));
        std::span<const std::string_view> words = all;
        while (!words.empty()) {
            std::string line = take_fitting(words, width, height, draw_texts);
            const bool is_last = fitted.lines.size() + 1 == most && !(words.empty() && trimmed(rest).empty());
            if (is_last) line += ELLIPSIS;
            std::string drawn = shortened(line, width, height, draw_texts);
            fitted.is_shortened = fitted.is_shortened || is_last || drawn != line;
            if (!drawn.empty()) fitted.lines.push_back(std::move(drawn));
            if (is_last) return fitted;
        }
    }
    return fitted;
}

}  // namespace shvr::ui
