#include "engine/device/resident_volume.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstring>
#include <deque>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>

#include "engine/base/waits/waits.h"
#include "engine/volume/grid.h"

namespace shvr {

/// Encodes bricks in index order on a background thread, and passes batches to the uploading thread in a short queue.
class ResidentVolume::Builder {
public:
    struct Brick {
        glm::uvec3 place{0};
        BrickTexels texels;
    };
    using Batch = std::vector<Brick>;

    Builder(std::shared_ptr<const VolumeSource> source, const IntensityWindow& window, int threads)
        : source_(std::move(source))
    {
        thread_ = std::jthread([this, window, threads] { build(window, threads); });
    }
    ~Builder()
    {
        {
            const std::scoped_lock lock(mutex_);
            is_stopped_ = true;
        }
        changed_.notify_all();
    }
    Builder(const Builder&) = delete;

    /// The next batch; empty if none is ready. Rethrows the builder thread's exceptions.
    Batch take()
    {
        const std::scoped_lock lock(mutex_);
        if (ready_.empty()) {
            if (failure_) std::rethrow_exception(failure_);
            return {};
        }
        Batch batch = std::move(ready_.front());
        ready_.pop_front();
        changed_.notify_all();
        return batch;
    }

private:
    static constexpr size_t MAX_READY = 8;  // batches: 20 MiB
    struct Abandoned {};

    void build(const IntensityWindow& window, int threads)
    {
        const WaitsUntil waits([this] { return is_stopped_.load(); });
        Batch batch;
        try {
            build_bricks(*source_, window, threads, [&](const glm::ivec3& brick, const BrickTexels& texels) {
                batch.push_back({glm::uvec3(brick), texels});
                if (batch.size() == BrickUploads::BATCH) hand_on(std::exchange(batch, {}));
            });
            if (!batch.empty()) hand_on(std::move(batch));
        } catch (const Abandoned&) {
        } catch (...) {
            const std::scoped_lock lock(mutex_);
            failure_ = std::current_exception();
        }
    }
    void hand_on(Batch batch)
    {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [&] { return is_stopped_ || ready_.size() < MAX_READY; });
        if (is_stopped_) throw Abandoned();
        ready_.push_back(std::move(batch));
    }

    std::shared_ptr<const VolumeSource> source_;
    std::mutex mutex_;
    std::condition_variable changed_;
    std::deque<Batch> ready_;
    std::exception_ptr failure_;
    std::atomic<bool> is_stopped_ = false;  ///< set under the mutex
    std::jthread thread_;  ///< declared last, so the thread ends before the members it uses are destroyed
};

ResidentVolume::ResidentVolume(gpu::Executor& executor, gpu::Memory& memory, std::shared_ptr<const VolumeSource> source,
                               const IntensityWindow& window, AtlasCodes codes, int threads, const Progress& progress)
    : DeviceVolume(source->info(), window),
      executor_(executor),
      memory_(memory),
      source_(std::move(source)),
      codes_(codes),
      brick_counts_(brick_counts(info().size))
{
    create_images();
    const uint64_t bricks = brick_count();
    uploads_.emplace(executor, memory, bricks, codes);
    build_bricks(*source_, window, threads, [&](const glm::ivec3& brick, const BrickTexels& texels) {
        slots_.push_back(slot_at(uint32_t(slots_.size()) + 1, atlas_slots_));
        upload(texels, glm::uvec3(brick));
        ranges_.push_back(texels.range);
        if (slots_.size() % BrickUploads::BATCH == 0) tell(progress, double(slots_.size()) / double(bricks));
    });
    upload_page_table();
}

ResidentVolume::ResidentVolume(gpu::Executor& executor, gpu::Memory& memory, std::shared_ptr<const VolumeSource> source,
                               const IntensityWindow& window, AtlasCodes codes, int threads, InSlices)
    : DeviceVolume(source->info(), window),
      executor_(executor),
      memory_(memory),
      source_(std::move(source)),
      codes_(codes),
      brick_counts_(brick_counts(info().size))
{
    create_images();
    builder_ = std::make_unique<Builder>(source_, window, threads);
}

ResidentVolume::~ResidentVolume() = default;

