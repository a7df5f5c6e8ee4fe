#include "engine/scene/annotator.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "engine/annotation/mask_file.h"
#include "engine/passes/paint.h"

namespace shvr {

namespace {

/// Regions of one frame: as many as keep the labels of all of them below this, and no more than that many, since each
/// has buffers of its own.
constexpr uint64_t LABEL_BYTES = uint64_t(32) << 20;
constexpr size_t MOST_REGIONS = 64;

Size3 voxel_at(const glm::dvec3& position)
{
    return Size3(glm::floor(position));
}

bool is_inside(const Size3& voxel, const Size3& size)
{
    return glm::all(glm::greaterThanEqual(voxel, Size3(0))) && glm::all(glm::lessThan(voxel, size));
}

gpu::RegionParams region_params(const BrushRegion& region, const VolumeBinding& volume, const PaintOp& op,
                                uint32_t threshold_code, const Size3& seed)
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
            .seed = seeded ? uint32_t(at.x + 32 * words * (at.y + size.y * at.z)) : gpu::NO_SEED,
            .brick_counts = volume.brick_counts};
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

std::vector<int64_t> bricks_of(const Command& command)
{
    std::vector<int64_t> bricks;
    for (const Change& change : command.changes)
        if (const auto* mask = std::get_if<MaskBrickChange>(&change)) bricks.push_back(mask->brick);
    return bricks;
}

}  // namespace

Annotator::Annotator(Renderer& renderer) : renderer_(renderer), document_{Mask(renderer.volume().info().size)} {}

VoxelSelection Annotator::select(const PaintOp& op)
{
    const VolumeInfo& info = renderer_.volume().info();
    const uint32_t threshold_code = renderer_.volume().window().threshold_code(op.threshold);
    const std::vector<glm::dvec3> positions = stroke_positions(op.path);
    VoxelSelection selection(info.size);

    size_t next = 0;
    while (next < positions.size()) {
        FrameGraph graph;
        const VolumeBinding volume = renderer_.volume().import(graph);
        std::vector<BrushRegion> regions;
        regions.reserve(std::min(positions.size() - next, MOST_REGIONS));  // spans of earlier ones stay where they are
        std::vector<uint32_t> read_backs;
        uint64_t labels = 0;
        for (; next < positions.size() && labels < LABEL_BYTES && regions.size() < MOST_REGIONS; ++next) {
            BrushRegion region = make_region(op.region, positions[next], op.radius_voxels, info.spacing, info.size);
            if (region.rows.empty() || region.words_per_row() == 0) continue;
            labels += uint64_t(region.words_per_row()) * 32 * region.rows.size() * sizeof(uint32_t);
            const gpu::RegionParams params =
                region_params(region, volume, op, threshold_code, voxel_at(positions[next]));
            regions.push_back(std::move(region));
            read_backs.push_back(graph.read_back(add_brush(graph, volume, op.brush, {params, regions.back().rows})));
        }
        if (regions.empty()) break;
        const gpu::FrameResult result = renderer_.executor().run(graph, {.timestamps = false});
        for (size_t i = 0; i < regions.size(); ++i) {
            const std::vector<std::byte>& bytes = result.read_backs[read_backs[i]];
            std::vector<uint32_t> words(bytes.size() / sizeof(uint32_t));
            std::memcpy(words.data(), bytes.data(), bytes.size());
            selection.add(regions[i], words);
        }
    }
    return selection;
}

int64_t Annotator::paint(const PaintOp& op)
{
    Command command{sentence(name_of(op.brush), ", group ", int(op.group)),
                    paint_changes(document_.mask, select(op), op.group)};
    int64_t voxels = 0;
    for (const Change& change : command.changes) voxels += std::get<MaskBrickChange>(change).voxels();
    const std::vector<int64_t> bricks = bricks_of(command);
    history_.perform(document_, std::move(command));
    renderer_.update_mask(document_.mask, bricks);
    return voxels;
}

void Annotator::bring_to_device(const Command& command)
{
    renderer_.update_mask(document_.mask, bricks_of(command));
}

bool Annotator::undo()
{
    const Command* command = history_.undo(document_);
    if (command) bring_to_device(*command);
    return command != nullptr;
}

bool Annotator::redo()
{
    const Command* command = history_.redo(document_);
    if (command) bring_to_device(*command);
    return command != nullptr;
}

void Annotator::load(const std::filesystem::path& mask_file)
{
    std::vector<int64_t> bricks;
    for (const MaskBrickChange& change : load_mask(mask_file, document_.mask.size())) {
        document_.mask.apply(change, Direction::forwards);
        bricks.push_back(change.brick);
    }
    renderer_.update_mask(document_.mask, bricks);
}

void Annotator::save(const std::filesystem::path& mask_file) const
{
    save_mask(mask_file, document_.mask);
}

}  // namespace shvr
