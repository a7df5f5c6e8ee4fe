#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace shvr {

/// "micron", "µm", "micrometer" -> "um"; unknown units are kept, without control characters and cut at 60.
std::string plain_unit(std::string_view unit);

/// Micrometres in a unit of length; nothing where it is none ("voxel").
std::optional<double> micrometres_in(const std::string& unit);

}  // namespace shvr
