#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace shvr {

/// Limits of the voxel spacing in its unit: rendering computes squares and quotients of it.
inline constexpr double MIN_SPACING = 1e-12, MAX_SPACING = 1e12;

/// "micron", "µm", "micrometer" -> "um"; unknown units are kept, cut at 60 characters and without control characters.
std::string plain_unit(std::string_view unit);

/// Micrometres in a unit of length; null if it is not one ("voxel").
std::optional<double> micrometres_in(const std::string& unit);

}  // namespace shvr
