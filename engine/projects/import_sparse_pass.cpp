// Visits only chunks in which the source stores something, ordered so that all chunks below a coarser chunk come
// consecutively. Workers make level 0 in parallel; each coarser level keeps only one unfinished chunk in memory.

#include <algorithm>
#include <array>
#include <atomic>

#include "engine/projects/import_pass.h"
#include "engine/projects/levels/import_cube.h"
#include "engine/projects/levels/import_tally.h"
#include "engine/projects/levels/sparse_ranges.h"
#include "engine/volume/voxel_dispatch.h"

namespace shvr {
namespace {

using Bytes = std::span<const std::byte>;

template <class T>
class SparsePass final : public ImportPass {
public:
    SparsePass(const VolumeSource& source, const Size3& origin, StoredChunks stored, const ImportSetup& setup)
        : source_(source),
          origin_(origin),
          stored_(std::move(stored)),
          info_(setup.info),
          fill_(setup.fill),
          halving_(setup.halving),
          merger_(setup.threads),
          chunks_(setup.chunks),
          pool_(setup.pool),
          counts_(info_.type, setup.threads),
          read_(size_t(setup.threads)),
          at_once_(size_t(2 * setup.threads)),
          half_(IMPORT_CHUNK / 2)
    {
        std::memcpy(&fill_voxel_, fill_.data(), sizeof(T));
        if (!has_small_tables(info_)) hasher_.emplace(info_);
        for (int level = 0; level < chunks_.levels(); ++level) {
            tables_.push_back(
                std::make_unique<SparseRanges<T>>(size_of_level(info_.size, level), range_of_voxel<T>(fill_)));
            if (level > 0) open_.push_back({.cube = ImportCube<T>(IMPORT_CHUNK)});
        }
        for (int worker = 0; worker < setup.threads; ++worker) cubes_.emplace_back(IMPORT_CHUNK);
        for (auto& halves : halves_)
            for (size_t i = 0; i < at_once_; ++i) halves.emplace_back(IMPORT_CHUNK / 2);
    }

    void run(const Keeper& keeper) override
    {
        done_ = int64_t(merged_);
        size_t place = 0;
        auto batch = start(merged_, place);
        while (merged_ < stored_.keys.size()) {
            pool_.wait(batch);
            const size_t next = std::min(merged_ + at_once_, stored_.keys.size());
            // The state is saved between batches only, since it must not contain a part of a batch.
            const bool keeps = next < stored_.keys.size() && keeper.is_due();
            if (!keeps) batch = start(next, 1 - place);
            for (size_t i = merged_; i < next; ++i) merge(stored_.at(i), halves_[place][i - merged_]);
            merged_ = next;
            if (keeps) {
                keeper.keep();
                batch = start(next, 1 - place);
            }
            place = 1 - place;
        }
        pool_.wait(batch);
        for (size_t i = 0; i < open_.size(); ++i) close(i);
        const int64_t rest = voxel_count(info_) - voxels_read_;
        counts_.add(Bytes(fill_).first(sizeof(T)), rest, 0);
    }

    int64_t all() const override { return int64_t(stored_.keys.size()); }
    int64_t done() const override { return done_; }
    double voxels() const override { return double(all()) * double(IMPORT_CHUNK * IMPORT_CHUNK * IMPORT_CHUNK); }
    bool is_begun() const override { return merged_ > 0; }

    ProjectTable ranges(int level) override
    {
        SparseRanges<T>& found = *tables_[size_t(level)];
        ProjectTable table = ranges_table(info_, level);
        table.is_sparse = true;
        const auto put = [&](const ImportRange<T>& range) {
            const auto bytes = std::as_bytes(std::span(&range, 1));
            table.elements.insert(table.elements.end(), bytes.begin(), bytes.end());
        };
        put(found.rest());
        for (const auto& brick : found.bricks()) {
            table.keys.push_back(brick.number);
            put(brick.range);
        }
        return stored_form(std::move(table), has_small_tables(info_));
    }

    std::optional<VolumeStatistics> statistics() const override { return counts_.statistics(); }

    std::string content_hash() override
    {
        if (hasher_) return hasher_->hash(Bytes(fill_).first(sizeof(T)));
        return shvr::content_hash(BoxOf(source_, info_, origin_, stored_));
    }

