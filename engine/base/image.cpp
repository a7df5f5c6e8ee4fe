#include "engine/base/image.h"

#include <algorithm>
#include <cmath>

#include "engine/base/error.h"

namespace shvr {
namespace {

uint8_t byte_of(double share)
{
    // Written so that NaN becomes 0; lround is undefined for it.
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

Image8 to_image8(const ImageF& image)
{
    const size_t values = 4 * size_t(image.width) * size_t(image.height);
    SHVR_CHECK(image.rgba.size() == values, image.rgba.size(), " != ", values);
    Image8 encoded{image.width, image.height, std::vector<uint8_t>(values)};
    for (size_t pixel = 0; pixel < values; pixel += 4) {
        const double alpha = double(image.rgba[pixel + 3]);
        encoded.rgba[pixel + 3] = byte_of(alpha);
        if (encoded.rgba[pixel + 3] == 0) continue;
        for (size_t channel = pixel; channel < pixel + 3; ++channel) {
            encoded.rgba[channel] = byte_of(srgb_encode(double(image.rgba[channel]) / alpha));
        }
    }
    return encoded;
}

size_t count_not_finite(const ImageF& image)
{
    return size_t(
        std::count_if(image.rgba.begin(), image.rgba.end(), [](float value) { return !std::isfinite(value); }));
}

}  // namespace shvr
