#pragma once
// Colours as spelled in files: "#rrggbb" or "#rrggbbaa", sRGB, to and from linear light. Alpha is straight and linear.
// Any thread.

#include <optional>
#include <string>
#include <string_view>

#include <glm/glm.hpp>

namespace shvr {

/// Null if the text is no such colour; alpha is 1 if not given.
std::optional<glm::dvec4> color_of(std::string_view text);

/// Rounded to 8 bits a channel; "#rrggbb" where alpha is 1.
std::string text_of_color(const glm::dvec4& linear);

}  // namespace shvr
