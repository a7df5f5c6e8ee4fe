// Imports all voxels, slab by slab.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <utility>

#include "engine/projects/import_memory.h"
#include "engine/projects/import_pass.h"
#include "engine/projects/levels/import_ranges.h"
#include "engine/projects/levels/import_tally.h"
#include "engine/volume/voxel_dispatch.h"

namespace shvr {
namespace {

using Bytes = std::span<const std::byte>;

class DensePass final : public ImportPass {
public:
    DensePass(Preparation& preparation, const ImportSetup& setup)
        : preparation_(preparation),
          info_(setup.info),
          fill_(setup.fill),
          chunks_(setup.chunks),
          pool_(setup.pool),
          pyramid_(make_import_pyramid(info_.size, info_.type, setup.threads, setup.halving, setup.fill)),
          tally_(info_, IMPORT_CHUNK, setup.threads),
          rows_(import_rows(info_)),
          bands_((info_.size.y + rows_ - 1) / rows_),
          slabs_(setup.slabs.value_or(SlabRange{0, (info_.size.z + IMPORT_CHUNK - 1) / IMPORT_CHUNK})),
          is_part_(setup.slabs.has_value()),
          slabs_done_(slabs_.lower)
    {
        if (!has_small_tables(info_)) hasher_.emplace(info_);
    }

    void run(const Keeper& keeper) override
    {
        const int64_t first = slabs_done_ * bands_, end = slabs_.upper * bands_;
        done_ = (slabs_done_ - slabs_.lower) * counts(0).x * counts(0).y;
        for (int64_t step = first; step < end; ++step) {
            const auto place = size_t(step % 2);
            if (step == first) read(slab_of(step), place);
            const auto batch = start(slab_of(step), place);
            if (step + 1 < end) read(slab_of(step + 1), 1 - place);
            pool_.wait(batch);
            if (step % bands_ != bands_ - 1) continue;
            finish_slab(step / bands_);
            if (slabs_done_ < slabs_.upper && keeper.is_due()) keeper.keep();
        }
        if (is_part_) return keep_last_slices();
        finish_levels();
    }

    void finish_levels()
    {
        pyramid_->finish();
        for (int level = IMPORT_REACH; level < pyramid_->levels(); ++level) {
            for (int64_t layer = 0; layer < counts(level).z; ++layer) write_layer(level, layer);
        }
    }

    int64_t all() const override { return counts(0).x * counts(0).y * (slabs_.upper - slabs_.lower); }
    int64_t done() const override { return done_; }
    double voxels() const override
    {
        const int64_t slices = std::min(slabs_.upper * IMPORT_CHUNK, info_.size.z) - slabs_.lower * IMPORT_CHUNK;
        return double(info_.size.x) * double(info_.size.y) * double(slices);
    }
    bool is_begun() const override { return slabs_done_ > slabs_.lower; }

    ProjectTable ranges(int level) override
    {
        ProjectTable table = ranges_table(info_, level);
        table.elements = pyramid_->ranges(level);
        if (has_small_tables(info_)) return table;
        const std::vector<std::byte> rest = range_of_fill();
        const auto is_rest = [&](size_t at) {
            return std::memcmp(table.elements.data() + at, rest.data(), rest.size()) == 0;
        };
        size_t listed = 0;
        for (size_t at = 0; at < table.elements.size(); at += rest.size()) listed += is_rest(at) ? 0 : 1;
        if (!is_smaller_as_list(table, listed)) return table;
        ProjectTable list = ranges_table(info_, level);
        list.is_sparse = true;
        list.elements = rest;
        for (size_t at = 0; at < table.elements.size(); at += rest.size()) {
            if (is_rest(at)) continue;
            list.keys.push_back(at / rest.size());
            const auto element = table.elements.begin() + std::ptrdiff_t(at);
            list.elements.insert(list.elements.end(), element, element + std::ptrdiff_t(rest.size()));
        }
        return list;
    }
    std::optional<VolumeStatistics> statistics() const override { return tally_.statistics(); }
    std::string content_hash() override
    {
        if (hasher_ && kind_for(info_, hasher_->varied()) == HashKind::chunks)
            return hasher_->hash(Bytes(fill_).first(bytes_of(info_.type)));
        return tally_.content_hash();
    }

