// Scale bar, axes, distances and words in pictures in files.

#include "engine/workbench/sight/figure.h"

#include <algorithm>

#include <doctest/doctest.h>

#include "engine/workbench/sight/figure_texts.h"

using namespace shvr;
using namespace shvr::ui;

namespace {

Stamp square(const glm::ivec2& begin, uint8_t covered = 255)
{
    return {.begin = begin, .pixels = {2, 2}, .coverage = std::vector<uint8_t>(4, covered), .color = {0.5, 0.0, 1.0}};
}

ImageF dark(int width, int height)
{
    return {width, height, std::vector<float>(size_t(width) * size_t(height) * 4, 0.0f)};
}

/// Draws each byte 10 pixels wide.
std::vector<TextImage> draw_bytes(std::span<const std::string> texts, double height)
{
    std::vector<TextImage> images;
    for (const std::string& text : texts) images.push_back({{int(10 * text.size()), int(height)}, {}});
    return images;
}

}  // namespace

TEST_CASE("a text that is too wide is shortened between characters")
{
    CHECK(shortened("vascular", 80.0, 12.0, draw_bytes) == "vascular");
    CHECK(shortened("vascular", 79.0, 12.0, draw_bytes) == "vasc...");
    CHECK(shortened("a vascular", 55.0, 12.0, draw_bytes) == "a...");
    CHECK(shortened("\u00b5\u00b5\u00b5", 59.0, 12.0, draw_bytes) == "\u00b5...");
    CHECK(shortened("vascular", 39.0, 12.0, draw_bytes).empty());
    CHECK(shortened("", 39.0, 12.0, draw_bytes).empty());
}

TEST_CASE("a text is split at line ends and wrapped at spaces, and what is missing is stated")
{
    const auto lines = [](const std::string& text, double width, size_t most) {
        return lines_of(text, width, 12.0, most, draw_bytes);
    };
    using Lines = std::vector<std::string>;
    const FittedLines whole = lines("one two\r\nthree\n\n four", 75.0, 5);
    CHECK(whole.lines == Lines{"one two", "three", "four"});
    CHECK_FALSE(whole.is_shortened);
    CHECK(lines("one two three", 65.0, 3).lines == Lines{"one", "two", "three"});
    const FittedLines too_many = lines("one two three", 65.0, 2);
    CHECK(too_many.lines == Lines{"one", "two..."});
    CHECK(too_many.is_shortened);
    const FittedLines too_wide = lines("a vascular bundle", 70.0, 3);
    CHECK(too_wide.lines == Lines{"a", "vasc...", "bundle"});
    CHECK(too_wide.is_shortened);
    CHECK(lines("vascular", 20.0, 3).lines.empty());
    CHECK(lines("one\n \n", 65.0, 1).lines == Lines{"one"});
    CHECK_FALSE(lines("one\n \n", 65.0, 1).is_shortened);
}

TEST_CASE("a stamp covers its pixels of its pane, and no others, whatever bands the picture comes in")
{
    const PixelBox pane{{2, 1}, {6, 7}};
    const std::vector<Stamp> stamps{square({1, 2}), square({-1, -1}), square({3, 5}, 51), square({40, 40})};
    ImageF whole = dark(8, 8);
    draw_stamps(whole, stamps, pane);
    const auto at = [&](int x, int y, int channel) { return whole.rgba[size_t(4 * (x + 8 * y) + channel)]; };
    CHECK(at(3, 3, 0) == 0.5f);
    CHECK(at(3, 3, 3) == 1.0f);
    CHECK(at(4, 4, 2) == 1.0f);
    CHECK(at(5, 3, 3) == 0.0f);
    CHECK(at(2, 1, 3) == 1.0f);  // of the one that begins outside
    CHECK(at(1, 1, 3) == 0.0f);
    CHECK(at(2, 0, 3) == 0.0f);
    CHECK(at(5, 6, 0) == doctest::Approx(0.1));
    CHECK(at(6, 6, 3) == 0.0f);
    for (int rows = 1; rows <= 3; ++rows) {
        ImageF bands = dark(8, 0);
        for (int first = 0; first < 8; first += rows) {
            ImageF band = dark(8, std::min(rows, 8 - first));
            draw_stamps(band, stamps, pane, uint32_t(first));
            bands.rgba.insert(bands.rgba.end(), band.rgba.begin(), band.rgba.end());
        }
        CHECK(bands.rgba == whole.rgba);
    }
    Image8 screen{8, 8, std::vector<uint8_t>(256, 0)};
    draw_stamps(screen, stamps, pane);
    CHECK(screen.rgba[size_t(4 * (3 + 8 * 3))] == 188);  // half of the light, as sRGB
    CHECK(screen.rgba[size_t(4 * (5 + 8 * 3))] == 0);
}
