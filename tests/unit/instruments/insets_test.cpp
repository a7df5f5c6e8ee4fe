// The parts of pictures that the bench shows enlarged.

#include <cmath>

#include <doctest/doctest.h>

#include "tools/bench/insets.h"

using namespace shvr;

namespace {

ImageF grey(int width, int height)
{
    ImageF image{width, height, std::vector<float>(size_t(width) * size_t(height) * 4, 0.5f)};
    for (size_t i = 3; i < image.rgba.size(); i += 4) image.rgba[i] = 1.0f;
    return image;
}

void change(ImageF& image, int x, int y, float by)
{
    image.rgba[4 * (size_t(y) * size_t(image.width) + size_t(x))] += by;
}

}  // namespace

TEST_CASE("the inset is where errors sum up to most, not where one pixel is worst")
{
    const ImageF truth = grey(40, 24);
    ImageF wrong = truth;
    change(wrong, 2, 2, 0.3f);
    for (int y = 13; y < 18; ++y)
        for (int x = 25; x < 33; ++x) change(wrong, x, y, 0.2f);
    const bench::Window window = bench::worst_window(wrong, truth);
    CHECK(window.width == 10);
    CHECK(window.height == 6);
    CHECK(window.x <= 25);
    CHECK(window.x + window.width >= 33);
    CHECK(window.y <= 13);
    CHECK(window.y + window.height >= 18);
    CHECK(bench::rmse_in(wrong, truth, window) == doctest::Approx(0.2 * std::sqrt(40.0 / (3 * 60))));
    CHECK(bench::rmse_in(truth, truth, window) == 0.0);
}

TEST_CASE("pictures without an error have an inset, and small ones, too")
{
    const ImageF truth = grey(3, 2);
    CHECK(bench::worst_window(truth, truth) == bench::Window{0, 0, 1, 1});
    ImageF wrong = truth;
    change(wrong, 2, 1, 0.1f);
    CHECK(bench::worst_window(wrong, truth) == bench::Window{2, 1, 1, 1});
}

TEST_CASE("an inset is enlarged pixel by pixel")
{
    ImageF image = grey(4, 4);
    change(image, 2, 1, 0.4f);
    const Image8 part = bench::enlarged(image, {1, 1, 2, 1}, 3);
    REQUIRE(part.width == 6);
    REQUIRE(part.height == 3);
    const auto red = [&](int x, int y) { return part.rgba[4 * size_t(y * part.width + x)]; };
    CHECK(red(2, 2) == red(0, 0));
    CHECK(red(3, 0) > red(2, 0));
    CHECK(red(5, 2) == red(3, 0));
}
