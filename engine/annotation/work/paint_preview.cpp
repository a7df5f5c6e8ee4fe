#include "engine/annotation/work/paint_preview.h"

#include <algorithm>

#include "engine/volume/grid.h"

namespace shvr {

namespace {

/// Calls `row(first voxel, count)` for each row of the brick, or part of a row, that a run covers.
template <class Run, class Row>
void for_each_row(const Run& run, const Size3& brick_begin, const Row& row)
{
    for (int64_t first = run.first; first <= run.last;) {
        const int64_t last = std::min<int64_t>(run.last, first / BRICK_SIDE * BRICK_SIDE + BRICK_SIDE - 1);
        row(brick_begin + Size3(first % BRICK_SIDE, first / BRICK_SIDE % BRICK_SIDE, first / (BRICK_SIDE * BRICK_SIDE)),
            last - first + 1);
        first = last + 1;
    }
}

template <class Row>
void for_each_row(std::span<const Change> changes, const Size3& volume_size, const Row& row)
{
    const Size3 counts = brick_grid(volume_size);
    const auto for_brick = [&](const auto& brick) {
        const Size3 begin = BRICK_SIDE * position_of(brick.brick, counts);
        for (const auto& run : brick.runs) for_each_row(run, begin, row);
    };
    const ByKind voxels{
        [&](const MaskBrickChange& mask) { for_brick(mask); },
        [&](const DensityBrickChange& density) { for_brick(density); },
        [](const TraceChange&) {},
        [](const SettingChange&) {},
    };
    for (const Change& change : changes) std::visit(voxels, change);
}

}  // namespace

bool PaintPreview::contains(const Size3& voxel) const
{
    const Size3 at = voxel - box.lower, size = box.size();
    if (glm::any(glm::lessThan(at, Size3(0))) || glm::any(glm::greaterThanEqual(at, size))) return false;
    return words[size_t(at.x / 32 + words_per_row() * (at.y + size.y * at.z))] >> (at.x % 32) & 1u;
}

PaintPreview preview_of(std::span<const Change> changes, const Size3& volume_size, PaintPreview::Kind kind)
{
    PaintPreview preview{.box = {volume_size, Size3(0)}, .words = {}, .kind = kind};
    for_each_row(changes, volume_size, [&](const Size3& first, int64_t count) {
        preview.box.lower = glm::min(preview.box.lower, first);
        preview.box.upper = glm::max(preview.box.upper, first + Size3(count, 1, 1));
    });
    if (glm::any(glm::lessThanEqual(preview.box.upper, preview.box.lower))) {
        preview.box = {};
        return preview;
    }
    const Size3 size = preview.box.size();
    preview.words.resize(size_t(preview.words_per_row() * size.y * size.z));
    for_each_row(changes, volume_size, [&](const Size3& first, int64_t count) {
        const Size3 at = first - preview.box.lower;
        uint32_t* const row = &preview.words[size_t(preview.words_per_row() * (at.y + size.y * at.z))];
        for (int64_t x = at.x; x < at.x + count; ++x) {
            uint32_t& word = row[x / 32];
            const uint32_t bit = 1u << (x % 32);
            preview.voxels += (word & bit) == 0;  // counted once if both its group and its offset change
            word |= bit;
        }
    });
    return preview;
}

}  // namespace shvr
