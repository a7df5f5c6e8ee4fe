#include "engine/base/image_metrics.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "engine/base/error.h"
#include "engine/base/flip.h"

using namespace shvr;

namespace {

struct Color {
    uint8_t red = 0, green = 0, blue = 0, alpha = 255;
};
constexpr Color BLACK{}, WHITE{255, 255, 255}, RED{255, 0, 0}, GREEN{0, 255, 0}, BLUE{0, 0, 255};

Color grey(int level)
{
    const auto value = uint8_t(level);
    return {value, value, value};
}

Image8 painted(int width, int height, const std::function<Color(int x, int y)>& color_at)
{
    Image8 image{width, height, {}};
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const Color color = color_at(x, y);
            image.rgba.insert(image.rgba.end(), {color.red, color.green, color.blue, color.alpha});
        }
    }
    return image;
}

Image8 plain(Color color, int width = 128, int height = 128)
{
    return painted(width, height, [&](int, int) { return color; });
}

Image8 noise(int width, int height, unsigned seed)
{
    std::mt19937 random(seed);
    return painted(width, height, [&](int, int) {
        const auto level = [&] { return uint8_t(random()); };
        return Color{level(), level(), level()};
    });
}

struct FlipAnchor {
    const char* name;
    Image8 a, b;
    double mean, max;
};

/// SSIM as its definition says: each window by itself, no separable filter, two passes for the variances.
double ssim_by_definition(const Image8& a, const Image8& b)
{
    const auto luma = [](const Image8& image, int x, int y) {
        const uint8_t* const rgba = &image.rgba[4 * size_t(y * image.width + x)];
        return 0.2126 * rgba[0] + 0.7152 * rgba[1] + 0.0722 * rgba[2];
    };
    double total = 0.0;
    for (int cy = 5; cy < a.height - 5; ++cy) {
        for (int cx = 5; cx < a.width - 5; ++cx) {
            const auto mean_of = [&](const std::function<double(int, int)>& value) {
                double sum = 0.0, weights = 0.0;
                for (int dy = -5; dy <= 5; ++dy) {
                    for (int dx = -5; dx <= 5; ++dx) {
                        const double weight = std::exp(-(dx * dx + dy * dy) / 4.5);
                        sum += weight * value(cx + dx, cy + dy);
                        weights += weight;
                    }
                }
                return sum / weights;
            };
            const double ma = mean_of([&](int x, int y) { return luma(a, x, y); });
            const double mb = mean_of([&](int x, int y) { return luma(b, x, y); });
            const double va = mean_of([&](int x, int y) { return std::pow(luma(a, x, y) - ma, 2); });
            const double vb = mean_of([&](int x, int y) { return std::pow(luma(b, x, y) - mb, 2); });
            const double cab = mean_of([&](int x, int y) { return (luma(a, x, y) - ma) * (luma(b, x, y) - mb); });
            constexpr double C1 = 6.5025, C2 = 58.5225;
            total += (2 * ma * mb + C1) * (2 * cab + C2) / ((ma * ma + mb * mb + C1) * (va + vb + C2));
        }
    }
    return total / ((a.width - 10) * (a.height - 10));
}

}  // namespace

TEST_CASE("equal pictures do not differ in any metric")
{
    const Image8 image = noise(40, 30, 1);
    const ImageDifference difference = compare(image, image);
    CHECK(difference.max_abs == 0.0);
    CHECK(difference.rmse == 0.0);
    CHECK_FALSE(difference.psnr_db.has_value());
    CHECK(difference.mean_error == 0.0);
    CHECK(difference.fraction_over_1 == 0.0);
    CHECK(difference.fraction_over_4 == 0.0);
    CHECK(difference.ssim == 1.0);
    CHECK(difference.flip_mean == 0.0);
    CHECK(difference.flip_p99 == 0.0);
}

