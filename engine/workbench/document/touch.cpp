#include "engine/workbench/document/touch.h"

#include <algorithm>
#include <ctime>
#include <utility>

#include "engine/workbench/touch/felt_relevance.h"
#include "haptics/simulated_device.h"

namespace shvr::ui {

namespace {

/// Size of a voxel in the device's workspace, for which the force law's stiffness is tuned (scans of vascular bundles).
constexpr double VOXEL_M = 0.00025;

uint64_t now_ns()
{
    timespec time{};
    clock_gettime(CLOCK_MONOTONIC, &time);  // the servo's clock
    return uint64_t(time.tv_sec) * 1'000'000'000u + uint64_t(time.tv_nsec);
}

}  // namespace

Touch::Touch(Renderer& renderer) : renderer_(renderer), relevance_(renderer) {}

void Touch::start(std::shared_ptr<HapticDevice> device)
{
    stop();
    sent_.reset();
    state_ = {};
    tap_ = {};
    if (recorder_) recorder_->swap_device();
    servo_ = std::make_unique<TappedServo>(std::move(device), real_pacing(), recorder_ ? recorder_->number() : 0);
    Servo& servo = servo_->servo;
    mirror_ = std::make_unique<RelevanceMirror>(
        RelevanceMirror::Ends{.probe = [&servo]() -> std::optional<ProbeMotion> {
                                  servo.place().take();
                                  const ProbePlace& place = servo.place().value();
                                  if (!place.is_known) return std::nullopt;
                                  return ProbeMotion{place.point, place.velocity};
                              },
                              .publish =
                                  [tapped = servo_.get()](const MirroredRelevance& mirrored) {
                                      put_mirrored(mirrored, tapped->relevance());
                                      tapped->publish_relevance();
                                  },
                              .now_ns = now_ns});
}

void Touch::stop()
{
    mirror_.reset();
    if (recorder_ && servo_) recorder_->advance(*servo_->link);
    servo_.reset();
}

void Touch::use(std::shared_ptr<HapticDevice> device, bool moves_view)
{
    if (device == device_ && moves_view == moves_view_) return;
    stop();
    puck_.reset();
    puck_state_ = {};
    mouse_ = nullptr;
    wish_ = probe_;
    device_ = std::move(device);
    moves_view_ = moves_view && device_;
    if (moves_view_)
        puck_ = std::make_unique<TappedServo>(device_);
    else if (device_)
        start(device_);
}

void Touch::start_mouse()
{
    auto device = std::make_shared<SimulatedDevice>();
    mouse_ = device.get();
    wish_ = probe_;
    send_wish(true);
    start(std::move(device));
}

void Touch::stop_mouse()
{
    stop();
    mouse_ = nullptr;
    wish_ = probe_;  // it stays where assistance left it
}

double Touch::finest_spacing() const
{
    const glm::dvec3& spacing = renderer_.volume().info().spacing;
    return std::min({spacing.x, spacing.y, spacing.z});
}

Workspace Touch::workspace(const TouchSettings& settings) const
{
    if (!is_mouse()) return workspace_in_view(settings.camera, settings.view_height, settings.scale);
    const VolumeInfo& info = renderer_.volume().info();
    return {.to_volume = glm::dmat3(finest_spacing() / VOXEL_M), .origin = 0.5 * glm::dvec3(info.size) * info.spacing};
}

/// Moves the probe. If a plane constrains the probe, moves the plane along with it.
void Touch::place(const glm::dvec3& point)
{
    if (plane_ != TouchPlane::none) on_plane_ = point;
    wish_ = probe_ = point;
    send_wish(true);
}

void Touch::wish(const glm::dvec3& point)
{
    if (!is_mouse()) return;  // the device's hand is elsewhere
    wish_ = in_plane(plane_, on_plane_, point);
    if (servo_)
        send_wish(false);
    else
        probe_ = wish_;
}

void Touch::send_wish(bool jump)
{
    if (!mouse_) return;
    jumps_ += jump;
    const Workspace space = workspace({});
    mouse_->wish().publish({.position_m = (wish_ - space.origin) / space.scale(), .buttons = 0, .jump = jumps_});
}

uint32_t Touch::buttons() const
{
    return puck_ ? puck_state_.device.buttons : is_mouse() ? 0 : state_.device.buttons;
}

bool Touch::is_realtime() const
{
    return servo_ ? servo_->servo.is_realtime() : puck_ && puck_->servo.is_realtime();
}

// ---- Turns

void Touch::hold_to_plane(const TouchSettings& settings)
{
    if (settings.guide.feel.plane == plane_) return;
    plane_ = settings.guide.feel.plane;
    on_plane_ = probe_;
    ++planes_;
}

/// Sends settings only if they differ from those last sent, so that a recording contains changes only.
void Touch::send_settings(const TouchSettings& settings)
{
    const GuideSettings& guide = settings.guide;
    TapOrder order;
    order.settings.threshold = guide.threshold;
    order.settings.force = {.assistance = guide.assists && !awaits_relevance_,
                            .law = guide.law,
                            .probe_radius = guide.probe_radius,
                            .stiffness = guide.feel.stiffness,
                            .damping = guide.feel.damping,
                            .workspace = workspace(settings),
                            .reset = resets_,
                            .mode = guide.mode,
                            .to_camera = -axes_of(settings.camera).forward,
                            .surface_share = guide.feel.surface_share,
                            .movement_scale = is_mouse() ? 1.0 : settings.scale,
                            .strength = guide.feel.strength,
                            .clicks = guide.feel.clicks,
                            .let_go = settings.lets_go,
                            .finds_middle = guide.feel.at_proxy,
                            .relevance_settings = chosen_.settings};
    order.plane = plane_of(plane_, on_plane_, order.settings.force.workspace, planes_);
    order.recording = recorder_ ? recorder_->number() : 0;
    if (sent_ == order) return;
    sent_ = order;
    servo_->link->orders().publish(order);
}

void Touch::choose(const TouchSettings& settings)
{
    const GuideSettings& guide = settings.guide;
    const std::shared_ptr<const VolumeSource> source = guide.assists ? settings.source : nullptr;
    const bool has_new_voxels = annotation_ != settings.voxels || chosen_.source != source;
    const bool needs_mask = guide.limits.need_mask() && settings.mask;
    chosen_.settings += chosen_.threshold != guide.threshold;
    chosen_.voxels += has_new_voxels || chosen_.limits.unpainted != guide.limits.unpainted;
    chosen_.threshold = guide.threshold;
    chosen_.radius = guide.probe_radius;
    // Copies share their bricks.
    if (has_new_voxels) {
        const bool has_offsets = settings.offsets && settings.offsets->voxels() > 0;
        chosen_.offsets = has_offsets ? std::make_shared<const DensityField>(*settings.offsets) : nullptr;
    }
    if (!needs_mask)
        chosen_.mask = nullptr;
    else if (has_new_voxels || !chosen_.mask)
        chosen_.mask = std::make_shared<const Mask>(*settings.mask);
    chosen_.limits = guide.limits;
    chosen_.source = source;
    annotation_ = settings.voxels;
    mirror_->choose(chosen_);
}

void Touch::ask()
{
    if (asked_ && relevance_.is_asking()) {
        std::optional<RelevanceBits> bits = relevance_.take();
        if (!bits) return;
        relevance_gpu_ms_ = bits->gpu_ms;
        constexpr size_t KEPT = 10'000;  // of a day's many
        if (mirror_ms_.size() == 2 * KEPT) mirror_ms_.erase(mirror_ms_.begin(), mirror_ms_.begin() + KEPT);
        mirror_ms_.push_back(double(now_ns() - bits->asked_ns) * 1e-6);
        mirror_->offer(*asked_, std::move(*bits));
        asked_.reset();
        return;
    }
    const std::optional<RelevanceMirror::Wanted> wanted = mirror_->wanted();
    if (!wanted) return;
    asked_ = wanted;
    try {
        relevance_.ask(wanted->place.box, wanted->threshold, now_ns());
    } catch (const DeviceLost&) {
        throw;
    } catch (const Error&) {  // the device lacks memory for this cube of voxels
        mirror_->decline(*wanted);
    }
}

double Touch::relevance_age_ms() const
{
    return servo_ && state_.relevance_time_ns > 0 ? double(now_ns() - state_.relevance_time_ns) * 1e-6 : 0.0;
}

/// Moves the probe to the servo's position, unless they differ by rounding only. A guided probe at rest may oscillate
/// in the last bits for ever; if the probe followed, pictures and previews would restart each time and never finish.
void Touch::follow_servo(const glm::dvec3& point)
{
    constexpr double REST_VOXELS = 1e-6;
    if (glm::distance(point, probe_) > REST_VOXELS * finest_spacing()) probe_ = point;
}

void Touch::receive()
{
    if (servo_->servo.state().take()) {
        state_ = servo_->servo.state().value();
        awaits_relevance_ = awaits_relevance_ && state_.relevance_time_ns == 0;
        if (state_.ticks > 0) follow_servo(state_.step.probe);
    }
    if (servo_->link->state().take()) tap_ = servo_->link->state().value();
    if (recorder_) recorder_->advance(*servo_->link);
}

void Touch::advance(const TouchSettings& settings)
{
    const bool assists = settings.guide.assists;
    hold_to_plane(settings);
    if (is_mouse()) {
        if ((assists || recorder_) && !servo_) start_mouse();
        if (!assists && !recorder_ && servo_) stop_mouse();
    }
    if (puck_ && puck_->servo.state().take()) puck_state_ = puck_->servo.state().value();
    resets_ += assists && !was_assisting_;  // users clear a fault by switching assistance on again
    was_assisting_ = assists;
    if (!servo_) return;
    choose(settings);
    send_settings(settings);
    if (assists) ask();
    receive();
}

// ---- Recording

void Touch::begin_recording(const std::filesystem::path& path)
{
    recorder_ = std::make_unique<StylusRecorder>(path, renderer_.volume().info().unit, ++recordings_);
    awaits_relevance_ = true;
    drop_queries();
    if (is_mouse())
        start_mouse();
    else
        start(device_);
}

Trace Touch::end_recording()
{
    const std::unique_ptr<StylusRecorder> recorder = std::exchange(recorder_, nullptr);
    awaits_relevance_ = false;
    if (servo_) {
        recorder->advance(*servo_->link);
        servo_->link->relevance_log().end();
    }
    return recorder->take();
}

}  // namespace shvr::ui
