#include "engine/picture/picture_job.h"

#include <algorithm>
#include <cstring>
#include <utility>

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

/// A pane in parts of at most `side` pixels a side, the first one last.
std::vector<PicturePart> parts_of(const glm::uvec2& pixels, uint32_t side, const std::optional<ProbeLook>& probe)
{
    std::vector<PicturePart> parts;
    for (uint32_t y = 0; y < pixels.y; y += side)
        for (uint32_t x = 0; x < pixels.x; x += side) {
            const glm::uvec2 begin(x, y);
            parts.push_back({.pixels = pixels, .begin = begin, .end = glm::min(begin + side, pixels), .probe = probe});
        }
    std::ranges::reverse(parts);
    return parts;
}

/// The one that is drawn first last.
std::vector<PicturePart> quarters_of(const PicturePart& part)
{
    std::vector<PicturePart> quarters;
    const glm::uvec2 middle = part.begin + (part.end - part.begin + 1u) / 2u;
    for (const bool below : {true, false})
        for (const bool right : {true, false}) {
            PixelBox pixels{part.begin, part.end};
            (right ? pixels.begin.x : pixels.end.x) = middle.x;
            (below ? pixels.begin.y : pixels.end.y) = middle.y;
            if (pixels.empty()) continue;
            quarters.push_back(part);
            quarters.back().begin = pixels.begin;
            quarters.back().end = pixels.end;
        }
    return quarters;
}

uint64_t area_of(const PicturePart& part)
{
    return PixelBox{part.begin, part.end}.area();
}

}  // namespace

PictureJob::PictureJob(Renderer& renderer, Session session, const Camera& camera, const RenderOptions& options)
    : renderer_(renderer), session_(std::move(session)), camera_(camera), options_(options), size_(session_.render.size)
{
    const VolumeInfo& info = renderer_.volume().info();
    const uint64_t bytes = uint64_t(size_.x) * size_.y * 4 * sizeof(float);
    if (bytes > renderer_.host_budget_)
        fail("render.size is ", size_.x, " x ", size_.y, " pixels, which take ", bytes >> 20,
             " MiB of memory; expected at most the host's budget, ", renderer_.host_budget_ >> 20, " MiB");
    const glm::dvec3 probe_voxel = session_.probe.voxel.value_or(0.5 * glm::dvec3(info.size));
    panes_ = panes_of(session_.view, camera_, size_, info, probe_voxel);
    overlay_ = {.main = camera_,
                .main_pixels = panes_[0].box.end - panes_[0].box.begin,
                .probe = {.center = probe_voxel * info.spacing, .is_outlined = false}};
    if (const auto& probe = options_.probe) {
        overlay_.probe = {.center = probe->center,
                          .radius = probe->radius,
                          .color = probe->color,
                          .is_outlined = options_.outlines_probe};
        if (probe->shell) {
            const glm::dvec3 middle = probe->center / info.spacing, reach = probe->radius / info.spacing;
            always_shown_ = VoxelBox{Size3(glm::floor(middle - reach)), Size3(glm::ceil(middle + reach))};
        }
    }
    picture_.image = {int(size_.x), int(size_.y), std::vector<float>(size_t(size_.x) * size_.y * 4)};
    begin_pane();
}

void PictureJob::begin_pane()
{
    parts_ = parts_of(pane().box.end - pane().box.begin, options_.part_pixels, options_.probe);
}

void PictureJob::end_pane()
{
    const PixelBox& box = pane().box;
    draw_strokes(picture_.image, strokes_of(pane(), overlay_, renderer_.volume().info()), box);
}

void PictureJob::renew_occlusion()
{
    if (!pane().shot.is_slice)
        append(picture_.passes, renderer_.make_occlusion(session_, pane().shot.camera, options_));
}

void PictureJob::step()
{
    SHVR_CHECK(!is_done());
    if (parts_.empty()) {
        ++pane_;
        begin_pane();
    }
    const std::optional<VoxelBox> shown_before = renderer_.always_shown_;
    renderer_.show_always(always_shown_);
    const PicturePart part = parts_.back();
    parts_.pop_back();
    draw_completely(part);
    renderer_.always_shown_ = shown_before;
    if (parts_.empty()) end_pane();
}

