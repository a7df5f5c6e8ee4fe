#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace shvr {

/// Limits of the voxel spacing, in its unit: rendering computes squares and quotients of the spacing.
inline constexpr double MIN_SPACING = 1e-12, MAX_SPACING = 1e12;

/// Maps "micron", "µm", "micrometer" to "um"; keeps unknown units, cut at 60 characters and without control characters.
std::string plain_unit(std::string_view unit);

/// Returns the micrometres in a unit of length; null if the unit is not a length ("voxel").
std::optional<double> micrometres_in(const std::string& unit);

}  // namespace shvr
