#pragma once
// Pictures in memory, and the conversion from light to bytes. Compositing happens in linear light; sRGB is applied
// once, here, on output. Plain values; any thread may use its own.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace shvr {

/// Pictures as files store them: 8-bit sRGB with straight (not premultiplied) alpha, RGBA, rows from the top.
struct Image8 {
    int width = 0, height = 0;
    std::vector<uint8_t> rgba;  ///< 4 * width * height
    bool operator==(const Image8&) const = default;
};

/// Pictures as rendered: linear light, RGB premultiplied by alpha, unclamped, rows from the top.
struct ImageF {
    int width = 0, height = 0;
    std::vector<float> rgba;  ///< 4 * width * height
    bool operator==(const ImageF&) const = default;
};

/// The exact piecewise sRGB curve of IEC 61966-2-1: maps linear light in 0..1 to sRGB in 0..1, without clamping.
double srgb_encode(double linear);
/// The inverse of srgb_encode. The standard's rounded constants leave a gap of 3e-9 where the pieces meet.
double srgb_decode(double encoded);

/// Un-premultiplies, clamps to 0..1, encodes as sRGB and rounds to nearest; does not encode alpha. A pixel whose alpha
/// rounds to 0 becomes 0,0,0,0. NaN becomes 0; `count_not_finite` reports whether there is any.
Image8 to_image8(const ImageF& image);
/// Converts pixels as `to_image8` does; both spans must hold the same number of pixels.
void encode_pixels(std::span<const float> light, std::span<uint8_t> encoded);

/// Counts values (not pixels) that are NaN or infinite. Any such value is a defect, which the caller reports.
size_t count_not_finite(const ImageF& image);

}  // namespace shvr
