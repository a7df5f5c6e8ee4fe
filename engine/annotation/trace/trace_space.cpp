#include "engine/annotation/trace/trace_space.h"

#include <cmath>

#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/volume/unit.h"

namespace shvr {

namespace {

bool states_place(const TraceSpace& space)
{
    return !space.frame.empty() || space.origin != glm::dvec3(0.0) || space.directions != glm::dmat3(1.0);
}

/// Converts RAS to LPS and vice versa.
TraceSpace turned_round(TraceSpace space)
{
    const glm::dvec3 turn(-1.0, -1.0, 1.0);
    for (int axis = 0; axis < 3; ++axis) space.directions[axis] *= turn;
    space.origin *= turn;
    return space;
}

/// Whether two spaces have the same place, up to the rounding of numbers that other programs store as 32-bit floats.
bool is_in_place(const TraceSpace& found, const TraceSpace& expected)
{
    constexpr double MAX_TURN = 1e-3, MAX_VOXELS = 0.05, ROUNDING = 1e-6;
    const std::optional<double> from = micrometres_in(found.unit), to = micrometres_in(expected.unit);
    const double factor = from && to ? *from / *to : 1.0;
    for (int axis = 0; axis < 3; ++axis)
        if (!(glm::length(found.directions[axis] - expected.directions[axis]) <= MAX_TURN)) return false;
    const glm::dvec3 away = glm::abs(glm::inverse(expected.directions) * (factor * found.origin - expected.origin));
    const glm::dvec3 allowed = MAX_VOXELS * expected.spacing + ROUNDING * glm::length(expected.origin);
    return glm::all(glm::lessThanEqual(away, allowed));
}

std::string place_in_words(const TraceSpace& space)
{
    return sentence("origin ", digits_of(space.origin), " and axes along ", digits_of(space.directions[0]), ", ",
                    digits_of(space.directions[1]), " and ", digits_of(space.directions[2]),
                    space.frame.empty() ? "" : " of ", space.frame);
}

const char* axes_in_words(const std::string& frame)
{
    return frame == "LPS"   ? "LPS (x to the left, y to the back, z upwards)"
           : frame == "RAS" ? "RAS (x to the right, y to the front, z upwards)"
                            : "the volume's file";
}

}  // namespace

TraceSpace space_of(const VolumeInfo& volume)
{
    return {volume.size, volume.spacing, plain_unit(volume.unit), volume.directions, volume.origin, volume.frame};
}

glm::dvec3 physical_of(const TraceSpace& space, const glm::dvec3& position)
{
    return space.origin + space.directions * (position - 0.5 * space.spacing);
}

glm::dvec3 position_of(const TraceSpace& space, const glm::dvec3& physical)
{
    return glm::inverse(space.directions) * (physical - space.origin) + 0.5 * space.spacing;
}

std::string why_elsewhere(const TraceSpace& found, const TraceSpace& expected)
{
    if (!states_place(found) || !states_place(expected)) return {};
    // A coordinate frame without a name is compatible with any frame.
    const bool may_be_same = found.frame == expected.frame || found.frame.empty() || expected.frame.empty();
    const bool may_be_turned = found.frame != expected.frame;
    if ((may_be_same && is_in_place(found, expected)) || (may_be_turned && is_in_place(turned_round(found), expected)))
        return {};
    return sentence(place_in_words(found), "; expected ", place_in_words(expected));
}

std::string in_words(const TraceSpace& space, Positions positions)
{
    if (positions == Positions::volume)
        return sentence("positions are voxels times spacing, in ", space.unit,
                        ", from the outer corner of voxel 0: the centre of voxel i is at (i + 1/2) spacing");
    return sentence("positions are physical, in ", space.unit, ", along the axes of ", axes_in_words(space.frame),
                    ": the centre of voxel 0 is at the origin");
}

std::vector<std::pair<const char*, std::string>> statements_of(const TraceSpace& space, Positions positions)
{
    if (positions == Positions::volume) return {{"space", "volume"}};
    std::string directions;
    for (int axis = 0; axis < 3; ++axis) directions += (axis == 0 ? "" : " ") + digits_of(space.directions[axis]);
    std::vector<std::pair<const char*, std::string>> statements{{"space", "physical"}};
    if (!space.frame.empty()) statements.emplace_back("frame", space.frame);
    statements.emplace_back("origin", digits_of(space.origin));
    statements.emplace_back("directions", directions);
    return statements;
}

}  // namespace shvr