/// Null if no atlas has enough slots.
std::optional<ResidentVolume::Shape> ResidentVolume::shape_of(const gpu::Memory& memory, const glm::uvec3& brick_counts,
                                                              AtlasCodes codes)
{
    const gpu::DeviceTraits& traits = memory.traits();
    const uint64_t bricks = uint64_t(brick_counts.x) * brick_counts.y * brick_counts.z;
    // Slot 0 stays unused, since 0 in the page table stands for a missing brick.
    const uint32_t max_side = traits.limits.maxImageDimension3D;
    if (bricks + 1 > max_atlas_slots(gpu::BRICK_TEXELS, max_side)) return std::nullopt;
    const glm::uvec3 slots = atlas_layout(bricks + 1, gpu::BRICK_TEXELS, max_side, traits.is_cpu);
    const glm::uvec3 of_codes = codes_side_by_side(brick_counts);
    const uint64_t bytes = uint64_t{of_codes.x} * of_codes.y * of_codes.z * code_bytes(codes);
    return Shape{.atlas_slots = slots,
                 .atlas = atlas_desc(codes, of_codes, is_by_address(traits, codes, bytes)),
                 .page_table = buffer_desc(bricks * sizeof(uint32_t)),
                 .cells = image_desc(Format::r32_uint, brick_counts * gpu::BRICK_CELLS)};
}

bool ResidentVolume::is_possible(const gpu::Memory& memory, const VolumeInfo& info, AtlasCodes codes)
{
    const std::optional<Shape> shape = shape_of(memory, glm::uvec3(shvr::brick_counts(info.size)), codes);
    return shape && memory.can_create(shape->atlas) && memory.can_create(shape->page_table) &&
           memory.can_create(shape->cells);
}

void ResidentVolume::create_images()
{
    cell_counts_ = brick_counts_ * gpu::BRICK_CELLS;
    const std::optional<Shape> shape = shape_of(memory_, brick_counts_, codes_);
    if (!shape)
        fail(info().name, ": the volume has ", brick_count(), " bricks, more than an image of the device holds; ",
             "expected render.paging automatic");
    atlas_slots_ = shape->atlas_slots;
    const auto create = [&](const char* name, const ResourceDesc& desc) {
        return memory_.create(name, desc, gpu::Placement::device, "the volume");
    };
    atlas_ = create("atlas", shape->atlas);
    page_table_ = create("page table", shape->page_table);
    cell_ranges_ = create("cell ranges", shape->cells);
    leap_ = create("leap grid", shape->cells);
    const ResourceDesc bits = image_desc(Format::r32_uint, shape->cells.texels * glm::uvec3(1, 1, 2));
    const glm::uvec3 most = gpu::SAMPLE_BITS_SIZE * glm::uvec3(16, 4, 1);
    if (codes_ != AtlasCodes::filtered && glm::all(glm::lessThanEqual(glm::uvec3(info().size), most)) &&
        memory_.can_create(bits))
        sample_bits_ = create("sample bits", bits);
    const glm::uvec3 words = shape->cells.texels / glm::uvec3(gpu::LEAP_WORD_CELLS, 1, 1);
    for (gpu::Storage& scratch : leap_scratch_) scratch = create("leap scratch", image_desc(Format::r32_uint, words));
}

/// A brick at a face of the volume also fills the part of the atlas's border next to that face.
void ResidentVolume::upload(const BrickTexels& texels, const glm::uvec3& brick)
{
    const glm::uvec3 border = gpu::code_border(), none(0);
    const glm::uvec3 before = glm::mix(none, border, glm::equal(brick, none));
    const glm::uvec3 behind = glm::mix(none, border, glm::equal(brick + 1u, brick_counts_));
    uploads_->stage({.codes = &atlas_,
                     .code = border + gpu::BRICK_SIZE * brick - before,
                     .begin = -glm::ivec3(before),
                     .end = glm::ivec3(gpu::BRICK_SIZE + behind),
                     .cells = &cell_ranges_,
                     .cell = gpu::BRICK_CELLS * brick},
                    texels);
}

/// To be called once all bricks are staged.
void ResidentVolume::upload_page_table()
{
    uploads_->flush();
    uploads_->finish();
    uploads_.reset();
    gpu::Storage staging = memory_.create("staging", page_table_.desc(), gpu::Placement::upload);
    std::memcpy(staging.mapped().data(), slots_.data(), staging.mapped().size());
    slots_ = {};
    FrameGraph graph;
    static_cast<void>(graph.copy(graph.import("staging", staging.import()),
                                 graph.import("page table", page_table_.import()), {{0, 0, page_table_.desc().bytes}},
                                 "upload page table"));
    executor_.run(graph, {.timestamps = false});
}

