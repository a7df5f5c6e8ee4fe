#pragma once
// Formats positions, lengths and readings for display. Pure; any thread.

#include <string>

#include "engine/look/camera.h"
#include "engine/look/settings.h"
#include "engine/session/session.h"
#include "engine/workbench/models/sight.h"

namespace shvr::ui {

/// Returns a text such as "12.35 mm", with four digits. Displays micrometres with the Greek letter.
std::string length_in_words(double length, const std::string& unit);
/// Returns "12.35 mm" or, for an angle, "43.2°".
std::string value_in_words(const Measurement& measurement, const VolumeInfo& volume);
/// Returns "voxel 120, 80, 33 (1.2, 0.8, 0.33 mm)", counting voxels from 0. Without a unit, states the voxel only.
std::string place_in_words(const glm::dvec3& voxel, const VolumeInfo& volume);
/// Returns a text such as "value 12345 + 30", "value ..." or "outside". Integers get all digits, other values four.
std::string value_in_words(const Reading& reading);
/// Formats a reading in one line, for the status bar. `group_name`: name of the group at the reading's voxel.
std::string in_words(const Reading& reading, const VolumeInfo& volume, const std::string& group_name);
/// Returns "z 214 of 512, 1.284 mm": slices count from 1, and the length is the position of the slice's middle.
std::string slice_in_words(int axis, const glm::dvec3& voxel, const VolumeInfo& volume);

/// Returns the depth of a point along the line of sight, from where the drawn volume begins; at least 0.
double depth_below_surface(const Camera& camera, const CutBox& cut, const VolumeInfo& volume, const glm::dvec3& point);

/// A scale bar. Its length is 1, 2 or 5 times a power of ten: the longest that takes at most `longest_pixels`.
struct ScaleBar {
    double pixels = 0.0;
    std::string text;  ///< "200 µm"
};
ScaleBar scale_bar(double units_per_pixel, double longest_pixels, const std::string& unit);
/// Stands behind the length in a perspective, where the bar holds at one depth: that of the camera's target.
inline constexpr const char* HOLDS_AT_TARGET = " at the middle of the view";

/// Returns a name, cut to 32 characters of UTF-8 and "..." if it is longer.
std::string shortened_name(const std::string& name);

}  // namespace shvr::ui
