#pragma once
// Converts colours between the form in files, "#rrggbb" or "#rrggbbaa" (sRGB), and linear light. Alpha is linear. Any
// thread.

#include <optional>
#include <string>
#include <string_view>

#include <glm/glm.hpp>

namespace shvr {

/// Returns null if the text is not a colour. Alpha is 1 if the text states none.
std::optional<glm::dvec4> color_of(std::string_view text);

/// Rounds to 8 bits per channel. Returns "#rrggbb" if alpha is 1.
std::string text_of_color(const glm::dvec4& linear);

}  // namespace shvr
