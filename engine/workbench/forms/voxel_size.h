#pragma once
// The size of a voxel as a person types it: "0.8 x 0.8 x 1.2 um", "0.5 0.5 2 mm", "4 um". Pure; any thread.

#include <optional>
#include <string>

#include <glm/glm.hpp>

namespace shvr::ui {

struct VoxelSize {
    glm::dvec3 spacing{1.0};
    std::string unit{};  ///< empty: none was typed
};

/// Returns null for a text that states no size: one number for all axes, or three, each above 0, and then the unit. A
/// comma is a decimal comma, "1,5 um", or, if there are two, between the numbers, "1, 1, 2" and "1,1,2".
std::optional<VoxelSize> voxel_size_of(const std::string& text);
/// Returns "0.8 x 0.8 x 1.2 um", which voxel_size_of reads as the same size.
std::string text_of(const VoxelSize& size);
/// Returns why a typed size cannot be that of a voxel, in a sentence; empty: it can. `unit`: the unit that the volume
/// has, which need not be known. Other units must be lengths.
std::string why_no_voxel_size(const std::string& text, const std::string& unit = {});
/// What a text that states no size is told.
inline constexpr const char* EXPECTED_VOXEL_SIZE = "expected the size of a voxel, as in 0.8 x 0.8 x 1.2 um";

}  // namespace shvr::ui