    void save(StateWriter& state) const override
    {
        state.put_all(std::vector<int64_t>{slabs_done_});
        tally_.save(state);
        pyramid_->save(state);
        if (hasher_) state.put_all(hasher_->digests());
        if (is_part_) save_loose(state);
    }
    void load(StateReader& state) override
    {
        std::vector<int64_t> slabs(1);
        state.take_all(slabs);
        tally_.load(state);
        pyramid_->load(state);
        if (hasher_) hasher_->restore(state.take_list<ChunkHasher::Digest>());
        slabs_done_ = slabs[0];
        if (is_part_) load_loose(state);
    }

    void save_piece(StateWriter& state) const override
    {
        state.put_all(std::vector<int64_t>{slabs_.lower, slabs_.upper});
        tally_.save(state);
        for (int level = 0; level <= std::min(IMPORT_REACH, pyramid_->levels() - 1); ++level)
            state.put(pyramid_->ranges(level));
        if (pyramid_->levels() > IMPORT_REACH) {
            const SlabRange slices = slices_of(IMPORT_REACH);
            state.put(pyramid_->slices(IMPORT_REACH, slices.lower, slices.upper));
        }
        if (hasher_) state.put_all(hasher_->digests());
        save_loose(state);
    }

    void merge_piece(StateReader& state) override
    {
        std::vector<int64_t> slabs(2);
        state.take_all(slabs);
        if (slabs[0] < 0 || slabs[0] > slabs[1] || (slabs[1] - 1) * IMPORT_CHUNK >= info_.size.z) state.refuse();
        slabs_ = {slabs[0], slabs[1]};
        tally_.merge(state, slices_of(0).lower, slices_of(0).upper);
        for (int level = 0; level <= std::min(IMPORT_REACH, pyramid_->levels() - 1); ++level)
            if (!pyramid_->include_ranges(level, state.take())) state.refuse();
        if (pyramid_->levels() > IMPORT_REACH) {
            const SlabRange slices = slices_of(IMPORT_REACH);
            if (!pyramid_->put_slices(IMPORT_REACH, slices.lower, slices.upper, state.take())) state.refuse();
        }
        if (hasher_) {
            std::vector<ChunkHasher::Digest> digests = hasher_->digests();
            const std::vector<ChunkHasher::Digest> added = state.take_list<ChunkHasher::Digest>();
            digests.insert(digests.end(), added.begin(), added.end());
            hasher_->restore(std::move(digests));
        }
        load_loose(state);
    }

    void finish_pieces() override
    {
        std::ranges::sort(loose_, {}, [](const LooseSlices& each) { return std::pair(each.level, each.lower); });
        for (size_t i = 0; i < loose_.size();) {
            const int level = loose_[i].level;
            const int64_t layer = loose_[i].lower / IMPORT_CHUNK;
            for (; i < loose_.size() && loose_[i].level == level && loose_[i].lower / IMPORT_CHUNK == layer; ++i)
                if (!pyramid_->put_slices(level, loose_[i].lower, loose_[i].upper, loose_[i].voxels))
                    fail("the pieces of an import do not fit together; expected those of one job");
            write_layer(level, layer);
            pyramid_->clear_layer(level);
        }
        finish_levels();
    }

private:
    Size3 counts(int level) const { return chunks_.counts(level); }

    Preparation::Slab slab_of(int64_t step) const
    {
        const int64_t z = step / bands_ * IMPORT_CHUNK;
        const int64_t y = step % bands_ * rows_;
        return {z, std::min(info_.size.z, z + IMPORT_CHUNK), y, std::min(info_.size.y, y + rows_)};
    }

