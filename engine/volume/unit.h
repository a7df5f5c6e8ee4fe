#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace shvr {

/// "micron", "µm", "micrometer" -> "um"; unknown units are kept, cut at 60 characters and without control characters.
std::string plain_unit(std::string_view unit);

/// Micrometres in a unit of length; nothing if it is not one ("voxel").
std::optional<double> micrometres_in(const std::string& unit);

}  // namespace shvr
