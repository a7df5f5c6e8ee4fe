#include "ui/workbench/document/touch.h"

#include <algorithm>
#include <ctime>

namespace shvr::ui {

namespace {

/// One voxel under the hand: the scale at which the force law's stiffness was chosen (micro-CT of vascular bundles).
constexpr double VOXEL_M = 0.00025;
/// Width of a haptic device's workspace, mapped to the height of the view.
constexpr double WORKSPACE_M = 0.12;

uint64_t now_ns()
{
    timespec time{};
    clock_gettime(CLOCK_MONOTONIC, &time);  // the servo's clock
    return uint64_t(time.tv_sec) * 1'000'000'000u + uint64_t(time.tv_nsec);
}

void publish(const MirroredRelevance& mirrored, Latest<RelevancePatch>& relevance)
{
    RelevancePatch& patch = relevance.writing();
    patch.sequence = mirrored.sequence;
    patch.time_ns = mirrored.true_at_ns;
    patch.origin = glm::ivec3(mirrored.place.box.lower);
    patch.size = glm::ivec3(mirrored.place.box.size());
    patch.words_per_row = int32_t(mirrored.bits.words_per_row);
    patch.spacing = mirrored.place.spacing;
    patch.volume_size = glm::ivec3(mirrored.place.level_size);
    patch.level = mirrored.place.level;
    patch.settings = mirrored.settings;
    std::ranges::copy(mirrored.bits.words, patch.words.begin());
    relevance.publish();
}

}  // namespace

Touch::Touch(Renderer& renderer) : renderer_(renderer), relevance_(renderer) {}

void Touch::use(std::unique_ptr<HapticDevice> device, const std::string& name)
{
    mouse_ = nullptr;
    is_mouse_ = false;
    device_name_ = name;
    start_servo(std::move(device));
}

void Touch::start_servo(std::unique_ptr<HapticDevice> device)
{
    mirror_.reset();
    servo_.reset();
    servo_ = std::make_unique<Servo>(std::move(device), real_pacing(), Servo::Options{});
    Servo& servo = *servo_;
    mirror_ = std::make_unique<RelevanceMirror>(RelevanceMirror::Ends{
        .probe = [&servo]() -> std::optional<glm::dvec3> {
            servo.place().take();
            const ProbePlace& place = servo.place().value();
            return place.is_known ? std::optional(place.point) : std::nullopt;
        },
        .publish = [&servo](const MirroredRelevance& mirrored) { publish(mirrored, servo.relevance()); },
        .now_ns = now_ns});
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
    wish_ = probe_;
    send_wish(true);
    start_servo(std::move(device));
}

void Touch::send_settings(const TouchSettings& settings)
{
    servo_->settings().publish({.assistance = settings.assistance,
                                .law = settings.law,
                                .probe_radius = settings.probe_radius,
                                .workspace = is_mouse_ ? mouse_workspace() : device_workspace(settings),
                                .reset = resets_,
                                .relevance_settings = chosen_.settings});
}

void Touch::choose(const TouchSettings& settings)
{
    const bool is_same = chosen_.threshold == settings.threshold && chosen_.groups == settings.groups;
    const bool has_new_voxels = chosen_.voxels != settings.voxels || chosen_.source != settings.source;
    chosen_.settings += !is_same;
    chosen_.threshold = settings.threshold;
    chosen_.radius = settings.probe_radius;
    if (has_new_voxels || !is_same) {  // copies share their bricks
        const bool has_offsets = settings.offsets && settings.offsets->voxels() > 0;
        chosen_.offsets = has_offsets ? std::make_shared<const DensityField>(*settings.offsets) : nullptr;
        chosen_.mask = settings.groups && settings.mask ? std::make_shared<const Mask>(*settings.mask) : nullptr;
    }
    chosen_.groups = settings.groups;
    chosen_.source = settings.source;
    chosen_.voxels = settings.voxels;
    mirror_->choose(chosen_);
}

void Touch::ask()
{
    if (asked_ && relevance_.is_asking()) {
        std::optional<RelevanceBits> bits = relevance_.take();
        if (!bits) return;
        relevance_gpu_ms_ = bits->gpu_ms;
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
    } catch (const Error&) {  // no room on the device for such a cube
        mirror_->decline(*wanted);
    }
}

double Touch::relevance_age_ms() const
{
    return servo_ && state_.relevance_time_ns > 0 ? double(now_ns() - state_.relevance_time_ns) * 1e-6 : 0.0;
}

void Touch::advance(const TouchSettings& settings)
{
    if (settings.assistance && !servo_) start_mouse();
    if (is_mouse_ && !settings.assistance && servo_) {
        mirror_.reset();
        servo_.reset();
        mouse_ = nullptr;
        wish_ = probe_;  // it stays where assistance left it
    }
    resets_ += settings.assistance && !was_assisting_;  // users clear a fault by switching assistance on again
    was_assisting_ = settings.assistance;
    if (!servo_) return;
    TouchSettings now = settings;
    if (!settings.assistance) now.source = nullptr;  // nothing is computed
    choose(now);
    send_settings(settings);
    if (settings.assistance) ask();
    if (servo_->state().take()) {
        state_ = servo_->state().value();
        if (state_.ticks > 0) probe_ = state_.step.probe;
    }
}

}  // namespace shvr::ui
