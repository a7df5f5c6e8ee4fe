// Fills between painted slices: a voxel of a slice in between is filled if its signed distances from the outlines in
// the two painted slices (negative inside), interpolated linearly, are at most 0.
//
// A gap is filled slice by slice, with distance maps of the rectangle around its two shapes. Bricks of the result are
// kept in memory until their layer of bricks is complete.

#include <algorithm>
#include <cmath>
#include <map>

#include "engine/annotation/operations/group_bricks.h"
#include "engine/annotation/operations/run_operation.h"
#include "engine/annotation/sets/parabolas.h"
#include "engine/annotation/sets/voxels_near.h"
#include "engine/base/text.h"

namespace shvr {

namespace {

/// Axes u and v of a slice, and the axis across it. A part of a slice is a box one voxel thick; u is fastest in memory.
struct Slicing {
    int u = 0, v = 1, across = 2;
    explicit Slicing(FillBetweenOp::Axis axis)
        : u(axis == FillBetweenOp::Axis::x ? 1 : 0),
          v(axis == FillBetweenOp::Axis::z ? 1 : 2),
          across(axis == FillBetweenOp::Axis::x   ? 0
                 : axis == FillBetweenOp::Axis::y ? 1
                                                  : 2)
    {}
    int64_t width(const VoxelBox& part) const { return part.size()[u]; }
    int64_t height(const VoxelBox& part) const { return part.size()[v]; }
    size_t pixels(const VoxelBox& part) const { return size_t(width(part) * height(part)); }
    size_t pixel(const VoxelBox& part, const Size3& voxel) const
    {
        return size_t(voxel[u] - part.lower[u] + width(part) * (voxel[v] - part.lower[v]));
    }
};

/// Box around both.
VoxelBox box_around(const VoxelBox& a, const VoxelBox& b)
{
    return {glm::min(a.lower, b.lower), glm::max(a.upper, b.upper)};
}

/// The group's slices that have voxels.
class PaintedSlices {
public:
    PaintedSlices(MaskEdit& edit, uint8_t group, const Slicing& slicing, const Progress& progress)
        : edit_(edit), group_(group), slicing_(slicing)
    {
        for_each_brick(edit.mask(), progress, [&](int64_t brick) { add(brick); });
    }
    /// For each painted slice, the box around its voxels.
    const std::map<int64_t, VoxelBox>& boxes() const { return boxes_; }
    /// Whether each pixel of a part of a slice is in the group; pixels beyond the volume's border are not.
    std::vector<uint8_t> shape(int64_t slice, const VoxelBox& part);

private:
    void add(int64_t brick);

