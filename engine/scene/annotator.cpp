#include "engine/scene/annotator.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <utility>

#include "engine/annotation/mask_file.h"
#include "engine/annotation/mask_image.h"
#include "engine/passes/paint.h"

namespace shvr {

namespace {

/// Regions of one frame: as many as keep the labels of all of them below this, and no more than that many, since each
/// has buffers of its own.
constexpr uint64_t LABEL_BYTES = uint64_t(32) << 20;
constexpr size_t MOST_REGIONS = 64;
/// Bricks of a frame's regions together, unless one region needs more.
constexpr uint32_t MOST_BRICKS = 48;

Size3 voxel_at(const glm::dvec3& position)
{
    return Size3(glm::floor(position));
}

bool is_inside(const Size3& voxel, const Size3& size)
{
    return glm::all(glm::greaterThanEqual(voxel, Size3(0))) && glm::all(glm::lessThan(voxel, size));
}

gpu::RegionParams region_params(const BrushRegion& region, const PaintOp& op, uint32_t threshold_code,
                                const Size3& seed)
{
    const Size3 at = seed - region.box.lower;
    const auto words = uint32_t(region.words_per_row());
    const Size3 size = region.box.size();
    const bool seeded = op.brush == Brush::flood && is_inside(at, size) && region.contains(seed);
    return {.origin = glm::uvec3(region.box.lower),
            .size = glm::uvec3(size),
            .words_per_row = words,
            .threshold_code = threshold_code,
            .connectivity = uint32_t(op.connectivity),
            .seed = seeded ? uint32_t(at.x + 32 * words * (at.y + size.y * at.z)) : gpu::NO_SEED};
}

Resource add_brush(FrameGraph& graph, const VolumeBinding& volume, Brush brush, const RegionInput& input)
{
    switch (brush) {
        case Brush::fill: return select_fill(graph, volume, input);
        case Brush::flood: return select_flood(graph, volume, input);
        case Brush::speckle: return select_speckles(graph, volume, input);
    }
    SHVR_CHECK(false, "brush ", int(brush));
}

const char* name_of(Brush brush)
{
    return brush == Brush::fill ? "fill" : brush == Brush::flood ? "flood fill" : "speckle fill";
}

std::string label_of(const PaintOp& op)
{
    return sentence(name_of(op.brush), ", group ", int(op.group));
}

std::vector<int64_t> bricks_of(std::span<const Change> changes)
{
    std::vector<int64_t> bricks;
    for (const Change& change : changes)
        if (const auto* mask = std::get_if<MaskBrickChange>(&change)) bricks.push_back(mask->brick);
    return bricks;
}

int64_t voxels_of(std::span<const Change> changes)
{
    int64_t voxels = 0;
    for (const Change& change : changes) voxels += std::get<MaskBrickChange>(change).voxels();
    return voxels;
}

void add_answers(VoxelSelection& selection, std::span<const BrushRegion> regions, std::span<const uint32_t> read_backs,
                 const gpu::FrameResult& result)
{
    for (size_t i = 0; i < regions.size(); ++i) {
        const std::vector<std::byte>& bytes = result.read_backs[read_backs[i]];
        std::vector<uint32_t> words(bytes.size() / sizeof(uint32_t));
        std::memcpy(words.data(), bytes.data(), bytes.size());
        selection.add(regions[i], words);
    }
}

}  // namespace

Annotator::Annotator(Renderer& renderer) : renderer_(renderer), document_{Mask(renderer.volume().info().size)} {}

std::optional<Annotator::Batch> Annotator::make_batch(const PaintOp& op, std::span<const glm::dvec3> positions,
                                                      size_t& next, bool wait)
{
    DeviceVolume& volume = renderer_.volume();
    const VolumeInfo& info = volume.info();
    const uint32_t threshold_code = volume.window().threshold_code(op.threshold);
    Batch batch;
    std::vector<gpu::RegionParams> params;
    VoxelBox around;
    uint64_t labels = 0;
    size_t end = next;
    for (; end < positions.size() && labels < LABEL_BYTES && batch.regions.size() < MOST_REGIONS; ++end) {
        BrushRegion region = make_region(op.region, positions[end], op.radius_voxels, info.spacing, info.size);
        if (region.rows.empty() || region.words_per_row() == 0) continue;
        const VoxelBox both = batch.regions.empty() ? region.box
                                                    : VoxelBox{glm::min(around.lower, region.box.lower),
                                                               glm::max(around.upper, region.box.upper)};
        // All of them look into the same bricks, so those must find room at once.
        const glm::uvec3 bricks = bricks_around(both).counts;
        if (!batch.regions.empty() && both != around && bricks.x * bricks.y * bricks.z > MOST_BRICKS) break;
        around = both;
        labels += uint64_t(region.words_per_row()) * 32 * region.rows.size() * sizeof(uint32_t);
        params.push_back(region_params(region, op, threshold_code, voxel_at(positions[end])));
        batch.regions.push_back(std::move(region));
    }
    if (!batch.regions.empty()) {
        const std::optional<RegionBricks> bricks = volume.region(around, wait);
        if (!bricks) return std::nullopt;
        const VolumeBinding atlas = volume.atlas(batch.graph);
        for (size_t i = 0; i < batch.regions.size(); ++i)
            batch.read_backs.push_back(batch.graph.read_back(
                add_brush(batch.graph, atlas, op.brush, {params[i], *bricks, batch.regions[i].rows})));
    }
    next = end;
    return batch;
}

VoxelSelection Annotator::select(const PaintOp& op)
{
    const std::vector<glm::dvec3> positions = stroke_positions(op.path);
    VoxelSelection selection(renderer_.volume().info().size);
    for (size_t next = 0; next < positions.size();) {
        Batch batch = make_batch(op, positions, next, true).value();
        if (batch.regions.empty()) break;
        add_answers(selection, batch.regions, batch.read_backs,
                    renderer_.executor().run(std::move(batch.graph), {.timestamps = false}));
    }
    return selection;
}

int64_t Annotator::paint(const PaintOp& op)
{
    SHVR_CHECK(!stroke_);
    Command command{label_of(op), paint_changes(document_.mask, select(op), op.group)};
    const int64_t voxels = voxels_of(command.changes);
    const std::vector<int64_t> bricks = bricks_of(command.changes);
    history_.perform(document_, std::move(command));
    renderer_.update_mask(document_.mask, bricks);
    return voxels;
}

void Annotator::begin_stroke(const PaintOp& brush)
{
    SHVR_CHECK(!stroke_);
    stroke_.emplace();
    stroke_->brush = brush;
}

void Annotator::extend_stroke(const glm::dvec3& voxel)
{
    SHVR_CHECK(stroke_ && !stroke_->has_ended);
    if (stroke_->last == voxel) return;
    const glm::dvec3 from = stroke_->last.value_or(voxel);
    const std::vector<glm::dvec3> way = stroke_positions(std::array{from, voxel});
    // The way's first position is the last one's end. A dab is a way from a point to itself: two positions, one kept.
    stroke_->waiting.insert(stroke_->waiting.end(), way.begin() + 1, way.end());
    stroke_->last = voxel;
}

void Annotator::end_stroke()
{
    SHVR_CHECK(stroke_);
    stroke_->has_ended = true;
}

std::optional<VoxelBox> Annotator::advance()
{
    if (!stroke_) return std::nullopt;
    Stroke& stroke = *stroke_;
    std::optional<VoxelBox> changed;
    if (stroke.answer) {
        if (!stroke.answer.done()) return std::nullopt;
        changed = paint_answer();
    }
    if (stroke.next < stroke.waiting.size()) {
        std::optional<Batch> batch = make_batch(stroke.brush, stroke.waiting, stroke.next, false);
        if (!batch) return changed;  // its bricks are on their way
        stroke.asked = std::move(batch->regions);
        stroke.read_backs = std::move(batch->read_backs);
        if (!stroke.asked.empty())
            stroke.answer = renderer_.executor().submit(std::move(batch->graph), {.timestamps = false});
    } else if (stroke.has_ended) {
        last_stroke_voxels_ = stroke.voxels;
        stroke_.reset();
    }
    return changed;
}

std::optional<VoxelBox> Annotator::paint_answer()
{
    Stroke& stroke = *stroke_;
    VoxelSelection selection(document_.mask.size());
    add_answers(selection, stroke.asked, stroke.read_backs, stroke.answer.finish());
    std::vector<Change> changes = paint_changes(document_.mask, selection, stroke.brush.group);
    if (changes.empty()) return std::nullopt;
    stroke.voxels += voxels_of(changes);
    const std::vector<int64_t> bricks = bricks_of(changes);
    if (std::exchange(stroke.is_recorded, true))
        history_.extend(document_, std::move(changes));
    else
        history_.perform(document_, {label_of(stroke.brush), std::move(changes)});
    renderer_.update_mask(document_.mask, bricks);
    VoxelBox box = stroke.asked.front().box;
    for (const BrushRegion& region : stroke.asked)
        box = {glm::min(box.lower, region.box.lower), glm::max(box.upper, region.box.upper)};
    return box;
}

void Annotator::bring_to_device(const Command& command)
{
    renderer_.update_mask(document_.mask, bricks_of(command.changes));
}

const Command* Annotator::undo()
{
    const Command* command = stroke_ ? nullptr : history_.undo(document_);
    if (command) bring_to_device(*command);
    return command;
}

const Command* Annotator::redo()
{
    const Command* command = stroke_ ? nullptr : history_.redo(document_);
    if (command) bring_to_device(*command);
    return command;
}

VoxelBox Annotator::reach_of(const Command& command) const
{
    const Size3 counts = document_.mask.brick_counts(), size = document_.mask.size();
    VoxelBox box{size, Size3(0)};
    for (const int64_t brick : bricks_of(command.changes)) {
        const Size3 first = int64_t(gpu::BRICK_SIZE) *
                            Size3(brick % counts.x, brick / counts.x % counts.y, brick / (counts.x * counts.y));
        box = {glm::min(box.lower, first), glm::max(box.upper, glm::min(first + int64_t(gpu::BRICK_SIZE), size))};
    }
    return box;
}

void Annotator::load(const std::filesystem::path& mask_file, const std::string& volume_hash)
{
    check_mask_image(mask_file, volume_hash);
    std::vector<int64_t> bricks;
    for (const MaskBrickChange& change : load_mask(mask_file, document_.mask.size())) {
        document_.mask.apply(change, Direction::forwards);
        bricks.push_back(change.brick);
    }
    renderer_.update_mask(document_.mask, bricks);
}

void Annotator::save(const std::filesystem::path& mask_file, const std::string& volume_hash) const
{
    save_mask(mask_file, document_.mask);
    save_mask_image(mask_file, volume_hash);
}

}  // namespace shvr
