// Sketches of a view (view.h), as coarse as time requires: the whole picture, and the pixels the probe may cover.

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/live/view.h"
#include "engine/passes/encode.h"

namespace shvr {

namespace {

constexpr double MAX_SCALE = 8.0;

/// Returns the share (sketch pixels per screen pixel, along each axis) at which a sketch takes `target_ms`: at most
/// `most`, and not too coarse to be useful. `ms`: the sketch's time at a share of 1.
double share_for(double ms, double target_ms, double most)
{
    return std::clamp(std::sqrt(target_ms / std::max(ms, 1e-9)), std::min(1.0 / MAX_SCALE, most), most);
}

}  // namespace

void View::start(Sketch& sketch, const SightRef& sight, const std::optional<ProbeLook>& probe, double target_ms)
{
    const bool is_patch = &sketch == &patch_;
    PixelBox part{glm::uvec2(0), sight->pixels};
    if (is_patch) part = PixelBox{};
    if (is_patch && probe) {
        const glm::dvec3& spacing = scene().info().spacing;
        part = pixels_of_ball(sight->shot.camera, sight->pixels, probe->center, probe->reach(spacing));
        if (const auto& eye = sight->shot.right_eye)
            part = united(part, pixels_of_ball(*eye, sight->pixels, probe->center, probe->reach(spacing)));
    }
    // An infinite `target_ms` means that nothing moves: the sketch is then drawn sharp at any cost.
    const double most = std::isinf(target_ms) ? 1.0 : sight->interaction.resolution;
    const double share = share_for(double(part.area()) * average_ms_per_pixel_, target_ms, most);
    start(sketch, {.sight = sight, .probe = probe, .share = share}, part);
}

/// `part`: pixels of the screen.
void View::start(Sketch& sketch, Sketch::Content content, PixelBox part)
{
    const bool is_patch = &sketch == &patch_;
    const SightRef& sight = content.sight;
    const double share = content.share;
    sketch_ms_ = 0.0;
    content.pixels = glm::uvec2(glm::ceil(glm::dvec2(sight->pixels) * share));
    if (!part.empty()) {
        const glm::dvec2 scale = glm::dvec2(content.pixels) / glm::dvec2(sight->pixels);
        content.part = {glm::uvec2(glm::floor(glm::dvec2(part.begin) * scale)),
                        glm::min(glm::uvec2(glm::ceil(glm::dvec2(part.end) * scale)), content.pixels)};
        content.target = {content.part.begin * sight->pixels / content.pixels,
                          content.part.end * sight->pixels / content.pixels};
        reserve(sketch.images[1 - sketch.front], is_patch ? "probe's pixels" : "sketch", Format::rgba8_unorm,
                content.target.end - content.target.begin);
        reserve(work_, "light", Format::rgba32_float, content.part.end - content.part.begin);
    }
    sketch.next_row = content.part.begin.y;
    sketch.next_encoded = content.target.begin.y;
    sketch.job = std::move(content);
}

/// Draws a finer sketch before the sharp tiles, so that the tiles' edges stand out less. Done once per sight, and only
/// if the sketch adds little to the picture's total time.
bool View::submit_finer_sketch()
{
    constexpr double SHARE = 0.18;  // share along each axis; 3 % of all pixels
    if (finer_sight_ == shown_sight_ || !(base_.shown.share < 0.8 * SHARE)) return false;
    finer_sight_ = shown_sight_;
    start(base_, {.sight = shown_sight_, .probe = {}, .share = SHARE}, {glm::uvec2(0), shown_sight_->pixels});
    return true;
}

void View::drop_finer_sketch()
{
    base_.job.reset();
    changed_during_base_.clear();  // their tiles are marked
    if (unsharp_sight_ == shown_sight_) mark_due({glm::uvec2(0), shown_sight_->pixels}, false);
}

/// Submits the next graph of a sketch. Returns false if no graph is left or bricks are still being listed.
bool View::submit_sketch(Sketch& sketch, Purpose purpose)
{
    if (!sketch.job) return false;
    if (sketch.next_row < sketch.job->part.end.y) {
        if (!is_listed(*sketch.job->sight)) return false;
        if (!submit_preparation(*sketch.job->sight)) submit_rows(sketch, purpose);
        return true;
    }
    if (sketch.next_encoded >= sketch.job->target.end.y) return false;
    submit_encoding(sketch, purpose);
    return true;
}

void View::submit_rows(Sketch& sketch, Purpose purpose)
{
    const Sketch::Content& job = *sketch.job;
    const uint32_t width = job.part.end.x - job.part.begin.x;
    const auto affordable = uint32_t(std::min(rays_.affords(options_.step_ms) / width, 65536.0));
    const uint32_t rows = std::min(std::max(affordable / 8 * 8, 8u), job.part.end.y - sketch.next_row);
    const PicturePart part{.pixels = job.pixels,
                           .begin = {job.part.begin.x, sketch.next_row},
                           .end = {job.part.end.x, sketch.next_row + rows},
                           .target = {0, sketch.next_row - job.part.begin.y},
                           .detail_pixels = job.sight->pixels,
                           .probe = job.probe};
    FrameGraph graph;
    Running running{.purpose = purpose, .pixels = uint64_t(width) * rows, .sight = job.sight};
    const Resource light = draw(graph, part, work_.import(), running);
    const uint32_t end = sketch.next_row + rows;
    const bool encodes = job.share == 1.0;  // otherwise rows are enlarged, using neighbouring rows, once all rows are
                                            // drawn
    if (encodes) encode_rows(graph, light, sketch, sketch.next_encoded, end);
    submit(std::move(graph), std::move(running));
    sketch.next_row = end;
    if (encodes) sketch.next_encoded = end;
    ++sketch.running;
}

void View::submit_encoding(Sketch& sketch, Purpose purpose)
{
    const uint32_t width = sketch.job->target.end.x - sketch.job->target.begin.x;
    const auto affordable = uint32_t(std::clamp(enlarging_.affords(options_.step_ms) / width, 8.0, 65536.0));
    const uint32_t end = std::min(sketch.next_encoded + affordable, sketch.job->target.end.y);
    FrameGraph graph;
    encode_rows(graph, graph.import("light", work_.import()), sketch, sketch.next_encoded, end);
    const double pixels = double(width) * (end - sketch.next_encoded);
    submit(std::move(graph), {.purpose = purpose, .pace = &enlarging_, .units = pixels, .sight = sketch.job->sight});
    sketch.next_encoded = end;
    ++sketch.running;
}

/// Encodes rows of the sketch's target. `light` begins at the first pixel of the sketch's part.
void View::encode_rows(FrameGraph& graph, Resource light, const Sketch& sketch, uint32_t begin, uint32_t end)
{
    const Sketch::Content& job = *sketch.job;
    const glm::dvec2 step = glm::dvec2(job.pixels) / glm::dvec2(job.sight->pixels);
    const glm::uvec2 from(job.target.begin.x, begin);
    gpu::EncodeParams params = encoding();
    params.target = from - job.target.begin;
    params.size = {job.target.end.x - job.target.begin.x, end - begin};
    params.first = (glm::dvec2(from) + 0.5) * step - glm::dvec2(job.part.begin);
    params.step = step;
    params.last = job.part.end - job.part.begin - 1u;
    static_cast<void>(encode(graph, light, graph.import("display", sketch.images[1 - sketch.front].import()), params));
}

void View::flip(Sketch& sketch)
{
    sketch.front = 1 - sketch.front;
    sketch.shown = std::move(*sketch.job);
    sketch.job.reset();
    ++revision_;
}

void View::finish_sketches()
{
    if (!base_.is_drawn() || !patch_.is_drawn()) return;
    // The sketches of the picture and of its probe are shown at the same time.
    if (patch_.job) flip(patch_);
    if (!base_.job) return;
    average_ms_per_pixel_ = sketch_ms_ / double(base_.job->part.area());
    flip(base_);
    shown_sight_ = base_.shown.sight;
    reset_tiles();
    for (const VoxelBox& voxels : std::exchange(changed_during_base_, {})) changed(voxels);
}

}  // namespace shvr
