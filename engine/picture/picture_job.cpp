#include "engine/picture/picture_job.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

namespace shvr {

namespace {

/// Adds up the costs of a picture's parts, pass by pass.
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

/// A pane in parts, the first one last.
std::vector<PicturePart> parts_of(const glm::uvec2& pixels, const RenderOptions& options, const VolumeInfo& volume)
{
    const std::optional<VoxelBox> always_shown = voxels_of_shell(options.probe, volume);
    const uint32_t side = options.part_pixels;
    std::vector<PicturePart> parts;
    for (uint32_t y = 0; y < pixels.y; y += side)
        for (uint32_t x = 0; x < pixels.x; x += side) {
            const glm::uvec2 begin(x, y);
            parts.push_back({.pixels = pixels,
                             .begin = begin,
                             .end = glm::min(begin + side, pixels),
                             .probe = options.probe,
                             .always_shown = always_shown});
        }
    std::ranges::reverse(parts);
    return parts;
}

/// The four quarters of a part, the next one to draw last.
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

PictureJob::PictureJob(Renderer& renderer, const Session& session, const Camera& camera, const RenderOptions& options)
    : renderer_(renderer), look_(session.look()), options_(options), size_(look_.render.size)
{
    const VolumeInfo& info = scene().info();
    const uint64_t bytes = uint64_t(size_.x) * size_.y * 4 * sizeof(float);
    if (bytes > renderer_.host_budget())
        fail("render.size is ", size_.x, " x ", size_.y, " pixels, which take ", bytes >> 20,
             " MiB of memory; expected at most the host's budget, ", renderer_.host_budget() >> 20, " MiB");
    const glm::dvec3 probe_voxel = session.probe.voxel.value_or(0.5 * glm::dvec3(info.size));
    panes_ = panes_of(session.view, camera, size_, info, probe_voxel);
    overlay_ = {.main = camera,
                .main_pixels = panes_[0].box.end - panes_[0].box.begin,
                .probe = {.center = probe_voxel * info.spacing, .is_outlined = false}};
    if (const auto& probe = options_.probe) {
        overlay_.probe = {.center = probe->center,
                          .radius = probe->radius,
                          .color = probe->color,
                          .is_outlined = options_.outlines_probe};
    }
    picture_.image = {int(size_.x), int(size_.y), std::vector<float>(size_t(size_.x) * size_.y * 4)};
    begin_pane();
}

void PictureJob::begin_pane()
{
    parts_ = parts_of(pane().pixels(), options_, scene().info());
}

void PictureJob::end_pane()
{
    const PixelBox& box = pane().box;
    draw_strokes(picture_.image, strokes_of(pane(), overlay_, scene().info()), box);
}

/// Completes the ambient occlusion that the look wants, as far as the loaded bricks allow.
void PictureJob::renew_occlusion(const Progress& progress)
{
    constexpr Occlusion::Most MOST{.bricks = gpu::OCCLUSION_SLICE, .cell_bricks = 512};
    if (pane().shot.is_slice) return;
    if (scene().has_occlusion(look_)) {
        scene().want_occlusion(look_);
        scene().advance(true, progress);
    }
    while (std::optional<FrameGraph> slice = next_occlusion(scene(), look_, pane().shot.camera, MOST)) {
        tell(progress, 0.0);
        append(picture_.passes,
               renderer_.executor().run(std::move(*slice), {.timestamps = options_.timestamps}).passes);
    }
}

/// Of a part that is drawn for the nth time: how often it will be is not known, so each round counts half of the rest.
Progress PictureJob::progress_of(const PicturePart& part, int round)
{
    if (!options_.progress) return {};
    const double all = double(uint64_t(size_.x) * size_.y);
    const double area = double(area_of(part)), left = std::ldexp(area, -round);
    return [=, this, drawn = double(drawn_pixels_)](double fraction) {
        told_ = std::max(told_, (drawn + area - left + 0.5 * left * fraction) / all);
        options_.progress(told_);
    };
}

void PictureJob::step()
{
    SHVR_CHECK(!is_done());
    if (parts_.empty()) {
        ++pane_;
        begin_pane();
    }
    const PicturePart part = parts_.back();
    parts_.pop_back();
    draw_completely(part);
    if (parts_.empty()) end_pane();
}

/// Draws a part with the bricks on the device; stores its pixels, and reports the visited bricks to the volume.
std::vector<gpu::PassReport> PictureJob::draw(const PicturePart& part)
{
    FrameGraph& graph = picture_.graph = FrameGraph();
    const glm::uvec2 size = part.end - part.begin, origin = pane().box.begin + part.begin;
    const Resource color = graph.create("color", image_desc(Format::rgba32_float, glm::uvec3(size, 1)));
    const Drawn drawn = shvr::draw(graph, scene(), look_, pane().shot, part, color, options_.count_work);
    const uint32_t pixels = graph.read_back(drawn.target);
    gpu::FrameResult result =
        renderer_.executor().run(graph, {.timestamps = options_.timestamps, .serialize = options_.serialize});
    scene().volume().take_feedback(drawn.feedback, result);
    const std::byte* row = result.read_backs[pixels].data();
    const size_t row_bytes = size_t(size.x) * 4 * sizeof(float);
    for (uint32_t y = 0; y < size.y; ++y, row += row_bytes)
        std::memcpy(&picture_.image.rgba[4 * (origin.x + size_t(size_.x) * (origin.y + y))], row, row_bytes);
    picture_.wall_ms += result.wall_ms;
    return std::move(result.passes);
}

/// Draws a part with all bricks that its rays visit, or splits it into quarters.
void PictureJob::draw_completely(const PicturePart& part)
{
    using State = DeviceVolume::State;
    DeviceVolume& volume = scene().volume();
    look_at(scene(), look_, pane().shot, part);
    if (area_of(part) != PixelBox{glm::uvec2(0), part.pixels}.area()) volume.forget_visits();
    std::vector<gpu::PassReport> passes;
    for (int round = 0;; ++round) {
        const Progress progress = progress_of(part, round);
        tell(progress, 0.0);
        renew_occlusion(progress);
        passes = draw(part);
        scene().advance(true, progress);
        if (!pane().shot.is_slice && scene().occlusion().is_due()) continue;  // of bricks visited for the first time
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
    picture_.complete = picture_.complete && !scene().occlusion_has_no_room();
    picture_.warnings = scene().take_messages();
    return std::move(picture_);
}

}  // namespace shvr
