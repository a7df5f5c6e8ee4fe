#include "engine/projects/import_memory.h"

#include <algorithm>
#include <cmath>

#include "engine/base/error.h"
#include "engine/base/machine/machine.h"
#include "engine/projects/import_box.h"
#include "engine/projects/levels/import_pyramid.h"
#include "engine/volume/content_hash.h"
#include "shaders/bricks.h"

namespace shvr {
namespace {

constexpr int64_t SLAB_BYTES = int64_t{64} << 20;
/// Size of the XXH3 state for one slice. All slices of a slab are hashed at the same time.
constexpr double HASHER_BYTES = 1024.0;
constexpr double MIB = 1048576.0;
/// Maximum number of bricks that intersect an isolated chunk or the voxels next to it.
constexpr double MAX_BRICKS = 64.0;

/// Sizes of data of all levels that stays in memory until the end.
struct Kept {
    double levels = 0.0;         ///< voxels of coarser levels, with the ranges of the voxels below
    double tables = 0.0;         ///< ranges of bricks, checksums of chunks
    double largest_table = 0.0;  ///< tables are written one by one
};

Kept kept_of(const VolumeInfo& info)
{
    Kept kept;
    const auto voxel_bytes = double(bytes_of(info.type));
    for (int level = 0; level < level_count(info.size); ++level) {
        const Size3 size = size_of_level(info.size, level);
        const double ranges = voxels_in(size_of_level(size, 5)) * 2.0 * voxel_bytes;
        const double checksums = voxels_in(size_of_level(size, IMPORT_REACH)) * 2.0 * sizeof(uint64_t);
        static_assert(gpu::BRICK_SIZE == 32);
        kept.tables += ranges + checksums;
        kept.largest_table = std::max({kept.largest_table, ranges, checksums});
        if (level == 0) continue;
        const int64_t slices = level >= IMPORT_REACH ? size.z : std::min(size.z, IMPORT_CHUNK);
        const double windows = level % IMPORT_REACH == 0 ? 3.0 : 1.0;
        kept.levels += windows * voxel_bytes * voxels_in({size.x, size.y, slices});
    }
    return kept;
}

/// Memory to hash slices, and for types with too many values to count, to measure the written project in pieces.
double measuring_bytes(const VolumeInfo& info)
{
    const double all = voxels_in(info.size) * double(bytes_of(info.type));
    return std::min(all, (bytes_of(info.type) > 2 ? 128.0 : 32.0) * MIB);
}

/// Memory of one worker: a chunk, its coarser levels with ranges, and the buffers for compression.
double worker_bytes(const VolumeInfo& info)
{
    const auto chunk = double(IMPORT_CHUNK * IMPORT_CHUNK * IMPORT_CHUNK * int64_t(bytes_of(info.type)));
    const double levels = 4.0 / 3.0;  // sum of 1 / 4^l, since rows keep their full length at every level
    const double counts = bytes_of(info.type) <= 2 ? 8.0 * double(int64_t{1} << (8 * bytes_of(info.type))) : 0.0;
    return 3.0 * levels * chunk + 4.0 * chunk + counts;
}

}  // namespace

int64_t import_rows(const VolumeInfo& info)
{
    const int64_t row_bytes = info.size.x * int64_t(bytes_of(info.type));
    const int64_t rows = SLAB_BYTES / (IMPORT_CHUNK * row_bytes) / IMPORT_CHUNK * IMPORT_CHUNK;
    return std::clamp(rows, std::min(IMPORT_CHUNK, info.size.y), info.size.y);
}

double dense_import_bytes(const Preparation& preparation, int threads, bool keeps_state)
{
    const VolumeInfo& info = preparation.info();
    const int64_t rows = import_rows(info), slices = std::min(IMPORT_CHUNK, info.size.z);
    const double slab = voxels_in({info.size.x, rows, slices}) * double(bytes_of(info.type));
    const double places = voxels_in({info.size.x, rows, slices}) < voxels_in(info.size) ? 2.0 : 1.0;
    const Kept kept = kept_of(info);
    const double hashes = 16.0 * double(info.size.z) + HASHER_BYTES * double(slices) +
                          2.0 * sizeof(ChunkHasher::Digest) * voxels_in(size_of_level(info.size, IMPORT_REACH));
    // The state is collected and compressed as a whole, in buffers that are copied when they grow.
    const double state = keeps_state ? 3.0 * (kept.levels + kept.tables + hashes) : 0.0;
    const double table = 3.0 * kept.largest_table;
    return IMPORT_PROGRAM_BYTES + measuring_bytes(info) + places * slab + kept.levels + kept.tables + hashes +
           std::max(state, table) + double(threads) * worker_bytes(info) + preparation.bytes(rows, slices, threads);
}

double sparse_import_bytes(const VolumeSource& source, const VolumeInfo& info, const StoredChunks& stored, int threads)
{
    const auto voxel_bytes = double(bytes_of(info.type));
    const double chunk = double(IMPORT_CHUNK * IMPORT_CHUNK * IMPORT_CHUNK) * voxel_bytes;
    double cubes = 0.0, tables = 0.0;
    for (int level = 0; level < level_count(info.size); ++level) {
        double chunks = 0.0;
        for (size_t i = 0; i < stored.keys.size(); ++i)
            chunks += i == 0 || stored.keys[i] >> (3 * level) != stored.keys[i - 1] >> (3 * level) ? 1.0 : 0.0;
        const double bricks =
            std::min(chunks * MAX_BRICKS, voxels_in(size_of_level(size_of_level(info.size, level), 5)));
        tables += 2.0 * (chunks * 2.0 * sizeof(uint64_t) + bricks * (16.0 + 2.0 * std::max(4.0, voxel_bytes)));
        cubes += 3.0 * chunk;
    }
    const double lists = double(stored.keys.size()) * (sizeof(uint64_t) + 2.0 * sizeof(ChunkHasher::Digest)) +
                         double(stored.blocks) * 3.0 * sizeof(glm::ivec3);
    const double halves = 4.0 * double(threads) * 0.75 * chunk;
    const double reading = ImportBox(source, {Size3(0), info.size}, false).bytes(Size3(IMPORT_CHUNK), threads);
    return IMPORT_PROGRAM_BYTES + measuring_bytes(info) + 4.0 * (cubes + tables + lists) + halves +
           double(threads + 1) * worker_bytes(info) + double(threads) * chunk + reading;
}

double import_budget(int64_t wanted)
{
    if (wanted > 0) return double(wanted);
    return 0.75 * double(memory_allowed());
}

void check_import_budget(const std::filesystem::path& project, const VolumeInfo& info, double bytes, int64_t wanted)
{
    const double budget = import_budget(wanted);
    if (bytes <= budget) return;
    fail(project.string(), ": importing ", info.size.x, " x ", info.size.y, " x ", info.size.z, " voxels of ",
         name_of(info.type), " takes up to ", int64_t(std::ceil(bytes / MIB)), " MiB of memory; expected at most ",
         int64_t(budget / MIB), " MiB, ",
         wanted > 0 ? "which --budget-host states" : "three quarters of this machine's",
         ": use --crop or --downscale, or a larger --budget-host");
}

}  // namespace shvr
