#pragma once
// The data of a kind of phantom: tubes, tissues and the graph. One thread builds a model, which is then not changed.

#include <functional>

#include "engine/volume/phantoms/phantom.h"
#include "engine/volume/procedural/tube_scene.h"

namespace shvr {

/// Intensities of tissues.
inline constexpr double AIR = 20.0, GROUND_TISSUE = 60.0, DERMAL_TISSUE = 105.0, RECEPTACLE_TISSUE = 90.0, VEIN = 200.0;

struct PhantomModel {
    std::vector<Tube> tubes;
    std::vector<ProceduralTruth::Node> nodes;
    std::vector<std::array<size_t, 2>> links;
    std::map<std::string, uint8_t> sections;
    uint8_t group_of_separate = 0;  ///< group of the tubes that the partial mask leaves out; 0: no partial mask
    /// Intensity outside all tubes, at voxel coordinates. It uses only sums, products, divisions and square roots.
    std::function<double(const glm::dvec3& voxel)> tissue = [](const glm::dvec3&) { return GROUND_TISSUE; };

    size_t add_node(const glm::dvec3& voxel, double radius, uint8_t group)
    {
        nodes.push_back({voxel, radius, group});
        return nodes.size() - 1;
    }
    /// Adds an internode and the tube around it; both get the group of the second node.
    void link(size_t from, size_t to, double intensity_from = VEIN, double intensity_to = VEIN)
    {
        links.push_back({from, to});
        tubes.push_back({.ends = {nodes[from].voxel, nodes[to].voxel},
                         .radii = {nodes[from].radius_voxels, nodes[to].radius_voxels},
                         .group = nodes[to].group,
                         .intensity = {intensity_from, intensity_to}});
    }
    /// A node linked to `from`.
    size_t add_next(size_t from, const glm::dvec3& voxel, double radius, uint8_t group, double intensity = VEIN)
    {
        const size_t node = add_node(voxel, radius, group);
        link(from, node, intensity, intensity);
        return node;
    }
};

/// Of one of `procedural_kinds()`.
Phantom make_procedural_phantom(const PhantomSpec& spec);

PhantomModel make_section(const PhantomSpec& spec);
PhantomModel make_capitulum(const PhantomSpec& spec);

/// Returns the fraction of a voxel that lies inside a flat surface at `distance`; the surface is `blur` voxels thick.
inline double cover_of(double distance, double blur)
{
    const double cover = 0.5 - distance / blur;
    return cover < 0.0 ? 0.0 : cover > 1.0 ? 1.0 : cover;
}

/// Returns a random number of a phantom, 0 <= result < 1.
double random_unit(uint32_t seed, uint32_t purpose, uint32_t index, uint32_t of = 0);

}  // namespace shvr
