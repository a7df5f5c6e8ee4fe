// A phantom of roots in soil (thesis, figure 5.5): thick, long tubes below a shoot, seen in fragments, among stones
// that touch them and bits of organic matter of equal brightness. Two more roots belong to other plants: one passes a
// root at a distance of 1.5 voxels, one is fused with another root. Positions are fractions of the shortest side.

#include <cmath>
#include <optional>

#include "engine/volume/phantoms/bodies.h"
#include "engine/volume/phantoms/texture.h"
#include "engine/volume/procedural/turns.h"

namespace shvr {

namespace {

enum RootRandom : uint32_t { ROOT_PLACES = 91, ROOT_BRIGHTNESS, LATERALS, STONES, STONE_FACETS, BITS };
constexpr uint8_t MAIN_ROOT = 1, LATERAL_ROOT = 2, FOREIGN_ROOT = 3;
constexpr int MAIN_ROOTS = 5, ROOT_PIECES = 12;
constexpr double SOIL_SURFACE = 0.84;

/// Returns the soil at a position: grains, clods and pores, whose brightest parts are as bright as the faintest roots.
Tissue soil_at(const glm::dvec3& place, uint32_t seed, double softness)
{
    const double height = place.z - SOIL_SURFACE - 0.04 * (value_noise(seed + 1, place * 9.0) - 0.5);
    const double clods = value_noise(seed + 2, place * 11.0), grains = value_noise(seed + 3, place * 45.0);
    const double pores = value_noise(seed + 4, place * 16.0);
    double soil = 88.0 + 50.0 * (clods - 0.5) + 70.0 * (grains - 0.5);
    soil += (AIR - soil) * std::clamp((pores - 0.68) / 0.06, 0.0, 1.0);
    return {soil + (AIR - soil) * cover_of(-height, softness), 0};
}

class Roots {
public:
    explicit Roots(const PhantomSpec& spec)
        : spec_(spec),
          scale_(double(std::min({spec.size.x, spec.size.y, spec.size.z}))),
          corner_(0.5 * (glm::dvec3(spec.size) - scale_))
    {}

    PhantomModel make()
    {
        add_roots();
        add_foreign(0, 1.5, 0.0);
        add_foreign(2, 0.0, -0.5);
        for (size_t i = 0; i < 160; ++i) add_stone(i);
        for (size_t i = 0; i < 50; ++i) add_bit(i);
        model_.sections = {{"main root", MAIN_ROOT}, {"lateral root", LATERAL_ROOT}, {"foreign root", FOREIGN_ROOT}};
        model_.tissues = {{"stone", STONE}, {"organic", ORGANIC}};
        model_.group_of_separate = FOREIGN_ROOT;
        model_.pieces_in_gap = 2;
        model_.gap_intensity = 0.0;  // the soil shows
        const auto bodies =
            std::make_shared<const Bodies>(std::move(bodies_), std::move(facets_), spec_.size, spec_.flaws.blur);
        model_.tissue = [bodies, corner = corner_, scale = scale_, seed = mixed(spec_.seed ^ 0x5011u),
                         softness = spec_.flaws.blur / scale_](const glm::dvec3& voxel) {
            return bodies->over(soil_at((voxel - corner) / scale, seed, softness), voxel);
        };
        return std::move(model_);
    }

private:
    double random(RootRandom purpose, size_t index, size_t of = 0) const
    {
        return random_unit(spec_.seed, purpose, uint32_t(index), uint32_t(of));
    }
    glm::dvec3 voxel(const glm::dvec3& place) const { return corner_ + scale_ * place; }
    double radius(double of_side) const { return std::max(1.0, of_side * scale_); }
    glm::dvec3 random_direction(RootRandom purpose, size_t index, size_t of) const
    {
        const double z = 2.0 * random(purpose, index, of) - 1.0;
        return glm::dvec3(std::sqrt(1.0 - z * z) * direction_of(random(purpose, index, of + 1)), z);
    }
    /// Returns the brightness of a root at a node; it varies, because roots dry in places.
    double brightness(size_t node) const { return 150.0 + 50.0 * (random(ROOT_BRIGHTNESS, node) - 0.5); }
    size_t add_next(size_t from, const glm::dvec3& place, double thick, uint8_t group)
    {
        const size_t node = model_.add_node(voxel(place), radius(thick), group);
        model_.link(from, node, brightness(from), brightness(node));
        return node;
    }