/// With the bricks that are there. Pixels go to the picture, and what rays came by to the volume.
std::vector<gpu::PassReport> PictureJob::draw(const PicturePart& part)
{
    FrameGraph& graph = picture_.graph = FrameGraph();
    const glm::uvec2 size = part.end - part.begin, origin = pane().box.begin + part.begin;
    const Resource color = graph.create("color", image_desc(Format::rgba32_float, glm::uvec3(size, 1)));
    const Renderer::Drawn drawn = renderer_.draw(graph, session_, pane().shot, part, color, options_.count_work);
    const uint32_t pixels = graph.read_back(drawn.target);
    gpu::FrameResult result =
        renderer_.executor_.run(graph, {.timestamps = options_.timestamps, .serialize = options_.serialize});
    renderer_.volume().take_feedback(drawn.feedback, result);
    const std::byte* row = result.read_backs[pixels].data();
    const size_t row_bytes = size_t(size.x) * 4 * sizeof(float);
    for (uint32_t y = 0; y < size.y; ++y, row += row_bytes)
        std::memcpy(&picture_.image.rgba[4 * (origin.x + size_t(size_.x) * (origin.y + y))], row, row_bytes);
    picture_.wall_ms += result.wall_ms;
    return std::move(result.passes);
}

/// With all bricks that its rays visit, or else in quarters.
void PictureJob::draw_completely(const PicturePart& part)
{
    using State = DeviceVolume::State;
    DeviceVolume& volume = renderer_.volume();
    const Shot& shot = pane().shot;
    const glm::uvec2 pixels = pane().box.end - pane().box.begin;
    renderer_.look(session_, shot, pixels);
    if (area_of(part) != PixelBox{glm::uvec2(0), pixels}.area()) volume.forget_visits();
    std::vector<gpu::PassReport> passes;
    for (;;) {
        renew_occlusion();
        passes = draw(part);
        static_cast<void>(volume.advance(true));
        if (!shot.is_slice && renderer_.occlusion_.is_due()) continue;  // on what rays came by for the first time
        if (volume.state() == State::complete && !volume.is_stale()) break;
        if (volume.state() == State::limited) break;
    }
    if (volume.state() == State::limited && area_of(part) > 1) {
        for (const PicturePart& quarter : quarters_of(part)) parts_.push_back(quarter);
        return;
    }
    drawn_pixels_ += area_of(part);
    picture_.complete = picture_.complete && volume.state() == State::complete && volume.missing() == 0;
    append(picture_.passes, std::move(passes));
}

Picture PictureJob::take()
{
    SHVR_CHECK(is_done());
    picture_.complete = picture_.complete && !renderer_.occlusion_has_no_room_;
    picture_.warnings = renderer_.take_messages();
    return std::move(picture_);
}

/// All that `session` wants and that can be made with the bricks that are there. Returns the passes.
std::vector<gpu::PassReport> Renderer::make_occlusion(const Session& session, const Camera& camera,
                                                      const RenderOptions& options)
{
    constexpr Occlusion::Most MOST{.bricks = gpu::OCCLUSION_SLICE, .cell_bricks = 512};
    std::vector<gpu::PassReport> passes;
    if (draws_occlusion(session)) {
        occlusion_.look(occlusion_look(session), *volume_, mask_);
        volume_->want_around(occlusion_.reach());
        static_cast<void>(volume_->advance(true));
    }
    while (std::optional<OcclusionSlice> slice = next_occlusion(session, camera, MOST))
        append(passes, executor_.run(std::move(slice->graph), {.timestamps = options.timestamps}).passes);
    return passes;
}

Picture Renderer::render(const Session& session, const Camera& camera, const RenderOptions& options)
{
    PictureJob job(*this, session, camera, options);
    while (!job.is_done()) job.step();
    return job.take();
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
