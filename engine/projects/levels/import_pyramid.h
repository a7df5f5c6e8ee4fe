#pragma once
// Makes the levels of a volume while its level 0 streams through in chunks of 64^3 voxels.
//
// A voxel of level l + 1 is the mean of the 2^3 voxels of level l below it; at the volume's end, of those that exist,
// and always of the finite ones. Integers are rounded to nearest, ties to even; for labels it is the most frequent one
// (halving.h). Since 64 is 2^6, a chunk alone determines its voxels of the six levels above it. Voxels of levels 1 to 5
// are gathered until 64 slices of a level are complete; higher levels are small and kept whole. So memory depends on
// the size of a slice, not on the number of slices: about 43 bytes per voxel of a slice of 16 bits.
//
// The pass also finds, for every level and every brick of 32^3 voxels, the smallest and largest finite value of level 0
// below the brick and one voxel of its level around it.

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "engine/projects/levels/import_state.h"
#include "engine/volume/halving.h"
#include "engine/volume/volume.h"

namespace shvr {

/// Voxels along each axis of a chunk, at every level.
inline constexpr int64_t IMPORT_CHUNK = 64;
/// A chunk determines this many levels above its own.
inline constexpr int IMPORT_REACH = 6;
static_assert(IMPORT_CHUNK == int64_t{1} << IMPORT_REACH);

/// Enough levels that one brick of 32^3 voxels holds the coarsest.
int level_count(const Size3& size);

class ImportPyramid {
public:
    virtual ~ImportPyramid() = default;

    /// Takes the chunk whose first voxel is at `origin`, with `extent` voxels inside the volume; rows and slices lie
    /// `row_bytes` and `slice_bytes` apart. Returns all its 64^3 voxels, the fill value outside the volume; they stay
    /// valid until the next call with the same `worker`. Different workers may add different chunks at once.
    struct Chunk {
        Size3 origin{0};
        Size3 extent{0};
        const std::byte* voxels = nullptr;
        size_t row_bytes = 0;
        size_t slice_bytes = 0;
    };
    virtual std::span<const std::byte> add(const Chunk& chunk, int worker) = 0;

    /// Whether a layer of chunks of `level` (1 ... 5) is complete as soon as `slices` slices of level 0 have been
    /// added. Higher levels are complete at the end.
    bool completes_layer(int level, int64_t slices) const;
    /// Computes everything that needs the whole volume: levels above the sixth. Call after the last chunk.
    virtual void finish() = 0;
    /// The voxels of a chunk of a complete layer, as `add` returns them.
    virtual std::span<const std::byte> gather(int level, const Size3& chunk, int worker) = 0;
    /// Call once the layer of `level` has been written; its memory is reused for the next one.
    virtual void clear_layer(int level) = 0;

    /// The elements of PROJECT/shvr/ranges-LEVEL.
    virtual std::vector<std::byte> ranges(int level) const = 0;

    /// Valid only between two layers of chunks of level 0.
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

/// A voxel, in as many bytes as its type has.
using FillVoxel = std::array<std::byte, 8>;

std::unique_ptr<ImportPyramid> make_import_pyramid(const Size3& size, VoxelType type, int workers,
                                                   Halving how = Halving::mean, const FillVoxel& fill = {});

}  // namespace shvr
