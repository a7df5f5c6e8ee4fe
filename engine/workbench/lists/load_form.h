#pragma once
// Contents of the form for opening a file with the user's options, and their conversion to settings. Pure; any thread.

#include <string>

#include "engine/workbench/models/model.h"

namespace shvr::ui {

struct LoadForm {
    std::string channel, frame;   ///< empty: the file has only one
    int level = 0;                ///< 0: the finest
    bool states_spacing = false;  ///< false: uses the spacing that the file states, or else 1 voxel
    glm::dvec3 spacing{1.0};
    std::string unit;      ///< empty: the unit in the file
    bool is_bare = false;  ///< raw voxels without a header
    int size[3] = {512, 512, 512};
    VoxelType type = VoxelType::uint8;
    bool is_big_endian = false;
    int offset_bytes = 0;
};

/// Returns the settings in the form, as the action Open takes them: one per line.
std::string settings_of(const LoadForm& form);
/// Returns size, type and spacing as text: "512 x 512 x 300 voxels of uint16, each 0.8 x 0.8 x 1.2 µm".
std::string size_in_words(const VolumeInfo& volume);
/// Returns where a value comes from: "stated by the file", "typed", "assumed: the file states none".
const char* in_words(Provenance provenance);

}  // namespace shvr::ui
