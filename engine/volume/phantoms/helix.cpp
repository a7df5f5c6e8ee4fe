// A phantom: a right-handed helix around the volume's z axis, whose length, curvature and torsion are known exactly.

#include <algorithm>
#include <cmath>

#include "engine/volume/phantoms/phantom_model.h"
#include "engine/volume/procedural/turns.h"

namespace shvr {

PhantomModel make_helix(const PhantomSpec& spec)
{
    constexpr int TURNS = 3, LINKS_PER_TURN = 48;
    constexpr double FULL_TURN = 6.283185307179586;
    const double side = double(std::min({spec.size.x, spec.size.y, spec.size.z}));
    const double radius = 0.30 * side, pitch = 0.24 * side, tube = std::max(1.0, 0.03 * side);
    const glm::dvec3 middle = 0.5 * glm::dvec3(spec.size);
    // The seed rotates the helix, so that each seed samples it at other positions.
    const double start = spec.seed == 1 ? 0.0 : random_unit(spec.seed, 41, 0);

    PhantomModel model;
    for (int i = 0; i <= TURNS * LINKS_PER_TURN; ++i) {
        const double turns = double(i) / LINKS_PER_TURN;
        const glm::dvec2 direction = direction_of(start + turns);
        const glm::dvec3 at =
            middle + glm::dvec3(radius * direction.x, radius * direction.y, pitch * (turns - 0.5 * TURNS));
        if (i == 0)
            model.add_node(at, tube, 1);
        else
            model.add_next(size_t(i) - 1, at, tube, 1);
    }
    model.sections = {{"helix", 1}};
    const double rise = pitch / FULL_TURN, squared = radius * radius + rise * rise;
    const double height = pitch / LINKS_PER_TURN, chord = 2.0 * radius * direction_of(0.5 / LINKS_PER_TURN).y;
    model.facts = {{"axis_through_voxels", {middle.x, middle.y, middle.z}},
                   {"axis_direction", {0.0, 0.0, 1.0}},
                   {"helix_radius_voxels", {radius}},
                   {"pitch_voxels", {pitch}},
                   {"turns", {TURNS}},
                   {"curvature_per_voxel", {radius / squared}},
                   {"torsion_per_voxel", {rise / squared}},
                   {"length_voxels", {TURNS * FULL_TURN * std::sqrt(squared)}},
                   {"length_of_links_voxels", {TURNS * LINKS_PER_TURN * std::sqrt(chord * chord + height * height)}}};
    return model;
}

}  // namespace shvr