    void read(const Preparation::Slab& slab, size_t place)
    {
        const int64_t voxels = info_.size.x * (slab.upper_row - slab.lower_row) * (slab.upper - slab.lower);
        buffers_[place].resize(size_t(voxels) * bytes_of(info_.type));
        preparation_.read(slab, buffers_[place], pool_);
    }

    /// Starts the tasks for a slab: writing chunks and levels, and hashing and counting its slices.
    std::shared_ptr<WorkPool::Batch> start(const Preparation::Slab& slab, size_t place)
    {
        const std::byte* const voxels = buffers_[place].data();
        const size_t row_bytes = size_t(info_.size.x) * bytes_of(info_.type);
        const size_t slice_bytes = row_bytes * size_t(slab.upper_row - slab.lower_row);
        const int64_t along_x = counts(0).x;
        const int64_t along_y = (slab.upper_row - slab.lower_row + IMPORT_CHUNK - 1) / IMPORT_CHUNK;
        const int64_t chunks = along_x * along_y;
        const auto run = [=, this](int64_t task, int worker) {
            if (task >= chunks) {
                const auto slice = size_t(task - chunks);
                tally_.add(slab.lower + task - chunks, Bytes(voxels + slice * slice_bytes, slice_bytes), worker);
                return;
            }
            const Size3 chunk{task % along_x, slab.lower_row / IMPORT_CHUNK + task / along_x,
                              slab.lower / IMPORT_CHUNK};
            const Size3 origin = chunk * IMPORT_CHUNK;
            const size_t first =
                size_t(origin.y - slab.lower_row) * row_bytes + size_t(origin.x) * bytes_of(info_.type);
            const ImportPyramid::Chunk taken{.origin = origin,
                                             .extent = glm::min(Size3(IMPORT_CHUNK), info_.size - origin),
                                             .voxels = voxels + first,
                                             .row_bytes = row_bytes,
                                             .slice_bytes = slice_bytes};
            if (hasher_) hasher_->add(chunk, taken.voxels, row_bytes, slice_bytes);
            chunks_.write(0, chunk, pyramid_->add(taken, worker), worker);
            ++done_;
        };
        return pool_.start(chunks + slab.upper - slab.lower, run);
    }

    void finish_slab(int64_t slab)
    {
        const int64_t slices = std::min(info_.size.z, (slab + 1) * IMPORT_CHUNK);
        tally_.finish(slab * IMPORT_CHUNK, slices);
        for (int level = 1; level < pyramid_->levels(); ++level) {
            if (!pyramid_->completes_layer(level, slices)) continue;
            const int64_t layer = (size_of_level(Size3(slices), level).z - 1) / IMPORT_CHUNK;
            if (layer << level >= slabs_.lower)
                write_layer(level, layer);
            else  // another process has the layer's first slices
                keep_slices(level, layer, slices);
            pyramid_->clear_layer(level);
        }
        slabs_done_ = slab + 1;
    }

    void write_layer(int level, int64_t layer)
    {
        const Size3 chunks = counts(level);
        pool_.run(chunks.x * chunks.y, [&](int64_t task, int worker) {
            const Size3 chunk{task % chunks.x, task / chunks.x, layer};
            chunks_.write(level, chunk, pyramid_->gather(level, chunk, worker), worker);
        });
    }

    // ---- Layers of coarser levels whose slices several processes make ----

    struct LooseSlices {
        int level = 0;
        int64_t lower = 0, upper = 0;  ///< slices of the level
        std::vector<std::byte> voxels;
    };

    /// Slices of a level that this pass makes.
    SlabRange slices_of(int level) const
    {
        if (slabs_.lower == slabs_.upper) return {0, 0};
        const int64_t slices = std::min(slabs_.upper * IMPORT_CHUNK, info_.size.z);
        return {slabs_.lower * IMPORT_CHUNK >> level, size_of_level(Size3(slices), level).z};
    }

