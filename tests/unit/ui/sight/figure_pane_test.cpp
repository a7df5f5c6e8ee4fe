// Ink of texts, lines and dots in figures.

#include "engine/workbench/sight/figure_pane.h"

#include <doctest/doctest.h>

using namespace shvr;
using namespace shvr::ui;

namespace {

constexpr glm::dvec3 BLACK(0.0), WHITE(1.0);

std::vector<TextImage> blocks(std::span<const std::string> texts, double pixels)
{
    const glm::ivec2 size{int(pixels)};
    return {texts.size(), TextImage{size, std::vector<uint8_t>(size_t(size.x) * size_t(size.y), 255)}};
}

/// A scan of 200 x 200 mm in the middle of a pane of 300 x 300 pixels, seen from above: a millimetre is a pixel.
struct Seen {
    VolumeInfo volume{.name = "volume"};
    Pane pane{.kind = Pane::Kind::slice, .shot = Camera(), .box = {{0, 0}, {300, 300}}, .name = "slice", .axis = 2};
    TextDrawer draw_texts = blocks;

    Seen()
    {
        volume.size = {100, 100, 100};
        volume.spacing = glm::dvec3(2.0);
        Camera camera;
        camera.projection = Camera::Projection::orthographic;
        camera.eye = {100.0, 100.0, 400.0};
        camera.target = {100.0, 100.0, 100.0};
        camera.up = {0.0, 1.0, 0.0};
        camera.height = 300.0;
        pane.shot = camera;
        pane.shot.is_slice = true;
    }
    FigurePane on(const glm::dvec4& background) const { return {pane, volume, background, 10.0, draw_texts}; }
};

}  // namespace

TEST_CASE("over the scan in a slice, words and lines are white with a black rim; on its light margin black")
{
    const Seen seen;
    FigurePane drawn = seen.on(glm::dvec4(1.0));
    drawn.write({{{150.0, 150.0}, {0.5, 0.5}, "a"}, {{20.0, 150.0}, {0.5, 0.5}, "b"}}, 10.0);
    const std::vector<LabelLine> lines{{{100.0, 150.0}, {200.0, 150.0}}, {{10.0, 10.0}, {30.0, 10.0}}};
    drawn.lines(lines, 2.0);
    drawn.dot({150.0, 150.0}, 3.0);
    const Figure::Part part = drawn.take_part();
    REQUIRE(part.stamps.size() == 4);
    for (const auto& [index, color] : {std::pair{0, BLACK}, {1, WHITE}, {2, WHITE}, {3, BLACK}})
        CHECK(part.stamps[size_t(index)].color == color);
    REQUIRE(part.strokes.size() == 6);
    for (const auto& [index, color] : {std::pair{0, BLACK}, {1, WHITE}, {2, WHITE}, {3, BLACK}, {4, BLACK}, {5, WHITE}})
        CHECK(part.strokes[size_t(index)].color == color);
}

TEST_CASE("in other views, and on a dark background, the ink follows the background")
{
    Seen seen;
    const glm::dvec2 inside(150.0), outside(20.0);
    for (const glm::dvec2& pixel : {inside, outside}) CHECK(seen.on({0.0, 0.0, 0.0, 1.0}).ink_at(pixel).color == WHITE);
    seen.pane.kind = Pane::Kind::main;
    for (const glm::dvec2& pixel : {inside, outside}) {
        CHECK(seen.on(glm::dvec4(1.0)).ink_at(pixel).color == BLACK);
        CHECK(seen.on({0.0, 0.0, 0.0, 0.0}).ink_at(pixel).rim == WHITE);
    }
}