    void add_roots();
    void add_lateral(size_t from, double turns, size_t number);
    void add_foreign(size_t root, double apart_voxels, double apart_radii);
    void add_stone(size_t i);
    void add_bit(size_t i);

    /// Returns the tube of the root nearest to a position, with its distance.
    std::pair<const Tube*, TubeDistance> nearest_root(const glm::dvec3& at) const
    {
        std::pair<const Tube*, TubeDistance> nearest{nullptr, {1e9, 0.0}};
        for (const Tube& tube : model_.tubes)
            if (const TubeDistance distance = distance_from(tube, at); distance.voxels < nearest.second.voxels)
                nearest = {&tube, distance};
        return nearest;
    }

    const PhantomSpec& spec_;
    double scale_;  ///< voxels
    glm::dvec3 corner_;
    PhantomModel model_;
    std::array<std::vector<size_t>, MAIN_ROOTS> main_;  ///< nodes of each main root, starting at the crown
    std::vector<Tube> bodies_;
    std::vector<std::vector<Facet>> facets_;
};

/// Adds the main roots, each in its own sector around the crown.
void Roots::add_roots()
{
    const size_t shoot = model_.add_node(voxel({0.5, 0.5, 0.95}), radius(0.036), MAIN_ROOT);
    const size_t crown = add_next(shoot, {0.5, 0.5, 0.83}, 0.042, MAIN_ROOT);
    for (size_t i = 0; i < MAIN_ROOTS; ++i) {
        const double turns = (double(i) + 0.3 * (random(ROOT_PLACES, i) - 0.5)) / MAIN_ROOTS;
        const double reach = 0.26 + 0.14 * random(ROOT_PLACES, i, 1), depth = 0.60 + 0.16 * random(ROOT_PLACES, i, 2);
        const double phase = random(ROOT_PLACES, i, 3);
        main_[i].push_back(crown);
        for (int piece = 1; piece <= ROOT_PIECES; ++piece) {
            const double t = double(piece) / ROOT_PIECES;
            const double rho = reach * t * (2.0 - t);
            const glm::dvec2 wander = 0.035 * t * direction_of(phase + 1.3 * t);
            const glm::dvec2 at = 0.5 + rho * direction_of(turns + 0.05 * wander.y) + wander;
            const double height = 0.83 - depth * (0.35 * t + 0.65 * t * t);
            main_[i].push_back(add_next(main_[i].back(), {at.x, at.y, height}, 0.031 - 0.014 * t, MAIN_ROOT));
        }
        for (const size_t from : {size_t{3}, size_t{6}, size_t{9}})
            add_lateral(main_[i][from], turns + (from == 6 ? -0.08 : 0.08), 3 * i + from / 3);
    }
}

void Roots::add_lateral(size_t from, double turns, size_t number)
{
    constexpr int STEPS = 5;
    glm::dvec3 at = (model_.nodes[from].voxel - corner_) / scale_;
    for (int step = 0; step < STEPS; ++step) {
        const double turn = turns + 0.10 * (random(LATERALS, number, size_t(step)) - 0.5);
        at +=
            glm::dvec3(0.034 * direction_of(turn), -0.022 + 0.030 * (random(LATERALS, number, size_t(step) + 9) - 0.5));
        at = glm::clamp(at, 0.04, 0.96);
        from = add_next(from, at, 0.014 - 0.001 * step, LATERAL_ROOT);
    }
}

/// Adds a root of another plant, which runs next to three pieces of a main root and then leaves it.
void Roots::add_foreign(size_t root, double apart_voxels, double apart_radii)
{
    const double thick = radius(0.016);
    const auto beside = [&](size_t piece) {
        const ProceduralTruth::Node& node = model_.nodes[main_[root][piece]];
        const glm::dvec2 out = glm::dvec2(node.voxel - voxel(glm::dvec3(0.5)));
        const glm::dvec2 across = glm::dvec2(-out.y, out.x) / std::sqrt(out.x * out.x + out.y * out.y);
        const double away = node.radius_voxels + thick + apart_voxels + apart_radii * thick;
        return node.voxel + glm::dvec3(away * across, 0.0);
    };
    const std::array<glm::dvec3, 4> middles = {beside(6), beside(7), beside(8), beside(9)};
    const glm::dvec3 in = middles[0] + scale_ * glm::dvec3(0.0, 0.0, 0.20);
    const glm::dvec3 out = middles[3] + (middles[3] - middles[2]) + scale_ * glm::dvec3(0.0, 0.0, -0.10);
    glm::dvec3 previous = in;
    const auto add = [&](const glm::dvec3& next) {
        model_.tubes.push_back(
            {.ends = {previous, next}, .radii = {thick, thick}, .group = FOREIGN_ROOT, .intensity = {150.0, 150.0}});
        previous = next;
    };
    for (const glm::dvec3& middle : middles) add(middle);
    add(out);
}

/// Adds a stone; the first stones touch roots. Planes cut off those parts that would lie in a root.
void Roots::add_stone(size_t i)
{
    const double size = scale_ * (0.022 + 0.050 * random(STONES, i) * random(STONES, i, 1));
    glm::dvec3 middle = voxel({random(STONES, i, 2), random(STONES, i, 3), 0.81 * random(STONES, i, 4)});
    if (i < 2 * MAIN_ROOTS) {
        const size_t node = main_[i % MAIN_ROOTS][4 + 4 * (i / MAIN_ROOTS)];
        const glm::dvec3 away(direction_of(random(STONES, i, 5)), 0.0);
        middle = model_.nodes[node].voxel + away * (model_.nodes[node].radius_voxels + 0.6 * size);
    }
    std::vector<Facet> facets;
    for (const Tube& tube : model_.tubes) {
        const auto [distance, along] = distance_from(tube, middle);
        if (distance >= size) continue;
        if (distance < 0.3 * size) return;  // little would be left
        const glm::dvec3 to = (1.0 - along) * tube.ends[0] + along * tube.ends[1] - middle;
        facets.push_back({to / std::sqrt(to.x * to.x + to.y * to.y + to.z * to.z), distance});
    }
    for (size_t k = 0; k < 8; ++k)
        facets.push_back(
            {random_direction(STONE_FACETS, i, 3 * k), size * (0.62 + 0.34 * random(STONE_FACETS, i, 3 * k + 2))});
    const double bright = 130.0 + 110.0 * random(STONES, i, 6);
    bodies_.push_back(
        {.ends = {middle, middle}, .radii = {size, size}, .tissue = STONE, .intensity = {bright, bright}});
    facets_.push_back(std::move(facets));
}

/// Adds a bit of organic matter, such as a piece of straw, unless it would intersect a root.
void Roots::add_bit(size_t i)
{
    const double thick = scale_ * (0.006 + 0.010 * random(BITS, i)),
                 length = scale_ * (0.04 + 0.10 * random(BITS, i, 1));
    const glm::dvec3 from = voxel({random(BITS, i, 2), random(BITS, i, 3), 0.80 * random(BITS, i, 4)});
    const glm::dvec3 to = from + length * random_direction(BITS, i, 5);
    for (int k = 0; k <= 8; ++k)
        if (nearest_root(from + (to - from) * (k / 8.0)).second.voxels < thick) return;
    const double bright = 115.0 + 55.0 * random(BITS, i, 7);
    bodies_.push_back(
        {.ends = {from, to}, .radii = {thick, 0.7 * thick}, .tissue = ORGANIC, .intensity = {bright, bright}});
    facets_.emplace_back();
}

}  // namespace

PhantomModel make_roots(const PhantomSpec& spec)
{
    return Roots(spec).make();
}

}  // namespace shvr