    MaskEdit& edit_;
    uint8_t group_;
    Slicing slicing_;
    std::map<int64_t, VoxelBox> boxes_{};
    std::map<int64_t, std::vector<int64_t>> layers_{};  ///< bricks of the group, by their layer along `across`
};

void PaintedSlices::add(int64_t brick)
{
    const BrickBits bits = bits_of(edit_.read(brick), group_);
    if (is_empty(bits)) return;
    const Size3 corner = edit_.mask().box_of(brick).lower;
    std::array<VoxelBox, BRICK_SIDE> found;
    found.fill({Size3(BRICK_SIDE), Size3(0)});
    for (size_t row = 0; row < bits.size(); ++row)
        for (uint32_t left = bits[row]; left != 0; left &= left - 1) {
            const Size3 at(std::countr_zero(left), int64_t(row) % BRICK_SIDE, int64_t(row) / BRICK_SIDE);
            VoxelBox& box = found[size_t(at[slicing_.across])];
            box = box_around(box, {at, at + int64_t{1}});
        }
    for (const VoxelBox& box : found) {
        if (box.upper == Size3(0)) continue;
        const VoxelBox part{corner + box.lower, corner + box.upper};
        const auto [place, is_new] = boxes_.try_emplace(part.lower[slicing_.across], part);
        if (!is_new) place->second = box_around(place->second, part);
    }
    layers_[corner[slicing_.across] / BRICK_SIDE].push_back(brick);
}

std::vector<uint8_t> PaintedSlices::shape(int64_t slice, const VoxelBox& part)
{
    std::vector<uint8_t> shape(slicing_.pixels(part));
    for (const int64_t brick : layers_.at(slice / BRICK_SIDE)) {
        const VoxelBox own = edit_.mask().box_of(brick);
        VoxelBox box{glm::max(own.lower, part.lower), glm::min(own.upper, part.upper)};
        box.lower[slicing_.across] = slice;
        box.upper[slicing_.across] = slice + 1;
        if (glm::any(glm::greaterThanEqual(box.lower, box.upper))) continue;
        const MaskBrick& voxels = edit_.read(brick);
        const Size3 size = box.size();
        for (int64_t i = 0; i < size.x * size.y * size.z; ++i) {
            const Size3 voxel = box.lower + position_of(i, size);
            if (voxels[index_in_brick(voxel)] == group_) shape[slicing_.pixel(part, voxel)] = 1;
        }
    }
    return shape;
}

/// The squared distance of each pixel to the nearest pixel whose value in `shape` is `wanted`.
std::vector<double> squared_distances(std::span<const uint8_t> shape, uint8_t wanted, int64_t width, int64_t height,
                                      const glm::dvec2& spacing)
{
    std::vector<double> squared(shape.size(), INFINITE);
    for (int64_t v = 0; v < height; ++v) {
        const auto pass = [&](int64_t first, int64_t end, int64_t step) {
            int64_t last = -1;
            for (int64_t u = first; u != end; u += step) {
                const auto pixel = size_t(u + width * v);
                if (shape[pixel] == wanted) last = u;
                const double away = double(last - u) * spacing.x;
                if (last >= 0) squared[pixel] = std::min(squared[pixel], away * away);
            }
        };
        pass(0, width, 1);
        pass(width - 1, -1, -1);
    }
    Parabolas along_v(spacing.y);
    for (int64_t u = 0; u < width; ++u) {
        const auto at = [&](int64_t v) { return squared[size_t(u + width * v)]; };
        if (along_v.build(height, std::numeric_limits<double>::max(), at))
            along_v.evaluate(0, height, [&](int64_t v, double value) { squared[size_t(u + width * v)] = value; });
    }
    return squared;
}

/// The distance of each pixel to the nearest pixel on the other side of the outline; negative inside the shape. The
/// part extends beyond the shape on all sides, so it contains the nearest pixel outside.
std::vector<double> signed_distances(std::span<const uint8_t> shape, int64_t width, int64_t height,
                                     const glm::dvec2& spacing)
{
    std::vector<double> distances = squared_distances(shape, 1, width, height, spacing);
    const std::vector<double> inside = squared_distances(shape, 0, width, height, spacing);
    for (size_t pixel = 0; pixel < shape.size(); ++pixel)
        distances[pixel] = shape[pixel] ? -std::sqrt(inside[pixel]) : std::sqrt(distances[pixel]);
    return distances;
}

/// Greatest memory per pixel: two shapes, and three distance maps at a time.
constexpr uint64_t BYTES_OF_PIXEL = 2 + 3 * sizeof(double);

class GapFiller {
public:
    GapFiller(const FillBetweenOp& op, MaskEdit& edit, PaintedSlices& slices)
        : edit_(edit), slices_(slices), group_(uint8_t(op.group)), slicing_(op.axis)
    {}
    /// Fills the slices between two painted slices, each given with the box around its voxels.
    void fill(const std::pair<const int64_t, VoxelBox>& from, const std::pair<const int64_t, VoxelBox>& to,
              const Progress& progress);
    /// Passes pending bricks to the edit if they lie before `layer`, because no later slice changes them.
    void finish_before(int64_t layer);

private:
    void fill_slice(int64_t slice, double from_weight, double to_weight);
    void fill_brick(VoxelBox box, double from_weight, double to_weight);
    bool is_in(size_t pixel, double from_weight, double to_weight) const
    {
        const double a = from_weight * from_[pixel], b = to_weight * to_[pixel];
        return a + b <= 1e-9 * (std::abs(a) + std::abs(b));
    }
    std::vector<double> distances(int64_t slice);

