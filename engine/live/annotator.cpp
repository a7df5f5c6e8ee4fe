#include "engine/live/annotator.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <utility>

#include "engine/passes/paint.h"
#include "engine/volume/grid.h"

namespace shvr {

namespace {

/// Regions of one frame: as many as keep the labels of all of them below this, and no more than that many, since each
/// has buffers of its own.
constexpr uint64_t LABEL_BYTES = uint64_t(32) << 20;
constexpr size_t MOST_REGIONS = 64;
/// Bricks of a frame's regions together, unless one region needs more.
constexpr uint32_t MOST_BRICKS = 48;

/// Voxels around a raised one that may look different: its samples, and theirs for gradients.
constexpr int64_t RAISED_REACH = 2;

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

/// Group 0 takes offsets away, whatever is painted otherwise.
bool resets(const PaintOp& op)
{
    return op.paints_group && op.group == 0;
}

const char* name_of(Brush brush)
{
    return brush == Brush::fill ? "fill" : brush == Brush::flood ? "flood fill" : "speckle fill";
}

std::string label_of(const PaintOp& op)
{
    const std::string brush = name_of(op.brush);
    if (!op.density) return sentence(brush, ", group ", int(op.group));
    const double offset = resets(op) ? 0.0 : *op.density->offset;
    const std::string density = offset == 0.0 ? "density reset" : sentence("density ", offset > 0.0 ? "+" : "", offset);
    return op.paints_group ? sentence(brush, ", group ", int(op.group), ", ", density) : sentence(brush, ", ", density);
}

int64_t voxels_of(std::span<const Change> changes)
{
    int64_t voxels = 0;
    for (const Change& change : changes) {
        if (const auto* mask = std::get_if<MaskBrickChange>(&change)) voxels += mask->voxels();
        if (const auto* density = std::get_if<DensityBrickChange>(&change)) voxels += density->voxels();
    }
    return voxels;
}

}  // namespace

PaintOp with_offset(PaintOp op, const TransferFunction& function)
{
    if (op.density && !op.density->offset) op.density->offset = automatic_offset(function.lower(), op.threshold);
    return op;
}

WorkFiles work_files(const Session& session, const VolumeInfo& volume)
{
    return {.journal = session.journal_path,
            .mask = session.mask_path,
            .trace = session.trace_path,
            .density = session.density_path,
            .volume_hash = session.volume_hash,
            .volume = volume};
}

Annotator::Annotator(Renderer& renderer)
    : renderer_(renderer), work_(renderer.volume().info().size, renderer.volume().info().type)
{}

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
        batch.regions.push_back({.region = std::move(region), .centre_voxel = positions[end]});
    }
    if (!batch.regions.empty()) {
        const std::optional<RegionBricks> bricks = volume.region(around, wait);
        if (!bricks) return std::nullopt;
        const VolumeBinding atlas = volume.atlas(batch.graph);
        for (size_t i = 0; i < batch.regions.size(); ++i)
            batch.regions[i].read_back = batch.graph.read_back(
                add_brush(batch.graph, atlas, op.brush, {params[i], *bricks, batch.regions[i].region.rows}));
    }
    next = end;
    return batch;
}

Annotator::Answered Annotator::nothing_yet(const PaintOp& op) const
{
    const VolumeInfo& info = renderer_.volume().info();
    Answered answered{.selection = VoxelSelection(info.size), .density = std::nullopt};
    if (!op.density) return answered;
    SHVR_CHECK(op.density->offset || resets(op), "an offset that nobody has chosen");
    if (resets(op))
        answered.density.emplace(info.size, info.spacing, info.type, 0.0, Falloff::flat);
    else
        answered.density.emplace(info.size, info.spacing, info.type, *op.density->offset, op.density->falloff);
    return answered;
}

void Annotator::add(Answered& answered, const PaintOp& op, std::span<const Asked> asked, const gpu::FrameResult& result)
{
    for (const Asked& one : asked) {
        const std::vector<std::byte>& bytes = result.read_backs[one.read_back];
        std::vector<uint32_t> words(bytes.size() / sizeof(uint32_t));
        std::memcpy(words.data(), bytes.data(), bytes.size());
        answered.selection.add(one.region, words);
        if (answered.density) answered.density->add(one.region, words, one.centre_voxel, op.radius_voxels);
    }
}

Annotator::Answered Annotator::ask(const PaintOp& op)
{
    const std::vector<glm::dvec3> positions = stroke_positions(op.path);
    Answered answered = nothing_yet(op);
    for (size_t next = 0; next < positions.size();) {
        Batch batch = make_batch(op, positions, next, true).value();
        if (batch.regions.empty()) break;
        add(answered, op, batch.regions, renderer_.executor().run(std::move(batch.graph), {.timestamps = false}));
    }
    return answered;
}

std::vector<Change> Annotator::changes_of(const PaintOp& op, const Answered& answered) const
{
    std::vector<Change> changes;
    if (op.paints_group) changes = as_changes(paint_changes(document().mask, answered.selection, op.group));
    if (answered.density)
        for (DensityBrickChange& change : answered.density->changes(document().density))
            changes.emplace_back(std::move(change));
    return changes;
}

