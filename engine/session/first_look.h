#pragma once
// Opens a session for a person who waits for its first picture.

#include "engine/session/session.h"

namespace shvr {

/// Maximum number of voxels that are measured of a volume on another machine: the finest level with so few is measured,
/// which takes one or two round trips.
inline constexpr int64_t MAX_VOXELS_OF_FIRST_LOOK = int64_t{1} << 22;

/// As open_session; but a volume on another machine is measured on a coarser level (VolumeStatistics::measured_level).
OpenedSession open_session_for_first_look(const std::filesystem::path& path, const std::vector<std::string>& settings,
                                          const OpeningOptions& options);

}  // namespace shvr
