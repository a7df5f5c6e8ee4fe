#include "engine/annotation/files/mask_source.h"

#include <algorithm>
#include <cmath>
#include <unordered_set>
#include <utility>

#include "engine/annotation/files/brick_boxes.h"
#include "engine/annotation/files/volume_place.h"
#include "engine/base/text.h"
#include "engine/volume/voxel_numbers.h"

namespace shvr {

MaskSource::MaskSource(const Mask& mask, const VolumeInfo& volume)
    : SparseSource(mask, info_beside(volume, "mask", VoxelType::uint8))
{}

namespace {

bool is_label(double value)
{
    constexpr double MAX_LABEL = 4294967295.0;  // of uint32
    return value >= 0.0 && value <= MAX_LABEL && value == std::trunc(value);
}

/// Reads the whole mask. If all of its values are labels, fails and says how many there are.
void refuse_labels(const VolumeSource& mask, const std::string& file)
{
    constexpr size_t MAX_COUNTED = 1'000'000;
    const VoxelType type = mask.info().type;
    std::unordered_set<double> labels;
    double highest = 0.0;
    bool has_others = false;
    for_each_brick_box(mask, [&](const VoxelBox& box) {
        const Size3 size = box.size();
        std::vector<double> values(size_t(size.x * size.y * size.z));
        std::vector<std::byte> voxels(values.size() * bytes_of(type));
        mask.read(box, voxels);
        load_voxels(type, voxels.data(), values);
        for (const double value : values) {
            has_others |= !is_label(value);
            if (has_others || value == 0.0) continue;
            highest = std::max(highest, value);
            if (labels.size() < MAX_COUNTED) labels.insert(value);
        }
    });
    if (has_others) return;
    fail(file, ": holds ", labels.size() < MAX_COUNTED ? "" : "at least ", counted(int64_t(labels.size()), "label"),
         ", the highest ", digits_of(highest), ", of type ", name_of(type),
         "; expected at most 255 labels, from 1 to 255: ",
         labels.size() <= 255 ? "renumber them" : "choose up to 255 and renumber them",
         " in the program that wrote the file");
}

}  // namespace

std::vector<uint8_t> groups_in(const VolumeSource& mask, const VoxelBox& box, const std::string& file)
{
    const VoxelType type = mask.info().type;
    const Size3 size = box.size();
    std::vector<uint8_t> groups(size_t(size.x * size.y * size.z));
    if (type == VoxelType::uint8) {
        mask.read(box, std::as_writable_bytes(std::span(groups)));
        return groups;
    }
    std::vector<std::byte> voxels(groups.size() * bytes_of(type));
    mask.read(box, voxels);
    std::vector<double> row(size_t(size.x));
    for (size_t first = 0; first < groups.size(); first += row.size()) {
        load_voxels(type, voxels.data() + first * bytes_of(type), row);
        for (size_t x = 0; x < row.size(); ++x) {
            if (row[x] >= 0.0 && row[x] <= 255.0 && row[x] == std::trunc(row[x])) {
                groups[first + x] = uint8_t(row[x]);
                continue;
            }
            if (is_label(row[x])) refuse_labels(mask, file);
            fail(file, ": holds ", row[x], " in voxel ", digits_of(box.lower + position_of(int64_t(first + x), size)),
                 ", of type ", name_of(type), "; expected whole numbers from 0 to 255, the groups of a mask");
        }
    }
    return groups;
}

std::vector<MaskBrickChange> mask_changes(const VolumeSource& groups, const std::string& file)
{
    std::vector<MaskBrickChange> changes;
    for_each_brick_box(groups, [&](const VoxelBox& box) {
        const std::vector<uint8_t> voxels = groups_in(groups, box, file);
        if (std::ranges::all_of(voxels, [](uint8_t group) { return group == 0; })) return;
        for_each_brick(box, groups.info().size, [&](const BrickOfBox& brick) {
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
