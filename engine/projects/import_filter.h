#pragma once
// Blurs or downscales voxels before they are stored. For import_prepare.cpp; import_prepare.h defines the results.

#include <memory>

#include "engine/projects/import_box.h"
#include "engine/projects/import_prepare.h"

namespace shvr {

/// `info` describes the result.
std::unique_ptr<Preparation> make_filter(VolumeInfo info, const ImportBox& box, const PreparationOptions& options);

}  // namespace shvr
