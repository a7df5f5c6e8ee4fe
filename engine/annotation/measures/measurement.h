#pragma once
// Distances, paths and angles that a person measures in a volume: their values and their table. Pure; any thread.

#include <optional>
#include <span>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "engine/annotation/trace/trace_space.h"
#include "engine/base/spelling.h"

namespace shvr {

/// A distance has two points, a path two or more, and an angle three, of which the second is its vertex.
enum class MeasureKind { distance, path, angle };
inline constexpr Spelling<MeasureKind> MEASURE_KINDS[] = {
    {MeasureKind::distance, "distance"}, {MeasureKind::path, "path"}, {MeasureKind::angle, "angle"}};
constexpr std::span<const Spelling<MeasureKind>> spellings_of(MeasureKind)
{
    return MEASURE_KINDS;
}

/// A measurement. Its points are in voxels, so that it follows changes of the spacing.
struct Measurement {
    std::vector<glm::dvec3> points;
    MeasureKind kind = MeasureKind::distance;
    std::string name;  ///< empty: the kind and the number
    bool operator==(const Measurement&) const = default;
};
/// The limits bound the undo history, in which each step stores all measurements before and after it.
inline constexpr size_t MAX_MEASUREMENTS = 1000, MAX_MEASURED_POINTS = 200;

/// Returns whether a measurement of that kind can have this number of points.
bool is_count_of(MeasureKind kind, size_t points);
/// Returns the number of points at which a measurement ends by itself; null for a path, which the user ends.
std::optional<size_t> last_point_of(MeasureKind kind);

/// Returns the length from the first point to the last along all points, in the unit of the spacing.
double length_of(const Measurement& measurement, const glm::dvec3& spacing);
/// Returns the angle at the second of three points, in degrees, 0 ... 180; null where a side has no length, or for
/// another number of points.
std::optional<double> angle_of(const Measurement& measurement, const glm::dvec3& spacing);

/// Returns "Path 2": the name, or else the kind and the number, which counts from 1.
std::string name_of(const Measurement& measurement, size_t number);
/// Returns a name for a new measurement: the kind and the first number that no other name has.
std::string unused_name(std::span<const Measurement> others, MeasureKind kind);

/// Returns a table, one measurement per row, whose headings have the units: number, name, kind, length, angle and the
/// points, of which the heading says whether they are physical, with the centre of voxel 0 at the scan's origin, or
/// counted from its corner. `separator`: a comma (RFC 4180) or a tab. Angles have no length, and lengths no angle.
std::string measurements_table(std::span<const Measurement> measurements, const TraceSpace& space, Positions positions,
                               char separator);

}  // namespace shvr
