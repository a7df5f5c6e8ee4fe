#include "engine/passes/occlusion.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace shvr {

namespace {

/// Half a voxel more than what keeps a ray that grazes a plane out of it: real edges are a voxel or two wide.
constexpr double LIFT = 1.5;
constexpr double LIFT_OF_LARGE_CELLS = 0.5;  ///< per voxel of their side beyond the first
constexpr double NO_SHADOW = 0.5;            ///< units: to the voxel's own border

/// For a radius of 16: 1, 2 | 3.5, 5.5 | 8.5, 12.5, 15.25. Stretches of one, two and four units, as the cells have.
constexpr double STRETCHES[] = {1, 1, 2, 2, 4, 4, 4};
constexpr uint32_t SIZES[] = {0, 0, 1, 1, 2, 2, 2};  ///< log2 of the cell's side
constexpr double PATTERN_RADIUS = 16.0;
static_assert(std::size(STRETCHES) == gpu::OCCLUSION_MOST_TAPS);

std::string variant(const char* kernel, const VolumeBinding& volume)
{
    return std::string(kernel) + (volume.pages ? "_paged" : "") + (volume.filtered ? "_filtered" : "");
}

}  // namespace

OcclusionTaps occlusion_taps(double radius)
{
    OcclusionTaps result{.radius = radius, .first = radius < 1.0 ? radius : NO_SHADOW};
    const double scale = std::max(1.0, radius / PATTERN_RADIUS);
    double begin = result.first;
    for (size_t i = 0; radius >= 1.0 && i < std::size(STRETCHES) && begin < radius; ++i) {
        double end = i == 0 ? scale + NO_SHADOW : begin + scale * STRETCHES[i];
        // The last one takes the rest, and what would be too short for one of its own.
        if (end + 0.25 > radius || i + 1 == std::size(STRETCHES)) end = radius;
        const double cell = double(1u << SIZES[i]), stretch = end - begin;
        result.taps.push_back({.distance = float(std::max(0.5 * (begin + end), 1.0)),
                               .lift = float(LIFT + LIFT_OF_LARGE_CELLS * (cell - 1.0)),
                               .stretch = float(stretch)});
        for (uint32_t size = SIZES[i]; size < gpu::OCCLUSION_SIZES; ++size)
            result.end[size] = uint32_t(result.taps.size());
        for (int code = 0; code < 256; ++code) {
            const double opacity = double(code * code) / (255.0 * 255.0);
            result.passed.push_back(opacity < 1.0 ? float(std::exp(stretch / cell * std::log1p(-opacity))) : 0.0f);
        }
        begin = end;
    }
    return result;
}

std::vector<glm::vec4> occlusion_directions(uint32_t count)
{
    std::vector<glm::vec4> directions;
    const double turn = std::numbers::pi * (3.0 - std::sqrt(5.0));
    for (uint32_t k = 0; k < count; ++k) {
        const double z = 1.0 - (2.0 * k + 1.0) / count, r = std::sqrt(1.0 - z * z);
        directions.emplace_back(r * std::cos(turn * k), r * std::sin(turn * k), z, 0.0);
    }
    return directions;
}

uint32_t occlusion_reach(double radius)
{
    // A tap lies within the radius and its lift; 4 holds that, and the voxel itself.
    return std::max(1u, uint32_t(std::ceil((radius + 4.0) / gpu::BRICK_SIZE)));
}

