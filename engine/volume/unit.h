#pragma once

#include <optional>
#include <string>
#include <string_view>

#include <glm/glm.hpp>

namespace shvr {

/// Limits of the voxel spacing, in its unit. They keep squares and quotients of spacings in range during rendering.
inline constexpr double MIN_SPACING = 1e-12, MAX_SPACING = 1e12;

/// Converts "micron", "µm", "micrometer" to "um". Cuts unknown units at 60 characters, removes control characters.
std::string plain_unit(std::string_view unit);

/// Returns a unit as people write it: "µm" for "um".
std::string unit_in_words(const std::string& unit);
/// Returns the size of a voxel for messages: "0.5 x 0.5 x 2 µm". An empty unit is left out.
std::string spacing_in_words(const glm::dvec3& spacing, const std::string& unit);

/// Returns the number of micrometres in a unit of length; null if the unit is not a length ("voxel").
std::optional<double> micrometres_in(const std::string& unit);

}  // namespace shvr