    void save(StateWriter& state) const override
    {
        state.put_all(std::vector<int64_t>{int64_t(merged_), voxels_read_});
        counts_.save(state);
        if (hasher_) state.put_all(hasher_->digests());
        for (const auto& table : tables_) table->save(state);
        for (const Open& open : open_) {
            const Size3 at = open.at.value_or(Size3(-1));
            state.put_all(std::vector<int64_t>{at.x, at.y, at.z});
            if (!open.at) continue;
            state.put_all(open.cube.values);
            state.put_all(open.cube.lower);
            state.put_all(open.cube.upper);
        }
    }

    void load(StateReader& state) override
    {
        std::vector<int64_t> numbers(2), at(3);
        state.take_all(numbers);
        counts_.load(state);
        if (hasher_) hasher_->restore(state.take_list<ChunkHasher::Digest>());
        for (auto& table : tables_) table->load(state);
        for (size_t i = 0; i < open_.size(); ++i) {
            state.take_all(at);
            if (at[0] < 0) continue;
            begin(i, {at[0], at[1], at[2]});
            state.take_all(open_[i].cube.values);
            state.take_all(open_[i].cube.lower);
            state.take_all(open_[i].cube.upper);
        }
        if (numbers[0] < 0 || numbers[0] > all()) state.refuse();
        merged_ = size_t(numbers[0]);
        voxels_read_ = numbers[1];
    }

private:
    /// An unfinished chunk of a coarser level: some chunks below it are still to come.
    struct Open {
        std::optional<Size3> at{};
        ImportCube<T> cube;
    };

    /// Presents the imported part of a source as a source.
    class BoxOf final : public VolumeSource {
    public:
        BoxOf(const VolumeSource& source, VolumeInfo info, const Size3& origin, const StoredChunks& stored)
            : VolumeSource(std::move(info)), source_(source), origin_(origin), stored_(stored)
        {}
        void read(const VoxelBox& box, std::span<std::byte> voxels) const override
        {
            source_.read({box.lower + origin_, box.upper + origin_}, voxels);
        }
        Size3 block() const override { return Size3(IMPORT_CHUNK); }
        std::optional<StoredBlocks> stored_blocks(int level, int64_t /*most*/) const override
        {
            if (level > 0) return std::nullopt;
            StoredBlocks blocks{.block = Size3(IMPORT_CHUNK)};
            for (size_t i = 0; i < stored_.keys.size(); ++i) blocks.blocks.emplace_back(stored_.at(i));
            return blocks;
        }

    private:
        const VolumeSource& source_;
        Size3 origin_;
        const StoredChunks& stored_;
    };

    // ---- Level 0 ----

    std::shared_ptr<WorkPool::Batch> start(size_t first, size_t place)
    {
        const size_t count = std::min(at_once_, stored_.keys.size() - first);
        return pool_.start(int64_t(count), [=, this](int64_t task, int worker) {
            make(stored_.at(first + size_t(task)), halves_[place][size_t(task)], worker);
            ++done_;
        });
    }

    void make(const Size3& chunk, ImportCube<T>& half, int worker)
    {
        const Size3 origin = chunk * IMPORT_CHUNK;
        ImportCube<T>& cube = cubes_[size_t(worker)];
        std::vector<T>& read = read_[size_t(worker)];
        cube.extent = glm::min(Size3(IMPORT_CHUNK), info_.size - origin);
        cube.has_ranges = false;
        std::ranges::fill(cube.values, fill_voxel_);
        const Size3& extent = cube.extent;
        read.resize(size_t(extent.x * extent.y * extent.z));
        source_.read({origin_ + origin, origin_ + origin + extent}, std::as_writable_bytes(std::span(read)));
        counts_.add(std::as_bytes(std::span(read)), worker);
        if (hasher_)
            hasher_->add(chunk, reinterpret_cast<const std::byte*>(read.data()), size_t(extent.x) * sizeof(T),
                         size_t(extent.x * extent.y) * sizeof(T));
        const T* from = read.data();
        for (int64_t z = 0; z < extent.z; ++z)
            for (int64_t y = 0; y < extent.y; ++y, from += extent.x)
                std::copy_n(from, extent.x, cube.values.data() + cube.row(y, z));
        find_own_ranges(cube);
        tables_[0]->add(cube, origin);
        if (!open_.empty()) halve_cube(cube, half, halving_);
        half.extent = size_of_level(extent, 1);
        chunks_.write(0, chunk, std::as_bytes(std::span(cube.values)), worker);
        voxels_read_ += int64_t(read.size());
    }

