#pragma once
// Measures how much two pictures of the same size differ: numbers to report, and tolerances for gates. All functions
// compare the stored bytes (sRGB with straight alpha), without compositing. Alpha counts as a fourth channel where a
// comment says "all channels"; RMSE, PSNR, SSIM and FLIP use RGB only. Any thread may call these functions.

#include <optional>
#include <string>

#include "engine/base/image.h"
#include "engine/base/progress.h"

namespace shvr {

/// Metrics that are cheap to compute and suitable for gates.
struct PixelDifference {
    double max_abs = 0.0;           ///< 8-bit levels, all channels
    double rmse = 0.0;              ///< 8-bit levels, over red, green and blue
    double alpha_rmse = 0.0;        ///< 8-bit levels, over alpha
    std::optional<double> psnr_db;  ///< 20 log10(255 / rmse); null if the colours are equal (infinite PSNR)
    double mean_error = 0.0;        ///< |mean signed difference| / 255, maximum over all channels: detects a tint
    double fraction_over_1 = 0.0;   ///< fraction of pixels with any channel off by more than 1 level
    double fraction_over_4 = 0.0;   ///< fraction of pixels with any channel off by more than 4 levels
};

struct ImageDifference : PixelDifference {
    /// Mean structural similarity (Wang et al. 2004) of luma: 0.2126, 0.7152, 0.0722 of encoded RGB. Windows have 11 x
    /// 11 pixels with Gaussian weights of sigma 1.5, and lie inside the picture. If no window fits inside, windows
    /// centred on all pixels are used, with the picture's border repeated. 1 if the pictures are equal.
    double ssim = 1.0;
    double flip_mean = 0.0;  ///< mean FLIP error (flip.h) at the default distance
    double flip_p99 = 0.0;   ///< 99th percentile of the FLIP error
};

/// Compare two pictures. Both functions fail if the sizes differ; the error states the sizes.
PixelDifference compare_pixels(const Image8& a, const Image8& b);
ImageDifference compare(const Image8& a, const Image8& b, const Progress& progress = {});

/// Opaque picture of |a - b| * gain, for viewing. A difference in alpha shows as grey.
Image8 difference_picture(const Image8& a, const Image8& b, double gain = 16.0);

struct Tolerance {
    double max_abs = 0.0;              ///< 8-bit levels
    double max_fraction_over_1 = 0.0;  ///< fraction of the pixels
    double max_mean_error = 0.0;       ///< as PixelDifference::mean_error
};
inline constexpr Tolerance EXACT_TOLERANCE{};
/// Limits for the same arithmetic on another driver or processor. max_mean_error detects a tiny overall bias.
inline constexpr Tolerance TIGHT_TOLERANCE{.max_abs = 2.0, .max_fraction_over_1 = 0.0005, .max_mean_error = 1e-4};

/// Lists every exceeded limit with the value found; null if no limit is exceeded.
std::optional<std::string> why_not_within(const PixelDifference& difference, const Tolerance& tolerance);

}  // namespace shvr
