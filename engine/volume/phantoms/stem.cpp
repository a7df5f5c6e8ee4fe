// A phantom of a stem like that of Arabidopsis thaliana: a ring of long, thin, separate bundles, just below the dermal
// tissue; fibres between them, cortex outside, pith inside. Positions are fractions of a slice's shorter side.

#include <cmath>

#include "engine/volume/phantoms/phantom_model.h"
#include "engine/volume/phantoms/texture.h"
#include "engine/volume/procedural/turns.h"

namespace shvr {

namespace {

enum StemRandom : uint32_t { STEM_PLACES = 81, STEM_WAVES };
constexpr uint8_t BUNDLE = 1;
constexpr int BUNDLES_IN_RING = 8;
constexpr double OUTER = 0.40, DERMAL_INNER = 0.350, BUNDLE_RADIUS = 0.024, RING = 0.31, PITH = 0.265;
/// Limits of the distance between a bundle and the dermal tissue, which is nearly as bright as bundles.
constexpr double MIN_GAP = 0.006, MAX_GAP = 0.030;
constexpr double STEM_DERMAL = 150.0, CORTEX = 70.0, FIBRES = 100.0, LUMEN = 42.0, WALL = 78.0;

/// The stem's bent axis: maps a height in voxels to a position in the slice.
struct StemAxis {
    Size3 size;
    double scale;  ///< the shorter side of a slice, in voxels

    glm::dvec2 operator()(double z) const
    {
        const double t = z / double(size.z);
        const double bend = 0.10 * (4.0 * t * (1.0 - t) - 0.5) * 0.5;
        return 0.5 * glm::dvec2(size.x, size.y) + scale * bend * glm::dvec2(0.8, 0.6);
    }
};

/// Adds a bundle. Its nodes lie inside the volume; its tube extends beyond the first and the last slice.
void add_bundle(PhantomModel& model, const PhantomSpec& spec, const StemAxis& axis, int i)
{
    const auto random = [&](StemRandom purpose, int of) {
        return random_unit(spec.seed, purpose, uint32_t(i), uint32_t(of));
    };
    constexpr int PIECES = 24;
    const double turns = (double(i) + 0.3 * (random(STEM_PLACES, 0) - 0.5)) / BUNDLES_IN_RING;
    const double phase = random(STEM_WAVES, 0), twist = 0.03 * (random(STEM_WAVES, 1) - 0.5);
    const double thick = std::max(1.0, axis.scale * BUNDLE_RADIUS * (0.85 + 0.3 * random(STEM_PLACES, 1)));
    const double first = std::min(thick + 1.0, 0.25 * double(spec.size.z)), last = double(spec.size.z) - first;
    const auto place = [&](double z) {
        const double t = z / double(spec.size.z);
        const double gap = MIN_GAP + (MAX_GAP - MIN_GAP) * (0.5 + 0.5 * direction_of(phase + 1.5 * t).y);
        // Moves the xylem inwards to make room for phloem outside (add_phloem).
        const double rho = axis.scale * (DERMAL_INNER - gap) - (spec.double_tubes ? 2.7 : 1.0) * thick;
        return glm::dvec3(axis(z) + rho * direction_of(turns + twist * t), z);
    };
    size_t node = model.add_node(place(first), thick, BUNDLE);
    for (int piece = 1; piece <= PIECES; ++piece)
        node = model.add_next(node, place(first + (last - first) * piece / PIECES), thick, BUNDLE);
    for (const double end : {first, last}) {
        const double beyond = end == first ? -thick - 1.0 : double(spec.size.z) + thick + 1.0;
        const glm::dvec3 from = place(end);
        model.tubes.push_back({.ends = {from, {from.x, from.y, beyond}},
                               .radii = {thick, thick},
                               .group = BUNDLE,
                               .intensity = {VEIN, VEIN}});
    }
}

Tissue stem_tissue(const StemAxis& axis, uint32_t seed, double blur, const glm::dvec3& voxel)
{
    const glm::dvec2 d = (glm::dvec2(voxel) - axis(voxel.z)) / axis.scale;
    const double rho = std::sqrt(d.x * d.x + d.y * d.y);
    // Cells of the pith are wide, cells of the cortex narrow. Walls across the cells are left out.
    const double cell = rho < PITH ? 0.036 : 0.021;
    const double wall = distance_from_cell_wall(seed, d / cell);
    const double soft = std::max(0.16, blur / (axis.scale * cell));
    double inner = LUMEN + (WALL - LUMEN) * std::max(0.0, 1.0 - wall / soft);
    if (rho >= PITH) inner += CORTEX - 0.5 * (LUMEN + WALL);
    const double fibres = 1.0 - std::abs(rho - RING) / 0.022;  // on the ring, between bundles
    inner += (FIBRES - inner) * std::clamp(2.0 * fibres, 0.0, 1.0);
    const double speckled =
        STEM_DERMAL + 24.0 * (value_noise(seed + 7, glm::dvec3(d / 0.03, voxel.z / axis.scale / 0.08)) - 0.5);
    const double dermal = cover_of(axis.scale * (DERMAL_INNER - rho), blur);
    const double inside = inner + (speckled - inner) * dermal;
    return {AIR + (inside - AIR) * cover_of(axis.scale * (rho - OUTER), blur),
            rho > DERMAL_INNER && rho <= OUTER ? DERMAL : uint8_t{0}};
}

}  // namespace

PhantomModel make_stem(const PhantomSpec& spec)
{
    const StemAxis axis{spec.size, double(std::min(spec.size.x, spec.size.y))};
    PhantomModel model;
    for (int i = 0; i < BUNDLES_IN_RING; ++i) add_bundle(model, spec, axis, i);
    if (spec.double_tubes)
        for (Tube& tube : std::vector(model.tubes)) {
            const glm::dvec3 half = 0.5 * (tube.ends[0] + tube.ends[1]);
            add_phloem(model, tube, glm::dvec3(axis(half.z), half.z));
        }
    model.sections = {{"bundle", BUNDLE}};
    model.tissues = {{"dermal", DERMAL}};
    model.facts = {{"bundles", {BUNDLES_IN_RING}},
                   {"dermal_inner_radius_voxels", {axis.scale * DERMAL_INNER}},
                   {"dermal_outer_radius_voxels", {axis.scale * OUTER}}};
    model.tissue = [axis, seed = mixed(spec.seed ^ 0x57e3u), blur = spec.flaws.blur](const glm::dvec3& voxel) {
        return stem_tissue(axis, seed, blur, voxel);
    };
    return model;
}

}  // namespace shvr
