#include "engine/base/image.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "engine/base/error.h"

namespace shvr {
namespace {

uint8_t byte_of(double share)
{
    // The negated comparison is also true for NaN, which becomes 0; lround is undefined for NaN.
    if (!(share > 0.0)) return 0;
    return uint8_t(std::lround(std::min(share, 1.0) * 255.0));
}

}  // namespace

double srgb_encode(double linear)
{
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1.0 / 2.4) - 0.055;
}

double srgb_decode(double encoded)
{
    return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

void encode_pixels(std::span<const float> light, std::span<uint8_t> encoded)
{
    SHVR_CHECK(light.size() == encoded.size(), light.size(), " != ", encoded.size());
    for (size_t pixel = 0; pixel < light.size(); pixel += 4) {
        // Background pixels repeat, and powers are slow.
        if (pixel > 0 && std::memcmp(&light[pixel], &light[pixel - 4], 4 * sizeof(float)) == 0) {
            std::copy_n(&encoded[pixel - 4], 4, &encoded[pixel]);
            continue;
        }
        const double alpha = double(light[pixel + 3]);
        encoded[pixel + 3] = byte_of(alpha);
        for (size_t channel = pixel; channel < pixel + 3; ++channel)
            encoded[channel] =
                encoded[pixel + 3] == 0 ? uint8_t(0) : byte_of(srgb_encode(double(light[channel]) / alpha));
    }
}

Image8 to_image8(const ImageF& image)
{
    const size_t values = 4 * size_t(image.width) * size_t(image.height);
    SHVR_CHECK(image.rgba.size() == values, image.rgba.size(), " != ", values);
    Image8 encoded{image.width, image.height, std::vector<uint8_t>(values)};
    encode_pixels(image.rgba, encoded.rgba);
    return encoded;
}

size_t count_not_finite(const ImageF& image)
{
    return size_t(
        std::count_if(image.rgba.begin(), image.rgba.end(), [](float value) { return !std::isfinite(value); }));
}

}  // namespace shvr
