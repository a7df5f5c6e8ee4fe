// Whole pictures: pane by pane, and where bricks come and go again and again until all are there.

#include <algorithm>
#include <cstring>

#include "engine/scene/overlay.h"
#include "engine/scene/renderer.h"

namespace shvr {

namespace {

/// Adds up what the parts of a picture cost, pass by pass.
void append(std::vector<gpu::PassReport>& sum, std::vector<gpu::PassReport> passes)
{
    for (gpu::PassReport& pass : passes) {
        const auto known = std::ranges::find(sum, pass.name, &gpu::PassReport::name);
        if (known == sum.end()) {
            sum.push_back(std::move(pass));
            continue;
        }
        known->gpu_ms += pass.gpu_ms;
        known->dispatches += pass.dispatches;
        for (size_t i = 0; i < known->counters.size(); ++i) known->counters[i] += pass.counters[i];
    }
}

/// Puts the picture of a pane where it belongs.
void place(ImageF& whole, const ImageF& pane, const PixelBox& box)
{
    const size_t row_bytes = size_t(pane.width) * 4 * sizeof(float);
    for (uint32_t y = box.begin.y; y < box.end.y; ++y)
        std::memcpy(&whole.rgba[4 * (box.begin.x + size_t(whole.width) * y)],
                    &pane.rgba[4 * (size_t(pane.width) * (y - box.begin.y))], row_bytes);
}

}  // namespace

/// All that `session` wants and that can be made with the bricks that are there. Returns the passes.
std::vector<gpu::PassReport> Renderer::make_occlusion(const Session& session, const Camera& camera,
                                                      const RenderOptions& options)
{
    constexpr Occlusion::Most MOST{.bricks = 64, .cell_bricks = 512};
    std::vector<gpu::PassReport> passes;
    if (paged_ && draws_occlusion(session)) {
        occlusion_.look(occlusion_look(session), *volume_, mask_);
        want_around();
        static_cast<void>(paged_->advance(true));
    }
    while (std::optional<OcclusionSlice> slice = next_occlusion(session, camera, MOST))
        append(passes, executor_.run(std::move(slice->graph), {.timestamps = options.timestamps}).passes);
    return passes;
}

void Renderer::render_part(Picture& picture, const Session& session, const Shot& shot, const PicturePart& part,
                           const RenderOptions& options)
{
    picture.graph = FrameGraph();
    const glm::uvec2 size = part.end - part.begin;
    const Resource color = picture.graph.create("color", image_desc(Format::rgba32_float, glm::uvec3(size, 1)));
    const Drawn drawn = draw(picture.graph, session, shot, part, color, options.count_work);
    const uint32_t pixels = picture.graph.read_back(drawn.target);
    gpu::FrameResult result =
        executor_.run(picture.graph, {.timestamps = options.timestamps, .serialize = options.serialize});
    if (drawn.reached) paged_->note_reached(drawn.tree, result.read_backs[*drawn.reached]);
    const std::byte* row = result.read_backs[pixels].data();
    const size_t row_bytes = size_t(size.x) * 4 * sizeof(float);
    for (uint32_t y = 0; y < size.y; ++y, row += row_bytes)
        std::memcpy(&picture.image.rgba[4 * (part.begin.x + size_t(part.pixels.x) * (part.begin.y + y))], row,
                    row_bytes);
    picture.wall_ms += result.wall_ms;
    picture.passes = std::move(result.passes);
}

/// A pane, in its own pixels.
Picture Renderer::render_pane(const Session& session, const Pane& pane, const RenderOptions& options)
{
    Picture picture;
    const Shot& shot = pane.shot;
    const glm::uvec2 size = pane.box.end - pane.box.begin;
    picture.image = {int(size.x), int(size.y), {}};
    picture.image.rgba.resize(size_t(size.x) * size.y * 4);
    const PicturePart whole{.pixels = size, .end = size, .probe = options.probe};
    const auto renew_occlusion = [&] {
        return shot.is_slice ? std::vector<gpu::PassReport>() : make_occlusion(session, shot.camera, options);
    };
    if (!paged_) {
        std::vector<gpu::PassReport> passes = renew_occlusion();
        render_part(picture, session, shot, whole, options);
        append(picture.passes, std::move(passes));
        return picture;
    }
    // Draw, load what rays came by, and draw again, until they come by nothing that is not there. What needs more bricks
    // at once than there is room for is drawn in quarters.
    std::vector<gpu::PassReport> passes;
    std::vector<PicturePart> parts{whole};
    while (!parts.empty()) {
        const PicturePart part = parts.back();
        parts.pop_back();
        look(session, shot, size);
        if (parts.size() > 0 || part.end - part.begin != size) paged_->forget_reached();
        for (;;) {
            append(passes, renew_occlusion());
            render_part(picture, session, shot, part, options);
            static_cast<void>(paged_->advance(true));
            if (!shot.is_slice && occlusion_.is_due()) continue;  // on what rays came by for the first time
            if (paged_->state() == PagedVolume::State::complete && !paged_->is_stale()) break;
            if (paged_->state() == PagedVolume::State::limited) break;
        }
        const glm::uvec2 extent = part.end - part.begin;
        if (paged_->state() == PagedVolume::State::limited && extent.x * extent.y > 1) {
            const glm::uvec2 middle = part.begin + (extent + 1u) / 2u;
            for (const bool below : {true, false})
                for (const bool right : {true, false}) {
                    PicturePart quarter = part;
                    (right ? quarter.begin.x : quarter.end.x) = middle.x;
                    (below ? quarter.begin.y : quarter.end.y) = middle.y;
                    if (quarter.begin.x < quarter.end.x && quarter.begin.y < quarter.end.y) parts.push_back(quarter);
                }
            continue;
        }
        picture.complete =
            picture.complete && paged_->state() == PagedVolume::State::complete && paged_->missing() == 0;
        append(passes, std::move(picture.passes));
    }
    picture.passes = std::move(passes);
    return picture;
}

Picture Renderer::render(const Session& session, const Camera& camera, const RenderOptions& options)
{
    const glm::uvec2 size = session.render.size;
    const VolumeInfo& info = volume().info();
    const glm::dvec3 probe_voxel = session.probe.voxel.value_or(0.5 * glm::dvec3(info.size));
    const std::vector<Pane> panes = panes_of(session.view, camera, size, info, probe_voxel);
    OverlayScene overlay{.main = camera,
                         .main_pixels = panes[0].box.end - panes[0].box.begin,
                         .probe = {.center = probe_voxel * info.spacing, .is_outlined = false}};
    if (options.probe)
        overlay.probe = {.center = options.probe->center,
                         .radius = options.probe->radius,
                         .color = options.probe->color,
                         .is_outlined = options.outlines_probe};
    const std::optional<VoxelBox> shown_before = always_shown_;
    if (options.probe && options.probe->shell) {
        const glm::dvec3 middle = options.probe->center / info.spacing, reach = options.probe->radius / info.spacing;
        show_always(VoxelBox{Size3(glm::floor(middle - reach)), Size3(glm::ceil(middle + reach))});
    }
    Picture picture;
    picture.image = {int(size.x), int(size.y), std::vector<float>(size_t(size.x) * size.y * 4)};
    for (const Pane& pane : panes) {
        Picture drawn = render_pane(session, pane, options);
        draw_strokes(drawn.image, strokes_of(pane, overlay, info), {glm::uvec2(0), pane.box.end - pane.box.begin});
        if (panes.size() == 1)
            picture.image = std::move(drawn.image);
        else
            place(picture.image, drawn.image, pane.box);
        append(picture.passes, std::move(drawn.passes));
        picture.wall_ms += drawn.wall_ms;
        picture.complete = picture.complete && drawn.complete;
        picture.graph = std::move(drawn.graph);
    }
    always_shown_ = shown_before;
    picture.complete = picture.complete && !occlusion_has_no_room_;
    picture.warnings = take_messages();
    return picture;
}

std::optional<glm::dvec3> Renderer::pick(const Session& session, const Camera& camera, const glm::uvec2& pixels,
                                         const glm::uvec2& pixel)
{
    FrameGraph graph;
    Prepared prepared = prepare(graph, session, camera, {.pixels = pixels, .begin = pixel, .end = pixel + 1u}, false);
    prepared.input.pick = true;
    prepared.input.shaded = false;
    prepared.input.params.opacity_limit = std::min(prepared.input.params.opacity_limit, 0.5f);
    const Resource reached = graph.create("reached voxel", image_desc(Format::rgba32_float, glm::uvec3(1)));
    const uint32_t index = graph.read_back(raycast(graph, prepared.volume, prepared.input, reached));
    const gpu::FrameResult result = executor_.run(std::move(graph), {.timestamps = false});
    glm::vec4 voxel_and_hit;
    std::memcpy(&voxel_and_hit, result.read_backs[index].data(), sizeof voxel_and_hit);
    if (voxel_and_hit.w == 0.0f) return std::nullopt;
    return glm::dvec3(voxel_and_hit) * volume_->info().spacing;
}

}  // namespace shvr
