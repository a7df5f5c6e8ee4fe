#include "engine/passes/raycast.h"

#include <algorithm>
#include <cmath>

#include "shaders/counters.h"

namespace shvr {

uint32_t shininess_squarings(float shininess)
{
    for (uint32_t k = 0; k < gpu::NOT_A_POWER_OF_TWO; ++k)
        if (shininess == std::ldexp(1.0f, int(k))) return k;
    return gpu::NOT_A_POWER_OF_TWO;
}

namespace {

/// Number of threads that run in lockstep on devices that abort long loops (MAX_TURNS). An iteration needed by one
/// thread may cost all of them an iteration. Even for sixteen threads, the total stays below 65535 iterations.
constexpr uint64_t LANES = 8;
constexpr uint64_t MAX_BLOCKS = 4096;
/// Margins around an iso-surface's pixels: for rounding of rays, and for alignment to the widest thread groups.
constexpr double SHELL_MARGIN = 1.0, SHELL_ALIGNED = 16.0;  // pixels

constexpr double MAX_PIECES = 64.0;  ///< maximum pieces of a stretch if only the light is integrated: 2^HALVINGS

/// Maximum number of iterations per step of an integrated ray (integral.glsl). Lanes do not wait for each other: in
/// each iteration, each lane passes one stretch.
double turns_of_integral(const gpu::RaycastParams& params, uint64_t levels)
{
    const double stretches = 2.0 * std::sqrt(3.0) * double(params.step) + 4.0;
    const double to_find = 1.0 + std::ceil(std::log2(double(params.point_count) + 1.0));
    return stretches * (1.0 + 2.0 * double(levels) + to_find * (3.0 + MAX_PIECES + double(params.point_count)));
}

/// Maximum number of steps of a ray in one dispatch.
uint64_t steps_of_block(const VolumeBinding& volume, const RaycastInput& input, bool is_shelled)
{
    // Maximum number of iterations of the separate loop that finds a position's brick or cell; in paged bricks, one per
    // directory level. Unrolled loops of fixed length do not count (mask.glsl, groups.glsl, search.glsl).
    const uint64_t levels = volume.pages ? volume.pages->depth : 0;
    const uint64_t to_leap = 1 + levels;
    const uint64_t to_search = to_leap + 1 + gpu::SEARCH_AHEAD * levels;  // all iterations but the last advance
    const uint64_t to_take = 1 + 2 * levels + (is_shelled ? 2 * (to_leap + 1) : 0);
    // Every iteration advances at least one lane by a step, except iterations in which all lanes find that they must
    // continue in another cell or brick.
    double turns = input.integrated && !input.pick
                       ? turns_of_integral(input.params, levels)
                       : double(LANES * std::max(to_leap, to_take) + 1 + to_leap + to_search + to_take);
    // An iso-surface is searched cell by cell: at most three cells per reference length, plus the cell where the ray
    // enters. Before each cell, the ray passes cells of four voxels a side, a quarter as many.
    if (is_shelled) turns += 2.25 * double(LANES * (to_leap + 1)) * (3.0 * double(input.params.step) + 1.0);
    return std::max(uint64_t(double(gpu::MAX_TURNS) / turns), uint64_t{1});
}

/// Number of steps of the longest possible ray.
uint64_t steps_of_ray(const gpu::RaycastParams& params)
{
    constexpr double ROUNDING = 1.0 + 1e-5, MOST = 2147483648.0;
    const double longest = glm::length(glm::dvec3(params.box_upper - params.box_lower) * glm::dvec3(params.spacing));
    const double steps = longest / double(params.step) * ROUNDING + 1.0;
    return uint64_t(steps < MOST ? steps : MOST);  // NaN also gives the maximum
}

std::vector<std::byte> bytes_of(const RaycastOcclusion& occlusion)
{
    const auto look = std::as_bytes(std::span(&occlusion.look, 1)),
               segments = std::as_bytes(std::span(occlusion.segments));
    std::vector<std::byte> bytes(look.begin(), look.end());
    bytes.insert(bytes.end(), segments.begin(), segments.end());
    return bytes;
}

/// For shorter steps (in reference lengths), sums use compensation: plain sums have an error of 1.5e-7 / step.
constexpr float MIN_PLAIN_STEP = 0.05f;

/// The inputs that select the kernel and its constants.
struct Choice {
    bool is_paged, is_filtered, is_masked, is_occluded, is_surfaced;
    std::vector<std::pair<std::string, uint32_t>> of_codes;  ///< constants that describe the codes
    uint32_t shell = gpu::SHELL_NONE;
    bool feedback, has_sample_bits, is_shaded, picks, is_integrated;
    uint32_t kept = gpu::KEPT_NOTHING;
};

/// Whether all rays of the part are short enough for sample bits (shaders/leap.h). This is true unless the angle of
/// view is extreme.
bool finds_sample_bits(const gpu::RaycastParams& params)
{
    const glm::vec3& limit = params.position_limit;
    const float most = gpu::SAMPLE_BITS_REACH * std::max({limit.x, limit.y, limit.z});
    const auto is_near = [&](float x, float y) {
        const glm::vec3 apart = params.far_corner - params.near_corner + x * (params.far_dx - params.near_dx) +
                                y * (params.far_dy - params.near_dy);
        return glm::all(glm::lessThanEqual(glm::abs(apart), glm::vec3(most)));
    };
    const glm::vec2 begin = params.pixel_begin, end = params.pixel_end;
    return is_near(begin.x, begin.y) && is_near(end.x, begin.y) && is_near(begin.x, end.y) && is_near(end.x, end.y);
}

Choice choice_of(const VolumeBinding& volume, const RaycastInput& input, bool is_shelled, bool keeps_rays)
{
    return {.is_paged = volume.pages.has_value(),
            .is_filtered = volume.is_filtered(),
            .is_masked = input.mask.has_value(),
            .is_occluded = input.occlusion.has_value(),
            .is_surfaced = input.surfaces.has_value(),
            .of_codes = constants_of_codes(volume, volume.pages.has_value()),
            .shell = is_shelled ? input.shell : gpu::SHELL_NONE,
            .feedback = volume.pages && volume.pages->feedback,
            .has_sample_bits = volume.sample_bits && finds_sample_bits(input.params),
            .is_shaded = input.shaded,
            .picks = input.pick,
            .is_integrated = input.integrated && !input.pick,
            .kept = input.waiting ? gpu::KEPT_ALL
                    : keeps_rays  ? gpu::KEPT_SHELL
                                  : gpu::KEPT_NOTHING};
}

using Constants = std::vector<std::pair<std::string, uint32_t>>;

KernelVariant with(KernelVariant kernel, const Constants& constants)
{
    kernel.second.insert(kernel.second.end(), constants.begin(), constants.end());
    return kernel;
}

/// The constants that select how the steps of marching rays are classified.
Constants constants_of_steps(const Choice& choice, const RaycastInput& input)
{
    Constants constants{{"GROUP_WIDTH", input.pixel_groups.width}};
    if (input.params.cut_plane != glm::vec4(0.0f)) constants.emplace_back("HAS_CUT_PLANE", 1);
    if (choice.is_masked) constants.emplace_back("SMOOTH_BORDERS", input.smooth_borders);
    if (choice.is_integrated) return constants;
    constants.emplace_back("PREINTEGRATED", input.preintegrated ? input.params.opaque_map > 0 ? 2 : 1 : 0);
    if (!choice.is_paged && !choice.is_filtered) constants.emplace_back("HAS_SAMPLE_BITS", choice.has_sample_bits);
    if (input.params.step < MIN_PLAIN_STEP) constants.emplace_back("COMPENSATED", 1);
    return constants;
}

KernelVariant slice_kernel(const Choice& choice, const RaycastInput& input)
{
    KernelVariant kernel{
        variant_of("slice",
                   {{"PAGED", choice.is_paged}, {"FILTERED", choice.is_filtered}, {"MASKED", choice.is_masked}}),
        choice.of_codes};
    if (choice.is_paged) kernel = with(kernel, {{"FEEDBACK", choice.feedback}, {"KEPT", choice.kept}});
    return with(kernel,
                {{"GROUP_WIDTH", input.pixel_groups.width}, {"DISTANCE_BLEND", input.params.blend_size > 0.0f}});
}

KernelVariant pick_kernel(const Choice& choice, const RaycastInput& input)
{
    const KernelVariant kernel{
        variant_of("pick",
                   {{"PAGED", choice.is_paged}, {"FILTERED", choice.is_filtered}, {"MASKED", choice.is_masked}}),
        choice.of_codes};
    return with(with(kernel, constants_of_steps(choice, input)), {{"HAS_SURFACES", choice.is_surfaced}});
}

/// Returns the kernel for colours along rays, one sample per ray (slices), or the picked point.
KernelVariant kernel_of(const Choice& choice, const RaycastInput& input)
{
    if (input.slice) return slice_kernel(choice, input);
    if (choice.picks) return pick_kernel(choice, input);
    const bool is_shelled = choice.shell != gpu::SHELL_NONE;
    KernelVariant kernel{choice.is_integrated ? variant_of("integral", {{"PAGED", choice.is_paged},
                                                                        {"MASKED", choice.is_masked},
                                                                        {"OCCLUDED", choice.is_occluded},
                                                                        {"SURFACED", choice.is_surfaced},
                                                                        {"SHELLED", is_shelled}})
                                              : variant_of("raycast", {{"PAGED", choice.is_paged},
                                                                       {"FILTERED", choice.is_filtered},
                                                                       {"MASKED", choice.is_masked},
                                                                       {"OCCLUDED", choice.is_occluded},
                                                                       {"SURFACED", choice.is_surfaced},
                                                                       {"SHELLED", is_shelled}}),
                         choice.of_codes};
    kernel = with(kernel, constants_of_steps(choice, input));
    const auto constant = [&](const char* name, uint32_t value) { kernel.second.emplace_back(name, value); };
    if (choice.is_paged) constant("FEEDBACK", choice.feedback);
    constant("SHADED", choice.is_shaded);
    if (choice.is_shaded) {
        constant("SHININESS_SQUARINGS", shininess_squarings(input.params.shininess));
        if (input.analytic_gradient && !choice.is_integrated) constant("ANALYTIC_GRADIENT", 1);
    }
    constant("COUNT_WORK", input.count_work);
    if (is_shelled) constant("SHELL", choice.shell);
    if (choice.is_occluded) constant("OCCLUSION_MAPPED", !input.occlusion->segments.empty());
    constant("DISTANCE_BLEND", input.params.blend_size > 0.0f);
    if (choice.is_paged || is_shelled) constant("KEPT", choice.kept);
    return kernel;
}

/// Hints at the kernels that will probably be needed next: for painting, for an iso-surface or an opaque surface that
/// enters the picture, or for a click. `kept_of_shell`: the KEPT constant of pictures with an iso-surface.
void expect_next(FrameGraph& graph, const Choice& now, const RaycastInput& input, uint32_t kept_of_shell)
{
    const auto expect = [&](const auto& change) {
        Choice next = now;
        change(next);
        graph.expect(kernel_of(next, input));
    };
    if (!now.is_masked) expect([](Choice& next) { next.is_masked = true; });
    if (input.slice || now.picks) return;
    if (!now.is_surfaced) expect([](Choice& next) { next.is_surfaced = true; });
    if (now.shell == gpu::SHELL_NONE)
        for (const uint32_t shell : {gpu::SHELL_BALL, gpu::SHELL_BOX})
            expect([&](Choice& next) {
                next.shell = shell;
                next.kept = kept_of_shell;
            });
    expect([](Choice& next) {
        next.picks = true;
        next.is_shaded = next.feedback = false;
        next.shell = gpu::SHELL_NONE;
        next.kept = gpu::KEPT_NOTHING;
    });
}

/// Pixels, relative to the part's first pixel, that one kernel draws.
struct Area {
    glm::uvec2 begin{0}, end{0};
    bool is_shelled = false;
    bool is_empty() const { return begin.x >= end.x || begin.y >= end.y; }
};

/// The iso-surface kernel takes twice as long per ray even for rays that never meet the iso-surface. So the pixels
/// above, below and on both sides of the surface's pixels are drawn by the kernel without an iso-surface.
std::vector<Area> areas_of(const RaycastInput& input, bool is_shelled)
{
    const glm::uvec2 size = input.params.pixel_end - input.params.pixel_begin;
    if (!is_shelled) return {{{0, 0}, size, is_shelled}};
    const ShellPixels pixels = shell_pixels(input.params);
    const Area shell{pixels.begin, pixels.end, true};
    if (shell.is_empty()) return {{{0, 0}, size}};
    const Area candidates[] = {shell,
                               {{0, 0}, {size.x, shell.begin.y}},
                               {{0, shell.end.y}, size},
                               {{0, shell.begin.y}, {shell.begin.x, shell.end.y}},
                               {{shell.end.x, shell.begin.y}, {size.x, shell.end.y}}};
    std::vector<Area> areas;
    for (const Area& area : candidates)
        if (!area.is_empty()) areas.push_back(area);
    return areas;
}

/// Binds the data that all rays read: bricks, and the paint in them.
void bind_volume(Pass& pass, VolumeBinding& volume, const RaycastInput& input)
{
    pass.block("params_block", std::span(&input.params, 1));
    if (volume.pages) {
        pass.read("directory", volume.pages->directory);
        pass.read("cell_leap", volume.pages->cell_leap);
        volume.pages->reached = pass.modify("reached", volume.pages->reached);
    } else {
        pass.read("leap", volume.leap);
    }
    bind_atlas(pass, volume);
    if (input.mask) {
        pass.read("mask", input.mask->mask);
        pass.read("mask_table", input.mask->mask_table);
        pass.read("groups", input.groups);
    }
}

/// Binds what marching rays read.
void bind_steps(Pass& pass, const VolumeBinding& volume, const RaycastInput& input)
{
    pass.read("table", input.table);
    if (!volume.pages && !volume.is_filtered() && (input.pick || !input.integrated))
        pass.read("sample_bits", volume.sample_bits.value_or(volume.leap));  // a stand-in is never read
    if (input.pick)
        pass.read("surfaces", input.surfaces.value_or(input.table));  // also a stand-in that is never read
    else if (input.surfaces)
        pass.read("surfaces", *input.surfaces);
}

/// Binds the image of the values that rays keep between blocks; if rays keep none, binds an image of one texel.
void bind_rays(FrameGraph& graph, Pass& pass, const RaycastInput& input, std::optional<Resource>& rays, bool is_begun)
{
    const bool is_first = input.params.first_step == 0;
    if (!rays)
        static_cast<void>(pass.write("rays", graph.create("rays", picture_desc(Format::rgba32_float, {1, 1}))));
    else
        rays = is_first && (!is_begun || !input.waiting) ? pass.write("rays", *rays) : pass.modify("rays", *rays);
}

/// `is_begun`: whether other pixels of the target and of `rays` have been drawn already.
Resource raycast_block(FrameGraph& graph, VolumeBinding& volume, const RaycastInput& input, bool is_shelled,
                       Resource target, std::optional<Resource>& rays, bool is_begun)
{
    const glm::uvec2 pixels = input.params.drawn_end - input.params.drawn_begin;
    const KernelVariant kernel = kernel_of(choice_of(volume, input, is_shelled, rays.has_value()), input);
    Pass pass = graph.compute(kernel.first, input.name);
    for (const auto& [name, value] : kernel.second) pass.constant(name, value);
    bind_volume(pass, volume, input);
    if (!input.slice) bind_steps(pass, volume, input);
    if (is_shelled) pass.read("cell_ranges", volume.cell_ranges);
    const bool is_lit = !input.slice && !input.pick;
    if (is_lit && input.occlusion) {
        pass.read("occlusion", input.occlusion->values);
        const std::vector<std::byte> look = bytes_of(*input.occlusion);
        pass.block("occlusion_look", std::span(look));
    }
    if (!input.pick && (volume.pages || is_shelled)) bind_rays(graph, pass, input, rays, is_begun);
    pixel_groups(pass, pixels, input.pixel_groups);
    // Waiting rays keep their accumulated values elsewhere.
    const bool continues = input.params.first_step > 0 && !input.waiting;
    return continues || is_begun ? pass.modify("color", target) : pass.write("color", target);
}

}  // namespace

ShellPixels shell_pixels(const gpu::RaycastParams& params)
{
    const ShellPixels all{glm::uvec2(0), params.pixel_end - params.pixel_begin};
    const glm::dvec3 near(params.near_corner), far(params.far_corner);
    const glm::dvec3 normal = glm::cross(glm::dvec3(params.near_dx), glm::dvec3(params.near_dy));
    const double depth = glm::dot(normal, far - near);
    glm::dvec2 lower(1e30), upper(-1e30);
    for (int corner = 0; corner < 8; ++corner) {
        const glm::dvec3 side(corner & 1 ? 1.0 : -1.0, corner & 2 ? 1.0 : -1.0, corner & 4 ? 1.0 : -1.0);
        const glm::dvec3 point = glm::dvec3(params.shell_center) + side * glm::dvec3(params.shell_reach);
        // The plane through the point, parallel to the planes where rays begin and end.
        const double t = glm::dot(normal, point - near) / depth;
        const auto between = [&](const glm::vec3& a, const glm::vec3& b) {
            return (1.0 - t) * glm::dvec3(a) + t * glm::dvec3(b);
        };
        const glm::dvec3 dx = between(params.near_dx, params.far_dx), dy = between(params.near_dy, params.far_dy);
        const glm::dvec3 from = point - between(params.near_corner, params.far_corner);
        // dx and dy need not be orthogonal in voxel space.
        const double xx = glm::dot(dx, dx), xy = glm::dot(dx, dy), yy = glm::dot(dy, dy);
        const double along_x = glm::dot(from, dx), along_y = glm::dot(from, dy);
        const glm::dvec2 pixel =
            glm::dvec2(yy * along_x - xy * along_y, xx * along_y - xy * along_x) / (xx * yy - xy * xy);
        const bool is_ahead = t >= 0.0 && glm::abs(pixel.x) < 1e9 && glm::abs(pixel.y) < 1e9;  // false for NaN
        if (!is_ahead) return all;
        lower = glm::min(lower, pixel);
        upper = glm::max(upper, pixel);
    }
    const glm::dvec2 size(all.end), first(params.pixel_begin);
    const glm::dvec2 begin = glm::floor((lower - SHELL_MARGIN - first) / SHELL_ALIGNED) * SHELL_ALIGNED;
    const glm::dvec2 end = glm::ceil((upper + SHELL_MARGIN - first) / SHELL_ALIGNED) * SHELL_ALIGNED;
    return {glm::clamp(begin, glm::dvec2(0.0), size), glm::clamp(end, glm::dvec2(0.0), size)};
}

Resource raycast(FrameGraph& graph, VolumeBinding& volume, const RaycastInput& input, Resource target)
{
    const bool is_shelled = input.shell != gpu::SHELL_NONE && !input.pick;
    const uint64_t steps = input.slice ? 1 : steps_of_ray(input.params);
    const uint64_t before = input.waiting && input.waiting->have_begun ? 1 : 0;
    std::optional<Resource> waiting_rays;
    if (input.waiting) waiting_rays = input.waiting->state;
    bool is_begun = false;
    for (const Area& area : areas_of(input, is_shelled)) {
        const uint64_t steps_each = steps_of_block(volume, input, area.is_shelled);
        const uint64_t blocks = std::min((steps + steps_each - 1) / steps_each, MAX_BLOCKS);
        std::optional<Resource> of_area;  ///< null if all rays wait
        if (!input.waiting && area.is_shelled && blocks > 1)
            of_area = graph.create(
                "rays", picture_desc(Format::rgba32_float, input.params.pixel_end - input.params.pixel_begin));
        RaycastInput block = input;
        block.params.drawn_begin = area.begin;
        block.params.drawn_end = area.end;
        for (uint64_t i = before; i < before + blocks; ++i) {
            block.params.first_step = uint32_t(i * steps_each);
            block.params.end_step = uint32_t((i + 1) * steps_each);
            block.params.is_last_block = i + 1 == blocks;
            target = raycast_block(graph, volume, block, area.is_shelled, target,
                                   input.waiting ? waiting_rays : of_area, is_begun);
        }
        is_begun = true;
    }
    const bool shell_keeps_rays = input.waiting || steps > steps_of_block(volume, input, true);
    const Choice shelled = choice_of(volume, input, true, shell_keeps_rays);
    if (is_shelled) expect_next(graph, shelled, input, shelled.kept);
    // The kernel that draws the pixels without an iso-surface, including those outside the iso-surface's region.
    const Choice plain = choice_of(volume, input, false, input.waiting);
    if (is_shelled) graph.expect(kernel_of(plain, input));
    expect_next(graph, plain, input, shelled.kept);
    if (input.waiting) *input.waiting = {*waiting_rays, true};
    return target;
}

}  // namespace shvr
