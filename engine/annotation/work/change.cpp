#include "engine/annotation/work/change.h"

#include "engine/base/error.h"

namespace shvr {

namespace {

/// Returns the part of the document that a kind of change applies to.
Mask& part_for(Document& document, const MaskBrickChange&)
{
    return document.mask;
}
DensityField& part_for(Document& document, const DensityBrickChange&)
{
    return document.density;
}
TraceGraph& part_for(Document& document, const TraceChange&)
{
    return document.trace;
}
Settings& part_for(Document& document, const SettingChange&)
{
    return document.settings;
}

Direction opposite(Direction direction)
{
    return direction == Direction::forwards ? Direction::backwards : Direction::forwards;
}

/// The change to apply as number i: counted from the front if forwards, from the end if backwards.
const Change& in_order(std::span<const Change> changes, size_t i, Direction direction)
{
    return direction == Direction::forwards ? changes[i] : changes[changes.size() - 1 - i];
}

std::string why_it_does_not_fit(Document& document, const Change& change, Direction direction)
{
    return std::visit(
        [&](const auto& record) { return part_for(document, record).why_it_does_not_fit(record, direction); }, change);
}

}  // namespace

void apply(Document& document, const Change& change, Direction direction)
{
    std::visit([&](const auto& record) { part_for(document, record).apply(record, direction); }, change);
}

void apply_if_it_fits(Document& document, std::span<const Change> changes, Direction direction)
{
    // Selection and settings records are applied without comparing old values, so applying such a record backwards may
    // not restore the value before. Therefore both are copied first.
    const TraceSelection selection = document.trace.selection();
    const Settings settings = document.settings;
    for (size_t i = 0; i < changes.size(); ++i) {
        const Change& change = in_order(changes, i, direction);
        const std::string reason = why_it_does_not_fit(document, change, direction);
        if (reason.empty()) {
            apply(document, change, direction);
            continue;
        }
        while (i > 0) {
            const Change& applied = in_order(changes, --i, direction);
            if (why_it_does_not_fit(document, applied, opposite(direction)).empty())
                apply(document, applied, opposite(direction));
        }
        document.trace.select(selection);
        document.settings = settings;
        fail(reason);
    }
}

uint64_t memory_of(std::span<const Change> changes)
{
    uint64_t bytes = changes.size_bytes();
    const ByKind more{
        [](const MaskBrickChange& mask) { return mask.runs.size() * sizeof(MaskRun); },
        [](const DensityBrickChange& density) { return density.runs.size() * sizeof(DensityRun); },
        [](const TraceChange&) { return size_t{0}; },
        [](const SettingChange& setting) { return setting.name.size() + setting.before.size() + setting.after.size(); },
    };
    for (const Change& change : changes) bytes += std::visit(more, change);
    return bytes;
}

Touched touched_by(const Document& document, std::span<const Change> changes)
{
    Touched touched;
    const ByKind touch{
        [&](const MaskBrickChange& mask) {
            touched.voxels += mask.voxels();
            touched.mask_bricks.push_back(mask.brick);
        },
        [&](const DensityBrickChange& density) {
            touched.voxels += density.voxels();
            touched.raised.push_back(document.density.reach_of(density));
        },
        [&](const TraceChange&) { touched.trace = true; },
        [&](const SettingChange&) { touched.settings = true; },
    };
    for (const Change& change : changes) std::visit(touch, change);
    return touched;
}

}  // namespace shvr