    // ---- Coarser levels: open_[i] is of level i + 1 ----

    void merge(const Size3& chunk, const ImportCube<T>& half)
    {
        size_t closed = open_.size();
        while (closed > 0 && (!open_[closed - 1].at || *open_[closed - 1].at == above(chunk, closed))) --closed;
        for (size_t i = 0; i < closed; ++i) close(i);
        for (size_t i = 0; i < open_.size(); ++i)
            if (!open_[i].at) begin(i, above(chunk, i + 1));
        if (!open_.empty()) put(half, chunk, open_[0]);
    }

    static Size3 above(const Size3& chunk, size_t levels)
    {
        return {chunk.x >> levels, chunk.y >> levels, chunk.z >> levels};
    }

    /// Starts a chunk of a coarser level, filled with the fill value.
    void begin(size_t i, const Size3& at)
    {
        ImportCube<T>& cube = open_[i].cube;
        const ImportRange<T> range = range_of_voxel<T>(fill_);
        open_[i].at = at;
        cube.extent = glm::min(Size3(IMPORT_CHUNK), size_of_level(info_.size, int(i) + 1) - at * IMPORT_CHUNK);
        cube.has_ranges = true;
        cube.values.assign(cube.values.size(), fill_voxel_);
        cube.lower.assign(cube.values.size(), range.lower);
        cube.upper.assign(cube.values.size(), range.upper);
    }

    void close(size_t i)
    {
        Open& open = open_[i];
        if (!open.at) return;
        const int level = int(i) + 1;
        tables_[size_t(level)]->add(open.cube, *open.at * IMPORT_CHUNK);
        chunks_.write(level, *open.at, std::as_bytes(std::span(open.cube.values)), merger_);
        if (i + 1 < open_.size()) {
            halve_cube(open.cube, half_, halving_);
            put(half_, *open.at, open_[i + 1]);
        }
        open.at.reset();
    }

    /// Copies the halved chunk into its octant of the chunk of the next level.
    static void put(const ImportCube<T>& half, const Size3& chunk, Open& into)
    {
        const Size3 to = (chunk - *into.at * int64_t{2}) * (IMPORT_CHUNK / 2);
        for (int64_t z = 0; z < half.extent.z; ++z)
            for (int64_t y = 0; y < half.extent.y; ++y) {
                const auto from = std::ptrdiff_t(half.row(y, z));
                const auto at = std::ptrdiff_t(into.cube.row(to.y + y, to.z + z) + size_t(to.x));
                std::copy_n(half.values.begin() + from, half.extent.x, into.cube.values.begin() + at);
                std::copy_n(half.lower.begin() + from, half.extent.x, into.cube.lower.begin() + at);
                std::copy_n(half.upper.begin() + from, half.extent.x, into.cube.upper.begin() + at);
            }
    }

    const VolumeSource& source_;
    Size3 origin_;
    StoredChunks stored_;
    const VolumeInfo& info_;
    FillVoxel fill_;
    T fill_voxel_{};
    Halving halving_;
    int merger_;  ///< the owner's worker number
    ImportChunks& chunks_;
    WorkPool& pool_;

    ValueCounts counts_;
    std::optional<ChunkHasher> hasher_;                     ///< for volumes that are hashed in chunks
    std::vector<std::unique_ptr<SparseRanges<T>>> tables_;  ///< by level
    std::vector<ImportCube<T>> cubes_;                      ///< by worker
    std::vector<std::vector<T>> read_;                      ///< by worker
    size_t at_once_;                                        ///< number of chunks in a batch
    std::array<std::vector<ImportCube<T>>, 2> halves_;      ///< halved chunks of two batches
    std::vector<Open> open_;
    ImportCube<T> half_;
    size_t merged_ = 0;
    std::atomic<int64_t> done_ = 0, voxels_read_ = 0;
};

}  // namespace

std::unique_ptr<ImportPass> make_sparse_pass(const VolumeSource& source, const Size3& origin, StoredChunks stored,
                                             const ImportSetup& setup)
{
    return with_voxel_type(setup.info.type, [&]<class T>(T) -> std::unique_ptr<ImportPass> {
        return std::make_unique<SparsePass<T>>(source, origin, std::move(stored), setup);
    });
}

}  // namespace shvr
