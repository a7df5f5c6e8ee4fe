// Trace to mask. The volume is bisected down to single bricks, and each half is tested only against the shapes that
// reach into it. So the cost depends on the bricks that the trace meets, and only one brick is in memory at a time.

#include <algorithm>
#include <numeric>

#include "engine/annotation/operations/run_operation.h"
#include "engine/annotation/operations/trace_shapes.h"
#include "engine/annotation/sets/brick_bits.h"
#include "engine/base/error.h"
#include "engine/base/text.h"

namespace shvr {

namespace {

class TracePainter {
public:
    TracePainter(const MaskFromTraceOp& op, MaskEdit& edit, std::vector<TraceShape> shapes, const Progress& progress)
        : edit_(edit),
          shapes_(std::move(shapes)),
          spacing_(edit.input().volume.spacing),
          group_(uint8_t(op.group)),
          progress_(progress)
    {}
    void paint()
    {
        std::vector<uint32_t> all(shapes_.size());
        std::iota(all.begin(), all.end(), 0u);
        paint({Size3(0), edit_.mask().brick_counts()}, all, 0.0, 1.0);
    }

private:
    void paint(const VoxelBox& bricks, std::span<const uint32_t> shapes, double done, double share);
    void paint_brick(int64_t brick, std::span<const uint32_t> shapes);
    void paint_rows(const TraceShape& shape, const VoxelBox& box, MaskBrick& wanted) const;
    /// The shapes that intersect the smallest ball around the centres of a box's voxels.
    std::vector<uint32_t> reaching(const VoxelBox& voxels, std::span<const uint32_t> shapes) const;
    glm::dvec3 middle_of(const VoxelBox& voxels) const
    {
        return glm::dvec3(voxels.lower + voxels.upper) * 0.5 * spacing_;
    }
    double reach_of(const VoxelBox& voxels) const
    {
        return glm::length(glm::dvec3(voxels.size() - int64_t{1}) * 0.5 * spacing_) * (1.0 + 1e-9);
    }

    MaskEdit& edit_;
    const std::vector<TraceShape> shapes_;
    glm::dvec3 spacing_;
    uint8_t group_;
    const Progress& progress_;
};

std::vector<uint32_t> TracePainter::reaching(const VoxelBox& voxels, std::span<const uint32_t> shapes) const
{
    const glm::dvec3 middle = middle_of(voxels);
    const double reach = reach_of(voxels);
    std::vector<uint32_t> found;
    std::ranges::copy_if(shapes, std::back_inserter(found),
                         [&](uint32_t shape) { return shapes_[shape].contains(middle, reach); });
    return found;
}

/// `bricks`: a box of bricks; `done`, `share`: start and size of this call's part of the progress.
void TracePainter::paint(const VoxelBox& bricks, std::span<const uint32_t> shapes, double done, double share)
{
    const VoxelBox voxels{bricks.lower * BRICK_SIDE, glm::min(bricks.upper * BRICK_SIDE, edit_.mask().size())};
    if (edit_.limits().box && !meet(voxels, *edit_.limits().box)) return;
    const std::vector<uint32_t> mine = reaching(voxels, shapes);
    if (mine.empty()) return;
    const Size3 size = bricks.size();
    if (size == Size3(1)) {
        paint_brick(index_of(bricks.lower, edit_.mask().brick_counts()), mine);
        tell(progress_, done + share);
        return;
    }
    const int axis = size.z >= size.y && size.z >= size.x ? 2 : size.y >= size.x ? 1 : 0;
    VoxelBox lower = bricks, upper = bricks;
    lower.upper[axis] = upper.lower[axis] = bricks.lower[axis] + size[axis] / 2;
    paint(lower, mine, done, share / 2.0);
    paint(upper, mine, done + share / 2.0, share / 2.0);
}

void TracePainter::paint_brick(int64_t brick, std::span<const uint32_t> shapes)
{
    MaskBrick wanted = edit_.read(brick);
    for (const uint32_t shape : shapes) paint_rows(shapes_[shape], edit_.mask().box_of(brick), wanted);
    edit_.want(brick, wanted);
}

void TracePainter::paint_rows(const TraceShape& shape, const VoxelBox& box, MaskBrick& wanted) const
{
    const double reach = reach_of({Size3(0), Size3(box.size().x, 1, 1)});
    for (int64_t z = box.lower.z; z < box.upper.z; ++z)
        for (int64_t y = box.lower.y; y < box.upper.y; ++y) {
            const Size3 first(box.lower.x, y, z), end(box.upper.x, y + 1, z + 1);
            if (!shape.contains(middle_of({first, end}), reach)) continue;
            const size_t row = size_t(index_of(first - box.lower, Size3(BRICK_SIDE)));
            for (int64_t x = 0; x < box.size().x; ++x) {
                if (shape.contains((glm::dvec3(first + Size3(x, 0, 0)) + 0.5) * spacing_))
                    wanted[row + size_t(x)] = group_;
            }
        }
}

}  // namespace

void perform(const MaskFromTraceOp& op, MaskEdit& edit, const Progress& progress)
{
    const TraceGraph* const trace = edit.input().trace;
    if (!trace || trace->nodes().empty()) fail("the trace has no nodes; expected some to paint");
    std::vector<TraceShape> shapes = shapes_of(*trace, op.of);
    if (shapes.empty())
        fail("key of is ", text_of(op.of), "; expected groups of which the trace has nodes or internodes");
    edit.note(sentence("the trace has ", shapes.size(), " balls and cones"));
    TracePainter(op, edit, std::move(shapes), progress).paint();
}

}  // namespace shvr