TEST_CASE("pixel metrics are what their definitions say")
{
    const Image8 a = plain(grey(100), 10, 10);
    Image8 b = a;
    SUBCASE("one channel of one pixel")
    {
        b.rgba[148] = 110;
        const PixelDifference difference = compare_pixels(a, b);
        CHECK(difference.max_abs == 10.0);
        CHECK(difference.rmse == doctest::Approx(std::sqrt(100.0 / 300.0)));
        CHECK(difference.alpha_rmse == 0.0);
        CHECK(*difference.psnr_db == doctest::Approx(10.0 * std::log10(255.0 * 255.0 * 3.0)));
        CHECK(difference.mean_error == doctest::Approx(10.0 / 100.0 / 255.0));
        CHECK(difference.fraction_over_1 == 0.01);
        CHECK(difference.fraction_over_4 == 0.01);
    }
    SUBCASE("alpha counts as a channel of the largest difference and has an RMSE of its own")
    {
        b.rgba[3] = 252;
        const PixelDifference difference = compare_pixels(a, b);
        CHECK(difference.max_abs == 3.0);
        CHECK(difference.rmse == 0.0);
        CHECK(difference.alpha_rmse == doctest::Approx(0.3));
        CHECK_FALSE(difference.psnr_db.has_value());
        CHECK(difference.fraction_over_1 == 0.01);
        CHECK(difference.fraction_over_4 == 0.0);
    }
    SUBCASE("errors that cancel have no mean")
    {
        b.rgba[0] = 101;
        b.rgba[4] = 99;
        CHECK(compare_pixels(a, b).mean_error == 0.0);
        CHECK(compare_pixels(a, b).max_abs == 1.0);
    }
    SUBCASE("the limits of the shares are exclusive")
    {
        b.rgba[0] = 101;
        b.rgba[4] = 104;
        CHECK(compare_pixels(a, b).fraction_over_1 == 0.01);
        CHECK(compare_pixels(a, b).fraction_over_4 == 0.0);
    }
}

// Kind (Instruments): an opaque picture, whose alpha is no error
TEST_CASE("black and white differ by the whole range")
{
    const PixelDifference difference = compare_pixels(plain(BLACK), plain(WHITE));
    CHECK(difference.rmse == 255.0);
    CHECK(*difference.psnr_db == 0.0);
}

TEST_CASE("comparison does not depend on the order of the pictures")
{
    const Image8 a = noise(50, 40, 2), b = noise(50, 40, 3);
    const ImageDifference ab = compare(a, b), ba = compare(b, a);
    CHECK(ab.rmse == ba.rmse);
    CHECK(ab.mean_error == ba.mean_error);
    CHECK(ab.ssim == doctest::Approx(ba.ssim).epsilon(1e-12));
    CHECK(ab.flip_mean == doctest::Approx(ba.flip_mean).epsilon(1e-12));
}

TEST_CASE("pictures of different sizes are refused and both sizes named")
{
    const char* const words = "the pictures differ in size: 4 x 5 and 5 x 4 pixels; expected the same";
    const Image8 a = plain(BLACK, 4, 5), b = plain(BLACK, 5, 4);
    CHECK_THROWS_WITH_AS(compare(a, b), words, Error);
    CHECK_THROWS_WITH_AS(compare_pixels(a, b), words, Error);
    CHECK_THROWS_WITH_AS(difference_picture(a, b), words, Error);
}

TEST_CASE("SSIM agrees with its definition")
{
    const Image8 a = noise(24, 19, 4);
    Image8 b = a;
    std::mt19937 random(5);
    for (uint8_t& value : b.rgba) value = uint8_t(std::clamp(value + int(random() % 61) - 30, 0, 255));
    CHECK(compare(a, b).ssim == doctest::Approx(ssim_by_definition(a, b)).epsilon(1e-10));
    // Constant pictures: only the first factor is left.
    const double c1 = 6.5025;
    CHECK(compare(plain(grey(100)), plain(grey(150))).ssim ==
          doctest::Approx((2 * 100 * 150 + c1) / (100 * 100 + 150 * 150 + c1)).epsilon(1e-10));
}

TEST_CASE("pictures smaller than every window are compared")
{
    const ImageDifference difference = compare(plain(BLACK, 3, 2), plain(WHITE, 3, 2));
    CHECK(difference.ssim == doctest::Approx(6.5025 / (255.0 * 255.0 + 6.5025)));
    CHECK(difference.flip_mean == doctest::Approx(0.967388).epsilon(1e-4));
}

TEST_CASE("FLIP agrees with the authors' implementation")
{
    const auto column = [](int x, int) { return x == 64 ? WHITE : BLACK; };
    const auto dot = [](int x, int y) { return x == 64 && y == 64 ? WHITE : BLACK; };
    const auto step_at = [](int edge) {
        return painted(128, 128, [=](int x, int) { return x < edge ? BLACK : WHITE; });
    };
    const FlipAnchor anchors[] = {
        {"identical", noise(128, 128, 6), noise(128, 128, 6), 0.0, 0.0},
        {"black and white", plain(BLACK), plain(WHITE), 0.967388, 0.967388},
        {"green and blue", plain(GREEN), plain(BLUE), 1.0, 1.0},
        {"red and black", plain(RED), plain(BLACK), 0.970501, 0.970501},
        {"grey 128 and 129", plain(grey(128)), plain(grey(129)), 0.029863, 0.029863},
        {"grey 128 and 138", plain(grey(128)), plain(grey(138)), 0.149010, 0.149010},
        {"black and one white column", plain(BLACK), painted(128, 128, column), 0.041261, 0.975739},
        {"black and one white pixel", plain(BLACK), painted(128, 128, dot), 0.000873, 0.864906},
        {"step at 64 and at 65", step_at(64), step_at(65), 0.025866, 0.772917},
    };
    for (const FlipAnchor& anchor : anchors) {
        const std::vector<double> map = flip_map(anchor.a, anchor.b);
        const double mean = compare(anchor.a, anchor.b).flip_mean;
        const double max = *std::max_element(map.begin(), map.end());
        INFO(anchor.name, ": mean ", mean, ", expected ", anchor.mean, "; max ", max, ", expected ", anchor.max);
        CHECK(std::abs(mean - anchor.mean) < 1e-4);
        CHECK(std::abs(max - anchor.max) < 1e-4);
        CHECK(*std::min_element(map.begin(), map.end()) >= 0.0);
        CHECK(max <= 1.0);
    }
}

