// One struct, two languages: the kernels' offsets equal those of the C++ compiler.

#include <cstddef>

#include <doctest/doctest.h>

#include "engine/gpu/embedded_kernels.h"
#include "engine/gpu/kernel.h"
#include "shaders/brick_unpack.h"
#include "shaders/mix.h"
#include "shaders/occlusion/occlusion_bake.h"
#include "shaders/pages.h"
#include "shaders/preview.h"
#include "shaders/raycast.h"
#include "shaders/regions/regions.h"
#include "shaders/saturation.h"
#include "shaders/surfaces.h"

using namespace shvr;

namespace {

using Members = std::vector<std::pair<const char*, size_t>>;

#define MEMBER(type, name)                                                                                             \
    {                                                                                                                  \
#name, offsetof(gpu::type, name)                                                                               \
    }

Members raycast_params()
{
    return {MEMBER(RaycastParams, near_corner),
            MEMBER(RaycastParams, near_dx),
            MEMBER(RaycastParams, near_dy),
            MEMBER(RaycastParams, far_corner),
            MEMBER(RaycastParams, far_dx),
            MEMBER(RaycastParams, far_dy),
            MEMBER(RaycastParams, pixel_begin),
            MEMBER(RaycastParams, pixel_end),
            MEMBER(RaycastParams, target),
            MEMBER(RaycastParams, drawn_begin),
            MEMBER(RaycastParams, drawn_end),
            MEMBER(RaycastParams, box_lower),
            MEMBER(RaycastParams, box_upper),
            MEMBER(RaycastParams, cut_plane),
            MEMBER(RaycastParams, position_limit),
            MEMBER(RaycastParams, spacing),
            MEMBER(RaycastParams, inverse_spacing),
            MEMBER(RaycastParams, page_counts),
            MEMBER(RaycastParams, page_shift),
            MEMBER(RaycastParams, page_depth),
            MEMBER(RaycastParams, step),
            MEMBER(RaycastParams, opacity_limit),
            MEMBER(RaycastParams, table_lower),
            MEMBER(RaycastParams, table_upper),
            MEMBER(RaycastParams, table_scale),
            MEMBER(RaycastParams, table_entries),
            MEMBER(RaycastParams, table_depths),
            MEMBER(RaycastParams, opaque_map),
            MEMBER(RaycastParams, opaque_scale),
            MEMBER(RaycastParams, first_step),
            MEMBER(RaycastParams, end_step),
            MEMBER(RaycastParams, is_last_block),
            MEMBER(RaycastParams, background),
            MEMBER(RaycastParams, light),
            MEMBER(RaycastParams, ambient),
            MEMBER(RaycastParams, diffuse),
            MEMBER(RaycastParams, specular),
            MEMBER(RaycastParams, shininess),
            MEMBER(RaycastParams, gradient_fade),
            MEMBER(RaycastParams, depth_plane),
            MEMBER(RaycastParams, blend_color),
            MEMBER(RaycastParams, blend_size),
            MEMBER(RaycastParams, blend_rate),
            MEMBER(RaycastParams, slice_black),
            MEMBER(RaycastParams, slice_scale),
            MEMBER(RaycastParams, slice_paint),
            MEMBER(RaycastParams, shell_center),
            MEMBER(RaycastParams, shell_reach),
            MEMBER(RaycastParams, shell_code),
            MEMBER(RaycastParams, shell_color),
            MEMBER(RaycastParams, shell_opacity),
            MEMBER(RaycastParams, points),
            MEMBER(RaycastParams, point_count)};
}

Members preview_params()
{
    return {MEMBER(PreviewParams, near_corner), MEMBER(PreviewParams, near_dx),       MEMBER(PreviewParams, near_dy),
            MEMBER(PreviewParams, far_corner),  MEMBER(PreviewParams, far_dx),        MEMBER(PreviewParams, far_dy),
            MEMBER(PreviewParams, size),        MEMBER(PreviewParams, words_per_row), MEMBER(PreviewParams, lower),
            MEMBER(PreviewParams, color),       MEMBER(PreviewParams, is_striped)};
}

Members surface_params()
{
    return {MEMBER(SurfaceParams, origin),
            MEMBER(SurfaceParams, origin_rest),
            MEMBER(SurfaceParams, middle_corner),
            MEMBER(SurfaceParams, middle_dx),
            MEMBER(SurfaceParams, middle_dy),
            MEMBER(SurfaceParams, along_corner),
            MEMBER(SurfaceParams, along_dx),
            MEMBER(SurfaceParams, along_dy),
            MEMBER(SurfaceParams, begin),
            MEMBER(SurfaceParams, middle),
            MEMBER(SurfaceParams, end),
            MEMBER(SurfaceParams, slack),
            MEMBER(SurfaceParams, node_count),
            MEMBER(SurfaceParams, first_node),
            MEMBER(SurfaceParams, end_node),
            MEMBER(SurfaceParams, nodes_in_round),
            MEMBER(SurfaceParams, is_first_round),
            MEMBER(SurfaceParams, is_last_round),
            MEMBER(SurfaceParams, probe_center),
            MEMBER(SurfaceParams, probe_radius),
            MEMBER(SurfaceParams, probe_color)};
}

Members occupancy_params()
{
    return {MEMBER(OccupancyParams, cell_begin),    MEMBER(OccupancyParams, cell_end),
            MEMBER(OccupancyParams, brick_counts),  MEMBER(OccupancyParams, table_lower),
            MEMBER(OccupancyParams, table_upper),   MEMBER(OccupancyParams, table_scale),
            MEMBER(OccupancyParams, table_entries), MEMBER(OccupancyParams, guard),
            MEMBER(OccupancyParams, skipping),      MEMBER(OccupancyParams, empty_distance),
            MEMBER(OccupancyParams, paint_reach)};
}

Members region_params()
{
    return {MEMBER(RegionParams, origin),        MEMBER(RegionParams, size),
            MEMBER(RegionParams, words_per_row), MEMBER(RegionParams, threshold_code),
            MEMBER(RegionParams, connectivity),  MEMBER(RegionParams, seed),
            MEMBER(RegionParams, brick_begin),   MEMBER(RegionParams, brick_counts)};
}

Members brick_leap_params()
{
    return {MEMBER(BrickLeapParams, table_lower), MEMBER(BrickLeapParams, table_upper),
            MEMBER(BrickLeapParams, table_scale), MEMBER(BrickLeapParams, table_entries),
            MEMBER(BrickLeapParams, guard),       MEMBER(BrickLeapParams, skipping),
            MEMBER(BrickLeapParams, paint_reach)};
}

Members brick_leap_jobs()
{
    return {MEMBER(BrickLeapJob, brick), MEMBER(BrickLeapJob, level), MEMBER(BrickLeapJob, slot),
            MEMBER(BrickLeapJob, mask_slot)};
}

Members occlusion_bake_params()
{
    return {MEMBER(OcclusionBakeParams, inverse_spacing), MEMBER(OcclusionBakeParams, radius),
            MEMBER(OcclusionBakeParams, first),           MEMBER(OcclusionBakeParams, gradient_fade),
            MEMBER(OcclusionBakeParams, full_sphere),     MEMBER(OcclusionBakeParams, rays),
            MEMBER(OcclusionBakeParams, turn_cos),        MEMBER(OcclusionBakeParams, turn_sin),
            MEMBER(OcclusionBakeParams, reach),           MEMBER(OcclusionBakeParams, grow),
            MEMBER(OcclusionBakeParams, table_lower),     MEMBER(OcclusionBakeParams, table_upper),
            MEMBER(OcclusionBakeParams, table_scale),     MEMBER(OcclusionBakeParams, table_entries),
            MEMBER(OcclusionBakeParams, guard),           MEMBER(OcclusionBakeParams, aprons),
            MEMBER(OcclusionBakeParams, cell_counts),     MEMBER(OcclusionBakeParams, near_taps),
            MEMBER(OcclusionBakeParams, taps_2),          MEMBER(OcclusionBakeParams, taps_4),
            MEMBER(OcclusionBakeParams, far_exponent),    MEMBER(OcclusionBakeParams, voxels)};
}

Members occlusion_gather_params()
{
    return {MEMBER(OcclusionGatherParams, voxels), MEMBER(OcclusionGatherParams, cell_counts),
            MEMBER(OcclusionGatherParams, reach), MEMBER(OcclusionGatherParams, aprons),
            MEMBER(OcclusionGatherParams, exponents)};
}

Members occlusion_cells_params()
{
    return {MEMBER(OcclusionCellsParams, table_lower),  MEMBER(OcclusionCellsParams, table_upper),
            MEMBER(OcclusionCellsParams, table_scale),  MEMBER(OcclusionCellsParams, table_entries),
            MEMBER(OcclusionCellsParams, level),        MEMBER(OcclusionCellsParams, lower),
            MEMBER(OcclusionCellsParams, upper),        MEMBER(OcclusionCellsParams, cut_plane),
            MEMBER(OcclusionCellsParams, brick_counts), MEMBER(OcclusionCellsParams, far_exponent)};
}

Members occlusion_entry()
{
    return {MEMBER(OcclusionEntry, opacity), MEMBER(OcclusionEntry, sums), MEMBER(OcclusionEntry, rests)};
}

gpu::KernelInterface interface_of(const std::string& name)
{
    for (const gpu::EmbeddedKernel& kernel : gpu::embedded_kernels())
        if (name == kernel.name) return gpu::reflect(name, {kernel.words, kernel.word_count});
    FAIL("no kernel " << name);
    return {};
}

void check_members(const std::string& kernel, const std::string& block, const Members& expected)
{
    CAPTURE(kernel);
    CAPTURE(block);
    const gpu::KernelInterface interface = interface_of(kernel);
    REQUIRE(interface.members.contains(block));
    const std::vector<gpu::KernelInterface::Member>& members = interface.members.at(block);
    REQUIRE(members.size() == expected.size());
    for (size_t i = 0; i < members.size(); ++i) {
        CHECK(members[i].name == expected[i].first);
        CHECK(members[i].offset == expected[i].second);
    }
}

}  // namespace

