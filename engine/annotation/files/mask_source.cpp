#include "engine/annotation/files/mask_source.h"

#include <algorithm>
#include <utility>

#include "engine/annotation/files/brick_boxes.h"
#include "engine/annotation/files/volume_place.h"

namespace shvr {

MaskSource::MaskSource(const Mask& mask, const VolumeInfo& volume)
    : SparseSource(mask, info_beside(volume, "mask", VoxelType::uint8))
{}

std::vector<MaskBrickChange> mask_changes(const VolumeSource& groups, const std::string& file)
{
    const VolumeInfo& info = groups.info();
    if (info.type != VoxelType::uint8)
        fail(file, ": holds voxels of type ", name_of(info.type), "; expected uint8, colour groups");
    std::vector<MaskBrickChange> changes;
    std::vector<uint8_t> voxels;
    for_each_brick_box(groups, [&](const VoxelBox& box) {
        const Size3 size = box.size();
        voxels.resize(size_t(size.x * size.y * size.z));
        groups.read(box, std::as_writable_bytes(std::span(voxels)));
        if (std::ranges::all_of(voxels, [](uint8_t group) { return group == 0; })) return;
        for_each_brick(box, info.size, [&](const BrickOfBox& brick) {
            MaskBrickChange change{brick.index, {}};
            for (int64_t z = 0; z < brick.extent.z; ++z)
                for (int64_t y = 0; y < brick.extent.y; ++y)
                    append_painted_runs(change.runs,
                                        std::span(voxels).subspan(size_t(brick.row(y, z)), size_t(brick.extent.x)),
                                        size_t(BRICK_SIDE * (y + BRICK_SIDE * z)));
            if (!change.runs.empty()) changes.push_back(std::move(change));
        });
    });
    std::ranges::sort(changes, {}, &MaskBrickChange::brick);
    return changes;
}

}  // namespace shvr