TEST_CASE("FLIP agrees with the authors' implementation on a checker and half grey")
{
    // The authors' grey is 127.5, which 8 bits do not have; it is taken as the mean of its neighbours.
    const Image8 checker = painted(128, 128, [](int x, int y) { return (x + y) % 2 == 0 ? BLACK : WHITE; });
    double mean = 0.0, max = 0.0;
    for (const int level : {127, 128}) {
        const std::vector<double> map = flip_map(checker, plain(grey(level)));
        mean += 0.5 * compare(checker, plain(grey(level))).flip_mean;
        max += 0.5 * *std::max_element(map.begin(), map.end());
    }
    CHECK(std::abs(mean - 0.514218) < 1e-4);
    CHECK(std::abs(max - 0.791464) < 1e-4);
}

TEST_CASE("99 % of the pixels, and no fewer, are at or below the 99th percentile of FLIP")
{
    for (const int width : {1, 7, 10, 43}) {
        const Image8 a = noise(width, 10, 7), b = noise(width, 10, 8);
        const double p99 = compare(a, b).flip_p99;
        const std::vector<double> map = flip_map(a, b);
        const auto share = [&](auto is_counted) {
            return double(std::ranges::count_if(map, is_counted)) / double(map.size());
        };
        CHECK(share([&](double value) { return value <= p99; }) >= 0.99);
        CHECK(share([&](double value) { return value < p99; }) < 0.99);
    }
}

TEST_CASE("the difference picture shows differences enlarged and opaque")
{
    Image8 a = plain(grey(10), 3, 1), b = a;
    b.rgba = {13, 10, 10, 255, 200, 9, 10, 255, 10, 10, 10, 253};
    CHECK(difference_picture(a, b).rgba == std::vector<uint8_t>{48, 0, 0, 255, 255, 16, 0, 255, 32, 32, 32, 255});
    CHECK(difference_picture(b, a, 1.0).rgba == std::vector<uint8_t>{3, 0, 0, 255, 190, 1, 0, 255, 2, 2, 2, 255});
}

TEST_CASE("the tight tolerance refuses a large error, many small ones and a tint")
{
    const Image8 a = plain(grey(100), 100, 100);
    const auto verdict = [&](const Image8& b) { return why_not_within(compare_pixels(a, b), TIGHT_TOLERANCE); };
    Image8 b = a;
    CHECK_FALSE(verdict(a));
    CHECK_FALSE(why_not_within(compare_pixels(a, a), EXACT_TOLERANCE));
    SUBCASE("5 pixels in 10,000 may differ by 2 levels")
    {
        for (size_t pixel = 0; pixel < 5; ++pixel) b.rgba[4 * pixel] = 102;
        CHECK_FALSE(verdict(b));
        CHECK(why_not_within(compare_pixels(a, b), EXACT_TOLERANCE));
    }
    SUBCASE("6 may not")
    {
        for (size_t pixel = 0; pixel < 6; ++pixel) b.rgba[4 * pixel] = 102;
        CHECK(*verdict(b) == "the share of pixels that differ by more than 1/255 is 0.06 %, expected at most 0.05 %");
    }
    SUBCASE("none may differ by 3")
    {
        b.rgba[0] = 103;
        CHECK(*verdict(b) == "the largest difference is 3/255, expected at most 2/255");
    }
    SUBCASE("a level more in every 39th pixel is a tint")
    {
        for (size_t pixel = 0; pixel < 10000; pixel += 39) b.rgba[4 * pixel + 1] = 101;
        REQUIRE(verdict(b));
        CHECK(verdict(b)->starts_with("the mean error is 0.0001"));
    }
    SUBCASE("every limit that is exceeded is named")
    {
        CHECK(std::ranges::count(*verdict(plain(grey(140), 100, 100)), ';') == 2);
    }
}
