#include "engine/live/view.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>
#include <utility>

#include "engine/passes/encode.h"

namespace shvr {

namespace {

/// Linear light drawn behind a translucent background.
constexpr glm::vec3 BEHIND(0.05f);

double now_s()
{
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

glm::uvec2 divided(const glm::uvec2& pixels, uint32_t scale)
{
    return (pixels + scale - 1u) / scale;
}

/// Rounds width and height up to powers of two, so that growing images are seldom re-created.
glm::uvec2 roomy(const glm::uvec2& pixels)
{
    return {std::bit_ceil(pixels.x), std::bit_ceil(pixels.y)};
}

}  // namespace

void View::look(const Look& look, const InteractionSettings& interaction, const Shot& shot, const glm::uvec2& pixels)
{
    SHVR_CHECK(pixels.x > 0 && pixels.y > 0);
    sight_ = std::make_shared<const Sight>(Sight{look, interaction, shot, pixels});
}

void View::show_probe(const std::optional<ProbeLook>& probe)
{
    probe_ = probe;
}

void View::changed(const VoxelBox& voxels)
{
    patch_is_dirty_ = true;
    if (base_.job) changed_during_base_.push_back(voxels);
    if (shown_sight_) mark_voxels(voxels);
}

void View::bricks_arrived(const VoxelBox& voxels)
{
    patch_is_dirty_ = true;
    if (base_.job) changed_during_base_.push_back(voxels);
    if (shown_sight_) mark_voxels(voxels, false);
}

/// Notes that light changed. The patch over the probe is redrawn once all occlusion is updated (submit_occlusion).
void View::light_changed(const VoxelBox& voxels)
{
    occlusion_was_renewed_ = true;
    if (base_.job) changed_during_base_.push_back(voxels);
    if (shown_sight_) mark_voxels(voxels);
}

/// Returns the pixels that may show the voxels, seen by the camera or by both cameras of an anaglyph.
PixelBox View::pixels_of(const Sight& sight, const VoxelBox& voxels) const
{
    // A voxel's paint fills only the voxel's own cube, so pixels beyond the cube stay the same.
    const glm::dvec3& spacing = scene().info().spacing;
    const glm::dvec3 lower = glm::dvec3(voxels.lower) * spacing, upper = glm::dvec3(voxels.upper) * spacing;
    const PixelBox one = pixels_of_box(sight.shot.camera, sight.pixels, lower, upper);
    if (!sight.shot.right_eye) return one;
    return united(one, pixels_of_box(*sight.shot.right_eye, sight.pixels, lower, upper));
}

void View::mark_voxels(const VoxelBox& voxels, bool is_urgent)
{
    mark_due(pixels_of(*shown_sight_, voxels), is_urgent);
}

glm::uvec2 View::tile_counts() const
{
    return divided(shown_sight_->pixels, TILE);
}

void View::mark_due(const PixelBox& pixels, bool is_urgent)
{
    if (pixels.empty()) return;
    const glm::uvec2 counts = tile_counts(), first = pixels.begin / TILE, last = (pixels.end - 1u) / TILE;
    for (uint32_t y = first.y; y <= last.y; ++y)
        for (uint32_t x = first.x; x <= last.x; ++x) {
            Tile& tile = tiles_[x + counts.x * y];
            tile.is_due = true;
            tile.is_urgent = tile.is_urgent || is_urgent;
        }
}

void View::reset_tiles()
{
    const glm::uvec2 counts = tile_counts();
    const bool is_due = base_.shown.share < 1.0 && unsharp_sight_ != shown_sight_;
    tiles_.assign(size_t(counts.x) * counts.y, {.is_shown = false, .is_due = is_due});
    has_no_strips_ = false;
}

void View::reserve(gpu::Storage& image, const std::string& name, Format format, const glm::uvec2& pixels)
{
    if (image && glm::all(glm::greaterThanEqual(glm::uvec2(image.desc().texels), pixels))) return;
    const glm::uvec2 before = image ? glm::uvec2(image.desc().texels) : glm::uvec2(0);
    image.reset();
    try {
        image = renderer_.memory().create(name, picture_desc(format, glm::max(before, pixels)), gpu::Placement::device,
                                          "the picture on the screen");
    } catch (...) {
        forget();
        throw;
    }
}

/// Resets the view: nothing is shown or in progress, no memory is used, and the next picture starts from scratch.
void View::forget()
{
    for (const Running& running : running_) running.submission.wait();
    running_.clear();
    in_flight_ms_ = 0.0;
    base_ = {};
    patch_ = {};
    work_.reset();
    for (gpu::Storage& strip : strips_) strip.reset();
    sharp_.reset();
    tiles_.clear();
    changed_during_base_.clear();
    shown_sight_.reset();
    coming_sight_.reset();
    finer_sight_.reset();
    ++revision_;
}

// ---- What comes next ------------------------------------------------------------------------------------------------

void View::advance()
{
    reap();
    scene().advance();
    for (const Scene::Changed& what : scene().take_changed()) switch (what.cause) {
            case Scene::Cause::edit: changed(what.voxels); break;
            case Scene::Cause::bricks: bricks_arrived(what.voxels); break;
            case Scene::Cause::light: light_changed(what.voxels); break;
        }
    submit_due();
}

void View::submit_due(double ahead_ms)
{
    while (in_flight_ms_ < options_.in_flight_ms + ahead_ms && submit_or_give_way(false)) {
    }
}

void View::submit_sketches(double ahead_ms)
{
    while (in_flight_ms_ < options_.in_flight_ms + ahead_ms && submit_or_give_way(true)) {
    }
}

/// Submits the next work. If memory is short, frees ambient occlusion and defers the work to the next frame.
bool View::submit_or_give_way(bool sketches_alone)
{
    try {
        return submit_next(sketches_alone);
    } catch (const gpu::MemoryError& error) {
        if (!scene().give_way(error.what())) throw;
        return false;  // the next frame tries again
    }
}

bool View::patch_is_due() const
{
    return patch_.shown.sight != shown_sight_ || patch_.shown.probe != probe_ || (probe_ && patch_is_dirty_);
}

bool View::is_listed(const Sight& sight)
{
    return get_ready(scene(), sight.look, sight.shot,
                     {.pixels = sight.pixels, .always_shown = voxels_of_shell(probe_, scene().info())});
}

/// Returns the requested sight if its bricks are listed, or else a recent sight with listed bricks; null if none has.
View::SightRef View::listed_sight()
{
    if (!coming_sight_) coming_sight_ = sight_;
    if (!is_listed(*coming_sight_)) return nullptr;
    const SightRef listed = std::exchange(coming_sight_, nullptr);
    return is_listed(*sight_) ? sight_ : listed;
}

/// Lists the bricks of the next sketch while the current sketch is being drawn.
void View::list_ahead()
{
    if (sight_ == shown_sight_ || (base_.job && base_.job->sight == sight_)) return;
    if (coming_sight_ == sight_ || (coming_sight_ && !is_listed(*coming_sight_))) return;
    coming_sight_ = sight_;
    static_cast<void>(is_listed(*sight_));
}

bool View::submit_next(bool sketches_alone)
{
    if (!sight_) return false;
    if (is_drawing_finer_sketch() && (sight_ != shown_sight_ || patch_is_due())) {
        if (base_.running > 0) return false;  // the sketch's image is still in use, so the caller tries again later
        drop_finer_sketch();
    }
    if (submit_sketch(base_, Purpose::base) || submit_sketch(patch_, Purpose::patch)) return true;
    if (base_.job || patch_.job) {  // in flight
        list_ahead();
        return false;
    }
    if (sight_ != shown_sight_) {
        const SightRef sight = listed_sight();
        if (!sight) return false;
        pass_times_.clear();
        changed_during_base_.clear();
        start(base_, sight, std::nullopt, options_.motion_ms);
        if (probe_) start(patch_, sight, probe_, options_.probe_ms);  // shown at the same time as the picture's sketch
        patch_is_dirty_ = false;
        return submit_next(sketches_alone);
    }
    if (patch_is_due()) {
        patch_is_dirty_ = false;
        start(patch_, sight_, probe_, options_.probe_ms);
        finish_sketches();  // finishes sketches that have nothing to draw
        return submit_next(sketches_alone);
    }
    if (sketches_alone) return false;
    if (submit_occlusion()) return true;
    if (scene().has_changed()) return false;  // the changes must be collected first, or tiles are drawn twice
    if (patch_is_due()) return submit_next(sketches_alone);
    if (submit_finer_sketch()) return submit_next(sketches_alone);
    if (submit_tiles()) return true;
    if (std::ranges::any_of(tiles_, [this](const Tile& tile) { return may_draw(tile); }))
        return false;  // the bricks that these tiles need are being listed
    if (running_.empty() && patch_.shown.share < 1.0 && !patch_.shown.part.empty()) {
        start(patch_, sight_, probe_, std::numeric_limits<double>::infinity());  // nothing moves: draws the patch sharp
        return submit_next(sketches_alone);
    }
    return running_.empty() && submit_refinement();
}

bool View::submit_refinement()
{
    std::optional<FrameGraph> graph = next_refinement(scene(), shown_sight_->look);
    if (!graph) return false;
    submit(std::move(*graph), {.purpose = Purpose::preparation, .pace = &preparation_, .units = 1.0});
    return true;
}

bool View::submit_preparation(const Sight& sight)
{
    std::optional<FrameGraph> graph = next_preparation(scene(), sight.look);
    if (!graph) return false;
    submit(std::move(*graph), {.purpose = Purpose::preparation, .pace = &preparation_, .units = 1.0});
    return true;
}

Resource View::draw(FrameGraph& graph, const PicturePart& part, Import light, Running& running)
{
    const Sight& sight = *running.sight;
    PicturePart shown = part;
    shown.always_shown = voxels_of_shell(probe_, scene().info());  // every part shows these voxels, including parts
                                                                   // without the probe
    Drawn drawn = shvr::draw(graph, scene(), sight.look, sight.shot, shown, graph.import("light", light));
    running.pace = &rays_;
    running.units = double(running.pixels);
    running.feedback = std::move(drawn.feedback);
    return drawn.target;
}

gpu::EncodeParams View::encoding() const
{
    gpu::EncodeParams params{};
    params.step = glm::vec2(1.0f);
    params.behind = BEHIND;
    params.swap_red_blue = options_.swap_red_blue;
    return params;
}

bool View::occlusion_is_due() const
{
    const OcclusionSettings& settings = shown_sight_->look.light.occlusion;
    return !shown_sight_->shot.is_slice && (settings.automatic || occlusion_is_asked_for_) &&
           scene().occlusion().is_due();
}

/// Submits a slice of ambient occlusion. Bricks overlap on screen, so sharp tiles wait until no slice is left.
bool View::submit_occlusion()
{
    constexpr double LEAST = 2.0, MOST = 256.0;
    const auto bricks = uint32_t(std::clamp(occlusion_.affords(options_.step_ms), LEAST, MOST));
    const Sight& sight = *shown_sight_;
    if (sight.shot.is_slice) return false;
    if (!sight.look.light.occlusion.automatic && !occlusion_is_asked_for_) return false;
    constexpr double CELL_BRICKS = 8.0;  // the values of one brick cost about as much as the cells of this many bricks
    const Occlusion::Counts before = scene().occlusion().counts();
    std::optional<FrameGraph> slice = next_occlusion(scene(), sight.look, sight.shot.camera,
                                                     {.bricks = bricks, .cell_bricks = size_t(CELL_BRICKS) * bricks});
    if (!slice) {
        occlusion_is_asked_for_ = false;
        patch_is_dirty_ = patch_is_dirty_ || occlusion_was_renewed_;
        occlusion_was_renewed_ = false;
        return false;
    }
    const Occlusion::Counts& after = scene().occlusion().counts();  // fewer may be done than requested
    const double units = double(after.values - before.values) + double(after.cells - before.cells) / CELL_BRICKS;
    submit(std::move(*slice), {.purpose = Purpose::preparation, .pace = &occlusion_, .units = units});
    return true;
}

/// Selects the next batch of tiles, nearest to the focus first: large enough that a few batches complete the picture,
/// or all remaining tiles if they take only a moment.
void View::choose_batch(const glm::dvec2& focus)
{
    constexpr size_t BATCHES = 6;
    const uint32_t across = tile_counts().x;
    std::vector<std::pair<double, uint32_t>> left;  // by distance
    for (uint32_t index = 0; index < tiles_.size(); ++index) {
        if (tiles_[index].is_in_batch && !tiles_[index].is_drawn) return;  // there is a batch already
        if (tiles_[index].is_shown || !tiles_[index].is_due) continue;
        const glm::dvec2 apart = (glm::dvec2(index % across, index / across) + 0.5) * double(TILE) - focus;
        left.emplace_back(glm::dot(apart, apart), index);
    }
    const auto of_moment = size_t(options_.moment_ms / cost_ms(uint64_t(TILE) * TILE));
    const size_t count = std::min(left.size(), std::max((tiles_.size() + BATCHES - 1) / BATCHES, of_moment));
    std::ranges::nth_element(left, left.begin() + std::ptrdiff_t(count));
    for (size_t i = 0; i < count; ++i) tiles_[left[i].second].is_in_batch = true;
}

/// Shows the tiles of the batch, if all of them are drawn.
void View::show_batch()
{
    const auto is_missing = [](const Tile& tile) { return tile.is_in_batch && !tile.is_drawn; };
    if (std::ranges::any_of(tiles_, is_missing)) return;
    for (Tile& tile : tiles_) {
        if (!std::exchange(tile.is_in_batch, false)) continue;
        tile.is_shown = true;
        ++revision_;
    }
}

bool View::may_draw(const Tile& tile) const
{
    constexpr double AGAIN_S = 0.25;
    if (!tile.is_shown && !tile.is_urgent && !tile.is_in_batch) return false;  // tiles of later batches wait
    if (!tile.is_due || tile.drawn_s == 0.0 || tile.is_urgent) return tile.is_due;
    const bool more_comes = scene().volume().state() == DeviceVolume::State::loading;
    return !more_comes || now_s() - tile.drawn_s > AGAIN_S;
}

/// Returns whether there is memory for sharp tiles. Reports a lack of memory once per view.
bool View::has_room_for_tiles()
{
    if (unsharp_sight_ == shown_sight_) return false;
    const glm::uvec2 pixels = shown_sight_->pixels;
    if (sharp_ && glm::all(glm::greaterThanEqual(glm::uvec2(sharp_.desc().texels), pixels))) return true;
    for (Tile& tile : tiles_) tile.is_shown = false;
    ++revision_;
    sharp_.reset();
    try {
        sharp_ = renderer_.memory().create("sharp picture", picture_desc(Format::rgba8_unorm, pixels),
                                           gpu::Placement::device, "the sharp picture on the screen");
        return true;
    } catch (const gpu::MemoryError& error) {
        if (scene().give_way(error.what())) return has_room_for_tiles();
        unsharp_sight_ = shown_sight_;
        scene().note_message(sentence("pictures stay coarse: ", error.what()));
        return false;
    }
}

/// Draws a new sketch of the whole picture instead of sharp tiles, which do not fit in memory.
bool View::submit_sketch_instead()
{
    start(base_, shown_sight_, std::nullopt, options_.motion_ms);
    for (Tile& tile : tiles_) tile = {};
    return submit_sketch(base_, Purpose::base);
}

/// Returns a box of tiles around a due tile, as large as one step allows. Grows within the row first, then row by row.
PixelBox View::strip_of_tiles(const glm::uvec2& nearest) const
{
    constexpr uint32_t MAX_TILES = (1u << 20) / (TILE * TILE);  // 16 MiB of light
    const glm::uvec2 counts = tile_counts();
    const double affordable = std::min(rays_.affords(options_.step_ms) / (TILE * TILE), double(MAX_TILES));
    PixelBox strip{nearest, nearest + 1u};
    const auto grow = [&](const glm::uvec2& begin, const glm::uvec2& end) {
        const PixelBox grown{glm::min(strip.begin, begin), glm::max(strip.end, end)};
        if (double(grown.area()) > affordable) return false;
        for (uint32_t y = begin.y; y < end.y; ++y)
            for (uint32_t x = begin.x; x < end.x; ++x)
                if (!may_draw(tiles_[x + counts.x * y])) return false;
        strip = grown;
        return true;
    };
    while (strip.end.x < counts.x && grow({strip.end.x, strip.begin.y}, strip.end + glm::uvec2(1, 0))) {
    }
    while (strip.begin.x > 0 && grow(strip.begin - glm::uvec2(1, 0), {strip.begin.x, strip.end.y})) {
    }
    while (strip.end.y < counts.y && grow({strip.begin.x, strip.end.y}, strip.end + glm::uvec2(0, 1))) {
    }
    while (strip.begin.y > 0 && grow(strip.begin - glm::uvec2(0, 1), {strip.end.x, strip.begin.y})) {
    }
    return strip;
}

/// Returns the image for the light of the next sharp tiles.
Import View::strip_light(const glm::uvec2& pixels)
{
    if (!has_no_strips_) try {
            gpu::Storage& strip = strips_[next_strip_];
            next_strip_ = (next_strip_ + 1) % strips_.size();
            const bool fits = strip && glm::all(glm::greaterThanEqual(glm::uvec2(strip.desc().texels), pixels));
            const glm::uvec2 before = strip ? glm::uvec2(strip.desc().texels) : glm::uvec2(0);
            if (!fits) {
                strip.reset();
                strip = renderer_.memory().create("light of tiles",
                                                  picture_desc(Format::rgba32_float, glm::max(before, roomy(pixels))),
                                                  gpu::Placement::device, "the sharp picture on the screen");
            }
            return strip.import();
        } catch (const gpu::MemoryError&) {
            has_no_strips_ = true;
            for (gpu::Storage& strip : strips_) strip.reset();
        }
    reserve(work_, "light", Format::rgba32_float, pixels);
    return work_.import();
}

bool View::submit_tiles()
{
    const glm::uvec2 counts = tile_counts(), pixels = shown_sight_->pixels;
    glm::dvec2 focus = 0.5 * glm::dvec2(pixels);
    if (probe_)
        if (const auto seen = project(shown_sight_->shot.camera, pixels, probe_->center)) focus = seen->pixel;
    choose_batch(focus);
    std::optional<glm::uvec2> nearest;
    double best = 0.0;
    for (uint32_t y = 0; y < counts.y; ++y)
        for (uint32_t x = 0; x < counts.x; ++x) {
            if (!may_draw(tiles_[x + counts.x * y])) continue;
            const glm::dvec2 apart = (glm::dvec2(x, y) + 0.5) * double(TILE) - focus;
            const double square = glm::dot(apart, apart);
            if (!nearest || square < best) nearest = glm::uvec2(x, y), best = square;
        }
    if (!nearest) return false;
    if (!has_room_for_tiles()) return submit_sketch_instead();
    if (!is_listed(*shown_sight_)) return false;  // paint or the probe's shell reached an unlisted brick
    if (submit_preparation(*shown_sight_)) return true;

    const PixelBox strip = strip_of_tiles(*nearest);
    Running running{.purpose = Purpose::tiles, .sight = shown_sight_};
    for (uint32_t y = strip.begin.y; y < strip.end.y; ++y)
        for (uint32_t x = strip.begin.x; x < strip.end.x; ++x) running.tiles.push_back(x + counts.x * y);
    const PicturePart part{.pixels = pixels, .begin = strip.begin * TILE, .end = glm::min(strip.end * TILE, pixels)};
    running.pixels = PixelBox{part.begin, part.end}.area();
    const glm::uvec2 size = part.end - part.begin;
    FrameGraph graph;
    const Import light_of_strip = strip_light(size);
    // Imports the light of the other tiles as well, so that barriers cover accesses to it by earlier graphs.
    for (const gpu::Storage& other : strips_)
        if (other && other.import().id != light_of_strip.id)
            static_cast<void>(graph.import("light of other tiles", other.import()));
    const Resource light = draw(graph, part, light_of_strip, running);
    gpu::EncodeParams params = encoding();
    params.target = part.begin;
    params.size = size;
    params.first = glm::vec2(0.5f);
    params.last = size - 1u;
    static_cast<void>(encode(graph, light, graph.import("display", sharp_.import()), params));
    submit(std::move(graph), std::move(running));
    for (const uint32_t index : running_.back().tiles) {
        Tile& tile = tiles_[index];
        if (tile.is_urgent) tile.is_in_batch = false;  // changed voxels are shown at once instead of with a batch
        tile.is_due = tile.is_urgent = false;
        tile.drawn_s = now_s();
    }
    return true;
}

void View::submit(FrameGraph graph, Running running)
{
    if (running.pace) running.estimate_ms = running.pace->ms() * running.units;
    if (running_.empty()) busy_since_ = std::chrono::steady_clock::now();
    running.submission = renderer_.executor().submit(std::move(graph));
    in_flight_ms_ += running.estimate_ms;
    ++submissions_;
    running_.push_back(std::move(running));
}

// ---- Completed work -------------------------------------------------------------------------------------------------

void View::note(const std::string& pass, double ms, bool waits)
{
    auto known = std::ranges::find(pass_times_, pass, &PassTime::name);
    if (known == pass_times_.end()) known = pass_times_.insert(known, {.name = pass});
    ++known->runs;
    known->total_ms += ms;
    known->longest_ms = std::max(known->longest_ms, ms);
    known->waits += waits;
}

void View::account(const gpu::FrameResult& result, const Running& done)
{
    const auto waits = [](const gpu::PassReport& pass) { return pass.barrier.starts_with("compute"); };
    const auto now = std::chrono::steady_clock::now();
    const double host_ms = std::chrono::duration<double, std::milli>(now - busy_since_).count();
    busy_since_ = now;
    if (!host_tells_time())
        for (const gpu::PassReport& pass : result.passes) note(pass.name, pass.gpu_ms, waits(pass));
    // Passes may overlap, so their times may add up to more than the total time.
    const double ms = host_tells_time() ? host_ms : result.gpu_ms;
    // If only the host can measure the time, all of the frame's time is charged to the most expensive pass.
    if (host_tells_time() && !result.passes.empty()) {
        const auto rays = std::ranges::find(result.passes, "raycast", &gpu::PassReport::name);
        const bool has_rays = rays != result.passes.end();
        note(has_rays ? "raycast" : result.passes.back().name, ms, has_rays && waits(*rays));
    }
    if (done.pace) done.pace->learn(ms, done.units);
    if (done.pixels > 0) sketch_ms_ += ms;
}

void View::wait()
{
    while (!running_.empty()) {
        running_.front().submission.wait();
        reap();
    }
}

/// Reports once per view.
void View::note_cut_short(const Running& done, uint64_t rays)
{
    if (rays == 0 || !done.sight || done.sight == cut_short_sight_) return;
    cut_short_sight_ = done.sight;
    scene().note_message(cut_short_sentence(rays, done.sight->look));
}

void View::reap()
{
    while (!running_.empty() && running_.front().submission.done()) {
        Running done = std::move(running_.front());
        running_.pop_front();
        in_flight_ms_ = running_.empty() ? 0.0 : in_flight_ms_ - done.estimate_ms;
        const gpu::FrameResult result = done.submission.finish();
        account(result, done);
        scene().volume().take_feedback(done.feedback, result);
        note_cut_short(done, rays_cut_short(result.passes));
        switch (done.purpose) {
            case Purpose::preparation: break;
            case Purpose::base: --base_.running; break;
            case Purpose::patch: --patch_.running; break;
            case Purpose::tiles:
                if (done.sight != shown_sight_) break;
                for (const uint32_t index : done.tiles) {
                    Tile& tile = tiles_[index];
                    tile.is_drawn = true;
                    tile.is_shown = tile.is_shown || !tile.is_in_batch;
                    if (tile.is_shown) ++revision_;
                }
                show_batch();
                break;
        }
        finish_sketches();
    }
}

bool View::complete() const
{
    if (!sight_) return true;
    return scene().volume().state() != DeviceVolume::State::loading && !scene().has_changed() && is_finished();
}

bool View::is_finished() const
{
    if (!sight_) return true;
    if (sight_ != shown_sight_ || !running_.empty() || base_.job || patch_.job || patch_is_due()) return false;
    if (occlusion_is_due() || scene().volume().refinement_is_due()) return false;
    return (patch_.shown.share == 1.0 || patch_.shown.part.empty()) &&
           std::ranges::none_of(tiles_, [](const Tile& tile) { return tile.is_due; });
}

std::vector<View::Layer> View::layers() const
{
    std::vector<Layer> layers;
    if (!shown_sight_) return layers;
    const glm::uvec2 pixels = shown_sight_->pixels;
    const auto add_sketch = [&](const Sketch& sketch) {
        const Sketch::Content& shown = sketch.shown;
        if (shown.sight != shown_sight_ || shown.part.empty()) return;
        layers.push_back({.image = sketch.images[sketch.front].import(),
                          .source = {glm::uvec2(0), shown.target.end - shown.target.begin},
                          .target = shown.target});
    };
    const bool is_sharp = std::ranges::all_of(tiles_, &Tile::is_shown);
    if (!is_sharp) add_sketch(base_);
    const glm::uvec2 counts = tile_counts();
    const auto add_tiles = [&](uint32_t begin, uint32_t end, uint32_t y, uint32_t rows) {
        const PixelBox box{glm::uvec2(begin, y) * TILE, glm::min(glm::uvec2(end, y + rows) * TILE, pixels)};
        layers.push_back({.image = sharp_.import(), .source = box, .target = box});
    };
    if (is_sharp) add_tiles(0, counts.x, 0, counts.y);
    for (uint32_t y = 0; !is_sharp && y < counts.y; ++y)
        for (uint32_t x = 0; x < counts.x; ++x) {
            const uint32_t begin = x;
            while (x < counts.x && tiles_[x + counts.x * y].is_shown) ++x;
            if (x > begin) add_tiles(begin, x, y, 1);
        }
    add_sketch(patch_);
    return layers;
}

Image8 View::read_back()
{
    const glm::uvec2 pixels = shown_sight_ ? shown_sight_->pixels : glm::uvec2(0);
    Image8 picture{int(pixels.x), int(pixels.y), std::vector<uint8_t>(size_t(pixels.x) * pixels.y * 4)};
    for (const Layer& layer : layers()) {
        const glm::uvec2 size = layer.target.end - layer.target.begin;
        FrameGraph graph;
        graph.read_back(graph.import("layer", layer.image));
        const gpu::FrameResult result = renderer_.executor().run(std::move(graph), {.timestamps = false});
        const size_t source_width = layer.image.desc.texels.x;
        for (uint32_t y = 0; y < size.y; ++y)
            std::memcpy(&picture.rgba[4 * ((layer.target.begin.y + y) * size_t(pixels.x) + layer.target.begin.x)],
                        &result.read_backs[0][4 * ((layer.source.begin.y + y) * source_width + layer.source.begin.x)],
                        4 * size_t(size.x));
    }
    if (options_.swap_red_blue)
        for (size_t pixel = 0; pixel < picture.rgba.size(); pixel += 4)
            std::swap(picture.rgba[pixel], picture.rgba[pixel + 2]);
    return picture;
}

}  // namespace shvr
