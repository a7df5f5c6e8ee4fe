#include "engine/passes/leap_grid.h"

namespace shvr {

namespace {

/// The cells that a stage must compute: those that the changed cells can affect, and what later stages read around
/// them.
CellBox cells_of_stage(const CellBox& changed, const glm::uvec3& counts, uint32_t stage)
{
    // A distance is at most LEAP_LIMIT, so the last stage covers one reach around the change. Stage s is read along the
    // axes of the stages after it: x by stage 1, y by stage 2, z by stage 3.
    const glm::uvec3 reach = gpu::LEAP_LIMIT * (1u + glm::uvec3(stage < 1, stage < 2, stage < 3));
    return {changed.begin - glm::min(changed.begin, reach), glm::min(changed.end + reach, counts)};
}

void occupancy(FrameGraph& graph, const VolumeBinding& volume, const LeapGridInput& input, const CellBox& cells,
               uint32_t empty_distance, Resource& to)
{
    Pass pass = graph.compute("leap_occupancy", {{"MASKED", input.mask.has_value()}});
    pass.read("cell_ranges", volume.cell_ranges);
    pass.read("page_table", volume.page_table);
    pass.block("visible_intervals", std::span<const uint32_t>(input.visible_intervals));
    if (input.mask) {
        pass.read("mask", input.mask->mask);
        pass.read("mask_table", input.mask->mask_table);
        pass.block("visible_groups", std::span<const uint32_t>(input.visible_groups));
    }
    gpu::OccupancyParams params = input.params;
    params.cell_begin = cells.begin;
    params.cell_end = cells.end;
    params.empty_distance = empty_distance;
    graph.expect({variant_of("leap_occupancy", {{"MASKED", true}}), {}});  // once something is painted
    graph.expect({"leap_bound", {}});
    pass.push(params);
    pass.dispatch(cells.end - cells.begin);
    to = pass.write("leap", to);
}

void distance(FrameGraph& graph, const VolumeBinding& volume, uint32_t axis, const CellBox& cells, Resource from,
              Resource& to)
{
    const char* const names[] = {"leap_distance x", "leap_distance y", "leap_distance z"};
    Pass pass = graph.compute("leap_distance", names[axis]);
    pass.read("source", from);
    pass.push(gpu::LeapDistanceParams{volume.cell_counts, cells.begin, cells.end, axis});
    pass.dispatch(cells.end - cells.begin);
    to = pass.write("leap", to);
}

/// A sample between the voxels of two cells has its bit in the upper one.
void sample_bits(FrameGraph& graph, VolumeBinding& volume, const LeapGridInput& input)
{
    if (!volume.sample_bits) return;
    const CellBox cells{input.changed.begin, glm::min(input.changed.end + 1u, volume.cell_counts)};
    Pass pass = graph.compute("sample_bits");
    pass.read("leap", volume.leap);
    read_atlas(pass, volume);
    // A code next to what is seen counts: the ray caster's rounding may move a sample a few ulp past its voxels' codes.
    pass.push(gpu::SampleBitsParams{cells.begin, cells.end, input.params.table_lower - 1.0f,
                                    input.params.table_upper + 1.0f});
    pass.dispatch(cells.end - cells.begin);
    volume.sample_bits = pass.write("sample_bits", *volume.sample_bits);
}

}  // namespace

void leap_grid_stage(FrameGraph& graph, VolumeBinding& volume, const LeapGridInput& input, uint32_t stage)
{
    const CellBox cells = cells_of_stage(input.changed, volume.cell_counts, stage);
    switch (stage) {
        case 0: return occupancy(graph, volume, input, cells, gpu::LEAP_LIMIT, volume.leap_scratch[0]);
        case 1: return distance(graph, volume, 0, cells, volume.leap_scratch[0], volume.leap_scratch[1]);
        case 2: return distance(graph, volume, 1, cells, volume.leap_scratch[1], volume.leap_scratch[0]);
        case 3:
            distance(graph, volume, 2, cells, volume.leap_scratch[0], volume.leap);
            return sample_bits(graph, volume, input);
        default: SHVR_CHECK(false, "stage ", stage);
    }
}

void leap_grid_patch(FrameGraph& graph, VolumeBinding& volume, const LeapGridInput& input)
{
    // As in the last stage: the cells whose distance the changed ones may limit.
    const CellBox cells = cells_of_stage(input.changed, volume.cell_counts, LEAP_STAGES - 1);
    Pass pass = graph.compute("leap_bound");
    pass.push(gpu::LeapBoundParams{cells.begin, cells.end, input.changed.begin, input.changed.end});
    pass.dispatch(cells.end - cells.begin);
    volume.leap = pass.modify("leap", volume.leap);
    const CellBox inside{input.changed.begin, glm::min(input.changed.end, volume.cell_counts)};
    occupancy(graph, volume, input, inside, 1, volume.leap);
    sample_bits(graph, volume, input);
}

}  // namespace shvr