VoxelSelection Annotator::select(const PaintOp& op)
{
    PaintOp groups_alone = op;
    groups_alone.density.reset();
    return ask(groups_alone).selection;
}

int64_t Annotator::paint(const PaintOp& op)
{
    SHVR_CHECK(!stroke_);
    Command command{label_of(op), changes_of(op, ask(op))};
    const int64_t voxels = voxels_of(command.changes);
    const Touched touched = touched_by(command.changes);
    work_.perform(std::move(command));
    bring_to_device(touched);
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

void Annotator::drop_stroke()
{
    if (stroke_) last_stroke_voxels_ = stroke_->voxels;
    stroke_.reset();
}

std::optional<VoxelBox> Annotator::advance()
{
    if (!stroke_) return std::nullopt;
    try {
        return advance_stroke();
    } catch (const Error&) {
        drop_stroke();  // what cannot be kept is not painted, nor is the rest
        throw;
    }
}

std::optional<VoxelBox> Annotator::advance_stroke()
{
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
    Answered answered = nothing_yet(stroke.brush);
    add(answered, stroke.brush, stroke.asked, stroke.answer.finish());
    std::vector<Change> changes = changes_of(stroke.brush, answered);
    if (changes.empty()) return std::nullopt;
    stroke.voxels += voxels_of(changes);
    const Touched touched = touched_by(changes);
    if (std::exchange(stroke.is_recorded, true))
        work_.extend(std::move(changes));
    else
        work_.perform({label_of(stroke.brush), std::move(changes)});
    bring_to_device(touched);
    VoxelBox box = stroke.asked.front().region.box;
    for (const Asked& asked : stroke.asked)
        box = {glm::min(box.lower, asked.region.box.lower), glm::max(box.upper, asked.region.box.upper)};
    if (touched.raised.empty()) return box;
    return VoxelBox{glm::max(box.lower - RAISED_REACH, Size3(0)),
                    glm::min(box.upper + RAISED_REACH, document().mask.size())};
}

Annotator::Touched Annotator::touched_by(std::span<const Change> changes) const
{
    Touched touched;
    for (const Change& change : changes) {
        if (const auto* mask = std::get_if<MaskBrickChange>(&change)) touched.painted_bricks.push_back(mask->brick);
        if (const auto* density = std::get_if<DensityBrickChange>(&change))
            touched.raised.push_back(document().density.reach_of(*density));
    }
    return touched;
}

void Annotator::bring_to_device(const Touched& touched)
{
    revision_ += !touched.painted_bricks.empty() || !touched.raised.empty();
    if (!touched.painted_bricks.empty()) renderer_.update_mask(document().mask, touched.painted_bricks);
    if (!touched.raised.empty()) renderer_.update_density(document().density, touched.raised);
}

void Annotator::edit_trace(std::string label, std::vector<TraceChange> changes)
{
    SHVR_CHECK(!stroke_);
    Command command{std::move(label), {}};
    for (TraceChange& change : changes) command.changes.emplace_back(std::move(change));
    work_.perform(std::move(command));
}

const Command* Annotator::undo()
{
    const Command* command = stroke_ ? nullptr : work_.undo();
    if (command) bring_to_device(touched_by(command->changes));
    return command;
}

const Command* Annotator::redo()
{
    const Command* command = stroke_ ? nullptr : work_.redo();
    if (command) bring_to_device(touched_by(command->changes));
    return command;
}

VoxelBox Annotator::reach_of(const Command& command) const
{
    const Size3 counts = document().mask.brick_counts(), size = document().mask.size();
    const Touched touched = touched_by(command.changes);
    if (touched.painted_bricks.empty() && touched.raised.empty()) return {};
    VoxelBox box{size, Size3(0)};
    const auto include = [&](const VoxelBox& more) {
        box = {glm::min(box.lower, more.lower), glm::max(box.upper, more.upper)};
    };
    for (const VoxelBox& raised : touched.raised)
        include({glm::max(raised.lower - RAISED_REACH, Size3(0)), glm::min(raised.upper + RAISED_REACH, size)});
    for (const int64_t brick : touched.painted_bricks) {
        const Size3 first = int64_t(gpu::BRICK_SIZE) * position_of(brick, counts);
        include({first, glm::min(first + int64_t(gpu::BRICK_SIZE), size)});
    }
    return box;
}

std::vector<std::string> Annotator::open(const WorkFiles& files, Work::Start start)
{
    std::vector<std::string> messages = work_.open(files, start);
    bring_all_to_device();
    return messages;
}

void Annotator::bring_all_to_device()
{
    Touched all{.painted_bricks = document().mask.painted_bricks(), .raised = {}};
    const DensityField& density = document().density;
    for (const int64_t brick : density.painted_bricks())
        all.raised.push_back(shvr::voxels_of({0, density.position_of(brick)}, density.size()));
    bring_to_device(all);
}

}  // namespace shvr
