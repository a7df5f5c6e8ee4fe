#pragma once
// Computes how far rays may leap within bricks (shaders/brick_leap.comp), with one workgroup per brick. Runs for
// arriving bricks, and for all bricks on the device when the transfer function or the groups change.

#include <array>
#include <span>
#include <vector>

#include "engine/passes/volume_binding.h"
#include "shaders/pages.h"

namespace shvr {

/// Which codes and groups are visible.
struct Visibility {
    gpu::BrickLeapParams params{};
    std::vector<uint32_t> visible_intervals;  ///< engine/look/transfer_function.h
    std::array<uint32_t, 8> visible_groups{};
    /// Whether a range of codes contains visible codes, as in kernels (shaders/library/occupancy.glsl).
    bool shows(double lower_code, double upper_code) const;
};
bool operator==(const Visibility& a, const Visibility& b);

void brick_leap(FrameGraph& graph, VolumeBinding& volume, const Visibility& visibility,
                const std::optional<MaskBinding>& mask, std::span<const gpu::BrickLeapJob> jobs);

}  // namespace shvr
