#pragma once
// Voxels that are blurred or made smaller before they are kept. For import_prepare.cpp, whose header says how.

#include <memory>

#include "engine/projects/import_box.h"
#include "engine/projects/import_prepare.h"

namespace shvr {

/// `info` is that of what comes out.
std::unique_ptr<Preparation> make_filter(VolumeInfo info, const ImportBox& box, const PreparationOptions& options);

}  // namespace shvr
