#include "engine/picture/picture_job.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <utility>

#include "engine/passes/surfaces.h"

namespace shvr {

namespace {

/// Adds the costs of a part's passes to the costs of the same passes of the picture.
void append(std::vector<gpu::PassReport>& sum, std::vector<gpu::PassReport> passes)
{
    for (gpu::PassReport& pass : passes) {
        const auto known = std::ranges::find(sum, pass.name, &gpu::PassReport::name);
        if (known == sum.end()) {
            sum.push_back(std::move(pass));
            continue;
        }
        known->gpu_ms += pass.gpu_ms;
        known->record_ms += pass.record_ms;
        known->submissions += pass.submissions;
        known->dispatches += pass.dispatches;
        known->tiles += pass.tiles;
        // Some kernels of a pass have counters, while others have none (slice.comp), so the number of counters varies.
        known->counters.resize(std::max(known->counters.size(), pass.counters.size()));
        for (size_t i = 0; i < pass.counters.size(); ++i) known->counters[i] += pass.counters[i];
        known->invocations = known->invocations && pass.invocations
                                 ? std::optional(*known->invocations + *pass.invocations)
                                 : std::nullopt;
    }
}

/// Bytes per pixel of a picture's read-back.
constexpr uint64_t PIXEL_BYTES = 4 * sizeof(float);
/// Maximum host memory of the band being drawn; the previous band may still be in memory, while it is being written.
constexpr uint64_t MAX_BAND_BYTES = uint64_t{32} << 20;
/// Device memory that drawing needs in addition to a part's own images: tables and the directory of bricks.
constexpr uint64_t BESIDE_PARTS = uint64_t{8} << 20;

/// Maximum area, in pixels, of a part whose rays wait for bricks: a ray's state takes WaitingRays::PIXEL_BYTES.
constexpr uint64_t MAX_WAITING_PIXELS = 64 * 64;

/// Returns the device bytes per pixel of a part, for the images that frame.cpp allocates.
uint64_t device_bytes_per_pixel(const Scene& scene, const Shot& shot, const std::optional<ProbeLook>& probe)
{
    constexpr uint64_t LISTED_BYTES = SURFACE_TILE_BYTES / (gpu::SURFACE_TILE * gpu::SURFACE_TILE);
    uint64_t of_eye = 0;
    if (!shot.is_slice && scene.has_surfaces())
        of_eye += PIXEL_BYTES + LISTED_BYTES;
    else if (!shot.is_slice && probe && probe->ball_share > 0.0)
        of_eye += PIXEL_BYTES;
    if (probe && probe->preview) of_eye += 2 * PIXEL_BYTES;
    const int pictures = pictures_of(shot, probe), eyes = shot.right_eye ? 2 : 1;
    if (pictures > eyes) of_eye = 2 * of_eye + PIXEL_BYTES;
    return PIXEL_BYTES + (shot.right_eye ? 2 * (PIXEL_BYTES + of_eye) : of_eye);
}

/// Splits rows of a pane into parts of at most `side` x `side` pixels, in reverse order: the first to draw comes last.
std::vector<PicturePart> parts_of(const PicturePart& whole, const PixelBox& rows, uint32_t side)
{
    std::vector<PicturePart> parts;
    for (uint32_t y = rows.begin.y; y < rows.end.y; y += side)
        for (uint32_t x = rows.begin.x; x < rows.end.x; x += side) {
            PicturePart& part = parts.emplace_back(whole);
            part.begin = {x, y};
            part.end = glm::min(part.begin + side, rows.end);
        }
    std::ranges::reverse(parts);
    return parts;
}

/// Returns the four quarters of a part in reverse order: the next one to draw comes last.
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

PictureJob::PictureJob(Renderer& renderer, const Session& session, const Camera& camera, const RenderOptions& options,
                       TakeRows take_rows, const RowRange& rows)
    : renderer_(renderer),
      look_(session.look()),
      options_(options),
      take_rows_(std::move(take_rows)),
      size_(look_.render.size),
      rows_begin_(std::min(rows.lower, size_.y)),
      rows_end_(std::clamp(rows.upper.value_or(size_.y), rows_begin_, size_.y))
{
    band_end_ = rows_begin_;
    const VolumeInfo& info = scene().info();
    if (scene().draws_finest()) look_.render.detail = 0.0;
    always_shown_ = voxels_of_shell(options_.probe, info);
    const glm::dvec3 probe_voxel = session.probe.voxel.value_or(0.5 * glm::dvec3(info.size));
    panes_ = panes_of(session.view, camera, size_, info, probe_voxel);
    overlay_ = overlay_of(session.view, session.cut, camera, panes_[0].pixels(), probe_voxel, info);
    if (const auto& probe = options_.probe) {
        overlay_.probe = {.center = probe->center,
                          .radius = probe->radius,
                          .color = probe->color,
                          .is_outlined = options_.outlines_probe && probe->has_silhouette,
                          .has_arrow = options_.outlines_probe && probe->has_arrow};
    }
    const uint64_t row_bytes = PIXEL_BYTES * size_.x;
    const uint64_t band_bytes = std::min(MAX_BAND_BYTES, renderer_.memory().host_bytes_left() / 8);
    band_rows_ = uint32_t(std::clamp<uint64_t>(band_bytes / row_bytes, 1, size_.y));
    if (rows_begin_ < rows_end_) begin_band();
}

PictureJob::~PictureJob()
{
    renderer_.note_picture_bytes(0);
}

void PictureJob::begin_band()
{
    band_begin_ = band_end_;
    band_end_ = std::min(band_begin_ + band_rows_, rows_end_);
    const size_t values = size_t(size_.x) * (band_end_ - band_begin_) * 4;
    // Counts two bands, since the receiver may still hold the previous band, and the copy of one part's pixels.
    constexpr uint64_t BANDS = 2;
    renderer_.note_picture_bytes(BANDS * values * sizeof(float) +
                                 PIXEL_BYTES * options_.part_pixels * std::min(options_.part_pixels, band_rows_));
    band_ = {int(size_.x), int(band_end_ - band_begin_), std::vector<float>(values)};
    pane_ = 0;
    begin_parts();
    if (parts_.empty()) end_band();  // when no pane covers these rows
}

/// Lists the parts of the band in the current pane or, if they do not overlap, in the next pane that overlaps the band.
void PictureJob::begin_parts()
{
    for (; pane_ < panes_.size(); ++pane_) {
        const PixelBox& box = pane().box;
        const PixelBox met{{box.begin.x, std::max(box.begin.y, band_begin_)},
                           {box.end.x, std::min(box.end.y, band_end_)}};
        if (met.empty()) continue;
        const PicturePart whole{.pixels = pane().pixels(),
                                .begin = glm::uvec2(0),
                                .end = glm::uvec2(0),
                                .probe = options_.probe,
                                .always_shown = always_shown_};
        parts_ = parts_of(whole, {met.begin - box.begin, met.end - box.begin}, part_side());
        return;
    }
}

/// Returns the largest part side at which memory holds two parts: parts at a border need images of their own size.
uint32_t PictureJob::part_side()
{
    gpu::Memory& memory = renderer_.memory();
    const uint64_t of_pixel = device_bytes_per_pixel(scene(), pane().shot, options_.probe);
    uint64_t side = options_.part_pixels;
    const auto fits = [&](uint64_t spare) {
        const uint64_t left = memory.device_bytes_left();
        return side * side * of_pixel <= (left - std::min(left, spare)) / 2 &&
               side * side * PIXEL_BYTES <= memory.host_bytes_left() / 2;
    };
    static_cast<void>(!pane().shot.is_slice && scene().has_occlusion(look_));  // allocates its memory
    if (fits(BESIDE_PARTS)) return uint32_t(side);
    // Allocates the data that parts of every size need, so that the remaining memory becomes known.
    renderer_.executor().run(
        prepared(
            scene(), look_, pane().shot,
            {.pixels = pane().pixels(), .begin = glm::uvec2(0), .end = glm::uvec2(1), .always_shown = always_shown_}),
        {.timestamps = false});
    memory.free_idle();
    while (side > 1 && !fits(0)) side = (side + 1) / 2;
    return uint32_t(side);
}

/// Draws the overlay (outline of the probe, box of the cutting planes) over the finished band, and delivers the band.
void PictureJob::end_band()
{
    catch_up();
    for (const Pane& each : panes_)
        draw_strokes(band_, strokes_of(each, overlay_, scene().info()), each.box, band_begin_);
    take_rows_(std::exchange(band_, {}));
    if (band_end_ < rows_end_) return begin_band();
    renderer_.note_picture_bytes(0);
}

/// Loads the requested bricks. If `waits` is false, returns false while some of these bricks are still being read.
bool PictureJob::load(const Progress& progress, bool waits)
{
    scene().advance(waits, progress);
    return waits || scene().volume().state() != DeviceVolume::State::loading;
}

/// Loads as many of the bricks around the visited ones as slots allow: ambient light on visited bricks depends on them.
bool PictureJob::load_around(const Progress& progress, bool waits)
{
    if (pane().shot.is_slice || !scene().has_occlusion(look_)) return true;
    scene().want_occlusion(look_);
    return load(progress, waits);
}

/// Brings the look's ambient occlusion up to date, as far as the loaded bricks allow. If `waits` is false, returns
/// false while work remains.
bool PictureJob::renew_occlusion(const Progress& progress, bool waits)
{
    constexpr Occlusion::Most MOST{.bricks = gpu::OCCLUSION_SLICE, .cell_bricks = 512};
    if (pane().shot.is_slice) return true;
    if (!load_around(progress, waits)) return false;
    while (std::optional<FrameGraph> slice = next_occlusion(scene(), look_, pane().shot.camera, MOST)) {
        tell(progress, 0.0);
        append(picture_.passes,
               renderer_.executor()
                   .run(std::move(*slice), {.timestamps = options_.timestamps, .statistics = options_.statistics})
                   .passes);
        if (!waits) return false;
    }
    return true;
}

/// Returns the progress of a part in its nth round. The number of rounds is unknown: each counts half of the remainder.
Progress PictureJob::progress_of(const PicturePart& part, int round)
{
    if (!options_.progress) return {};
    const double all = double(pixels());
    const double area = double(area_of(part)), left = std::ldexp(area, -round);
    return [=, this, drawn = double(drawn_pixels_)](double fraction) {
        told_ = std::max(told_, (drawn + area - left + 0.5 * left * fraction) / all);
        options_.progress(told_);
    };
}

void PictureJob::step(bool waits)
{
    SHVR_CHECK(!is_done());
    const PicturePart part = rounds_ ? rounds_->part : parts_.back();
    if (!rounds_) parts_.pop_back();
    // Draws ahead on GPUs only: a CPU device also copies the pixels, so drawing ahead would only take more memory.
    const bool is_paged = scene().volume().counts().has_value(), is_ahead = !is_paged && !scene().traits().is_cpu;
    try {
        if (is_ahead ? !draw_ahead(part, waits) : !draw_completely(part, waits)) return;
    } catch (const gpu::MemoryError& error) {
        rounds_.reset();
        scene().volume().let_rays_wait(false);
        if (under_way_) {
            catch_up();
            return parts_.push_back(part);  // it may fit when drawn alone
        }
        if (!has_given_way(part, error.what())) throw;
    }
    if (!parts_.empty()) return;
    ++pane_;
    begin_parts();
    if (parts_.empty()) end_band();
}

/// Reacts to a lack of memory: frees ambient occlusion or else splits the part. Returns false if neither is possible.
bool PictureJob::has_given_way(const PicturePart& part, const std::string& why)
{
    if (scene().give_way(why)) {
        parts_.push_back(part);
        return true;
    }
    if (area_of(part) <= MAX_WAITING_PIXELS) return false;
    for (const PicturePart& quarter : quarters_of(part)) parts_.push_back(quarter);
    return true;
}

/// Starts drawing a part with the bricks on the device.
PictureJob::UnderWay PictureJob::begin(const PicturePart& part, WaitingRays* waiting)
{
    FrameGraph& graph = picture_.graph = FrameGraph();
    const glm::uvec2 size = part.end - part.begin;
    const Resource color = graph.create("color", picture_desc(Format::rgba32_float, size));
    const Drawn drawn = shvr::draw(graph, scene(), look_, pane().shot, part, color, options_.count_work, waiting);
    const uint32_t pixels = graph.read_back(drawn.target);
    return {part, pane().box.begin + part.begin, pixels, drawn.feedback,
            renderer_.executor().submit(graph, {.timestamps = options_.timestamps,
                                                .statistics = options_.statistics,
                                                .serialize = options_.serialize})};
}

/// Copies the part's pixels into the band, and tells the volume which bricks were visited.
std::vector<gpu::PassReport> PictureJob::take(UnderWay part)
{
    gpu::FrameResult result = part.submission.finish();
    scene().volume().take_feedback(part.feedback, result);
    const glm::uvec2 size = part.part.end - part.part.begin, origin = part.origin;
    const std::byte* row = result.read_backs[part.pixels].data();
    const size_t row_bytes = size_t(size.x) * 4 * sizeof(float);
    for (uint32_t y = 0; y < size.y; ++y, row += row_bytes)
        std::memcpy(&band_.rgba[4 * (origin.x + size_t(size_.x) * (origin.y - band_begin_ + y))], row, row_bytes);
    // If two parts are in flight, their drawing times overlap; the overlapping time counts only once.
    const double now_ms =
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch()).count();
    picture_.wall_ms += std::min(result.wall_ms, now_ms - last_taken_ms_.value_or(-HUGE_VAL));
    last_taken_ms_ = now_ms;
    return std::move(result.passes);
}

std::vector<gpu::PassReport> PictureJob::draw(const PicturePart& part, WaitingRays* waiting)
{
    return take(begin(part, waiting));
}

/// Draws a part that is complete after one drawing, and copies the previous part's pixels while the device draws this
/// part. Waits for the picture's very first part, whose time determines how the other parts are divided. If `waits` is
/// false, returns false while ambient light remains to be computed: the part is then drawn by a later step.
bool PictureJob::draw_ahead(const PicturePart& part, bool waits)
{
    look_at(scene(), look_, pane().shot, part);
    const Progress progress = progress_of(part, 0);
    tell(progress, 0.0);
    if (!renew_occlusion(progress, waits)) {
        parts_.push_back(part);
        return false;
    }
    UnderWay next = begin(part);
    if (drawn_pixels_ == 0 && !under_way_) {
        finish(part, take(std::move(next)));
        return true;
    }
    catch_up();
    under_way_ = std::move(next);
    return true;
}

/// Finishes the part in flight, if there is one.
void PictureJob::catch_up()
{
    if (!under_way_) return;
    UnderWay last = std::move(*under_way_);
    under_way_.reset();
    const PicturePart part = last.part;
    finish(part, take(std::move(last)));
}

/// Draws a part with all bricks that its rays visit, or splits the part. Returns false if the next step must go on.
bool PictureJob::draw_completely(const PicturePart& part, bool waits)
{
    DeviceVolume& volume = scene().volume();
    // Other callers may have set another view since the last step, making the drawing stale: set the view again.
    look_at(scene(), look_, pane().shot, part);
    if (!rounds_) {
        if (area_of(part) != PixelBox{glm::uvec2(0), part.pixels}.area()) volume.forget_visits();
        rounds_.emplace(Rounds{.part = part});
    }
    if (!rounds_->rays) {
        if (!draw_rounds(waits)) return false;
        const bool is_limited = volume.state() != DeviceVolume::State::complete;
        if (is_limited && area_of(part) > MAX_WAITING_PIXELS) {
            rounds_.reset();
            for (const PicturePart& quarter : quarters_of(part)) parts_.push_back(quarter);
            return true;
        }
        if (is_limited) begin_waiting();
    }
    if (rounds_->rays && !draw_waiting(waits)) return false;
    finish(part, std::move(rounds_->passes));
    rounds_.reset();
    volume.let_rays_wait(false);
    return true;
}

/// Draws the part in `rounds_` repeatedly, until the device has all bricks that its rays visit or has no slots left.
bool PictureJob::draw_rounds(bool waits)
{
    using State = DeviceVolume::State;
    DeviceVolume& volume = scene().volume();
    for (;; ++rounds_->round) {
        const Progress progress = progress_of(rounds_->part, rounds_->round);
        if (!rounds_->is_drawn) {
            tell(progress, 0.0);
            if (!renew_occlusion(progress, waits)) return false;
            rounds_->passes = draw(rounds_->part);
            rounds_->is_drawn = true;
        }
        if (!load(progress, waits)) return false;
        // Visited bricks may have been lit without their neighbours, for lack of slots: load the neighbours now.
        if (!load_around(progress, waits)) return false;
        rounds_->is_drawn = false;
        if (volume.state() == State::limited) return true;
        if (!pane().shot.is_slice && scene().occlusion().is_due()) continue;  // for bricks visited for the first time
        if (volume.state() == State::complete && !volume.is_stale()) return true;
    }
}

void PictureJob::begin_waiting()
{
    const PicturePart part = rounds_->part;
    rounds_.emplace(Rounds{.part = part, .round = 1});
    rounds_->rays.emplace(renderer_.memory(), part.end - part.begin, pictures_of(pane().shot, part.probe));
    rounds_->waits_for_light = !pane().shot.is_slice && scene().has_occlusion(look_);
}

/// Draws a part whose rays need more bricks than fit. Every round loads the awaited bricks nearest to the camera, as
/// many as fit. So at least one ray advances in each round, and each ray passes bricks from near to far. If other
/// callers have drawn since the last step, the list of awaited bricks is determined again.
bool PictureJob::draw_waiting(bool waits)
{
    DeviceVolume& volume = scene().volume();
    const auto is_lit = [&scene = scene()](const BrickKey& key) { return scene.occlusion().is_lit(key); };
    for (;; ++rounds_->round) {
        volume.let_rays_wait(true, rounds_->waits_for_light ? std::function<bool(const BrickKey&)>(is_lit) : nullptr);
        if (!volume.has_rays_waiting()) {
            append(rounds_->passes, draw(rounds_->part, &*rounds_->rays));
            if (!volume.has_rays_waiting()) return true;
            if (rounds_->waits_for_light && !volume.limit_visits(scene().occlusion().reach())) {
                // If no ray can advance, let rays continue with incomplete light, and mark the picture as incomplete.
                note_limited();
                volume.let_rays_wait(false);
                volume.want_around({});
                rounds_->waits_for_light = false;
                continue;
            }
        }
        const Progress progress = progress_of(rounds_->part, rounds_->round);
        if (!(rounds_->waits_for_light ? renew_occlusion(progress, waits) : load(progress, waits))) return false;
        volume.forget_visits();
    }
}

/// Adds a warning that the ambient light of a single brick needs more bricks than fit on the device.
void PictureJob::note_limited()
{
    picture_.complete = false;
    if (!picture_.warnings.empty()) return;
    const DeviceVolume::Counts counts = scene().volume().counts().value_or(DeviceVolume::Counts{});
    const uint64_t budget = renderer_.memory().device_budget() >> 20;
    picture_.warnings.push_back(sentence("ambient light comes to a brick from ", gpu::OCCLUSION_AROUND,
                                         " bricks, and a device budget of ", budget, " MiB has room for ", counts.slots,
                                         "; expected a light.occlusion.radius of at most ", gpu::BRICK_SIZE - 4,
                                         ", or a larger one, as --budget-device ", 2 * budget, " gives"));
}

void PictureJob::finish(const PicturePart& part, std::vector<gpu::PassReport> passes)
{
    drawn_pixels_ += area_of(part);
    rays_cut_short_ += rays_cut_short(passes);
    picture_.complete = picture_.complete && scene().volume().missing() == 0;
    append(picture_.passes, std::move(passes));
}

Picture PictureJob::take()
{
    picture_.complete = is_complete();
    for (std::string& message : scene().take_messages()) picture_.warnings.push_back(std::move(message));
    if (rays_cut_short_ > 0) picture_.warnings.push_back(cut_short_sentence(rays_cut_short_, look_));
    return std::move(picture_);
}

}  // namespace shvr
