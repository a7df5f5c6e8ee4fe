#pragma once
// Sources of voxels. A source has one volume, and returns boxes of voxels in the file's own type; it does not depend on
// windows or devices. Readers are functions: a null source means "not my format", an `Error` means "mine, but broken".
// `open_volume` (open_volume.h) tries the readers in a fixed order.
//
// Levels. Level 0 is the volume. A voxel of level l covers 2^l voxels of level 0 along each axis, exactly aligned:
// voxel i covers [2^l i, 2^l (i + 1)), so position p of level 0 is position p / 2^l of level l. A level has ceil(size /
// 2^l) voxels along each axis; its last voxels may cover fewer. Most files have only level 0.

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>

#include "engine/base/progress.h"
#include "engine/volume/volume.h"

namespace shvr {

/// The stored blocks of a level in which most blocks may be absent, as in a sparse file. Work on such a level need only
/// visit the stored blocks.
struct StoredBlocks {
    Size3 block{1};                    ///< size in voxels; block i covers [i * block, (i + 1) * block)
    double fill = 0.0;                 ///< value of all voxels in no block; may be infinite or NaN
    std::vector<glm::ivec3> blocks{};  ///< without repetitions, sorted by z, then y, then x
};

/// Selects a volume from files that hold several. Without a choice, a reader refuses such a file with a message that
/// lists the choices. Readers of formats with one volume ignore the choice.
struct OpenOptions {
    std::string channel{};  ///< "red", "green", "blue", "alpha", a channel's name in the file, or its number from 1
    std::string frame{};    ///< number of the time point, starting at 1, if there are several
    int level = 0;          ///< the level to open as level 0 if the file has several (coarser.h); 0: the finest
    /// Replaces or provides the spacing of the file (engine/formats/restated.h).
    std::optional<glm::dvec3> spacing{};
    std::string unit{};  ///< empty: the file's
    /// Value of voxels without data; infinite: there is no such value; null: detected automatically (outliers.h).
    std::optional<double> nodata{};
    bool operator==(const OpenOptions&) const = default;
};

class Gaps;

class VolumeSource {
public:
    virtual ~VolumeSource() = default;

    const VolumeInfo& info() const { return info_; }

    /// Copies the voxels of `box`, which lies inside the volume, into `voxels`, x fastest, in the native byte order of
    /// `info().type`. The size of `voxels` is that of the box. Any thread may call it. Throws `Error` if reading fails.
    virtual void read(const VoxelBox& box, std::span<std::byte> voxels) const = 0;

    /// The block size of level 0 in the file. If boxes consist of whole blocks, counted from voxel 0, every block is
    /// decoded only once. 1, 1, 1: all boxes are equally efficient.
    virtual Size3 block() const { return Size3(1); }

    /// The number of levels, at least 1.
    virtual int levels() const { return 1; }
    /// Like `read`, for any level.
    virtual void read_level(int level, const VoxelBox& box, std::span<std::byte> voxels) const;
    /// Returns the range of the values of a brick of `level` (gpu::BRICK_SIZE voxels a side, counted from voxel 0) and
    /// of one voxel of `level` around it, without reading voxels. The range includes the same region on all finer
    /// levels. Null if the source does not know the range.
    virtual std::optional<ValueRange> brick_range(int level, const Size3& brick) const;
    /// Returns the stored blocks of a level, without reading voxels. Null if the source does not know them, or if there
    /// are more than `most`.
    virtual std::optional<StoredBlocks> stored_blocks(int level, int64_t most) const;
    /// Returns the statistics of level 0 if the source knows them. Otherwise `measure` computes them.
    virtual std::optional<VolumeStatistics> statistics() const { return std::nullopt; }

protected:
    explicit VolumeSource(VolumeInfo info) : info_(std::move(info)) {}

private:
    VolumeInfo info_;
};

struct MeasureOptions {
    bool exact = false;  ///< measures all voxels of level 0, even if this takes long
    Progress progress{};
    Gaps* gaps = nullptr;  ///< receives unreadable parts, which are left out (gaps.h); null: reading errors are thrown
};
/// Measures the volume in slabs of at most 16 MiB, but at least one row, and reads one ahead. Types of 32 and 64 bits
/// need a second pass for the histogram; its range, without outliers (outliers.h), comes from the first pass. A volume
/// without a finite voxel has minimum = maximum = mean = 0. Statistics that the source knows are returned as they are.
///
/// Large volumes: if a source knows its stored blocks, only those are read, and all other voxels count as fill values.
/// The measured level (VolumeStatistics::measured_level) is the finest that has, or stores, at most MAX_VOXELS_MEASURED
/// voxels. If there is none, it is the coarsest level, or level 0 if that stores at most MAX_VOXELS_EXACT; beyond that,
/// everything is estimated from a sample (VolumeStatistics::sampled_voxels): 256 pieces of about 2^18 voxels, or as
/// many voxels of stored blocks, evenly spread and always at the same places.
VolumeStatistics measure(const VolumeSource& source, const MeasureOptions& options = {});
inline constexpr int64_t MAX_VOXELS_MEASURED = int64_t{1} << 27;
inline constexpr int64_t MAX_VOXELS_EXACT = int64_t{1} << 30;
/// Practical maximum of the number of stored blocks: 2^42 voxels in blocks of 64^3. The list then takes 192 MiB.
inline constexpr int64_t MAX_STORED_BLOCKS = int64_t{1} << 24;

/// Measures one level like an exact `measure`, but always reads its voxels, even if the source knows its statistics.
VolumeStatistics measure_level(const VolumeSource& source, int level, const MeasureOptions& options = {});
/// Returns statistics of 8- or 16-bit integers: `counts[i]` voxels have the value `lowest` + i. `nodata`: VolumeInfo.
VolumeStatistics statistics_of(std::span<const int64_t> counts, int lowest, std::optional<double> nodata = {});

/// Returns warnings for the user, one sentence each: about NaN, infinities, fill values and outliers among the voxels,
/// and about statistics measured only on a coarser level or a sample.
std::vector<std::string> warnings_of(const VolumeStatistics& statistics);

/// ceil(size / 2^level).
Size3 size_of_level(const Size3& size, int level);

}  // namespace shvr
