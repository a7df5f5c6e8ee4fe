#include "engine/picture/frame.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "engine/passes/anaglyph.h"
#include "engine/passes/mix.h"
#include "engine/passes/paint.h"
#include "engine/passes/saturation.h"
#include "engine/picture/ray_params.h"

namespace shvr {

namespace {

/// Chooses sizes of thread groups and tiles. Tiles bound the time of one submission on a slow device. GPUs get square
/// tiles, so that rays in a tile are similar. CPU tiles are larger: they use caches better, and each ends with a wait
/// for the slowest thread. With powers of two, the number of dispatches does not depend on the number of threads.
PixelGroups pixel_groups_of(const gpu::DeviceTraits& traits)
{
    if (!traits.is_cpu) return {.width = 8, .layers = 1, .tile = {128, 128}};
    return {.width = 16, .layers = std::min(std::bit_ceil(traits.cpu_threads), 64u), .tile = {256, 256}};
}

/// Opacity of previewed voxels that other objects hide, and opacity of previewed voxels in slices.
constexpr float PREVIEW_SHARE = 0.55f, PREVIEW_SLICE_SHARE = 0.7f;

RaycastOcclusion raycast_occlusion(Resource values, const OcclusionSettings& settings)
{
    RaycastOcclusion occlusion{values, {float(settings.strength), float(settings.curve), 0.0f, 0}};
    const std::vector<OcclusionPoint>& points = settings.mapping;
    if (points.empty()) return occlusion;
    constexpr double NARROWEST = 1e-6;  // a step
    // A curve with a single point becomes one segment whose two ends are equal.
    for (size_t i = 0; i + 1 < std::max<size_t>(points.size(), 2); ++i) {
        const OcclusionPoint &from = points[i], &to = points[std::min(i + 1, points.size() - 1)];
        occlusion.segments.push_back({float(from.arrives), float(1.0 / std::max(to.arrives - from.arrives, NARROWEST)),
                                      float(to.seen - from.seen)});
    }
    occlusion.look.lowest = float(points.front().seen);
    occlusion.look.segments = uint32_t(occlusion.segments.size());
    return occlusion;
}

PageView page_view(const Look& look, const Shot& shot, const PicturePart& part)
{
    return {.camera = shot.camera,
            .other_eye = shot.right_eye,
            .pixels = part.detail_pixels.x > 0 ? part.detail_pixels : part.pixels,
            .detail = look.render.detail,
            .cut = shot.is_slice ? CutBox{} : look.cut,
            .shows_all = shot.is_slice,
            .shown = part.always_shown};
}

/// Data that both eyes of a stereo shot share.
struct Prepared {
    VolumeBinding volume;
    RaycastInput input;  ///< complete except for the surfaces
    std::optional<SurfaceList> listed, meshes;
};

/// Adds the passes that frame.h lists first: volume, occlusion and tables.
Prepared prepare(FrameGraph& graph, Scene& scene, const Look& look, const Shot& shot, const PicturePart& part,
                 bool feedback, bool rays_wait = false)
{
    if (!rays_wait) scene.volume().let_rays_wait(false);
    const double step_voxels = look_at(scene, look, shot, part);
    Prepared prepared;
    RaycastInput& input = prepared.input;
    input.mask = scene.mask().import(graph);
    prepared.volume = scene.volume().prepare(graph, scene.mask(), input.mask, feedback);
    if (!shot.is_slice && scene.has_occlusion(look)) {
        input.occlusion = raycast_occlusion(scene.occlusion().bring_up_to_date(graph).values, look.light.occlusion);
    }
    input.table = scene.tables().upload_function(graph, look, scene.volume().window(), step_voxels);
    if (input.mask) input.groups = scene.tables().upload_groups(graph, look, step_voxels);
    if (!shot.is_slice && look.shows_meshes) {
        prepared.listed = scene.surfaces().upload(graph);
        prepared.meshes = scene.meshes().upload(graph);
    }
    input.params = raycast_params(look, shot.camera, scene, prepared.volume, part, step_voxels);
    input.shaded = look.light.shaded && !shot.is_slice;
    input.analytic_gradient = look.render.gradient == Gradient::analytic;
    input.slice = shot.is_slice;
    input.smooth_borders = look.render.smooth_borders && !shot.is_slice;
    input.preintegrated = look.render.classifies_steps() && !shot.is_slice;
    input.integrated = look.render.exact_integral && !shot.is_slice && !prepared.volume.is_filtered();
    input.pixel_groups = pixel_groups_of(scene.traits());
    if (shot.is_slice) set_slice(input.params, look, scene);
    if (part.probe && !shot.is_slice) set_shell(input, *part.probe, scene);
    return prepared;
}

/// Draws the surfaces at which the rays of a part end: meshes, trace and the probe's ball; null if there are none.
std::optional<Resource> draw_surfaces(FrameGraph& graph, Scene& scene, const Prepared& prepared,
                                      const RaycastInput& input, const RayPlanes& planes, const PicturePart& part)
{
    const bool has_ball = part.probe && part.probe->ball_share > 0.0;
    if (input.slice) return std::nullopt;
    std::optional<Resource> meshes;
    if (prepared.meshes)
        meshes = surfaces(graph, {.params = input.params,
                                  .scene = scene.meshes().params(planes, part.pixels, scene.info()),
                                  .listed = prepared.meshes,
                                  .pixel_groups = input.pixel_groups});
    if (!prepared.listed && !has_ball) return meshes;
    SurfacesInput wanted{.params = input.params,
                         .scene = scene.surfaces().params(planes, part.pixels, scene.info()),
                         .listed = prepared.listed,
                         .probe = has_ball,
                         .pixel_groups = input.pixel_groups};
    if (has_ball) set_ball(wanted.scene, *part.probe, scene.info());
    const Resource drawn = surfaces(graph, wanted);
    return meshes ? nearer(graph, *meshes, drawn, part.end - part.begin) : drawn;
}

/// Returns whether objects behind the probe's ball are visible through it. If so, two pictures are drawn and mixed.
bool is_translucent(const std::optional<ProbeLook>& probe)
{
    return probe && probe->ball_share > 0.0 && probe->ball_opacity > 0.0 && probe->ball_opacity < 1.0;
}

/// Returns the part without the probe's ball.
PicturePart without_ball(PicturePart part)
{
    if (part.probe) part.probe->ball_share = 0.0;
    return part;
}

bool has_preview(const PicturePart& part)
{
    return part.probe && part.probe->preview && part.probe->preview->voxels > 0;
}

PreviewInput preview_input(const RaycastInput& input)
{
    return {.params = input.params,
            .preview = {},
            .words = {},
            .surfaces = input.surfaces,
            .slice = input.slice,
            .pixel_groups = input.pixel_groups};
}

PreviewSeen draw_preview(FrameGraph& graph, const RaycastInput& input, const RayPlanes& planes, const PicturePart& part)
{
    PreviewInput wanted = preview_input(input);
    wanted.preview = preview_params(*part.probe, planes);
    wanted.words = part.probe->preview->words;
    return preview(graph, wanted);
}

/// Draws the volume and its contents. A preview is computed before the volume's rays are cast, so that the rays can end
/// at previewed voxels; the preview is then drawn over the picture.
Resource draw_contents(FrameGraph& graph, Scene& scene, Prepared& prepared, RaycastInput input, const Camera& camera,
                       const PicturePart& part, Resource target, const WaitingRays* rays, size_t which)
{
    const RayPlanes planes = ray_planes(camera, part.pixels, scene.info());
    RaysInWaiting waiting;
    if (rays) {
        waiting = rays->import(graph, which);
        input.waiting = &waiting;
    }
    if (!has_preview(part)) {
        input.surfaces = draw_surfaces(graph, scene, prepared, input, planes, part);
        expect_preview(graph, preview_input(input));
        return raycast(graph, prepared.volume, input, target);
    }
    input.surfaces = draw_surfaces(graph, scene, prepared, input, planes, part);
    const PreviewSeen made = draw_preview(graph, input, planes, part);
    input.surfaces = made.surfaces;
    const Resource picture = raycast(graph, prepared.volume, input, target);
    return preview_over(graph, made.seen, picture,
                        {.target = input.params.target,
                         .size = part.end - part.begin,
                         .share = input.slice ? PREVIEW_SLICE_SHARE : PREVIEW_SHARE});
}

/// Draws a translucent ball of the probe: mixes a picture with an opaque ball and a picture without the ball.
Resource draw_through_ball(FrameGraph& graph, Scene& scene, Prepared& prepared, const RaycastInput& input,
                           const Camera& camera, const PicturePart& part, Resource target, const WaitingRays* rays,
                           size_t eye)
{
    const glm::uvec2 size = part.end - part.begin;
    const Resource opaque = draw_contents(graph, scene, prepared, input, camera, part, target, rays, 2 * eye);
    RaycastInput bare = input;
    bare.params.target = glm::uvec2(0);
    const Resource without =
        draw_contents(graph, scene, prepared, bare, camera, without_ball(part),
                      graph.create("without the probe", picture_desc(Format::rgba32_float, size)), rays, 2 * eye + 1);
    return mix(graph, without, opaque,
               {.target = input.params.target, .size = size, .share = float(1.0 - part.probe->ball_opacity)});
}

/// Draws the picture of one eye.
Resource draw_eye(FrameGraph& graph, Scene& scene, const Look& look, Prepared& prepared, const RaycastInput& input,
                  const Camera& camera, const PicturePart& part, Resource target, const WaitingRays* rays, size_t eye)
{
    const Resource picture = input.slice || !is_translucent(part.probe)
                                 ? draw_contents(graph, scene, prepared, input, camera, part, target, rays, eye)
                                 : draw_through_ball(graph, scene, prepared, input, camera, part, target, rays, eye);
    if (look.render.saturation == 1.0) return picture;
    return saturation(
        graph, picture,
        {.target = input.params.target, .size = part.end - part.begin, .saturation = float(look.render.saturation)});
}

}  // namespace

WaitingRays::WaitingRays(gpu::Memory& memory, const glm::uvec2& pixels, int pictures)
{
    for (int picture = 0; picture < pictures; ++picture)
        pictures_.push_back(memory.create("waiting rays", picture_desc(Format::rgba32_float, {pixels.x, 2 * pixels.y}),
                                          gpu::Placement::device, "the picture"));
}

RaysInWaiting WaitingRays::import(FrameGraph& graph, size_t picture) const
{
    return {graph.import("waiting rays", pictures_.at(picture).import()), have_begun_};
}

int pictures_of(const Shot& shot, const std::optional<ProbeLook>& probe)
{
    return (shot.right_eye ? 2 : 1) * (!shot.is_slice && is_translucent(probe) ? 2 : 1);
}

Drawn draw(FrameGraph& graph, Scene& scene, const Look& look, const Shot& shot, const PicturePart& whole_part,
           Resource target, bool count_work, WaitingRays* waiting)
{
    const bool has_ball = look.shows_meshes && whole_part.probe && whole_part.probe->ball_opacity > 0.0;
    const PicturePart part = has_ball ? whole_part : without_ball(whole_part);
    Prepared prepared = prepare(graph, scene, look, shot, part, true, waiting != nullptr);
    prepared.input.count_work = count_work;
    Drawn drawn;
    if (!shot.right_eye) {
        drawn.target = draw_eye(graph, scene, look, prepared, prepared.input, shot.camera, part, target, waiting, 0);
    } else {
        const glm::uvec2 size = part.end - part.begin;
        const ResourceDesc desc = picture_desc(Format::rgba32_float, size);
        RaycastInput left = prepared.input, right = prepared.input;
        left.params.target = right.params.target = glm::uvec2(0);
        set_rays(right.params, look, *shot.right_eye, scene.info(), part.pixels);
        const Resource by_left =
            draw_eye(graph, scene, look, prepared, left, shot.camera, part, graph.create("left eye", desc), waiting, 0);
        const Resource by_right = draw_eye(graph, scene, look, prepared, right, *shot.right_eye, part,
                                           graph.create("right eye", desc), waiting, 1);
        drawn.target = anaglyph(graph, by_left, by_right, target, size, part.target);
    }
    if (waiting) waiting->have_begun();
    expect_brushes(graph, prepared.volume);
    drawn.feedback = scene.volume().request_feedback(graph, prepared.volume);
    return drawn;
}

FrameGraph prepared(Scene& scene, const Look& look, const Shot& shot, const PicturePart& part)
{
    FrameGraph graph;
    static_cast<void>(prepare(graph, scene, look, shot, part, false));
    return graph;
}

Resource pick(FrameGraph& graph, Scene& scene, const Look& look, const Shot& shot, const PicturePart& part)
{
    Prepared prepared = prepare(graph, scene, look, shot, part, false);
    RaycastInput input = prepared.input;
    const bool has_ball = look.shows_meshes && part.probe && part.probe->ball_opacity >= 0.5;
    input.surfaces = draw_surfaces(graph, scene, prepared, input, ray_planes(shot.camera, part.pixels, scene.info()),
                                   has_ball ? part : without_ball(part));
    input.pick = true;
    input.shaded = false;
    return raycast(graph, prepared.volume, input,
                   graph.create("seen voxel", picture_desc(Format::rgba32_float, {1, gpu::PICK_ROWS})));
}

uint64_t rays_cut_short(const std::vector<gpu::PassReport>& passes)
{
    uint64_t rays = 0;
    for (const gpu::PassReport& pass : passes)
        if (!pass.counters.empty()) rays += pass.counters[gpu::COUNTER_CUT_SHORT];
    return rays;
}

std::string cut_short_sentence(uint64_t rays, const Look& look)
{
    return sentence(rays == 1 ? "1 ray stops before its end, because it takes"
                              : sentence(rays, " rays stop before their end, because they take"),
                    " more samples than the device draws; expected a render.step_voxels above ",
                    look.render.step_voxels, ", or a smaller box of the cutting planes");
}

bool get_ready(Scene& scene, const Look& look, const Shot& shot, const PicturePart& part)
{
    return scene.volume().get_ready(page_view(look, shot, part), scene.visibility_of(look));
}

double look_at(Scene& scene, const Look& look, const Shot& shot, const PicturePart& part)
{
    const int finest = scene.volume().look(page_view(look, shot, part), scene.visibility_of(look));
    return std::ldexp(look.render.step_voxels, finest);
}

std::optional<FrameGraph> next_preparation(Scene& scene, const Look& look)
{
    return scene.volume().next_preparation(scene.visibility_of(look), scene.mask());
}

std::optional<FrameGraph> next_refinement(Scene& scene, const Look& look)
{
    return scene.volume().next_refinement(scene.visibility_of(look), scene.mask());
}

std::optional<FrameGraph> next_occlusion(Scene& scene, const Look& look, const Camera& camera,
                                         const Occlusion::Most& most)
{
    if (!scene.has_occlusion(look)) {
        scene.occlusion().clear();
        scene.volume().want_around({});
        return std::nullopt;
    }
    if (!scene.volume().has_view()) return std::nullopt;
    scene.want_occlusion(look);
    if (!scene.occlusion().is_due()) return std::nullopt;
    FrameGraph graph;
    scene.add_occlusion(graph, camera, most);
    return graph;
}

}  // namespace shvr
