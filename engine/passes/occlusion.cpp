#include "engine/passes/occlusion.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/passes/occlusion_stretch.h"
#include "engine/passes/pixel_groups.h"

namespace shvr {

namespace {

/// Maximum distance between a voxel and the points where its rays start.
constexpr double MAX_OFFSET = double(gpu::OCCLUSION_FURTHEST) + double(gpu::OCCLUSION_LIFT);

/// Stretches (the ray length that one tap covers) for a radius of 16, in voxels of the level: for taps in voxels, in
/// cells of two voxels and in cells of four voxels. The last two grow with the radius. Smaller radii have fewer taps.
constexpr double NEAR_STRETCH = 1.035;
constexpr double NEAR_STRETCHES[] = {NEAR_STRETCH, NEAR_STRETCH, 2.0 * NEAR_STRETCH};
constexpr double NEAR_TOTAL = 4.0 * NEAR_STRETCH;
constexpr uint32_t FAR_SIZES[] = {0, 0, 0, 1, 1}, ALL_OF_2[std::size(FAR_SIZES)] = {};
constexpr double STRETCHES_OF_SIZES[] = {2.077, 2.815};
constexpr double MAX_STRETCH_2 = 8.6;  ///< beyond this, only the stretches of taps in cells of four voxels grow
constexpr uint32_t MAX_APRON = 14;     ///< maximum apron, in cells of either size, for the largest radius
constexpr double MAX_STRETCHED = 1.2;  ///< stretches grow by up to this factor before a tap is added
static_assert(std::size(FAR_SIZES) == gpu::OCCLUSION_TAPS_2 + gpu::OCCLUSION_TAPS_4);
static_assert(3.0 * NEAR_STRETCH + MAX_OFFSET + 0.5 < gpu::OCCLUSION_NEAR_APRON + 1);
static_assert(gpu::OCCLUSION_NEAR_APRON_PAGED >= gpu::OCCLUSION_NEAR_APRON + gpu::BRICK_APRON);

/// Angle between successive directions: the golden angle.
const double TURN = std::numbers::pi * (3.0 - std::sqrt(5.0));

}  // namespace

namespace {

/// Size of the scratch image for this many jobs; gpu::scratch_place locates a job's texels.
glm::uvec3 scratch_places(uint32_t jobs)
{
    const uint32_t columns = (jobs + gpu::OCCLUSION_COLUMN - 1) / gpu::OCCLUSION_COLUMN;
    const uint32_t rows = (columns + gpu::OCCLUSION_COLUMNS_A_ROW - 1) / gpu::OCCLUSION_COLUMNS_A_ROW;
    return {std::min(columns, gpu::OCCLUSION_COLUMNS_A_ROW), rows, std::min(jobs, gpu::OCCLUSION_COLUMN)};
}

}  // namespace

ResourceDesc occlusion_near_desc(uint32_t jobs, bool is_paged)
{
    const uint32_t side = is_paged ? gpu::OCCLUSION_NEAR_SIDE_PAGED : gpu::OCCLUSION_NEAR_SIDE;
    return image_desc(Format::r32_uint, side * scratch_places(jobs));
}

ResourceDesc occlusion_around_desc(uint32_t size, uint32_t jobs)
{
    const uint32_t side = (gpu::BRICK_SIZE >> (size + 1)) + 2 * MAX_APRON;
    return image_desc(Format::r32_uint, side * scratch_places(jobs));
}

namespace {

OcclusionTaps taps_in(std::span<const uint32_t> far_sizes, double radius, bool is_paged)
{
    const double max_offset = MAX_OFFSET + (is_paged ? gpu::BRICK_APRON : 0);
    OcclusionTaps result{.radius = radius, .first = radius < 1.0 ? radius : 0.0};
    if (radius < 1.0) return result;
    double begin = 0.0;
    const auto add = [&](double stretch) {
        result.taps.push_back({float(begin + 0.5 * stretch), float(stretch)});
        begin += stretch;
    };
    const double near = std::min(1.0, radius / NEAR_TOTAL);
    result.near_stretch = near * NEAR_STRETCH;
    for (const double stretch : NEAR_STRETCHES) add(near * stretch);
    result.end.fill(gpu::OCCLUSION_NEAR_TAPS);
    const double rest = radius - begin;
    double covered = 0.0;
    size_t count = 0;
    while (rest > 1e-6 && count < far_sizes.size() && rest > MAX_STRETCHED * covered)
        covered += STRETCHES_OF_SIZES[far_sizes[count++]];
    const double grown = count > 0 ? rest / covered : 1.0;
    const size_t of_4 = size_t(std::ranges::count(far_sizes.first(count), 1u)), of_2 = count - of_4;
    result.stretches = {grown * STRETCHES_OF_SIZES[0], grown * STRETCHES_OF_SIZES[1]};
    if (of_4 > 0 && result.stretches[0] > MAX_STRETCH_2)
        result.stretches = {MAX_STRETCH_2, (rest - double(of_2) * MAX_STRETCH_2) / double(of_4)};
    for (size_t i = 0; i < count; ++i) {
        const uint32_t size = far_sizes[i];
        add(result.stretches[size]);
        for (uint32_t later = size; later < gpu::OCCLUSION_SIZES; ++later) ++result.end[later + 1];
        const double cell = 2 << size;
        result.aprons[size] = uint32_t(std::ceil((double(result.taps.back().distance) + max_offset) / cell));
        SHVR_CHECK(result.aprons[size] <= MAX_APRON);
    }
    return result;
}

bool are_cubes(const glm::dvec3& spacing)
{
    return spacing == glm::dvec3(spacing.x);
}

}  // namespace

OcclusionTaps occlusion_taps(double radius, bool is_paged)
{
    return taps_in(FAR_SIZES, radius, is_paged);
}

OcclusionTaps occlusion_taps_of(const glm::dvec3& spacing, double radius, bool is_paged)
{
    const bool is_of_2 = !are_cubes(spacing) && radius <= OCCLUSION_MAX_RADIUS_OF_2;
    return taps_in(is_of_2 ? ALL_OF_2 : FAR_SIZES, radius, is_paged);
}

uint32_t occlusion_reach(double radius)
{
    // Every tap lies within `radius` of the ray's start. The other 4 voxels are for the voxel itself and for the
    // distance from the voxel to the ray's start.
    return std::max(1u, uint32_t(std::ceil((radius + 4.0) / gpu::BRICK_SIZE)));
}

void occlusion_reset(FrameGraph& graph, OcclusionBinding& occlusion, std::span<const uint32_t> slots)
{
    if (slots.empty()) return;
    constexpr uint64_t BYTES = uint64_t{gpu::BRICK_TEXELS} * gpu::BRICK_TEXELS * gpu::BRICK_TEXELS;
    const Resource lit = graph.fill(graph.create("occlusion start", buffer_desc(BYTES)), ~0u, "start occlusion");
    std::vector<ImageRegion> regions;
    for (const uint32_t slot : slots) regions.push_back({0, gpu::slot_origin(slot), glm::uvec3(gpu::BRICK_TEXELS)});
    occlusion.values = graph.copy_to_image(lit, occlusion.values, std::move(regions), "reset occlusion values");
}

void occlusion_begin(FrameGraph& graph, OcclusionBinding& occlusion)
{
    occlusion.values = graph.fill(occlusion.values, 255, "begin occlusion values");
    for (Resource& cells : occlusion.cells) cells = graph.fill(cells, 0, "clear occlusion cells");
}

namespace {

void bind_opacities(Pass& pass, const OcclusionCellsInput& input)
{
    if (input.mask) {
        pass.read("mask", input.mask->mask);
        pass.read("mask_table", input.mask->mask_table);
        pass.block("group_opacities", std::span<const float>(input.group_opacities));
    }
    pass.block("opacities", std::span<const gpu::OcclusionEntry>(input.opacities));
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
    const ResourceDesc of_one = occlusion_near_desc(1, volume.pages.has_value());
    const Resource zeros = graph.fill(graph.create("occlusion start", buffer_desc(of_one.bytes)), 0, "start occlusion");
    std::vector<ImageRegion> regions;
    for (uint32_t i = 0; i < jobs.size(); ++i)
        regions.push_back({0, of_one.texels * gpu::scratch_place(i), of_one.texels});
    scratch.near = graph.copy_to_image(zeros, scratch.near, std::move(regions), "clear occlusion scratch");
    Pass pass = graph.compute("occlusion_gather", {{"PAGED", volume.pages.has_value()},
                                                   {"FILTERED", volume.is_filtered()},
                                                   {"MASKED", input.near.mask.has_value()}});
    gpu::OcclusionGatherParams params{.voxels = input.near.params,
                                      .cell_counts = volume.cell_counts,
                                      .reach = occlusion_reach(input.taps.radius),
                                      .aprons = {},
                                      .exponents = {}};
    std::ranges::copy(input.taps.aprons, params.aprons);
    std::ranges::copy(input.exponents, params.exponents);
    pass.block("params_block", std::span<const gpu::OcclusionGatherParams>(&params, 1));
    pass.block("jobs", jobs);
    pass.block("bricks_around", around);
    bind_opacities(pass, input.near);
    read_atlas(pass, volume);
    bind_leap(pass, volume);
    group_each(pass, jobs.size(), gpu::OCCLUSION_SPLIT);
    for (size_t size = 0; volume.pages && size < gpu::OCCLUSION_SIZES; ++size) {
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
        {{"PAGED", volume.pages.has_value()}, {"FILTERED", volume.is_filtered()}, {"MASKED", input.mask.has_value()}});
    const gpu::OcclusionCellsParams& params = input.params;
    pass.block("params_block", std::span<const gpu::OcclusionCellsParams>(&params, 1));
    pass.block("jobs", jobs);
    bind_opacities(pass, input);
    read_atlas(pass, volume);
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
    Pass pass =
        graph.compute("occlusion_bake", {{"PAGED", volume.pages.has_value()}, {"FILTERED", volume.is_filtered()}});
    gpu::OcclusionBakeParams params = input.params;
    params.radius = float(input.taps.radius);
    params.first = float(input.taps.first);
    params.turn_cos = float(std::cos(TURN));
    params.turn_sin = float(std::sin(TURN));
    params.reach = occlusion_reach(input.taps.radius);
    std::ranges::copy(input.taps.aprons, params.aprons);
    params.cell_counts = volume.cell_counts;
    constexpr gpu::OcclusionTap UNUSED{.distance = 0.0f, .stretch = 0.0f};
    std::ranges::fill(params.near_taps, UNUSED);
    std::ranges::fill(params.taps_2, UNUSED);
    std::ranges::fill(params.taps_4, UNUSED);
    const OcclusionTaps& taps = input.taps;
    for (uint32_t i = 0; i < taps.end[0]; ++i) params.near_taps[i] = taps.taps[i];
    for (uint32_t i = taps.end[0]; i < taps.end[2]; ++i) {
        const uint32_t far = i - taps.end[0];
        (far < gpu::OCCLUSION_TAPS_2 ? params.taps_2[far] : params.taps_4[far - gpu::OCCLUSION_TAPS_2]) = taps.taps[i];
    }
    if (!are_cubes(glm::dvec3(params.inverse_spacing))) pass.constant("STRETCHED", taps.end[2] > taps.end[1] ? 1 : 2);
    params.far_exponent = float(taps.stretches[1] / std::max(taps.near_stretch, 1e-3));
    params.voxels = input.near.params;
    pass.block("params_block", std::span<const gpu::OcclusionBakeParams>(&params, 1));
    pass.block("jobs", jobs);
    pass.block("bricks_around", around);
    pass.block("opacities", std::span<const gpu::OcclusionEntry>(input.near.opacities));
    pass.block("visible_intervals", std::span<const uint32_t>(input.visible_intervals));
    read_atlas(pass, volume);
    pass.read("near", scratch.near);
    for (size_t size = 0; size < gpu::OCCLUSION_SIZES; ++size)
        if (volume.pages)
            pass.read(AROUND_NAMES[size], scratch.around[size]);
        else
            pass.read(CELL_NAMES[size], occlusion.cells[size]);
    bind_leap(pass, volume);
    group_each(pass, jobs.size(), gpu::OCCLUSION_SPLIT);
    occlusion.values = pass.write("values", occlusion.values);
}

}  // namespace shvr