void occlusion_reset(FrameGraph& graph, OcclusionBinding& occlusion, std::span<const uint32_t> slots, bool with_empty)
{
    constexpr uint64_t BYTES = uint64_t{gpu::BRICK_TEXELS} * gpu::BRICK_TEXELS * gpu::BRICK_TEXELS;
    const auto filled = [&](uint32_t value) {
        return graph.fill(graph.create("occlusion start", buffer_desc(BYTES)), value, "start occlusion");
    };
    std::vector<ImageRegion> regions;
    for (const uint32_t slot : slots) regions.push_back({0, gpu::slot_origin(slot), glm::uvec3(gpu::BRICK_TEXELS)});
    if (!regions.empty())
        occlusion.values =
            graph.copy_to_image(filled(~0u), occlusion.values, std::move(regions), "reset occlusion values");
    if (!with_empty) return;
    const Resource zeros = filled(0);
    for (uint32_t size = 0; size < gpu::OCCLUSION_SIZES; ++size)
        occlusion.cells[size] =
            graph.copy_to_image(zeros, occlusion.cells[size], {{0, glm::uvec3(0), glm::uvec3(gpu::BRICK_SIZE >> size)}},
                                "clear occlusion cells");
}

void occlusion_cells(FrameGraph& graph, const VolumeBinding& volume, OcclusionBinding& occlusion,
                     const OcclusionCellsInput& input, std::span<const gpu::OcclusionCellsJob> jobs)
{
    Pass pass = graph.compute(variant("occlusion_cells", volume) + (input.mask ? "_masked" : ""), "occlusion_cells");
    gpu::OcclusionCellsParams params = input.params;
    if (input.mask) {
        params.mask_slots = input.mask->slots;
        pass.read("mask", input.mask->mask);
        pass.read("mask_table", input.mask->mask_table);
        pass.block("group_opacities", std::span<const float>(input.group_opacities));
    }
    pass.block("params_block", std::span<const gpu::OcclusionCellsParams>(&params, 1));
    pass.block("jobs", jobs);
    pass.block("opacities", std::span<const float>(input.opacities));
    pass.read("atlas", volume.atlas);
    pass.dispatch({8 * uint32_t(jobs.size()), 8, 1});
    const char* const names[] = {"cells_1", "cells_2", "cells_4"};
    for (size_t size = 0; size < gpu::OCCLUSION_SIZES; ++size)
        occlusion.cells[size] = pass.write(names[size], occlusion.cells[size]);
}

void occlusion_bake(FrameGraph& graph, const VolumeBinding& volume, OcclusionBinding& occlusion,
                    const OcclusionInput& input, std::span<const gpu::OcclusionJob> jobs,
                    std::span<const uint32_t> around)
{
    Pass pass = graph.compute(variant("occlusion_bake", volume), "occlusion_bake");
    gpu::OcclusionParams params = input.params;
    params.radius = float(input.taps.radius);
    params.first = float(input.taps.first);
    params.rays = uint32_t(input.directions.size());
    params.reach = occlusion_reach(input.taps.radius);
    for (size_t size = 0; size < gpu::OCCLUSION_SIZES; ++size) params.taps_end[size] = input.taps.end[size];
    params.cell_counts = volume.cell_counts;
    pass.block("params_block", std::span<const gpu::OcclusionParams>(&params, 1));
    pass.block("jobs", jobs);
    pass.block("bricks_around", around);
    pass.block("directions", std::span<const glm::vec4>(input.directions));
    // Blocks are never empty.
    const gpu::OcclusionTap no_tap{};
    const float nothing = 1.0f;
    pass.block("taps", input.taps.taps.empty() ? std::span(&no_tap, 1) : std::span(input.taps.taps));
    pass.block("passed", input.taps.taps.empty() ? std::span(&nothing, 1) : std::span(input.taps.passed));
    pass.read("atlas", volume.atlas);
    const char* const names[] = {"cells_1", "cells_2", "cells_4"};
    for (size_t size = 0; size < gpu::OCCLUSION_SIZES; ++size) pass.read(names[size], occlusion.cells[size]);
    if (volume.pages)
        pass.read("cell_leap", volume.pages->cell_leap);
    else
        pass.read("leap", volume.leap);
    pass.dispatch({8 * uint32_t(jobs.size()), 8, gpu::OCCLUSION_SPLIT});
    occlusion.values = pass.write("values", occlusion.values);
}

}  // namespace shvr