TEST_CASE("members of shared structs lie where C++ puts them")
{
    for (const char* kernel :
         {"raycast", "raycast_masked", "raycast_filtered", "raycast_filtered_masked", "raycast_paged",
          "raycast_paged_masked", "raycast_paged_filtered", "raycast_paged_filtered_masked", "raycast_occluded",
          "raycast_surfaced", "raycast_paged_filtered_masked_occluded",
          "raycast_paged_filtered_masked_occluded_surfaced", "slice", "slice_paged_masked", "pick",
          "pick_paged_masked"})
        check_members(kernel, "params_block", raycast_params());
    for (const char* kernel : {"raycast_occluded", "raycast_paged_filtered_masked_occluded"})
        check_members(kernel, "occlusion_look",
                      {{"data", 0}, {"segments", sizeof(gpu::OcclusionLook)}});  // a look, and segments behind it
    for (const char* kernel : {"occlusion_bake", "occlusion_bake_paged_filtered"}) {
        check_members(kernel, "params_block", occlusion_bake_params());
        check_members(kernel, "jobs",
                      {MEMBER(OcclusionJob, brick), MEMBER(OcclusionJob, slot), MEMBER(OcclusionJob, around)});
    }
    for (const char* kernel : {"occlusion_gather", "occlusion_gather_paged_filtered_masked"})
        check_members(kernel, "params_block", occlusion_gather_params());
    for (const char* kernel : {"occlusion_cells", "occlusion_cells_paged_filtered_masked"}) {
        check_members(kernel, "params_block", occlusion_cells_params());
        check_members(kernel, "jobs", {MEMBER(OcclusionCellsJob, brick), MEMBER(OcclusionCellsJob, slot)});
    }
    for (const char* kernel : {"occlusion_bake", "occlusion_gather", "occlusion_cells"})
        check_members(kernel, "opacities", occlusion_entry());
    for (const char* kernel : {"surfaces", "surfaces_listed", "surface_tiles"}) {
        check_members(kernel, "params_block", raycast_params());
        check_members(kernel, "surface_params", surface_params());
    }
    for (const char* kernel : {"preview", "preview_surfaced"}) {
        check_members(kernel, "params_block", raycast_params());
        check_members(kernel, "preview_params", preview_params());
    }
    check_members(
        "preview_over", "push",
        {MEMBER(PreviewOverParams, target), MEMBER(PreviewOverParams, size), MEMBER(PreviewOverParams, share)});
    check_members("mix", "push", {MEMBER(MixParams, target), MEMBER(MixParams, size), MEMBER(MixParams, share)});
    check_members(
        "saturation", "push",
        {MEMBER(SaturationParams, target), MEMBER(SaturationParams, size), MEMBER(SaturationParams, saturation)});
    for (const char* kernel : {"brick_leap", "brick_leap_masked"}) {
        check_members(kernel, "push", brick_leap_params());
        check_members(kernel, "jobs", brick_leap_jobs());
    }
    for (const char* kernel : {"brick_unpack", "brick_unpack_filtered", "brick_unpack_by_address"})
        check_members(kernel, "jobs",
                      {MEMBER(BrickUnpackJob, code), MEMBER(BrickUnpackJob, codes), MEMBER(BrickUnpackJob, extent),
                       MEMBER(BrickUnpackJob, cell), MEMBER(BrickUnpackJob, ranges)});
    for (const char* kernel :
         {"leap_occupancy", "leap_occupancy_masked", "leap_occupancy_patch", "leap_occupancy_masked_patch"})
        check_members(kernel, "push", occupancy_params());
    for (const char* kernel : {"leap_distance", "leap_distance_last"})
        check_members(kernel, "push",
                      {MEMBER(LeapDistanceParams, word_counts), MEMBER(LeapDistanceParams, word_begin),
                       MEMBER(LeapDistanceParams, word_end), MEMBER(LeapDistanceParams, axis)});
    check_members("leap_bound", "push",
                  {MEMBER(LeapBoundParams, cell_begin), MEMBER(LeapBoundParams, cell_end),
                   MEMBER(LeapBoundParams, changed_begin), MEMBER(LeapBoundParams, changed_end)});
    for (const char* kernel :
         {"region_bits", "region_bits_filtered", "region_merge", "region_mark", "region_roots", "region_select"})
        check_members(kernel, "push", region_params());
    check_members("region_seeds", "push",
                  {MEMBER(SeedParams, size), MEMBER(SeedParams, words_per_row), MEMBER(SeedParams, to_seeds),
                   MEMBER(SeedParams, seed_size), MEMBER(SeedParams, seed_words_per_row)});
    for (const char* kernel : {"region_bits", "region_bits_filtered", "region_mark"})
        check_members(kernel, "rows", {MEMBER(RowSpan, begin), MEMBER(RowSpan, end)});
}

TEST_CASE("push constants are as long as their structs, and fit where the smallest device has room")
{
    CHECK(interface_of("leap_occupancy").push_bytes == sizeof(gpu::OccupancyParams));
    CHECK(interface_of("brick_leap").push_bytes == sizeof(gpu::BrickLeapParams));
    CHECK(interface_of("leap_distance").push_bytes == sizeof(gpu::LeapDistanceParams));
    CHECK(interface_of("region_merge").push_bytes == sizeof(gpu::RegionParams));
    for (const gpu::EmbeddedKernel& kernel : gpu::embedded_kernels()) {
        CAPTURE(kernel.name);
        const gpu::KernelInterface interface = interface_of(kernel.name);
        CHECK(interface.push_bytes <= 128);
        CHECK(interface.local_size[0] * interface.local_size[1] * interface.local_size[2] <= 128);
    }
}
