#pragma once
// Phantoms: models of scans of plants whose truth is exact by construction. Each has a scene of tubes, with a graph
// along their axes, within a plant's tissues; a voxel's value is a function of its position, plus flaws of scanners and
// samples. No voxel is stored, so memory does not grow with the size. Equal parameters give equal bits on every
// machine, whatever box is read.

#include <array>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "engine/volume/procedural/source_procedural.h"
#include "engine/volume/source.h"

namespace shvr {

/// Flaws of scanners and samples. Percentages are of the difference between veins and ground tissue, unless stated.
struct PhantomFlaws {
    double blur = 1.0;     ///< voxels over which one tissue changes into the next (partial volume)
    double noise = 3.0;    ///< standard deviation of normal noise, independent in each voxel
    double rings = 0.0;    ///< height of rings around the z axis, like those from unequal detector pixels
    double streaks = 0.0;  ///< height, straight across slices
    double specks = 0.0;   ///< percentage of voxels, at most 4, in bright balls of 1 to 2.5 voxels radius
    /// Percentage of a vein's pieces whose middle is invisible (of roots: two pieces in a row, as a whole). The ground
    /// truth keeps them.
    double gaps = 0.0;
    double falling = 0.0;  ///< percentage of the intensity that is missing on the axis (cupping)
    double uneven = 0.0;   ///< percentage by which intensities vary at most, smoothly, over a quarter of the volume
};

struct PhantomSpec {
    std::string kind = "capitulum";  ///< one of `phantom_kinds()`
    Size3 size{64};                  ///< voxels
    uint32_t seed = 1;
    /// Intensities are 0 ... 250; int8 voxels are lower by 128, and voxels of more than 8 bits are 100 times as large.
    VoxelType type = VoxelType::uint8;
    PhantomFlaws flaws{};

    // Of a capitulum.
    std::string species = "gerbera";        ///< one of `capitulum_species()`
    std::string stage = "d";                ///< stage of development, "a" to "d" (thesis, figure 5.3)
    std::string phyllotaxis = "fibonacci";  ///< "fibonacci", "lucas" or "bijugate"
    bool left_handed = false;               ///< mirrored: seen from above, successive florets turn clockwise
    int florets = 144;                      ///< 8 to 1000

    /// Of a capitulum, a section or a stem: adds a bundle's phloem next to its xylem; the xylem is traced.
    bool double_tubes = false;
};

struct Phantom {
    std::unique_ptr<VolumeSource> volume;
    std::unique_ptr<VolumeSource> mask{};          ///< uint8: the colour group of each voxel; null if it is not known
    std::unique_ptr<VolumeSource> partial_mask{};  ///< kind `section`: the mask without bundles that no trace reaches
    /// The graph along the tubes' centre lines. The balls of nodes and of the middles of links lie entirely in the
    /// mask, except in `section`.
    std::vector<ProceduralTruth::Node> nodes{};
    std::vector<std::array<size_t, 2>> links{};
    std::map<std::string, uint8_t> sections{};  ///< the colour group of each named part
    /// uint8: the group of the tissue at each voxel, 0 in bundles and in tissues without a name; null if none is named.
    std::unique_ptr<VolumeSource> tissue_mask{};
    std::map<std::string, uint8_t> tissues{};  ///< the group of each named tissue
    /// Numbers known in closed form, in voxels, degrees and turns as their names say. A capitulum has
    /// `axis_through_voxels` (the middle of the head; heights and rho are measured from it), `axis_direction`,
    /// `head_radius_voxels` (rho is 1 there), `divergence_degrees`, `jugacy` (florets at one height), `handedness` (1:
    /// successive florets turn counter-clockwise, seen against the axis's direction; -1: clockwise), `florets`.
    std::map<std::string, std::vector<double>> facts{};
};

/// Returns the kinds defined in this folder, to which PhantomSpec::flaws applies, and those of `procedural_kinds()`.
std::vector<std::string> phantom_kinds();
bool has_flaws(const std::string& kind);
/// The flaws that a scan of this kind of sample usually has.
PhantomFlaws usual_flaws(const std::string& kind);
/// True of kinds to which PhantomSpec::double_tubes applies.
bool has_double_tubes(const std::string& kind);
std::vector<std::string> capitulum_species();
/// Fails with a sentence that names the field if a field of `spec` has a value that is not among those listed above.
Phantom make_phantom(const PhantomSpec& spec);

}  // namespace shvr