bool ResidentVolume::load_on(double seconds)
{
    using Clock = std::chrono::steady_clock;
    const Clock::time_point end = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                                     std::chrono::duration<double>(std::max(seconds, 0.0)));
    while (builder_) {
        const Builder::Batch batch = builder_->take();
        if (batch.empty()) return false;
        if (!uploads_) uploads_.emplace(executor_, memory_, brick_count(), codes_);
        for (const Builder::Brick& brick : batch) {
            slots_.push_back(slot_at(uint32_t(slots_.size()) + 1, atlas_slots_));
            upload(brick.texels, brick.place);
            ranges_.push_back(brick.texels.range);
        }
        if (slots_.size() == brick_count()) {
            upload_page_table();
            builder_.reset();
        } else if (Clock::now() >= end) {
            return false;
        }
    }
    return true;
}

double ResidentVolume::loaded() const
{
    return builder_ ? double(slots_.size()) / double(brick_count()) : 1.0;
}

uint64_t ResidentVolume::bytes_for(const VolumeInfo& info, AtlasCodes codes)
{
    const glm::u64vec3 counts(brick_counts(info.size)), of_codes(codes_side_by_side(glm::uvec3(counts)));
    // Besides ranges: the grid, the sample bits, which count twice, and two scratch images of a byte for each cell.
    constexpr uint64_t LEAP_BYTES = 3 * BrickTexels::RANGE_BYTES + 2 * BrickTexels::RANGE_BYTES / sizeof(uint32_t);
    return of_codes.x * of_codes.y * of_codes.z * code_bytes(codes) +
           counts.x * counts.y * counts.z * (BrickTexels::RANGE_BYTES + LEAP_BYTES + sizeof(uint32_t));
}

std::optional<RegionBricks> ResidentVolume::region(const VoxelBox& voxels, bool /*wait*/)
{
    RegionBricks region = bricks_around(voxels);
    for (uint32_t z = 0; z < region.counts.z; ++z)
        for (uint32_t y = 0; y < region.counts.y; ++y)
            for (uint32_t x = 0; x < region.counts.x; ++x)
                region.slots.push_back(
                    slot_at(gpu::grid_index(region.begin + glm::uvec3(x, y, z), brick_counts_) + 1, atlas_slots_));
    return region;
}

std::vector<DeviceVolume::Place> ResidentVolume::places() const
{
    std::vector<Place> places;
    for (uint32_t index = 0; index < ranges_.size(); ++index) {
        const glm::uvec3 brick(position_of(index, Size3(brick_counts_)));
        places.push_back({{0, glm::ivec3(brick)}, slot_at(index + 1, atlas_slots_), ranges_[index]});
    }
    return places;
}

// ---- Leaps over empty space -----------------------------------------------------------------------------------------

int ResidentVolume::look(const PageView& /*view*/, const Visibility& visibility)
{
    look_by(visibility);
    return 0;
}

void ResidentVolume::look_by(const Visibility& visibility)
{
    visibility_ = visibility;
    empty_space_.want(leap_input(std::nullopt), cell_counts_);
}

LeapGridInput ResidentVolume::leap_input(const std::optional<MaskBinding>& painted) const
{
    return {.params = {.brick_counts = brick_counts_,
                       .table_lower = visibility_.params.table_lower,
                       .table_upper = visibility_.params.table_upper,
                       .table_scale = visibility_.params.table_scale,
                       .table_entries = visibility_.params.table_entries,
                       .guard = visibility_.params.guard,
                       .skipping = visibility_.params.skipping,
                       .paint_reach = visibility_.params.paint_reach},
            .changed = {},
            .visible_intervals = visibility_.visible_intervals,
            .mask = painted,
            .visible_groups = visibility_.visible_groups};
}

std::optional<FrameGraph> ResidentVolume::next_preparation(const Visibility& visibility, const DeviceMask& mask)
{
    look_by(visibility);
    if (!empty_space_.is_due()) return std::nullopt;
    FrameGraph graph;
    VolumeBinding volume = import(graph);
    empty_space_.prepare(graph, volume, leap_input(mask.import(graph)));
    return graph;
}

