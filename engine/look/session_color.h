#pragma once
// Colours as files spell them: "#rrggbb" or "#rrggbbaa", sRGB, to and from linear light. Alpha is straight and has no
// curve. Any thread.

#include <optional>
#include <string>
#include <string_view>

#include <glm/glm.hpp>

namespace shvr {

/// Nothing where the text is no such colour; alpha 1 where it states none.
std::optional<glm::dvec4> color_of(std::string_view text);

/// Rounded to 8 bits a channel; "#rrggbb" where alpha is 1.
std::string text_of_color(const glm::dvec4& linear);

}  // namespace shvr
