#include "engine/passes/leap_grid.h"

#include <algorithm>

namespace shvr {

namespace {

constexpr glm::uvec3 WORD(gpu::LEAP_WORD_CELLS, 1, 1);

/// Returns `value`, rounded up to whole words.
constexpr uint32_t in_words(uint32_t value)
{
    return (value + WORD.x - 1) / WORD.x * WORD.x;
}

CellBox widened(const CellBox& box, const glm::uvec3& reach, const glm::uvec3& counts)
{
    return {box.begin - glm::min(box.begin, reach), glm::min(box.end + reach, counts)};
}

/// The cells that a stage must compute: those that the changed cells can affect, and the cells around these that later
/// stages read. Whole words.
CellBox cells_of_stage(const CellBox& changed, const glm::uvec3& counts, uint32_t stage)
{
    // A distance is at most LEAP_LIMIT, so the last stage covers LEAP_LIMIT cells around the change. The result of each
    // stage is read by later stages along their axes: stage 1 runs along x, stage 2 along y, stage 3 along z.
    constexpr glm::uvec3 FAR(in_words(gpu::LEAP_LIMIT), gpu::LEAP_LIMIT, gpu::LEAP_LIMIT);
    const glm::uvec3 reach = FAR * (1u + glm::uvec3(stage < 1, stage < 2, stage < 3));
    const glm::uvec3 end(in_words(changed.end.x), changed.end.y, changed.end.z);
    return widened({changed.begin / WORD * WORD, end}, reach, counts);
}

/// Writes entries of the grid to `to` if it is a patch, else words.
void occupancy(FrameGraph& graph, const VolumeBinding& volume, const LeapGridInput& input, const CellBox& cells,
               bool is_patch, Resource& to)
{
    Pass pass = graph.compute("leap_occupancy", {{"MASKED", input.mask.has_value()}, {"PATCH", is_patch}});
    pass.read("cell_ranges", volume.cell_ranges);
    if (is_patch) pass.read("page_table", volume.page_table);
    pass.block("visible_intervals", std::span<const uint32_t>(input.visible_intervals));
    if (input.mask) {
        pass.read("mask", input.mask->mask);
        pass.read("mask_table", input.mask->mask_table);
        pass.block("visible_groups", std::span<const uint32_t>(input.visible_groups));
    }
    gpu::OccupancyParams params = input.params;
    params.cell_begin = cells.begin;
    params.cell_end = cells.end;
    params.empty_distance = is_patch ? 1 : gpu::LEAP_LIMIT;
    for (const bool patch : {false, true})  // needed once something is painted
        graph.expect({variant_of("leap_occupancy", {{"MASKED", true}, {"PATCH", patch}}), {}});
    graph.expect({"leap_bound", {}});
    pass.push(params);
    pass.dispatch((cells.end - cells.begin) / (is_patch ? glm::uvec3(1) : WORD));
    to = pass.write("leap", to);
}

/// Writes words to `to`, and entries of the grid for the last axis, z.
void distance(FrameGraph& graph, const VolumeBinding& volume, uint32_t axis, const CellBox& cells, Resource from,
              Resource& to)
{
    const char* const names[] = {"leap_distance x", "leap_distance y", "leap_distance z"};
    const bool is_last = axis == 2;
    Pass pass = graph.compute("leap_distance", {{"LAST", is_last}}, names[axis]);
    pass.read("source", from);
    if (is_last) pass.read("page_table", volume.page_table);
    pass.push(gpu::LeapDistanceParams{volume.cell_counts / WORD, cells.begin / WORD, cells.end / WORD, axis});
    pass.dispatch((cells.end - cells.begin) / WORD);
    to = pass.write("leap", to);
}

/// The maximum by which a sample's code may exceed the codes of the voxels of its bit (leap.h): the largest distance
/// from these voxels, summed over the axes, times the largest difference of codes.
float guard_of_sample_bits(const glm::uvec3& cell_counts)
{
    constexpr double CODES = 65535.0, EPSILON = 0x1p-24;
    const glm::uvec3 size = gpu::CELL_SIZE * cell_counts;
    const double side = std::max({size.x, size.y, size.z}), reach = gpu::SAMPLE_BITS_REACH;
    // Rounding errors of a length along the ray, of its product, and of the sum with the ray's start. All of them count
    // twice, since a distance is measured between two samples.
    const double of_floats = 2.0 * EPSILON * side * (3.0 * reach + (1.0 + reach));
    const double of_parts = (0.5 * gpu::SAMPLE_BITS_AHEAD + 1.0) / gpu::SAMPLE_BIT_PARTS;
    return float(1.0 + CODES * (3.0 * of_floats + of_parts * (1.0 + 1.0 / 4.0 + 1.0 / 16.0)));
}

/// Computes the sample bits. The bit of a sample between voxels of two cells is stored in the upper of these cells.
void sample_bits(FrameGraph& graph, VolumeBinding& volume, const LeapGridInput& input)
{
    if (!volume.sample_bits) return;
    // A cell next to a changed cell reads the changed cell's voxels, and whether that cell is empty.
    const CellBox cells{input.changed.begin - glm::min(input.changed.begin, glm::uvec3(1)),
                        glm::min(input.changed.end + 1u, volume.cell_counts)};
    Pass pass = graph.compute("sample_bits");
    pass.read("leap", volume.leap);
    read_atlas(pass, volume);
    const float guard = guard_of_sample_bits(volume.cell_counts);
    pass.push(gpu::SampleBitsParams{cells.begin, cells.end, input.params.table_lower - guard,
                                    input.params.table_upper + guard});
    pass.dispatch(cells.end - cells.begin);
    volume.sample_bits = pass.write("sample_bits", *volume.sample_bits);
}

}  // namespace

void leap_grid_stage(FrameGraph& graph, VolumeBinding& volume, const LeapGridInput& input, uint32_t stage)
{
    const CellBox cells = cells_of_stage(input.changed, volume.cell_counts, stage);
    switch (stage) {
        case 0: return occupancy(graph, volume, input, cells, false, volume.leap_scratch[0]);
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
    // The cells whose distance a changed cell may limit.
    const CellBox cells = widened(input.changed, glm::uvec3(gpu::LEAP_LIMIT), volume.cell_counts);
    Pass pass = graph.compute("leap_bound");
    pass.push(gpu::LeapBoundParams{cells.begin, cells.end, input.changed.begin, input.changed.end});
    pass.dispatch(cells.end - cells.begin);
    volume.leap = pass.modify("leap", volume.leap);
    const CellBox inside{input.changed.begin, glm::min(input.changed.end, volume.cell_counts)};
    occupancy(graph, volume, input, inside, true, volume.leap);
    sample_bits(graph, volume, input);
}

}  // namespace shvr
