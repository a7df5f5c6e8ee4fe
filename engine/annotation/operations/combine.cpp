// Set operations on two groups.

#include "engine/annotation/operations/group_bricks.h"
#include "engine/annotation/operations/run_operation.h"

namespace shvr {

namespace {

/// The new groups of the voxels of `group` and of the voxels of `with`.
struct Replacement {
    uint8_t of_group, of_with;
};

Replacement replacement_of(const CombineOp& op)
{
    const auto group = uint8_t(op.group), with = uint8_t(op.with);
    switch (op.how) {
        case CombineOp::How::add:
        case CombineOp::How::move: return {group, group};
        case CombineOp::How::subtract: break;
        case CombineOp::How::intersect: return {0, with};
        case CombineOp::How::copy: return {0, group};
        case CombineOp::How::swap: return {with, group};
    }
    return {group, with};
}

std::string note_of(CombineOp::How how)
{
    if (how == CombineOp::How::subtract || how == CombineOp::How::intersect)
        return "a voxel has one group, so two groups share none";
    if (how == CombineOp::How::copy) return "a voxel has one group, so the other group lost what was copied";
    return {};
}

}  // namespace

void perform(const CombineOp& op, MaskEdit& edit, const Progress& progress)
{
    // Bytes, for which the compiler compares many voxels in an instruction.
    const auto group = uint8_t(op.group), with = uint8_t(op.with);
    const auto [of_group, of_with] = replacement_of(op);
    edit.note(note_of(op.how));
    for_each_brick(edit.mask(), progress, [&, group, with, of_group, of_with](int64_t brick) {
        if (!edit.may_change(brick)) return;
        MaskBrick wanted = edit.read(brick);
        for (uint8_t& voxel : wanted) voxel = voxel == group ? of_group : voxel == with ? of_with : voxel;
        edit.want(brick, wanted);
    });
}

}  // namespace shvr