    MaskEdit& edit_;
    PaintedSlices& slices_;
    uint8_t group_;
    Slicing slicing_;
    VoxelBox part_{};  ///< box around both shapes, enlarged by a pixel on all sides
    std::vector<double> from_{}, to_{};
    std::map<int64_t, BrickBits> pending_{};
    int64_t pending_layer_ = 0;
};

std::vector<double> GapFiller::distances(int64_t slice)
{
    const glm::dvec3& spacing = edit_.input().volume.spacing;
    return signed_distances(slices_.shape(slice, part_), slicing_.width(part_), slicing_.height(part_),
                            {spacing[slicing_.u], spacing[slicing_.v]});
}

void GapFiller::fill(const std::pair<const int64_t, VoxelBox>& from, const std::pair<const int64_t, VoxelBox>& to,
                     const Progress& progress)
{
    const auto& box = edit_.limits().box;
    const int64_t first = std::max(from.first + 1, box ? box->lower[slicing_.across] : from.first + 1),
                  end = std::min(to.first, box ? box->upper[slicing_.across] : to.first);
    if (first >= end) return;
    part_ = box_around(from.second, to.second);
    part_.lower -= int64_t{1};
    part_.upper += int64_t{1};
    edit_.check_memory(slicing_.pixels(part_) * BYTES_OF_PIXEL);
    from_ = distances(from.first);
    to_ = distances(to.first);
    for (int64_t slice = first; slice < end; ++slice) {
        finish_before(slice / BRICK_SIDE);
        fill_slice(slice, double(to.first - slice), double(slice - from.first));
        tell(progress, double(slice + 1 - first) / double(end - first));
    }
}

void GapFiller::fill_slice(int64_t slice, double from_weight, double to_weight)
{
    const Size3 lower = glm::max(part_.lower, Size3(0)) / BRICK_SIDE,
                upper = (glm::min(part_.upper, edit_.mask().size()) - int64_t{1}) / BRICK_SIDE;
    Size3 brick = lower;
    brick[slicing_.across] = slice / BRICK_SIDE;
    for (brick[slicing_.v] = lower[slicing_.v]; brick[slicing_.v] <= upper[slicing_.v]; ++brick[slicing_.v])
        for (brick[slicing_.u] = lower[slicing_.u]; brick[slicing_.u] <= upper[slicing_.u]; ++brick[slicing_.u]) {
            VoxelBox box = edit_.mask().box_of(index_of(brick, edit_.mask().brick_counts()));
            box.lower[slicing_.across] = slice;
            box.upper[slicing_.across] = slice + 1;
            fill_brick(box, from_weight, to_weight);
        }
}

/// `box`: a brick's part of a slice.
void GapFiller::fill_brick(VoxelBox box, double from_weight, double to_weight)
{
    const int64_t brick = index_of(box.lower / BRICK_SIDE, edit_.mask().brick_counts());
    if (!edit_.may_change(brick)) return;
    for (const int axis : {slicing_.u, slicing_.v}) {
        box.lower[axis] = std::max(box.lower[axis], part_.lower[axis]);
        box.upper[axis] = std::min(box.upper[axis], part_.upper[axis]);
    }
    BrickBits* bits = nullptr;
    Size3 voxel = box.lower;
    for (voxel[slicing_.v] = box.lower[slicing_.v]; voxel[slicing_.v] < box.upper[slicing_.v]; ++voxel[slicing_.v])
        for (voxel[slicing_.u] = box.lower[slicing_.u]; voxel[slicing_.u] < box.upper[slicing_.u];
             ++voxel[slicing_.u]) {
            if (!is_in(slicing_.pixel(part_, voxel), from_weight, to_weight)) continue;
            if (!bits) bits = &pending_[brick];
            const size_t index = index_in_brick(voxel);
            (*bits)[index / BRICK_SIDE] |= 1u << (index % BRICK_SIDE);
        }
}

void GapFiller::finish_before(int64_t layer)
{
    if (layer <= pending_layer_) return;
    pending_layer_ = layer;
    for (const auto& [brick, bits] : pending_) {
        MaskBrick wanted = edit_.read(brick);
        for (size_t index = 0; index < wanted.size(); ++index)
            if ((bits[index / BRICK_SIDE] >> (index % BRICK_SIDE) & 1u) != 0) wanted[index] = group_;
        edit_.want(brick, wanted);
    }
    pending_.clear();
}

}  // namespace

void perform(const FillBetweenOp& op, MaskEdit& edit, const Progress& progress)
{
    PaintedSlices slices(edit, uint8_t(op.group), Slicing(op.axis), part_of(progress, 0.0, 0.2));
    const std::map<int64_t, VoxelBox>& boxes = slices.boxes();
    GapFiller filler(op, edit, slices);
    int64_t gaps = 0, done = 0;
    for (auto to = boxes.begin(); to != boxes.end(); ++to) {
        const Progress part = part_of(progress, 0.2 + 0.8 * double(done) / double(boxes.size()),
                                      0.2 + 0.8 * double(done + 1) / double(boxes.size()));
        ++done;
        if (to == boxes.begin() || std::prev(to)->first + 1 == to->first) continue;
        filler.fill(*std::prev(to), *to, part);
        ++gaps;
    }
    filler.finish_before(edit.mask().size()[Slicing(op.axis).across]);
    edit.note(sentence("the group has ", counted(int64_t(boxes.size()), "painted slice"), " with ",
                       counted(gaps, "gap"), " between them"));
}

}  // namespace shvr
