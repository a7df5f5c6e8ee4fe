#pragma once
// Phantoms: models of scans of plants whose truth is exact by construction. A scene of tubes, with the graph along
// their axes, stands in a plant's tissues; a voxel's value is a function of its position, and flaws of scanners and
// samples are added to it. Nothing is stored for each voxel: memory does not grow with the size. Equal parameters give
// equal bits on every machine, for any box that is read.

#include <array>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "engine/volume/procedural/source_procedural.h"
#include "engine/volume/source.h"

namespace shvr {

/// Percentages of the difference of veins and ground tissue, unless stated.
struct PhantomFlaws {
    double blur = 1.0;     ///< voxels over which a surface goes from one tissue to the other (partial volume)
    double noise = 3.0;    ///< standard deviation of normal noise, independent in each voxel
    double rings = 0.0;    ///< height of circles around the axis z, as from a detector's unequal pixels
    double streaks = 0.0;  ///< height, straight across slices
    double specks = 0.0;   ///< percent of the voxels, at most 4: bright balls of 1 to 2.5 voxels radius
    double gaps = 0.0;     ///< percent of a vein's pieces that are not seen in the middle; they stay in the truth
    double falling = 0.0;  ///< percent of the intensity that is missing on the axis (cupping)
};

struct PhantomSpec {
    std::string kind = "capitulum";  ///< one of `phantom_kinds()`
    Size3 size{64};                  ///< voxels
    uint32_t seed = 1;
    /// Intensities are 0 ... 250, 128 lower for int8, and 100 times as large for types of more than 8 bits.
    VoxelType type = VoxelType::uint8;
    PhantomFlaws flaws{};

    // Of a capitulum.
    std::string species = "gerbera";        ///< one of `capitulum_species()`
    std::string stage = "d";                ///< "a" to "d", of development (thesis, figure 5.3)
    std::string phyllotaxis = "fibonacci";  ///< "fibonacci", "lucas" or "bijugate"
    bool left_handed = false;               ///< mirrored: successive florets turn clockwise, seen from above
    int florets = 144;                      ///< 8 to 1000
    bool double_tubes = false;              ///< a bundle's phloem beside its xylem, which is traced
};

struct Phantom {
    std::unique_ptr<VolumeSource> volume;
    std::unique_ptr<VolumeSource> mask{};          ///< uint8: the colour group of each voxel; null if it is not known
    std::unique_ptr<VolumeSource> partial_mask{};  ///< section: without bundles that no trace reaches
    /// Along centre lines. Balls of nodes and of the middles of links lie in the mask to the last voxel, except in
    /// `section`.
    std::vector<ProceduralTruth::Node> nodes{};
    std::vector<std::array<size_t, 2>> links{};
    std::map<std::string, uint8_t> sections{};  ///< the colour group of each named part
};

/// Those of this room, to which `PhantomSpec`'s flaws apply, and `procedural_kinds()`.
std::vector<std::string> phantom_kinds();
bool has_flaws(const std::string& kind);
std::vector<std::string> capitulum_species();
/// Fails with a sentence that names the field if a value is none of those above.
Phantom make_phantom(const PhantomSpec& spec);

}  // namespace shvr
