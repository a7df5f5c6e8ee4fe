#pragma once
// Computes the levels of a volume while level 0 is read in chunks of 64^3 voxels.
//
// A voxel of level l + 1 is the mean of the 2^3 voxels of level l below it. Only finite voxels inside the volume count.
// Integers are rounded to nearest, ties to even. For labels, the most frequent label is taken instead (halving.h). As
// 64 is 2^6, a chunk alone determines its voxels in the next six coarser levels. Voxels of levels 1 to 5 are collected
// until 64 slices of a level are complete; higher levels are small and kept whole. So memory depends on the size of a
// slice, not on the number of slices: about 43 bytes per voxel of a slice of 16 bits.
//
// For every brick of 32^3 voxels of every level, also finds the smallest and largest finite value of the voxels of
// level 0 below the brick and below the voxels next to it.

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "engine/projects/levels/import_state.h"
#include "engine/volume/halving.h"
#include "engine/volume/volume.h"

namespace shvr {

/// Side of a chunk in voxels, at every level.
inline constexpr int64_t IMPORT_CHUNK = 64;
/// The number of coarser levels for which a single chunk determines its voxels.
inline constexpr int IMPORT_REACH = 6;
static_assert(IMPORT_CHUNK == int64_t{1} << IMPORT_REACH);

/// Returns the number of levels, such that one brick of 32^3 voxels covers the coarsest level.
int level_count(const Size3& size);

class ImportPyramid {
public:
    virtual ~ImportPyramid() = default;

    /// `add` adds the chunk whose first voxel is at `origin`, with `extent` voxels inside the volume; rows and slices
    /// lie `row_bytes` and `slice_bytes` apart. Returns all its 64^3 voxels, with the fill value outside the volume,
    /// valid until the next call with the same `worker`. Different workers may add different chunks at the same time.
    struct Chunk {
        Size3 origin{0};
        Size3 extent{0};
        const std::byte* voxels = nullptr;
        size_t row_bytes = 0;
        size_t slice_bytes = 0;
    };
    virtual std::span<const std::byte> add(const Chunk& chunk, int worker) = 0;

    /// Whether `level` (1 ... 5) has a new complete layer of chunks once `slices` slices of level 0 are added. Layers
    /// of higher levels are complete only at the end.
    bool completes_layer(int level, int64_t slices) const;
    /// Computes the levels above the sixth, which depend on the whole volume. Call this after the last chunk.
    virtual void finish() = 0;
    /// Returns the voxels of a chunk of a complete layer, laid out like the result of `add`.
    virtual std::span<const std::byte> gather(int level, const Size3& chunk, int worker) = 0;
    /// Call this once the layer of `level` has been written. The next layer reuses its memory.
    virtual void clear_layer(int level) = 0;

    // ---- Slices that several processes make ----
    /// Copies slices [lower, upper) of a level from the memory of its layers: the voxels and, of the sixth level, the
    /// ranges below them.
    virtual std::vector<std::byte> slices(int level, int64_t lower, int64_t upper) const = 0;
    /// Puts such slices back; returns false if they have another size.
    virtual bool put_slices(int level, int64_t lower, int64_t upper, std::span<const std::byte> slices) = 0;
    /// Extends each range by the range in `ranges`, in the form of the next function; returns false if there are not as
    /// many.
    virtual bool include_ranges(int level, std::span<const std::byte> ranges) = 0;

    /// The elements of PROJECT/shvr/ranges-LEVEL.
    virtual std::vector<std::byte> ranges(int level) const = 0;

    /// Call this only between two layers of chunks of level 0.
    virtual void save(StateWriter& state) const = 0;
    virtual void load(StateReader& state) = 0;

    int levels() const { return levels_; }
    const Size3& size() const { return size_; }

protected:
    explicit ImportPyramid(const Size3& size) : size_(size), levels_(level_count(size)) {}

private:
    Size3 size_;
    int levels_;
};

/// The bytes of a fill value. For types of less than 8 bytes, the rest is unused.
using FillVoxel = std::array<std::byte, 8>;

std::unique_ptr<ImportPyramid> make_import_pyramid(const Size3& size, VoxelType type, int workers,
                                                   Halving how = Halving::mean, const FillVoxel& fill = {});

}  // namespace shvr
