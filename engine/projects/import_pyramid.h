#pragma once
// The levels of a volume, made while its level 0 goes by in chunks of 64^3 voxels.
//
// A voxel of level l + 1 is the mean of the 2^3 voxels of level l it stands for, of those that there are at the
// volume's end, and of the finite ones; integers are rounded to nearest, ties to even; of labels it is the most
// frequent one (halving.h). Since 64 is 2^6, a chunk alone decides its
// voxels of the six levels above it. Those of levels 1 to 5 are gathered until 64 slices of a level are complete;
// higher levels are small and kept whole. So memory depends on the size of a slice, not on the number of slices: some
// 43 bytes for every voxel of a slice of 16 bits.
//
// For every level and every brick of 32^3 voxels, the smallest and largest finite value of level 0 below the brick and
// one voxel of its level around it are found on the way.

#include <memory>
#include <span>
#include <vector>

#include "engine/projects/import_state.h"
#include "engine/volume/halving.h"
#include "engine/volume/volume.h"

namespace shvr {

/// Voxels of a chunk along each axis, of every level.
inline constexpr int64_t IMPORT_CHUNK = 64;
/// A chunk decides this many levels above its own.
inline constexpr int IMPORT_REACH = 6;
static_assert(IMPORT_CHUNK == int64_t{1} << IMPORT_REACH);

/// As many as there are until one brick of 32^3 voxels holds all.
int level_count(const Size3& size);

class ImportPyramid {
public:
    virtual ~ImportPyramid() = default;

    /// Takes the chunk whose first voxel is at `origin`, and has `extent` voxels inside the volume; rows and slices lie
    /// `row_bytes` and `slice_bytes` apart. Returns all its 64^3 voxels, 0 beyond the volume, which stay until the next
    /// call with the same `worker`. Different chunks may be added at once, by different workers.
    struct Chunk {
        Size3 origin{0};
        Size3 extent{0};
        const std::byte* voxels = nullptr;
        size_t row_bytes = 0;
        size_t slice_bytes = 0;
    };
    virtual std::span<const std::byte> add(const Chunk& chunk, int worker) = 0;

    /// The slices of `level` (1 ... 5) that are complete once `slices` of level 0 have been added, and begin a layer of
    /// chunks with `slice`: true where there is such a layer now. Higher levels are complete at the end.
    bool completes_layer(int level, int64_t slices) const;
    /// Makes what can only be made of the whole: levels above the sixth. After the last chunk.
    virtual void finish() = 0;
    /// The voxels of a chunk of a complete layer, as `add` returns them.
    virtual std::span<const std::byte> gather(int level, const Size3& chunk, int worker) = 0;
    /// The layer of `level` was written; its memory is used for the next one.
    virtual void clear_layer(int level) = 0;

    /// The elements of PROJECT/shvr/ranges-LEVEL.
    virtual std::vector<std::byte> ranges(int level) const = 0;

    /// Everything between two layers of chunks of level 0.
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

std::unique_ptr<ImportPyramid> make_import_pyramid(const Size3& size, VoxelType type, int workers,
                                                   Halving how = Halving::mean);

}  // namespace shvr
