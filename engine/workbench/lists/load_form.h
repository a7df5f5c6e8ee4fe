#pragma once
// What a person fills in to open a file with choices of their own, and what that means as settings. Pure; any thread.

#include <string>

#include "engine/workbench/models/model.h"

namespace shvr::ui {

struct LoadForm {
    std::string channel, frame;   ///< empty: the file has one alone
    int level = 0;                ///< 0 the finest
    bool states_spacing = false;  ///< otherwise the file's, or 1 voxel
    glm::dvec3 spacing{1.0};
    std::string unit;      ///< empty: the file's
    bool is_bare = false;  ///< voxels without a header
    int size[3] = {512, 512, 512};
    VoxelType type = VoxelType::uint8;
    bool is_big_endian = false;
    int offset_bytes = 0;
};

/// As the action Open takes them, one a line.
std::string settings_of(const LoadForm& form);
/// "512 x 512 x 300 voxels of uint16, 0.8 x 0.8 x 1.2 um"
std::string size_in_words(const VolumeInfo& volume);
/// "stated by the file", "typed", "assumed: the file states none"
const char* in_words(Provenance provenance);

}  // namespace shvr::ui
