#pragma once
// A scalar volume: its size, voxel type, spacing and unit, and the intensity window that maps its voxels to the
// R16_UNORM codes of the device.
//
// Spaces. "voxel": index space of level 0; the centre of voxel i lies at i + 0.5. "volume": physical, in the file's
// unit, volume = voxel * spacing. The order of axes is x, y, z, with x fastest in memory. All counts have 64 bits.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <glm/glm.hpp>

namespace shvr {

using Size3 = glm::vec<3, int64_t>;

enum class VoxelType { uint8, int8, uint16, int16, uint32, int32, float32, float64 };
/// For tables and choices.
inline constexpr VoxelType VOXEL_TYPES[] = {VoxelType::uint8,   VoxelType::int8,   VoxelType::uint16,
                                            VoxelType::int16,   VoxelType::uint32, VoxelType::int32,
                                            VoxelType::float32, VoxelType::float64};
/// For messages that list the expected types.
inline constexpr const char* VOXEL_TYPE_NAMES = "uint8, int8, uint16, int16, uint32, int32, float32 or float64";

size_t bytes_of(VoxelType type);
const char* name_of(VoxelType type);
bool is_float(VoxelType type);
/// Parses spellings of file headers, such as "uint8", "UCHAR", "unsigned short" and "MET_SHORT"; null if unknown.
/// 64-bit integers count as unknown, since intensities are computed in double, which cannot represent all of them.
std::optional<VoxelType> voxel_type_of(const std::string& name);

/// A half-open box of voxels, [lower, upper).
struct VoxelBox {
    Size3 lower{0};
    Size3 upper{0};
    Size3 size() const { return upper - lower; }
    bool operator==(const VoxelBox&) const = default;
};

/// Where a spacing or a unit comes from: assumed, from the file, or given by the user (--spacing, --unit, a session).
enum class Provenance { assumed, file, given };
/// "assumed", "file", "given".
const char* name_of(Provenance provenance);

struct VolumeInfo {
    std::string name;    ///< for display: the file's name
    std::string format;  ///< the format's name, as the reader sets it: "raw", "nrrd", "tiff", ...
    Size3 size{0};       ///< voxels
    VoxelType type = VoxelType::uint8;
    glm::dvec3 spacing{1.0};     ///< unit per voxel, each > 0
    std::string unit = "voxel";  ///< "um", "mm", ... or "voxel" if the file states none
    Provenance spacing_from = Provenance::assumed;
    Provenance unit_from = Provenance::assumed;
    /// The position that the file states in frame `frame` ("RAS", "LPS", or "" if it states none): the centre of voxel
    /// 0 is at `origin`, and the voxel axes point along the columns of `directions` (unit vectors). Kept and exported,
    /// but not used for drawing: volume space is voxel * spacing. Axes are right-handed: a reader that finds
    /// left-handed axes reverses the order of voxels along one axis, and records this here and in a warning.
    glm::dmat3 directions{1.0};
    glm::dvec3 origin{0.0};
    std::string frame{};
    /// The fill value that the user states; infinite: there is none; null: fill values are detected (outliers.h).
    std::optional<double> nodata{};
    /// What the reader assumed or left out, one sentence each ("no spacing stated; 1 voxel assumed").
    std::vector<std::string> warnings{};
};

/// Returns whether the file states a position. If not, `frame` is empty, and `directions` and `origin` are defaults.
bool states_place(const VolumeInfo& info);
/// Returns whether the columns are right-handed unit vectors (orthogonal or not), within the rounding of 7-digit texts.
bool are_axes(const glm::dmat3& directions);

/// Returns size.x * size.y * size.z; fails if the product exceeds 63 bits. Each side must be 1 ... 2^20.
int64_t voxel_count(const VolumeInfo& info);

/// The smallest and the largest finite value; `lower > upper` if there is no finite value.
struct ValueRange {
    double lower = 0.0;
    double upper = 0.0;
    bool operator==(const ValueRange&) const = default;
};

/// A value, and the number of voxels that have it.
struct ValueCount {
    double value = 0.0;
    int64_t voxels = 0;
    bool operator==(const ValueCount&) const = default;
};

/// Minimum, maximum, mean and a 256-bin histogram of the finite voxels, in the file's own intensity units.
struct VolumeStatistics {
    double minimum = 0.0;
    double maximum = 0.0;
    double mean = 0.0;  ///< without fill values
    int64_t not_finite = 0;
    /// 256 bins over range(). Values outside the range count in the first or last bin; fill values are not counted.
    std::vector<int64_t> histogram{};
    /// The range of all values except fill values and a few outliers: broken, dead and hot voxels (outliers.h). Null if
    /// there are neither fill values nor outliers.
    std::optional<ValueRange> bulk{};
    int64_t beyond_bulk = 0;         ///< number of outliers that are not fill values
    std::vector<ValueCount> fill{};  ///< values that stand for "no data", however frequent
    bool fill_is_given = false;      ///< by the user, not found
    int measured_level = 0;          ///< above 0: a coarser level was measured, whose voxels are means
    int64_t sampled_voxels = 0;      ///< above 0: everything was estimated from this many voxels

    /// The range on which pictures, thresholds and the histogram are based.
    ValueRange range() const { return bulk.value_or(ValueRange{minimum, maximum}); }
};

/// The affine map from intensities to 16-bit codes: code = round((intensity - lower) * codes_per_unit). For integers
/// whose range is at most 65535, `codes_per_unit` is a whole number and the map is exact, so a threshold on codes
/// equals a threshold on intensities. Integers of 32 bits with a larger range, and floats, are quantised into 65535
/// steps of their range. Intensities outside the window are clamped to its nearer end.
struct IntensityWindow {
    double lower = 0.0;
    double codes_per_unit = 257.0;
    double upper() const { return lower + 65535.0 / codes_per_unit; }
    double code_of(double intensity) const { return (intensity - lower) * codes_per_unit; }
    double intensity_of(double code) const { return lower + code / codes_per_unit; }
    /// Returns the smallest code whose intensity is at least `threshold`; 65536 if there is none.
    uint32_t threshold_code(double threshold) const;
    bool operator==(const IntensityWindow&) const = default;
};

/// Returns the window of all values, or of range() if outliers would leave other values less than a fifth of the codes
/// and not every integer has its own code. For partly measured 16-bit integers: the whole range of their type.
IntensityWindow window_for(VoxelType type, const VolumeStatistics& statistics);
IntensityWindow window_for(VoxelType type, double minimum, double maximum);
/// Returns whether every value of such a volume has its own code in its window. If so, comparing codes gives the same
/// results as comparing intensities.
bool has_exact_codes(VoxelType type, const VolumeStatistics& statistics);

}  // namespace shvr
