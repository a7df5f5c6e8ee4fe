#include "engine/projects/import_plan.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <type_traits>

#include "engine/base/error.h"
#include "engine/base/machine/machine.h"
#include "engine/formats/zarr/project.h"
#include "engine/projects/import_box.h"
#include "engine/projects/import_memory.h"
#include "engine/volume/voxel_dispatch.h"

namespace shvr {
namespace {

/// If more than this fraction of the chunks is stored, a dense pass is as fast as a sparse one. At the same fraction,
/// the hash changes its kind (content_hash.h).
constexpr double MAX_SHARE_STORED = 0.125;
/// Memory per block while chunks are listed.
constexpr int64_t LISTED_BYTES = 256;

/// Whether the mean of any number of voxels with this value is the value itself, bit for bit. False for a few 64-bit
/// floats, whose sums are rounded.
template <class T>
bool is_own_mean(T voxel, Halving how)
{
    const std::array<T, 2> row{voxel, voxel};
    for (const int rows : {1, 2, 4})
        for (const int64_t length : {1, 2}) {
            HalvingRows<T> halved;
            for (; halved.count < rows; ++halved.count) halved.first[size_t(halved.count)] = row.data();
            T mean{};
            halve_rows(halved, length, &mean, how);
            if (std::memcmp(&mean, &voxel, sizeof(T)) != 0) return false;
        }
    return true;
}

bool is_kept_by_levels(const FillVoxel& fill, VoxelType type, Halving how)
{
    return with_voxel_type(type, [&]<class T>(T voxel) {
        std::memcpy(&voxel, fill.data(), sizeof(T));
        if constexpr (std::is_floating_point_v<T>)
            if (std::isinf(voxel)) return false;
        return is_own_mean(voxel, how);
    });
}

/// Whether all blocks that intersect a chunk fit into the source's cache together, so that no block is decoded twice.
bool fit_chunks(const VolumeSource& source)
{
    double bytes = double(bytes_of(source.info().type));
    for (int axis = 0; axis < 3; ++axis) {
        const int64_t block = source.block()[axis];
        bytes *= double(((STORED_CHUNK - 2) / block + 2) * block);
    }
    return bytes <= SOURCE_CACHE_BYTES;
}

}  // namespace

int import_threads(int wanted)
{
    return wanted > 0 ? wanted : processors_allowed();
}

void check_all_tables(const std::filesystem::path& project, const VolumeInfo& info)
{
    try {
        check_tables(project, info);
    } catch (const Error& error) {
        fail(
            project.string(), ": would have ", info.size.x, " x ", info.size.y, " x ", info.size.z,
            " voxels, and a project keeps the range of every brick and the checksum of every chunk in which something ",
            "is stored (", error.what(), "): use --crop or --downscale");
    }
}

ImportPlan plan_import(const VolumeSource& source, const std::filesystem::path& project, const ImportOptions& options)
{
    PreparationOptions preparation = options.preparation;
    preparation.reverse = false;  // leaves out reversal here, since its range requires a pass over all voxels
    const std::unique_ptr<Preparation> prepared = make_preparation(source, preparation);
    const VolumeInfo& info = prepared->info();
    static_cast<void>(voxel_count(info));
    const int threads = import_threads(options.threads);
    const double budget = import_budget(options.budget_host_bytes);
    const double dense_bytes = dense_import_bytes(*prepared, threads, true);
    ImportPlan plan;
    PreparationOptions harmless;
    harmless.crop = options.preparation.crop;
    if (options.preparation == harmless) {
        const VoxelBox box = options.preparation.crop.value_or(VoxelBox{Size3(0), source.info().size});
        const int64_t most = std::clamp(int64_t(budget) / LISTED_BYTES, int64_t{1024}, MAX_STORED_BLOCKS);
        std::optional<StoredChunks> stored = chunks_in(source, box, most);
        if (stored && is_kept_by_levels(stored->fill, info.type, options.halving)) {
            plan.fill = stored->fill;
            const double bytes = sparse_import_bytes(source, info, *stored, threads);
            const bool is_better = fit_chunks(source) || dense_bytes > budget;
            if (double(stored->keys.size()) <= std::floor(MAX_SHARE_STORED * stored->all()) && is_better) {
                if (bytes > budget && dense_bytes > budget)
                    check_import_budget(project, info, std::min(bytes, dense_bytes), options.budget_host_bytes);
                if (bytes <= budget) plan.stored = std::move(stored);
            }
        }
    }
    if (plan.stored) return plan;
    check_import_budget(project, info, dense_bytes, options.budget_host_bytes);
    check_all_tables(project, info);
    return plan;
}

}  // namespace shvr