    /// Keeps a layer's slices up to slice `slices` of level 0.
    void keep_slices(int level, int64_t layer, int64_t slices)
    {
        const int64_t lower = std::max(layer * IMPORT_CHUNK, slabs_.lower * IMPORT_CHUNK >> level);
        const int64_t upper = size_of_level(Size3(slices), level).z;
        loose_.push_back({level, lower, upper, pyramid_->slices(level, lower, upper)});
    }

    /// Keeps the slices of layers that are not complete at the end of the pass.
    void keep_last_slices()
    {
        const int64_t slices = std::min(slabs_.upper * IMPORT_CHUNK, info_.size.z);
        for (int level = 1; level < std::min(IMPORT_REACH, pyramid_->levels()); ++level)
            if (slabs_.lower < slabs_.upper && !pyramid_->completes_layer(level, slices))
                keep_slices(level, (size_of_level(Size3(slices), level).z - 1) / IMPORT_CHUNK, slices);
    }

    void save_loose(StateWriter& state) const
    {
        state.put_all(std::vector<int64_t>{int64_t(loose_.size())});
        for (const LooseSlices& each : loose_) {
            state.put_all(std::vector<int64_t>{each.level, each.lower, each.upper});
            state.put(each.voxels);
        }
    }

    void load_loose(StateReader& state)
    {
        std::vector<int64_t> count(1), place(3);
        state.take_all(count);
        for (int64_t i = 0; i < count[0]; ++i) {
            state.take_all(place);
            if (place[0] < 1 || place[0] >= std::min(IMPORT_REACH, pyramid_->levels()) || place[1] >= place[2])
                state.refuse();
            const std::span<const std::byte> voxels = state.take();
            loose_.push_back({int(place[0]), place[1], place[2], {voxels.begin(), voxels.end()}});
        }
    }

    /// Returns the range, as bytes, of a brick whose voxels all have the fill value.
    std::vector<std::byte> range_of_fill() const
    {
        std::vector<std::byte> range(2 * bytes_of(info_.type));
        with_voxel_type(info_.type, [&]<class T>(T) {
            const ImportRange<T> of_fill = range_of_voxel<T>(fill_);
            std::memcpy(range.data(), &of_fill, sizeof(of_fill));
        });
        return range;
    }

    Preparation& preparation_;
    const VolumeInfo& info_;
    FillVoxel fill_;
    ImportChunks& chunks_;
    WorkPool& pool_;
    std::unique_ptr<ImportPyramid> pyramid_;
    ImportTally tally_;
    std::optional<ChunkHasher> hasher_;  ///< for volumes whose hash may be a hash in chunks
    int64_t rows_;                       ///< rows of a slab that are in memory at once
    int64_t bands_;
    SlabRange slabs_;
    bool is_part_;  ///< whether other processes make the other slabs
    int64_t slabs_done_ = 0;
    std::vector<LooseSlices> loose_;
    std::atomic<int64_t> done_ = 0;
    std::array<std::vector<std::byte>, 2> buffers_;
};

}  // namespace

SlabRange slabs_of(const TaskChoice& task, const Size3& size)
{
    const int64_t slabs = (size.z + IMPORT_CHUNK - 1) / IMPORT_CHUNK;
    int64_t unit = 1;
    while (unit < int64_t{1} << (IMPORT_REACH - 1) && slabs / (2 * unit) >= 4 * task.of) unit *= 2;
    const TaskChoice::Range range = task.range_of((slabs + unit - 1) / unit);
    return {std::min(range.lower * unit, slabs), std::min(range.upper * unit, slabs)};
}

std::unique_ptr<ImportPass> make_dense_pass(Preparation& preparation, const ImportSetup& setup)
{
    return std::make_unique<DensePass>(preparation, setup);
}

}  // namespace shvr
