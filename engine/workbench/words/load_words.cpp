#include "engine/workbench/words/load_words.h"

#include "engine/base/error.h"

namespace shvr::ui {

namespace {

std::string counted(int64_t count, const char* one, const char* several)
{
    return sentence(count, ' ', count == 1 ? one : several);
}

std::string parts_in_words(const TraceGraph& trace)
{
    return counted(int64_t(trace.nodes().size()), "node", "nodes") + " and " +
           counted(int64_t(trace.internodes().size()), "internode", "internodes");
}

/// Counts voxels that change their offset.
int64_t offsets_in(std::span<const Change> changes)
{
    int64_t voxels = 0;
    for (const Change& change : changes)
        if (const auto* const bricks = std::get_if<DensityBrickChange>(&change)) voxels += bricks->voxels();
    return voxels;
}

}  // namespace

LoadPreview preview_of(Part part, const shvr::Document& before, const shvr::Document& after,
                       std::span<const Change> changes)
{
    LoadPreview preview{.part = part, .changes_anything = !changes.empty()};
    if (changes.empty()) {
        preview.changes = sentence("The scan already has this ", name_of(part), ".");
        return preview;
    }
    switch (part) {
        case Part::mask: {
            MaskPreview mask(before.mask);
            for (const Change& change : changes)
                if (const auto* const bricks = std::get_if<MaskBrickChange>(&change)) mask.add(*bricks);
            preview.groups = mask.groups();
            preview.changes = counted(mask.voxels(), "voxel changes its group", "voxels change their group") + ".";
            break;
        }
        case Part::offsets:
            preview.changes =
                counted(offsets_in(changes), "voxel changes its offset", "voxels change their offset") + ".";
            break;
        case Part::trace:
            preview.changes =
                "A trace of " + parts_in_words(after.trace) + " replaces one of " + parts_in_words(before.trace) + ".";
            break;
    }
    return preview;
}

}  // namespace shvr::ui
