#pragma once
// What every target of a volume reader does with a file: open it as a user would, hold what it says of itself against
// what volume.h promises, read a few boxes of every level, and go through all of it where that is little.

#include <filesystem>

#include "engine/formats/open_volume.h"

namespace shvr::fuzz {

void try_volume(const std::filesystem::path& path);
/// The same of a volume that is open.
void try_source(const VolumeSource& source);

}  // namespace shvr::fuzz
