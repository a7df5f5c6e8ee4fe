#include "ui/workbench/document/touch.h"

#include <algorithm>
#include <ctime>

namespace shvr::ui {

namespace {

/// One voxel under the hand: the scale at which the force law's stiffness was chosen (micro-CT of vascular bundles).
constexpr double VOXEL_M = 0.00025;
/// Width of a haptic device's workspace, mapped to the height of the view.
constexpr double WORKSPACE_M = 0.12;
/// Relevance is requested at this interval, so that it is never older than a few intervals.
constexpr uint64_t ASK_EVERY_NS = 16'000'000;

uint64_t now_ns()
{
    timespec time{};
    clock_gettime(CLOCK_MONOTONIC, &time);  // the servo's clock
    return uint64_t(time.tv_sec) * 1'000'000'000u + uint64_t(time.tv_nsec);
}

}  // namespace

Touch::Touch(Renderer& renderer) : renderer_(renderer), relevance_(renderer) {}

void Touch::use(std::unique_ptr<HapticDevice> device, const std::string& name)
{
    servo_.reset();
    mouse_ = nullptr;
    is_mouse_ = false;
    device_name_ = name;
    servo_ = std::make_unique<Servo>(std::move(device), real_pacing(), Servo::Options{});
}

Workspace Touch::mouse_workspace() const
{
    const VolumeInfo& info = renderer_.volume().info();
    const double finest = std::min({info.spacing.x, info.spacing.y, info.spacing.z});
    return {.to_volume = glm::dmat3(finest / VOXEL_M), .origin = 0.5 * glm::dvec3(info.size) * info.spacing};
}

Workspace Touch::device_workspace(const TouchSettings& settings)
{
    const CameraAxes& axes = settings.axes;
    return {.to_volume =
                glm::dmat3(axes.right, axes.up, -axes.forward) * (settings.scale * settings.view_height / WORKSPACE_M),
            .origin = settings.target};
}

void Touch::place(const glm::dvec3& point)
{
    wish_ = probe_ = point;
    send_wish(true);
}

void Touch::wish(const glm::dvec3& point)
{
    if (!is_mouse_) return;  // the device's hand is elsewhere
    wish_ = point;
    if (servo_)
        send_wish(false);
    else
        probe_ = point;
}

void Touch::send_wish(bool jump)
{
    if (!mouse_) return;
    jumps_ += jump;
    const Workspace space = mouse_workspace();
    mouse_->wish().publish({.position_m = (wish_ - space.origin) / space.scale(), .buttons = 0, .jump = jumps_});
}

void Touch::start_mouse()
{
    auto device = std::make_unique<SimulatedDevice>();
    mouse_ = device.get();
    state_ = {};
    published_ns_ = 0;
    wish_ = probe_;
    send_wish(true);
    servo_ = std::make_unique<Servo>(std::move(device), real_pacing(), Servo::Options{});
}

void Touch::send_settings(const TouchSettings& settings)
{
    servo_->settings().publish({.assistance = settings.assistance,
                                .law = settings.law,
                                .probe_radius = settings.probe_radius,
                                .workspace = is_mouse_ ? mouse_workspace() : device_workspace(settings),
                                .reset = resets_});
}

void Touch::ask(const TouchSettings& settings)
{
    const uint64_t now = now_ns();
    if (relevance_.is_asking() || now - asked_ns_ < ASK_EVERY_NS) return;
    asked_ns_ = now;
    relevance_.ask(probe_ / renderer_.volume().info().spacing, settings.threshold, now);
}

void Touch::mirror()
{
    const std::optional<RelevanceBits> bits = relevance_.take();
    if (!bits) return;
    const VolumeInfo& info = renderer_.volume().info();
    RelevancePatch& patch = servo_->relevance().writing();
    patch.sequence = ++patches_;
    patch.time_ns = bits->asked_ns;
    patch.origin = glm::ivec3(bits->box.lower);
    patch.size = glm::ivec3(bits->box.size());
    patch.words_per_row = int32_t(bits->words_per_row);
    patch.spacing = info.spacing;
    patch.volume_size = glm::ivec3(info.size);
    std::ranges::copy(bits->words, patch.words.begin());
    servo_->relevance().publish();
    published_ns_ = bits->asked_ns;
    relevance_gpu_ms_ = bits->gpu_ms;
    mirror_ms_.push_back(double(now_ns() - bits->asked_ns) * 1e-6);
}

double Touch::relevance_age_ms() const
{
    return servo_ && published_ns_ > 0 ? double(now_ns() - published_ns_) * 1e-6 : 0.0;
}

void Touch::advance(const TouchSettings& settings)
{
    if (settings.assistance && !servo_) start_mouse();
    if (is_mouse_ && !settings.assistance && servo_) {
        servo_.reset();
        mouse_ = nullptr;
        wish_ = probe_;  // it stays where assistance left it
    }
    resets_ += settings.assistance && !was_assisting_;  // users clear a fault by switching assistance on again
    was_assisting_ = settings.assistance;
    if (!servo_) return;
    send_settings(settings);
    mirror();
    if (settings.assistance) ask(settings);
    if (servo_->state().take()) {
        state_ = servo_->state().value();
        if (state_.ticks > 0) probe_ = state_.step.probe;
    }
}

}  // namespace shvr::ui
