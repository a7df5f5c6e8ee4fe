#pragma once
// Phantoms: models of scans of plants whose ground truth is exact by construction. A phantom is a scene of tubes, with
// a graph along their axes, within a plant's tissues. The value of a voxel is a function of its position, plus flaws of
// scanners and samples. No voxel is stored, so memory does not grow with the size. Equal parameters give equal bits on
// every machine, independently of the boxes that are read.

#include <array>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "engine/volume/procedural/source_procedural.h"
#include "engine/volume/source.h"

namespace shvr {

/// Flaws of scanners and samples. Unless stated otherwise, in percent of the contrast between veins and ground tissue.
struct PhantomFlaws {
    double blur = 1.0;     ///< width in voxels of the transition between two tissues (partial volume)
    double noise = 3.0;    ///< standard deviation of normally distributed noise, independent for each voxel
    double rings = 0.0;    ///< height of rings around the z axis, as unequal detector pixels cause them
    double streaks = 0.0;  ///< height, straight across slices
    double specks = 0.0;   ///< percentage of voxels, at most 4, that are in bright balls with radii of 1 to 2.5 voxels
    /// Percentage of the pieces of veins that have a gap: an invisible middle (in roots, two whole pieces in a row).
    /// The ground truth contains the gaps.
    double gaps = 0.0;
    double falling = 0.0;  ///< percentage by which the intensity is lower on the axis (cupping)
    double uneven = 0.0;   ///< maximum percentage of smooth variations of the intensity, over a quarter of the volume
};

struct PhantomSpec {
    std::string kind = "capitulum";  ///< one of `phantom_kinds()`
    Size3 size{64};                  ///< voxels
    uint32_t seed = 1;
    /// Intensities are 0 ... 250. For int8 they are lowered by 128; for more than 8 bits they are multiplied by 100.
    VoxelType type = VoxelType::uint8;
    PhantomFlaws flaws{};

    // Of a capitulum.
    std::string species = "gerbera";        ///< one of `capitulum_species()`
    std::string stage = "d";                ///< stage of development, "a" to "d" (thesis, figure 5.3)
    std::string phyllotaxis = "fibonacci";  ///< "fibonacci", "lucas" or "bijugate"
    bool left_handed = false;               ///< mirrored: seen from above, successive florets go clockwise
    int florets = 144;                      ///< 8 to 1000

    /// For a capitulum, section or stem: adds phloem next to the xylem of each bundle. The trace follows the xylem.
    bool double_tubes = false;
};

struct Phantom {
    std::unique_ptr<VolumeSource> volume;
    std::unique_ptr<VolumeSource> mask{};          ///< uint8: the colour group of each voxel; null if it is not known
    std::unique_ptr<VolumeSource> partial_mask{};  ///< kind `section`: the mask without bundles that no trace reaches
    /// The graph along the tubes' centre lines. Except in `section`, the balls of nodes and of the middles of links lie
    /// entirely in the mask.
    std::vector<ProceduralTruth::Node> nodes{};
    std::vector<std::array<size_t, 2>> links{};
    std::map<std::string, uint8_t> sections{};  ///< the colour group of each named part
    /// uint8: the group of a voxel's tissue; 0 in bundles and unnamed tissues. Null if the phantom names no tissue.
    std::unique_ptr<VolumeSource> tissue_mask{};
    std::map<std::string, uint8_t> tissues{};  ///< the group of each named tissue
    /// Exact numbers, in voxels, degrees or turns according to their names. A capitulum has `axis_through_voxels` (the
    /// middle of the head, from which heights and rho are measured), `axis_direction`, `head_radius_voxels` (where rho
    /// is 1; `head_radius` of --metrics, that of the outermost floret, is up to 5 % less), `divergence_degrees`,
    /// `jugacy` (florets at one height), `handedness` (1: successive florets turn counter-clockwise if the axis points
    /// towards the viewer; -1: clockwise) and `florets`.
    std::map<std::string, std::vector<double>> facts{};
};

/// Returns the kinds of this folder, for which PhantomSpec::flaws has an effect, and those of `procedural_kinds()`.
std::vector<std::string> phantom_kinds();
bool has_flaws(const std::string& kind);
/// Returns the flaws that scans of this kind of sample usually have.
PhantomFlaws usual_flaws(const std::string& kind);
/// True of kinds to which PhantomSpec::double_tubes applies.
bool has_double_tubes(const std::string& kind);
std::vector<std::string> capitulum_species();
/// Fails with a message that names the field if a field of `spec` has a value outside the limits stated above.
Phantom make_phantom(const PhantomSpec& spec);

}  // namespace shvr
