#pragma once
// A pass over the voxels of a volume: makes the chunks of all levels, and all other data of a project that depends on
// them. A dense pass visits all voxels in slabs; a sparse pass visits only the chunks in which the source stores
// something. Both give equal results. For import_volume.cpp. Only the pool's owner may call it, except `done`.

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "engine/base/waits/work_pool.h"
#include "engine/formats/zarr/project.h"
#include "engine/pieces/task_choice.h"
#include "engine/projects/import_chunks.h"
#include "engine/projects/import_prepare.h"
#include "engine/projects/levels/import_pyramid.h"
#include "engine/projects/levels/import_state.h"
#include "engine/volume/content_hash.h"
#include "engine/volume/stored_chunks.h"

namespace shvr {

class ImportPass {
public:
    virtual ~ImportPass() = default;

    /// Decides when to save the state, and saves it. No task may be running during a save.
    struct Keeper {
        std::function<bool()> is_due;
        std::function<void()> keep;
    };
    /// Makes all chunks that are not in the loaded state.
    virtual void run(const Keeper& keeper) = 0;

    virtual int64_t all() const = 0;    ///< number of chunks of level 0 to visit
    virtual int64_t done() const = 0;   ///< number of chunks visited; any thread
    virtual double voxels() const = 0;  ///< number of voxels in these chunks
    virtual bool is_begun() const = 0;  ///< whether a loaded state already contains some chunks

    // ---- Results, valid after `run` ----
    /// Returns the ranges of the bricks of a level in their stored form.
    virtual ProjectTable ranges(int level) = 0;
    /// Returns null if the voxel type has too many values to count each of them.
    virtual std::optional<VolumeStatistics> statistics() const = 0;
    virtual std::string content_hash() = 0;

    virtual void save(StateWriter& state) const = 0;
    virtual void load(StateReader& state) = 0;

    // ---- Passes of several processes (import_piece.h); only a dense pass can be split ----
    /// Saves what another pass needs to continue from this one's slabs.
    virtual void save_piece(StateWriter&) const { SHVR_CHECK(false, "a sparse pass is not split"); }
    /// Takes the slabs of another process, in any order.
    virtual void merge_piece(StateReader&) { SHVR_CHECK(false, "a sparse pass is not split"); }
    /// Makes the chunks of coarser levels that lie in the slabs of several processes, once all are merged.
    virtual void finish_pieces() { SHVR_CHECK(false, "a sparse pass is not split"); }
};

/// Slabs [lower, upper) of 64 slices, of a pass by one of several processes.
struct SlabRange {
    int64_t lower = 0, upper = 0;
};
/// Returns the slabs of a task. They begin where layers of coarser levels do, as far as that balances the tasks.
SlabRange slabs_of(const TaskChoice& task, const Size3& size);

struct ImportSetup {
    const VolumeInfo& info;  ///< describes the result
    Halving halving = Halving::mean;
    FillVoxel fill{};  ///< value of voxels in chunks that are not stored
    int threads = 1;
    ImportChunks& chunks;  ///< made for `threads` + 1 workers
    WorkPool& pool;
    std::optional<SlabRange> slabs{};  ///< slabs of a dense pass; null: all
};

std::unique_ptr<ImportPass> make_dense_pass(Preparation& preparation, const ImportSetup& setup);
/// `origin`: the first imported voxel of `source`, with which `stored` is aligned.
std::unique_ptr<ImportPass> make_sparse_pass(const VolumeSource& source, const Size3& origin, StoredChunks stored,
                                             const ImportSetup& setup);

/// Returns a table of ranges that has no elements yet.
inline ProjectTable ranges_table(const VolumeInfo& info, int level)
{
    return {.kind = "ranges",
            .level = level,
            .element_bytes = 2 * bytes_of(info.type),
            .counts = size_of_level(size_of_level(info.size, level), 5)};
}
/// Whether the tables of a volume have an element for every brick and chunk, even where nothing is stored.
inline bool has_small_tables(const VolumeInfo& info)
{
    return voxel_count(info) <= MAX_VOXELS_IN_SLICES;
}

}  // namespace shvr
