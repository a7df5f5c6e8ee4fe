#include "engine/passes/occlusion.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/passes/pixel_groups.h"

namespace shvr {

namespace {

/// Half a voxel more than keeps grazing rays out of a plane: real edges are a voxel or two wide.
constexpr double LIFT = 1.5;
constexpr double LIFT_OF_LARGE_CELLS = 0.5;  ///< per voxel of their side beyond the first

/// In units, for a radius of 16: two taps each in half voxels, in cells of two voxels and in cells of four; their
/// stretches grow with the radius. Smaller radii have fewer taps.
constexpr double NEAR_STRETCH = 0.875;
constexpr double NO_SHADOW = 0.65;  ///< to the voxel's own border: a compromise between rays along its edges and across
constexpr uint32_t NEAR_TAPS = 2;
constexpr double FAR_STRETCHES[] = {2, 2, 4, 4};
constexpr uint32_t FAR_SIZES[] = {0, 0, 1, 1};
constexpr uint32_t MAX_APRON = 14;     ///< in cells of any size, for the largest radius
constexpr double MAX_STRETCHED = 1.2;  ///< before another tap is added
static_assert(NEAR_TAPS + std::size(FAR_STRETCHES) == gpu::OCCLUSION_MAX_TAPS);
static_assert(NO_SHADOW + (NEAR_TAPS - 0.5) * NEAR_STRETCH + LIFT + 0.5 < gpu::OCCLUSION_NEAR_APRON);

/// Angle between successive directions: the golden angle.
const double TURN = std::numbers::pi * (3.0 - std::sqrt(5.0));

}  // namespace

ResourceDesc occlusion_near_desc(uint32_t jobs)
{
    constexpr uint32_t SIDE = gpu::OCCLUSION_NEAR_SIDE;
    return image_desc(Format::r32_uint, {SIDE, SIDE, SIDE * jobs});
}

ResourceDesc occlusion_around_desc(uint32_t size, uint32_t jobs)
{
    const uint32_t side = (gpu::BRICK_SIZE >> (size + 1)) + 2 * MAX_APRON;
    return image_desc(Format::r8_uint, {side, side, side * jobs});
}

OcclusionTaps occlusion_taps(double radius)
{
    OcclusionTaps result{.radius = radius, .first = radius < 1.0 ? radius : NO_SHADOW};
    if (radius < 1.0) return result;
    double begin = result.first;
    const auto add = [&](double stretch, double lift) {
        const double middle = begin + 0.5 * stretch;
        result.taps.push_back({float(std::max(middle, 1.0)), float(lift), float(stretch)});
        begin += stretch;
    };
    result.near_stretch = std::min(NEAR_STRETCH, (radius - begin) / NEAR_TAPS);
    for (uint32_t i = 0; i < NEAR_TAPS; ++i) add(result.near_stretch, LIFT);
    result.end.fill(NEAR_TAPS);
    const double rest = radius - begin;
    double covered = 0.0;
    size_t count = 0;
    while (rest > 1e-6 && count < std::size(FAR_STRETCHES) && rest > MAX_STRETCHED * covered)
        covered += FAR_STRETCHES[count++];
    if (count > 0) result.exponent = rest / covered;
    for (size_t i = 0; i < count; ++i) {
        const uint32_t size = FAR_SIZES[i];
        const double cell = 2 << size;
        add(result.exponent * FAR_STRETCHES[i], LIFT + LIFT_OF_LARGE_CELLS * (cell - 1.0));
        for (uint32_t later = size; later < gpu::OCCLUSION_SIZES; ++later) ++result.end[later + 1];
        const gpu::OcclusionTap& tap = result.taps.back();
        result.aprons[size] = uint32_t(std::ceil((double(tap.distance) + double(tap.lift)) / cell));
        SHVR_CHECK(result.aprons[size] <= MAX_APRON);
    }
    return result;
}

uint32_t occlusion_reach(double radius)
{
    // A tap lies within the radius plus its lift; 4 covers the lift and the voxel itself.
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
        occlusion.cells[size] = graph.copy_to_image(zeros, occlusion.cells[size],
                                                    {{0, glm::uvec3(0), glm::uvec3(gpu::BRICK_SIZE >> (size + 1))}},
                                                    "clear occlusion cells");
}

namespace {

void bind_opacities(Pass& pass, const OcclusionCellsInput& input)
{
    if (input.mask) {
        pass.read("mask", input.mask->mask);
        pass.read("mask_table", input.mask->mask_table);
        pass.block("group_opacities", std::span<const float>(input.group_opacities));
    }
    pass.block("opacities", std::span<const float>(input.opacities));
}

void bind_leap(Pass& pass, const VolumeBinding& volume)
{
    if (volume.pages)
        pass.read("cell_leap", volume.pages->cell_leap);
    else
        pass.read("leap", volume.leap);
}

constexpr const char* CELL_NAMES[] = {"cells_2", "cells_4"};
constexpr const char* AROUND_NAMES[] = {"around_2", "around_4"};

void gather(FrameGraph& graph, const VolumeBinding& volume, const OcclusionBinding& occlusion,
            OcclusionScratch& scratch, const OcclusionInput& input, std::span<const gpu::OcclusionJob> jobs,
            std::span<const uint32_t> around)
{
    constexpr uint32_t SIDE = gpu::OCCLUSION_NEAR_SIDE;
    const Resource zeros = graph.fill(graph.create("occlusion start", buffer_desc(uint64_t{4} * SIDE * SIDE * SIDE)), 0,
                                      "start occlusion");
    std::vector<ImageRegion> regions;
    for (uint32_t i = 0; i < jobs.size(); ++i) regions.push_back({0, {0, 0, SIDE * i}, glm::uvec3(SIDE)});
    scratch.near = graph.copy_to_image(zeros, scratch.near, std::move(regions), "clear occlusion scratch");
    Pass pass = graph.compute(
        "occlusion_gather",
        {{"PAGED", volume.pages.has_value()}, {"FILTERED", volume.filtered}, {"MASKED", input.near.mask.has_value()}});
    gpu::OcclusionGatherParams params{.voxels = input.near.params,
                                      .cell_counts = volume.cell_counts,
                                      .reach = occlusion_reach(input.taps.radius),
                                      .aprons = {},
                                      .exponent = float(input.taps.exponent)};
    std::ranges::copy(input.taps.aprons, params.aprons);
    pass.block("params_block", std::span<const gpu::OcclusionGatherParams>(&params, 1));
    pass.block("jobs", jobs);
    pass.block("bricks_around", around);
    bind_opacities(pass, input.near);
    pass.read("atlas", volume.atlas);
    bind_leap(pass, volume);
    group_each(pass, jobs.size(), gpu::OCCLUSION_SPLIT);
    for (size_t size = 0; size < gpu::OCCLUSION_SIZES; ++size) {
        pass.read(CELL_NAMES[size], occlusion.cells[size]);
        scratch.around[size] = pass.write(AROUND_NAMES[size], scratch.around[size]);
    }
    scratch.near = pass.write("near", scratch.near);
}

}  // namespace

void occlusion_cells(FrameGraph& graph, const VolumeBinding& volume, OcclusionBinding& occlusion,
                     const OcclusionCellsInput& input, std::span<const gpu::OcclusionCellsJob> jobs)
{
    Pass pass = graph.compute(
        "occlusion_cells",
        {{"PAGED", volume.pages.has_value()}, {"FILTERED", volume.filtered}, {"MASKED", input.mask.has_value()}});
    const gpu::OcclusionCellsParams& params = input.params;
    pass.block("params_block", std::span<const gpu::OcclusionCellsParams>(&params, 1));
    pass.block("jobs", jobs);
    bind_opacities(pass, input);
    pass.read("atlas", volume.atlas);
    group_each(pass, jobs.size());
    for (size_t size = 0; size < gpu::OCCLUSION_SIZES; ++size)
        occlusion.cells[size] = pass.write(CELL_NAMES[size], occlusion.cells[size]);
}

void occlusion_bake(FrameGraph& graph, const VolumeBinding& volume, OcclusionBinding& occlusion,
                    OcclusionScratch& scratch, const OcclusionInput& input, std::span<const gpu::OcclusionJob> jobs,
                    std::span<const uint32_t> around)
{
    SHVR_CHECK(jobs.size() <= gpu::OCCLUSION_SLICE);
    gather(graph, volume, occlusion, scratch, input, jobs, around);
    Pass pass = graph.compute("occlusion_bake", {{"PAGED", volume.pages.has_value()}, {"FILTERED", volume.filtered}});
    gpu::OcclusionBakeParams params = input.params;
    params.radius = float(input.taps.radius);
    params.first = float(input.taps.first);
    params.turn_cos = float(std::cos(TURN));
    params.turn_sin = float(std::sin(TURN));
    params.reach = occlusion_reach(input.taps.radius);
    std::ranges::copy(input.taps.aprons, params.aprons);
    params.cell_counts = volume.cell_counts;
    std::ranges::fill(params.taps, gpu::OcclusionTap{.distance = 1.0f, .lift = 0.0f, .stretch = 0.0f});
    // The taps of each size start at a fixed place.
    for (uint32_t size = 0, i = 0; size <= gpu::OCCLUSION_SIZES; ++size)
        for (uint32_t of_size = 0; i < input.taps.end[size]; ++i, ++of_size)
            params.taps[gpu::OCCLUSION_TAPS_EACH * size + of_size] = input.taps.taps[i];
    pass.block("params_block", std::span<const gpu::OcclusionBakeParams>(&params, 1));
    pass.block("jobs", jobs);
    pass.block("bricks_around", around);
    pass.read("atlas", volume.atlas);
    pass.read("near", scratch.near);
    for (size_t size = 0; size < gpu::OCCLUSION_SIZES; ++size) pass.read(AROUND_NAMES[size], scratch.around[size]);
    bind_leap(pass, volume);
    group_each(pass, jobs.size(), gpu::OCCLUSION_SPLIT);
    occlusion.values = pass.write("values", occlusion.values);
}

}  // namespace shvr
