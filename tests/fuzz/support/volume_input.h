#pragma once
// Shared by all targets of volume readers: opens a file as a user would, checks its information against the guarantees
// of volume.h, reads a few boxes of every level, and reads all of a small volume.

#include <filesystem>

#include "engine/formats/open_volume.h"

namespace shvr::fuzz {

void try_volume(const std::filesystem::path& path);
/// The same for an open volume.
void try_source(const VolumeSource& source);

}  // namespace shvr::fuzz