std::optional<FrameGraph> ResidentVolume::next_refinement(const Visibility& visibility, const DeviceMask& mask)
{
    if (!refinement_is_due()) return std::nullopt;
    look_by(visibility);
    if (!refinement_is_due()) return std::nullopt;  // refinement starts only after prepare() has built the grid
    FrameGraph graph;
    VolumeBinding volume = import(graph);
    empty_space_.refine(graph, volume, leap_input(mask.import(graph)));
    return graph;
}

VolumeBinding ResidentVolume::prepare(FrameGraph& graph, const DeviceMask& /*mask*/,
                                      const std::optional<MaskBinding>& painted, bool /*feedback*/)
{
    VolumeBinding volume = import(graph);
    while (empty_space_.is_due()) empty_space_.prepare(graph, volume, leap_input(painted));
    return volume;
}

void ResidentVolume::note_painted(const Mask& mask, std::span<const int64_t> bricks)
{
    for (const int64_t brick : bricks) {
        const glm::uvec3 first = gpu::BRICK_CELLS * glm::uvec3(position_of(brick, mask.brick_counts()));
        const glm::uvec3 reach(visibility_.params.paint_reach);  // paint reaches at most one voxel, so it reaches at
                                                                 // most one cell
        empty_space_.changed(
            {first - glm::min(first, reach), glm::min(first + gpu::BRICK_CELLS + reach, cell_counts_)});
    }
}

// ---- Changed voxels -------------------------------------------------------------------------------------------------

void ResidentVolume::renew(std::span<const VoxelBox> changed)
{
    renew_bricks(bricks_that_see(changed, info().size, 0));
    for (const VoxelBox& box : changed) {
        // A cell's range covers its voxels and one voxel around them; cells beyond the volume's end use its last ones.
        const Size3 lower = glm::max(box.lower - int64_t{gpu::BRICK_APRON}, Size3(0)) / int64_t{gpu::CELL_SIZE};
        Size3 upper = (box.upper + int64_t{gpu::BRICK_APRON} - int64_t{1}) / int64_t{gpu::CELL_SIZE} + int64_t{1};
        for (int axis = 0; axis < 3; ++axis)
            if (box.upper[axis] >= info().size[axis]) upper[axis] = cell_counts_[axis];
        empty_space_.changed({glm::uvec3(lower), glm::min(glm::uvec3(upper), cell_counts_)});
    }
}

void ResidentVolume::renew_bricks(std::span<const BrickKey> keys)
{
    if (uploads_ && (uploads_->is_idle() || uploads_->batch() < std::min(keys.size(), BrickUploads::BATCH))) {
        uploads_->finish();
        uploads_.reset();
    }
    if (keys.empty()) return;
    if (!uploads_) uploads_.emplace(executor_, memory_, keys.size(), codes_);
    BrickMaker maker(*source_, window());
    const auto texels = std::make_unique<BrickTexels>();
    for (const BrickKey& key : keys) {
        const glm::uvec3 brick(key.brick);
        const uint32_t index = gpu::grid_index(brick, brick_counts_);
        maker.make(key, *texels);
        upload(*texels, brick);
        ranges_[index] = texels->range;
    }
    uploads_->flush();
    ++places_revision_;
}

uint64_t ResidentVolume::brick_count() const
{
    return uint64_t(brick_counts_.x) * brick_counts_.y * brick_counts_.z;
}

VolumeBinding ResidentVolume::import(FrameGraph& graph) const
{
    return {.atlas = graph.import("atlas", atlas_.import()),
            .cell_ranges = graph.import("cell ranges", cell_ranges_.import()),
            .page_table = graph.import("page table", page_table_.import()),
            .leap = graph.import("leap grid", leap_.import()),
            .leap_scratch = {graph.import("leap scratch 0", leap_scratch_[0].import()),
                             graph.import("leap scratch 1", leap_scratch_[1].import())},
            .sample_bits = sample_bits_ && visibility_.params.skipping != 0
                               ? std::optional(graph.import("sample bits", sample_bits_.import()))
                               : std::nullopt,
            .brick_counts = brick_counts_,
            .cell_counts = cell_counts_,
            .codes = codes_,
            .by_address = atlas_.desc().by_address};
}

}  // namespace shvr
