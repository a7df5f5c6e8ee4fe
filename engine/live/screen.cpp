#include "engine/live/screen.h"

#include <algorithm>

namespace shvr {

void Screen::look(const Session& session, const Camera& camera, const glm::uvec2& pixels, const glm::dvec3& probe_voxel)
{
    look_ = session.look();
    view_ = session.view;
    cut_ = session.cut;
    interaction_ = session.interaction;
    camera_ = camera;
    pixels_ = pixels;
    probe_voxel_ = probe_voxel;
    arrange(true);
}

void Screen::look_from(const Camera& camera, const glm::dvec3& probe_voxel)
{
    camera_ = camera;
    probe_voxel_ = probe_voxel;
    arrange(false);
}

void Screen::go_through(const std::optional<glm::dvec3>& cross)
{
    view_.slices.cross = cross;
    if (!parts_.empty()) arrange(false);
}

void Screen::arrange(bool look_changed)
{
    const std::vector<Pane> panes = panes_of(view_, camera_, pixels_, renderer_.scene().info(), probe_voxel_);
    retire_beyond(panes.size());
    for (size_t i = 0; i < panes.size(); ++i) {
        const Pane& pane = panes[i];
        const glm::uvec2 size = pane.box.end - pane.box.begin;
        const bool is_new = i == parts_.size();
        if (is_new) parts_.push_back({.pane = pane, .view = std::make_unique<View>(renderer_, options_)});
        Pane& before = parts_[i].pane;
        const bool looks_the_same = before.shot == pane.shot && before.box.end - before.box.begin == size;
        before = pane;
        if (is_new || look_changed || !looks_the_same) parts_[i].view->look(look_, interaction_, pane.shot, size);
    }
}

void Screen::retire_beyond(size_t panes)
{
    while (parts_.size() > panes) {
        parts_.back().view->wait();
        retired_submissions_ += parts_.back().view->submissions();
        retired_revisions_ += parts_.back().view->revision() + 1;
        parts_.pop_back();
    }
}

void Screen::clear()
{
    retire_beyond(0);
    turn_ = 0;
}

void Screen::drop()
{
    for (const Part& part : parts_) {
        retired_submissions_ += part.view->submissions();
        retired_revisions_ += part.view->revision() + 1;
    }
    parts_.clear();
    turn_ = 0;
}

void Screen::show_probe(const ProbeLook& probe)
{
    // In slices, the probe affects only the brush's preview. Motions below a twentieth of a voxel are ignored: they are
    // less than a pixel in any slice that shows the whole volume.
    constexpr double STIR_VOXELS = 0.05;
    const glm::dvec3 voxel = probe.center / renderer_.scene().info().spacing;
    const bool follows = view_.arrangement == Arrangement::slices && !parts_.empty();
    if (follows && glm::distance(voxel, probe_voxel_) > STIR_VOXELS) look_from(camera_, voxel);
    for (const Part& part : parts_)
        part.view->show_probe(part.pane.kind == Pane::Kind::slice && !probe.preview ? std::nullopt
                                                                                    : std::optional(probe));
}

/// Takes the scene's changes. Arriving bricks were requested by the current pane; others redraw in their own turns.
void Screen::take_changed()
{
    renderer_.scene().advance();
    for (const Scene::Changed& what : renderer_.scene().take_changed()) switch (what.cause) {
            case Scene::Cause::edit:
                is_held_ = false;
                for (const Part& part : parts_) part.view->changed(what.voxels);
                break;
            case Scene::Cause::bricks:
                if (turn_ < parts_.size()) parts_[turn_].view->bricks_arrived(what.voxels);
                break;
            case Scene::Cause::light:
                for (const Part& part : parts_)
                    if (!part.pane.shot.is_slice) part.view->light_changed(what.voxels);
                break;
        }
}

void Screen::update_occlusion()
{
    for (const Part& part : parts_)
        if (!part.pane.shot.is_slice) return part.view->update_occlusion();
}

bool Screen::is_loading() const
{
    return renderer_.volume().state() == DeviceVolume::State::loading;
}

/// Lets another pane load bricks: the volume loads bricks for one pane at a time. Interrupted panes redraw later.
void Screen::give_turn(size_t part)
{
    if (part == turn_) return;
    if (is_loading() && turn_ < parts_.size())
        parts_[turn_].view->bricks_arrived({Size3(0), renderer_.scene().info().size});
    turn_ = part;
}

void Screen::advance()
{
    for (const Part& part : parts_) part.view->collect();
    take_changed();
    submit_ahead(0.0);
}

void Screen::submit_ahead(double ahead_ms)
{
    is_held_ = is_held_ && std::ranges::none_of(parts_, [](const Part& part) { return part.view->lags(); });
    if (is_held_) return;
    const auto first = [&](const auto& wants) {
        size_t part = 0;
        while (part < parts_.size() && !wants(part)) ++part;
        return part;
    };
    const size_t unsketched = first([&](size_t part) { return !parts_[part].view->is_sketched(); });
    const size_t next = unsketched < parts_.size() ? unsketched : first([&](size_t part) {
        return !parts_[part].view->is_finished() || (part == turn_ && is_loading());
    });
    if (next == parts_.size()) return;
    // Only one view draws at a time, so that the total work in flight stays small.
    for (size_t part = 0; part < parts_.size(); ++part)
        if (part != next && !parts_[part].view->is_idle()) return;
    give_turn(next);
    if (unsketched < parts_.size())
        parts_[next].view->submit_sketches(ahead_ms);
    else
        parts_[next].view->submit_due(ahead_ms);
}

void Screen::wait()
{
    for (const Part& part : parts_) part.view->wait();
}

bool Screen::complete() const
{
    return !is_loading() && !renderer_.scene().has_changed() &&
           std::ranges::all_of(parts_, [](const Part& part) { return part.view->is_finished(); });
}

std::vector<Stroke> Screen::strokes(const Part& part, const ProbeLook& probe, const TraceMarks& marks,
                                    bool shows_cut_box) const
{
    if (!part.view->shown_camera() || !shows_anything()) return {};
    Pane shown = part.pane;
    shown.shot.camera = *part.view->shown_camera();  // strokes must match the shown picture, which may be older
    const PixelBox& box = parts_[0].pane.box;
    return strokes_of(shown,
                      {.main = camera_,
                       .main_pixels = box.end - box.begin,
                       .probe = {.center = probe.center,
                                 .radius = probe.radius,
                                 .color = probe.color,
                                 .is_outlined = probe.has_silhouette,
                                 .has_arrow = probe.has_arrow},
                       .cross = cross(),
                       .balls = marks.balls,
                       .lines = marks.lines,
                       .box = cut_box(shows_cut_box)},
                      renderer_.scene().info());
}

/// Returns where the slices meet, in volume space; null: at the probe.
std::optional<glm::dvec3> Screen::cross() const
{
    if (!view_.slices.cross) return std::nullopt;
    return *view_.slices.cross * renderer_.scene().info().spacing;
}

std::optional<OverlayScene::Box> Screen::cut_box(bool is_wanted) const
{
    if (!view_.cut_box && !is_wanted) return std::nullopt;
    return box_of(cut_, renderer_.scene().info());
}

Image8 Screen::read_back()
{
    Image8 whole{int(pixels_.x), int(pixels_.y), std::vector<uint8_t>(size_t(pixels_.x) * pixels_.y * 4)};
    for (const Part& part : parts_) {
        const Image8 shown = part.view->read_back();
        const PixelBox& box = part.pane.box;
        for (uint32_t y = 0; y < uint32_t(shown.height); ++y)
            std::ranges::copy_n(&shown.rgba[4 * size_t(shown.width) * y], 4 * shown.width,
                                &whole.rgba[4 * (box.begin.x + size_t(pixels_.x) * (box.begin.y + y))]);
        const bool is_map = part.pane.kind == Pane::Kind::map || part.pane.kind == Pane::Kind::slice;
        if (!is_map && !view_.cut_box) continue;
        const VolumeInfo& volume = renderer_.scene().info();
        const OverlayScene scene = overlay_of(view_, cut_, camera_, parts_[0].pane.pixels(), probe_voxel_, volume);
        draw_strokes(whole, strokes_of(part.pane, scene, volume), box);
    }
    return whole;
}

std::vector<View::Layer> Screen::layers() const
{
    std::vector<View::Layer> layers;
    for (const Part& part : parts_)
        for (View::Layer layer : part.view->layers()) {
            layer.target = {layer.target.begin + part.pane.box.begin, layer.target.end + part.pane.box.begin};
            layers.push_back(layer);
        }
    return layers;
}

uint64_t Screen::revision() const
{
    uint64_t sum = retired_revisions_;
    for (const Part& part : parts_) sum += part.view->revision();
    return sum;
}

uint64_t Screen::submissions() const
{
    uint64_t sum = retired_submissions_;
    for (const Part& part : parts_) sum += part.view->submissions();
    return sum;
}

std::vector<View::PassTime> Screen::pass_times() const
{
    std::vector<View::PassTime> sum;
    for (const Part& part : parts_)
        for (const View::PassTime& pass : part.view->pass_times()) {
            auto known = std::ranges::find(sum, pass.name, &View::PassTime::name);
            if (known == sum.end()) known = sum.insert(known, {.name = pass.name});
            known->runs += pass.runs;
            known->total_ms += pass.total_ms;
            known->longest_ms = std::max(known->longest_ms, pass.longest_ms);
        }
    return sum;
}

}  // namespace shvr
