#include "engine/annotation/files/mask_place.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <set>
#include <string>
#include <vector>

#include "engine/annotation/files/brick_boxes.h"
#include "engine/annotation/files/volume_place.h"
#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/volume/unit.h"
#include "engine/volume/voxel_numbers.h"
#include "engine/volume/voxel_walk.h"

namespace shvr {

namespace {

/// Tolerances in voxels, for numbers that other programs store as 32-bit floats.
constexpr double MAX_DRIFT = 0.05, ROUNDING = 1e-6;

bool states_position(const TraceSpace& space)
{
    return !space.frame.empty() || space.origin != glm::dvec3(0.0) || space.directions != glm::dmat3(1.0);
}

/// The place of a mask on the volume's grid or, if there is none, the reason.
struct Trial {
    std::optional<GridPlace> place{};
    std::string reason{};
};

/// The steps from voxel to voxel along the three axes, as the columns of a matrix.
glm::dmat3 steps_of(const TraceSpace& space, double factor)
{
    glm::dmat3 steps;
    for (int axis = 0; axis < 3; ++axis) steps[axis] = factor * space.spacing[axis] * space.directions[axis];
    return steps;
}

/// `turn`: sign of each axis: (1, 1, 1), or (-1, -1, 1) to convert RAS to LPS or LPS to RAS.
Trial try_place(const TraceSpace& mask, const TraceSpace& volume, const glm::dvec3& turn)
{
    const std::optional<double> from = micrometres_in(mask.unit), to = micrometres_in(volume.unit);
    const double factor = from && to ? *from / *to : 1.0;
    const glm::dmat3 steps = steps_of(mask, factor), to_voxels = glm::inverse(steps_of(volume, 1.0));
    Trial trial{GridPlace{}, {}};
    for (int axis = 0; axis < 3; ++axis) {
        const glm::dvec3 step = to_voxels * (turn * steps[axis]), size = glm::abs(step);
        const int along = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
        glm::dvec3 drift = step;
        drift[along] = size[along] - 1.0;
        drift *= double(std::max<int64_t>(mask.size[axis] - 1, 5));
        if (!(glm::length(drift) <= MAX_DRIFT))
            return {
                {},
                sentence("its axis ", "xyz"[axis], " steps by ", digits_of(step),
                         " of this volume's voxels; expected one voxel along one axis: resample it onto this grid")};
        trial.place->axis[size_t(axis)] = along;
        trial.place->sign[size_t(axis)] = step[along] < 0.0 ? -1 : 1;
    }
    if (std::set<int>(trial.place->axis.begin(), trial.place->axis.end()).size() < 3)
        return {{}, "two of its axes run along one axis of this volume; expected three axes of its own"};
    const glm::dvec3 at = to_voxels * (factor * turn * mask.origin - volume.origin), nearest = glm::round(at);
    const double allowed =
        MAX_DRIFT + ROUNDING * glm::length(to_voxels * (glm::abs(factor * mask.origin) + glm::abs(volume.origin)));
    for (int axis = 0; axis < 3; ++axis)
        if (!(std::abs(at[axis] - nearest[axis]) <= allowed) || std::abs(at[axis]) > double(int64_t{1} << 40))
            return {{},
                    sentence("its first voxel lies at ", digits_of(at),
                             " of this volume's voxels; expected whole numbers: resample it onto this grid")};
    trial.place->first = Size3(nearest);
    return trial;
}

VoxelBox covered_by(const GridPlace& place, const Size3& mask)
{
    VoxelBox box{place.first, place.first + Size3(1)};
    for (size_t axis = 0; axis < 3; ++axis) {
        const int64_t reach = mask[int(axis)] - 1;
        (place.sign[axis] > 0 ? box.upper : box.lower)[place.axis[axis]] += place.sign[axis] * reach;
    }
    return box;
}

VoxelBox common_part(const VoxelBox& a, const VoxelBox& b)
{
    return {glm::max(a.lower, b.lower), glm::min(a.upper, b.upper)};
}

bool is_empty(const VoxelBox& box)
{
    return glm::any(glm::lessThanEqual(box.size(), Size3(0)));
}

VolumeInfo placed_info(const VolumeSource& mask, const TraceSpace& volume)
{
    VolumeInfo info = mask.info();
    info.size = volume.size;
    info.spacing = volume.spacing;
    info.unit = volume.unit;
    info.directions = volume.directions;
    info.origin = volume.origin;
    info.frame = volume.frame;
    return info;
}

}  // namespace

std::optional<GridPlace> place_of_mask(const std::filesystem::path& path, const VolumeInfo& mask,
                                       const TraceSpace& volume)
{
    const TraceSpace found = space_of(mask);
    if (found.size == volume.size && why_elsewhere(found, volume).empty()) return std::nullopt;
    const auto refuse = [&](const std::string& reason) {
        fail(path.string(), ": is a mask of ", digits_of(found.size), " voxels for this volume of ",
             digits_of(volume.size), ", but ", reason);
    };
    if (!states_position(found))
        refuse("it states no position; expected the size of this volume, or an origin from which it is placed");
    // A coordinate frame without a name is compatible with any frame.
    const bool may_be_same = found.frame == volume.frame || found.frame.empty() || volume.frame.empty();
    Trial trial;
    if (may_be_same) trial = try_place(found, volume, glm::dvec3(1.0));
    const auto is_within = [&] {
        return trial.place && !is_empty(common_part(covered_by(*trial.place, found.size), {Size3(0), volume.size}));
    };
    if (!is_within() && found.frame != volume.frame) {
        const Trial turned = try_place(found, volume, glm::dvec3(-1.0, -1.0, 1.0));
        if (turned.place || !may_be_same) trial = turned;
    }
    if (!trial.place) refuse(trial.reason);
    if (!is_within())
        refuse(sentence("its first voxel lies at ", digits_of(trial.place->first),
                        ", outside; expected a mask that has voxels in common with it"));
    return trial.place;
}

std::string in_words(const GridPlace& place, const Size3& mask, const TraceSpace& volume)
{
    const VoxelBox covered = covered_by(place, mask);
    std::string words = sentence("its ", digits_of(mask), " voxels are placed at ", digits_of(covered.lower),
                                 " of this volume, as its position says");
    if (place.axis != std::array<int, 3>{0, 1, 2}) {
        words += ", with its axes along ";
        for (size_t axis = 0; axis < 3; ++axis) words += sentence(axis == 0 ? "" : ", ", "xyz"[place.axis[axis]]);
    }
    std::string reversed;
    for (size_t axis = 0; axis < 3; ++axis)
        if (place.sign[axis] < 0) reversed += sentence(reversed.empty() ? "" : ", ", "xyz"[axis]);
    if (!reversed.empty()) words += ", in reverse order along its axis " + reversed;
    if (!states_position(volume)) words += "; this volume states none, and its first voxel is taken to lie at 0, 0, 0";
    return words;
}

PlacedSource::PlacedSource(const VolumeSource& mask, const GridPlace& place, const TraceSpace& volume)
    : VolumeSource(placed_info(mask, volume)), mask_(mask), place_(place), covered_(covered_by(place, mask.info().size))
{}

VoxelBox PlacedSource::on_volume(const VoxelBox& of_mask) const
{
    VoxelBox box{Size3(0), Size3(0)};
    for (size_t axis = 0; axis < 3; ++axis) {
        const int from = int(axis), to = place_.axis[axis];
        const bool runs_forwards = place_.sign[axis] > 0;
        box.lower[to] = place_.first[to] + (runs_forwards ? of_mask.lower[from] : 1 - of_mask.upper[from]);
        box.upper[to] = place_.first[to] + (runs_forwards ? of_mask.upper[from] : 1 - of_mask.lower[from]);
    }
    return box;
}

VoxelBox PlacedSource::on_mask(const VoxelBox& of_volume) const
{
    VoxelBox box{Size3(0), Size3(0)};
    for (size_t axis = 0; axis < 3; ++axis) {
        const int to = int(axis), from = place_.axis[axis];
        const bool runs_forwards = place_.sign[axis] > 0;
        const int64_t lower = of_volume.lower[from] - place_.first[from];
        const int64_t upper = of_volume.upper[from] - place_.first[from];
        box.lower[to] = runs_forwards ? lower : 1 - upper;
        box.upper[to] = runs_forwards ? upper : 1 - lower;
    }
    return box;
}

void PlacedSource::read(const VoxelBox& box, std::span<std::byte> voxels) const
{
    const size_t voxel_bytes = bytes_of(info().type);
    std::ranges::fill(voxels, std::byte{0});
    const VoxelBox part = common_part(box, covered_);
    if (is_empty(part)) return;
    const VoxelBox of_mask = on_mask(part);
    const Size3 size = of_mask.size();
    std::vector<std::byte> found(size_t(size.x * size.y * size.z) * voxel_bytes);
    mask_.read(of_mask, found);
    // Steps of the linear index in the volume's box from a voxel to its neighbours along the mask's axes.
    const Size3 strides(1, box.size().x, box.size().x * box.size().y);
    int64_t begin = index_of(part.lower - box.lower, box.size());
    Size3 step(0);
    for (size_t axis = 0; axis < 3; ++axis) {
        const int64_t stride = strides[place_.axis[axis]];
        step[int(axis)] = place_.sign[axis] * stride;
        if (place_.sign[axis] < 0) begin += (size[int(axis)] - 1) * stride;
    }
    const std::byte* from = found.data();
    for (int64_t z = 0; z < size.z; ++z)
        for (int64_t y = 0; y < size.y; ++y)
            for (int64_t x = 0; x < size.x; ++x, from += voxel_bytes) {
                const int64_t to = begin + x * step.x + y * step.y + z * step.z;
                std::memcpy(voxels.data() + size_t(to) * voxel_bytes, from, voxel_bytes);
            }
}

std::optional<StoredBlocks> PlacedSource::stored_blocks(int level, int64_t most) const
{
    SHVR_CHECK(level == 0, level);
    const VoxelBox volume{Size3(0), info().size};
    const std::optional<StoredBlocks> of_mask = mask_.stored_blocks(0, most);
    std::set<int64_t> bricks;
    const auto add = [&](const VoxelBox& box) {
        const VoxelBox part = common_part(box, volume);
        if (is_empty(part)) return true;
        const Size3 first = part.lower / BRICK_SIDE, end = brick_grid(part.upper), counts = end - first;
        if (counts.x * counts.y > most || counts.x * counts.y * counts.z > most) return false;
        Size3 at;
        for (at.z = first.z; at.z < end.z; ++at.z)
            for (at.y = first.y; at.y < end.y; ++at.y)
                for (at.x = first.x; at.x < end.x; ++at.x) bricks.insert(index_of(at, brick_grid(info().size)));
        return int64_t(bricks.size()) <= most;
    };
    if (of_mask && of_mask->fill == 0.0) {
        for (const glm::ivec3& block : of_mask->blocks)
            if (!add(on_volume(box_of_block(*of_mask, block, mask_.info().size)))) return std::nullopt;
    } else if (!add(covered_)) {
        return std::nullopt;
    }
    StoredBlocks stored{.block = Size3(BRICK_SIDE)};
    for (const int64_t brick : bricks) stored.blocks.emplace_back(position_of(brick, brick_grid(info().size)));
    return stored;
}

void PlacedSource::expect_nothing_outside(const std::filesystem::path& path) const
{
    const VoxelBox volume{Size3(0), info().size};
    if (common_part(covered_, volume) == covered_) return;
    std::vector<std::byte> found;
    std::vector<double> values;
    for_each_brick_box(mask_, [&](const VoxelBox& box) {
        const VoxelBox covered = on_volume(box);
        if (common_part(covered, volume) == covered) return;
        const Size3 size = box.size();
        const size_t voxel_bytes = bytes_of(info().type);
        found.resize(size_t(size.x * size.y * size.z) * voxel_bytes);
        mask_.read(box, found);
        values.resize(size_t(size.x));
        for (int64_t row = 0; row < size.y * size.z; ++row) {
            load_voxels(info().type, found.data() + size_t(row * size.x) * voxel_bytes, values);
            for (int64_t x = 0; x < size.x; ++x) {
                if (values[size_t(x)] == 0.0) continue;
                const Size3 voxel = box.lower + Size3(x, row % size.y, row / size.y);
                const VoxelBox there = on_volume({voxel, voxel + Size3(1)});
                if (!is_empty(common_part(there, volume))) continue;
                fail(path.string(), ": holds ", values[size_t(x)], " in its voxel ", digits_of(voxel),
                     ", which lies at ", digits_of(there.lower), " of this volume of ", digits_of(info().size),
                     " voxels; expected nothing painted outside it: cut the mask to this volume");
            }
        }
    });
}

}  // namespace shvr
