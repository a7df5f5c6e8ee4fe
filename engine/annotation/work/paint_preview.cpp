#include "engine/annotation/work/paint_preview.h"
#include "engine/volume/grid.h"

#include <algorithm>

namespace shvr {

namespace {

/// Calls `row(first, end)` for each piece of a row of voxels in a run, which may go over several rows of its brick.
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
    const Size3 counts = (volume_size + int64_t{gpu::BRICK_SIZE - 1}) / int64_t{gpu::BRICK_SIZE};
    const auto visit = [&](int64_t brick, const auto& runs) {
        const Size3 begin = int64_t{gpu::BRICK_SIZE} * position_of(brick, counts);
        for (const auto& run : runs) for_each_row(run, begin, row);
    };
    for (const Change& change : changes) {
        if (const auto* mask = std::get_if<MaskBrickChange>(&change)) visit(mask->brick, mask->runs);
        if (const auto* density = std::get_if<DensityBrickChange>(&change)) visit(density->brick, density->runs);
    }
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
            preview.voxels += (word & bit) == 0;  // a voxel may change its group and its offset
            word |= bit;
        }
    });
    return preview;
}

}  // namespace shvr
