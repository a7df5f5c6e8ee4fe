#pragma once
// Converts colours as spelled in files, "#rrggbb" or "#rrggbbaa" (sRGB), to and from linear light. Alpha is linear.
// Any thread.

#include <optional>
#include <string>
#include <string_view>

#include <glm/glm.hpp>

namespace shvr {

/// Returns null if the text is not such a colour; alpha is 1 if not given.
std::optional<glm::dvec4> color_of(std::string_view text);

/// Rounds to 8 bits per channel; "#rrggbb" if alpha is 1.
std::string text_of_color(const glm::dvec4& linear);

}  // namespace shvr
