#include "engine/base/image_metrics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <numeric>

#include "engine/base/error.h"
#include "engine/base/flip.h"
#include "engine/base/plane.h"

namespace shvr {
namespace {

void check_comparable(const Image8& a, const Image8& b)
{
    if (a.width != b.width || a.height != b.height) {
        fail("the pictures differ in size: ", a.width, " x ", a.height, " and ", b.width, " x ", b.height,
             " pixels; expected the same");
    }
    const size_t values = 4 * size_t(a.width) * size_t(a.height);
    SHVR_CHECK(a.rgba.size() == values && b.rgba.size() == values, a.rgba.size(), ", ", b.rgba.size(), ", ", values);
    if (values == 0) fail("the pictures are ", a.width, " x ", a.height, " pixels; expected at least one pixel");
}

Plane luma_of(const Image8& image)
{
    Plane luma(image.width, image.height);
    for (size_t pixel = 0; pixel < luma.values.size(); ++pixel) {
        const uint8_t* const rgba = image.rgba.data() + 4 * pixel;
        luma.values[pixel] = 0.2126 * rgba[0] + 0.7152 * rgba[1] + 0.0722 * rgba[2];
    }
    return luma;
}

/// Returns, for each pixel, the mean of a * b over the weighted window around the pixel.
Plane window_means(Plane a, const Plane& b, const std::vector<double>& window, FilterProgress& filters)
{
    std::transform(a.values.begin(), a.values.end(), b.values.begin(), a.values.begin(), std::multiplies());
    return filtered(a, window, window, filters);
}

double ssim_of(const Plane& a, const Plane& b, const Progress& progress)
{
    constexpr int RADIUS = 5;
    constexpr double C1 = 0.01 * 255 * 0.01 * 255, C2 = 0.03 * 255 * 0.03 * 255;
    const std::vector<double> window = gaussian_weights(1.5, RADIUS);
    FilterProgress filters(progress, 5.0);
    const Plane mean_a = filtered(a, window, window, filters), mean_b = filtered(b, window, window, filters);
    const Plane mean_aa = window_means(a, a, window, filters), mean_bb = window_means(b, b, window, filters);
    const Plane mean_ab = window_means(a, b, window, filters);
    const bool one_fits = std::min(a.width, a.height) > 2 * RADIUS;
    const int margin = one_fits ? RADIUS : 0;
    double sum = 0.0;
    for (int y = margin; y < a.height - margin; ++y) {
        for (int x = margin; x < a.width - margin; ++x) {
            const size_t at = size_t(y) * size_t(a.width) + size_t(x);
            const double ma = mean_a.values[at], mb = mean_b.values[at];
            const double variances = (mean_aa.values[at] - ma * ma) + (mean_bb.values[at] - mb * mb);
            const double covariance = mean_ab.values[at] - ma * mb;
            sum += (2.0 * ma * mb + C1) * (2.0 * covariance + C2) / ((ma * ma + mb * mb + C1) * (variances + C2));
        }
    }
    return sum / (double(a.width - 2 * margin) * (a.height - 2 * margin));
}

}  // namespace

PixelDifference compare_pixels(const Image8& a, const Image8& b)
{
    check_comparable(a, b);
    // Sums integers, so that the result does not depend on the order of summation.
    std::array<int64_t, 4> sums{}, squares{};
    int64_t over_1 = 0, over_4 = 0;
    int largest = 0;
    for (size_t pixel = 0; pixel < a.rgba.size(); pixel += 4) {
        int largest_here = 0;
        for (size_t channel = 0; channel < 4; ++channel) {
            const int difference = a.rgba[pixel + channel] - b.rgba[pixel + channel];
            sums[channel] += difference;
            squares[channel] += int64_t{difference} * difference;
            largest_here = std::max(largest_here, std::abs(difference));
        }
        largest = std::max(largest, largest_here);
        over_1 += largest_here > 1;
        over_4 += largest_here > 4;
    }
    const double pixels = double(a.rgba.size()) / 4.0;
    PixelDifference result;
    result.max_abs = largest;
    result.rmse = std::sqrt(double(squares[0] + squares[1] + squares[2]) / (3.0 * pixels));
    result.alpha_rmse = std::sqrt(double(squares[3]) / pixels);
    if (result.rmse > 0.0) result.psnr_db = 20.0 * std::log10(255.0 / result.rmse);
    for (const int64_t sum : sums) {
        result.mean_error = std::max(result.mean_error, double(std::abs(sum)) / pixels / 255.0);
    }
    result.fraction_over_1 = double(over_1) / pixels;
    result.fraction_over_4 = double(over_4) / pixels;
    return result;
}

ImageDifference compare(const Image8& a, const Image8& b, const Progress& progress)
{
    tell(progress, 0.0);
    ImageDifference result{compare_pixels(a, b)};
    constexpr double SSIM = 0.1;  // SSIM's share of the run time
    result.ssim = ssim_of(luma_of(a), luma_of(b), part_of(progress, 0.0, SSIM));
    std::vector<double> flip = flip_map(a, b, FLIP_PIXELS_PER_DEGREE, part_of(progress, SSIM, 1.0));
    result.flip_mean = std::accumulate(flip.begin(), flip.end(), 0.0) / double(flip.size());
    const auto p99 = flip.begin() + std::ptrdiff_t((flip.size() * 99 + 99) / 100 - 1);
    std::nth_element(flip.begin(), p99, flip.end());
    result.flip_p99 = *p99;
    return result;
}

Image8 difference_picture(const Image8& a, const Image8& b, double gain)
{
    check_comparable(a, b);
    Image8 picture = a;
    for (size_t pixel = 0; pixel < a.rgba.size(); pixel += 4) {
        const auto difference_at = [&](size_t at) { return std::abs(a.rgba[at] - b.rgba[at]); };
        const int of_alpha = difference_at(pixel + 3);
        for (size_t at = pixel; at < pixel + 3; ++at) {
            const double shown = gain * std::max(difference_at(at), of_alpha);
            picture.rgba[at] = uint8_t(std::lround(std::clamp(shown, 0.0, 255.0)));
        }
        picture.rgba[pixel + 3] = 255;
    }
    return picture;
}

std::optional<std::string> why_not_within(const PixelDifference& difference, const Tolerance& tolerance)
{
    std::string reasons;
    const auto check = [&](const char* what, double found, double limit, const char* unit) {
        // The comparison is written so that NaN counts as exceeding every limit.
        if (found <= limit) return;
        if (!reasons.empty()) reasons += "; ";
        reasons += sentence(what, " is ", found, unit, ", expected at most ", limit, unit);
    };
    check("the largest difference", difference.max_abs, tolerance.max_abs, "/255");
    check("the share of pixels that differ by more than 1/255", 100.0 * difference.fraction_over_1,
          100.0 * tolerance.max_fraction_over_1, " %");
    check("the mean error", difference.mean_error, tolerance.max_mean_error, "");
    if (reasons.empty()) return {};
    return reasons;
}

}  // namespace shvr
