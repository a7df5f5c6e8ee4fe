#include "tools/golden/light.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <sstream>

#include "engine/base/error.h"
#include "engine/base/file.h"

namespace shvr::golden {

namespace {

constexpr int64_t MAX_BYTES = int64_t{1} << 30;

}  // namespace

ImageF read_light(const std::filesystem::path& path)
{
    const std::vector<std::byte> bytes = read_file(path, MAX_BYTES);
    const auto* const text = reinterpret_cast<const char*>(bytes.data());
    std::istringstream head(std::string(text, std::min<size_t>(bytes.size(), 64)));
    std::string magic;
    int width = 0, height = 0;
    double scale = 0.0;
    head >> magic >> width >> height >> scale;
    const size_t values = width > 0 && height > 0 ? size_t(width) * size_t(height) * 3 : 0;
    if (magic != "PF" || values == 0 || bytes.size() < values * sizeof(float))
        fail(path.string(), ": is no picture in linear light; expected a portable float map");
    // Rows start at the bottom.
    const std::byte* const data = bytes.data() + bytes.size() - values * sizeof(float);
    ImageF image{width, height, std::vector<float>(size_t(width) * size_t(height) * 4, 1.0f)};
    for (size_t i = 0; i < values; ++i) {
        const size_t pixel = i / 3, x = pixel % size_t(width), y = size_t(height) - 1 - pixel / size_t(width);
        std::memcpy(&image.rgba[4 * (y * size_t(width) + x) + i % 3], data + i * sizeof(float), sizeof(float));
    }
    return image;
}

double largest_difference(const ImageF& a, const ImageF& b)
{
    SHVR_CHECK(a.width == b.width && a.height == b.height);
    double largest = 0.0;
    for (size_t i = 0; i < a.rgba.size(); ++i)
        largest = std::max(largest, std::abs(double(a.rgba[i]) - double(b.rgba[i])));
    return largest;
}

}  // namespace shvr::golden
