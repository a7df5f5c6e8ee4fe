#pragma once
// The parts of a phantom: tubes, tissues and the graph. One thread builds a model, which is immutable afterwards.

#include <functional>

#include "engine/volume/phantoms/phantom.h"
#include "engine/volume/procedural/tube_scene.h"

namespace shvr {

/// Intensities of tissues.
inline constexpr double AIR = 20.0, GROUND_TISSUE = 60.0, DERMAL_TISSUE = 105.0, RECEPTACLE_TISSUE = 90.0, VEIN = 200.0;

/// Groups in the mask of tissues, for all kinds of phantoms. Their numbers differ from the groups of bundles.
inline constexpr uint8_t DERMAL = 10, RECEPTACLE = 11, STONE = 12, ORGANIC = 13, FLORET_BODY = 14;

/// The tissue at a position that lies in no tube.
struct Tissue {
    double intensity = GROUND_TISSUE;
    uint8_t group = 0;  ///< 0: unnamed
};

struct PhantomModel {
    std::vector<Tube> tubes;
    std::vector<ProceduralTruth::Node> nodes;
    std::vector<std::array<size_t, 2>> links;
    std::map<std::string, uint8_t> sections;
    uint8_t group_of_separate = 0;  ///< group of tubes that the partial mask leaves out; 0: there is no partial mask
    std::map<std::string, uint8_t> tissues;
    std::map<std::string, std::vector<double>> facts;
    /// How many successive pieces a gap makes invisible. In a single piece, both ends stay visible; several pieces are
    /// invisible as a whole, since visible ends would make the gap too short.
    size_t pieces_in_gap = 1;
    double gap_intensity = GROUND_TISSUE;  ///< in gaps, unless the tissue around the tube is brighter
    /// Returns the tissue at voxel coordinates. Uses only sums, products, divisions and square roots, for equal bits.
    std::function<Tissue(const glm::dvec3& voxel)> tissue = [](const glm::dvec3&) { return Tissue{}; };

    size_t add_node(const glm::dvec3& voxel, double radius, uint8_t group)
    {
        nodes.push_back({voxel, radius, group});
        return nodes.size() - 1;
    }
    /// Adds an internode and the tube around it. Both have the group of the second node.
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

/// Adds phloem next to the xylem tube `xylem`, on the side that faces away from `middle`.
void add_phloem(PhantomModel& model, const Tube& xylem, const glm::dvec3& middle);

/// Of one of `procedural_kinds()`.
Phantom make_procedural_phantom(const PhantomSpec& spec);

PhantomModel make_section(const PhantomSpec& spec);
PhantomModel make_capitulum(const PhantomSpec& spec);
PhantomModel make_roots(const PhantomSpec& spec);
PhantomModel make_stem(const PhantomSpec& spec);
PhantomModel make_helix(const PhantomSpec& spec);

/// Returns the fraction of a voxel inside a flat surface at a signed `distance`; `blur`: width of the transition.
inline double cover_of(double distance, double blur)
{
    const double cover = 0.5 - distance / blur;
    return cover < 0.0 ? 0.0 : cover > 1.0 ? 1.0 : cover;
}

/// Returns a random number of a phantom, in [0, 1).
double random_unit(uint32_t seed, uint32_t purpose, uint32_t index, uint32_t of = 0);

}  // namespace shvr
