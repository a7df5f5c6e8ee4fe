#include "engine/session/meshes/mesh_place.h"

#include <limits>

#include "engine/base/error.h"
#include "engine/volume/unit.h"

namespace shvr {

namespace {

struct Box {
    glm::dvec3 lower{std::numeric_limits<double>::max()}, upper{std::numeric_limits<double>::lowest()};
    void add(const glm::dvec3& at)
    {
        lower = glm::min(lower, at);
        upper = glm::max(upper, at);
    }
};

std::string in_words(const Box& box)
{
    std::string text;
    for (int axis = 0; axis < 3; ++axis)
        text += sentence(axis == 0 ? "" : ", ", "xyz"[axis], ' ', box.lower[axis], " to ", box.upper[axis]);
    return text;
}

/// The space that a file states, in the volume's unit.
TraceSpace stated_space(const TriangleMesh& mesh, const TraceSpace& volume, double scale)
{
    TraceSpace space{.size = volume.size, .spacing = volume.spacing, .unit = volume.unit, .frame = mesh.frame};
    if (mesh.origin && mesh.directions) {
        space.origin = scale * *mesh.origin;
        space.directions = *mesh.directions;
    }
    return space;
}

/// Whether x and y of the positions in `found` have the other sign in `expected`: one frame is LPS and the other RAS,
/// or, where a frame has no name, the stated places agree only so.
bool is_turned_round(const TraceSpace& found, const TraceSpace& expected)
{
    if (found.frame == expected.frame) return false;
    if (!found.frame.empty() && !expected.frame.empty()) return true;
    TraceSpace unturned = expected;
    unturned.frame = found.frame;
    return why_elsewhere(found, expected).empty() && !why_elsewhere(found, unturned).empty();
}

}  // namespace

MeshPlace::MeshPlace(const TriangleMesh& mesh, const VolumeInfo& volume)
    : space_(space_of(volume)), is_physical_(mesh.positions != "volume")
{
    const std::optional<double> micrometres = micrometres_in(volume.unit);
    const double scale = mesh.metres && micrometres ? 1e6 * *mesh.metres / *micrometres : 1.0;
    scale_ = glm::dvec3(scale);
    if (is_physical_ && is_turned_round(stated_space(mesh, space_, scale), space_)) scale_ *= glm::dvec3(-1, -1, 1);
}

glm::dvec3 MeshPlace::in_volume(const glm::vec3& point) const
{
    const glm::dvec3 at = scale_ * glm::dvec3(point);
    return is_physical_ ? position_of(space_, at) : at;
}

glm::dvec3 MeshPlace::stated(const glm::dvec3& in_volume) const
{
    return is_physical_ ? physical_of(space_, in_volume) : in_volume;
}

std::string MeshPlace::why_unseen(const MeshShape& shape) const
{
    const glm::dvec3 end = glm::dvec3(space_.size) * space_.spacing;
    Box inside, mesh, volume;
    for (const glm::dvec3& point : shape.points) {
        inside.add(point);
        mesh.add(stated(point));
    }
    for (int corner = 0; corner < 8; ++corner)
        volume.add(stated(end * glm::dvec3(corner & 1, corner >> 1 & 1, corner >> 2)));
    const bool is_apart =
        glm::any(glm::lessThan(inside.upper, glm::dvec3(0.0))) || glm::any(glm::greaterThan(inside.lower, end));
    if (!is_apart) return {};
    return sentence(shape.name, ": lies outside the scan: its box is ", in_words(mesh), ", that of the scan ",
                    in_words(volume), ' ', space_.unit,
                    "; expected boxes that meet: its unit or space may be others than they are taken for");
}

}  // namespace shvr
