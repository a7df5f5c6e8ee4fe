#include "engine/passes/leap_grid.h"

namespace shvr {

Resource leap_grid(FrameGraph& graph, const VolumeBinding& volume, const LeapGridInput& input)
{
    Resource scratch = graph.create("leap scratch", image_desc(Format::r32_uint, volume.cell_counts));

    Pass occupancy = graph.compute(input.mask ? "leap_occupancy_masked" : "leap_occupancy");
    occupancy.read("cell_ranges", volume.cell_ranges);
    occupancy.read("page_table", volume.page_table);
    occupancy.block("visible_intervals", std::span<const uint32_t>(input.visible_intervals));
    if (input.mask) {
        occupancy.read("mask", input.mask->mask);
        occupancy.read("mask_table", input.mask->mask_table);
        occupancy.block("visible_groups", std::span<const uint32_t>(input.visible_groups));
    }
    occupancy.push(input.params);
    occupancy.dispatch(volume.cell_counts);
    scratch = occupancy.write("leap", scratch);

    Resource from = scratch;
    Resource to = volume.leap;
    for (uint32_t axis = 0; axis < 3; ++axis) {
        const char* const names[] = {"leap_distance x", "leap_distance y", "leap_distance z"};
        Pass distance = graph.compute("leap_distance", names[axis]);
        distance.read("source", from);
        const Resource written = distance.write("leap", to);
        distance.push(gpu::LeapDistanceParams{volume.cell_counts, axis});
        distance.dispatch(volume.cell_counts);
        to = from;
        from = written;
    }
    return from;  // x and z wrote the leap grid, y the scratch
}

}  // namespace shvr
