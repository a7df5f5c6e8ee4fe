#include "engine/look/session_color.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>

#include "engine/base/image.h"

namespace shvr {
namespace {

std::optional<double> byte_of(std::string_view digits)
{
    uint8_t value = 0;
    const char* const end = digits.data() + digits.size();
    const auto result = std::from_chars(digits.data(), end, value, 16);
    if (result.ec != std::errc() || result.ptr != end) return {};
    return value / 255.0;
}

std::string digits_of(double share)
{
    constexpr char DIGITS[] = "0123456789abcdef";
    const auto value = unsigned(std::lround(std::clamp(share, 0.0, 1.0) * 255.0));
    return {DIGITS[value / 16], DIGITS[value % 16]};
}

}  // namespace

std::optional<glm::dvec4> color_of(std::string_view text)
{
    if ((text.size() != 7 && text.size() != 9) || text[0] != '#') return {};
    glm::dvec4 color(1.0);
    for (size_t channel = 0; channel < text.size() / 2; ++channel) {
        const std::optional<double> share = byte_of(text.substr(1 + 2 * channel, 2));
        if (!share) return {};
        color[int(channel)] = channel < 3 ? srgb_decode(*share) : *share;
    }
    return color;
}

std::string text_of_color(const glm::dvec4& linear)
{
    std::string text = "#";
    for (int channel = 0; channel < 3; ++channel) text += digits_of(srgb_encode(linear[channel]));
    const std::string alpha = digits_of(linear.a);
    return alpha == "ff" ? text : text + alpha;
}

}  // namespace shvr
