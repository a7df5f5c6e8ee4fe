#pragma once
// Pre-integrated classification (Roettger, Kraus and Ertl 2000; Engel, Kraus and Ertl 2001): colour and opacity of a
// whole step, along which the density changes linearly from one value to another, so that no feature in between is
// missed, however narrow. Extinction between control points is integrated in closed form. The colour of a step is
// composited from at most 16 parts, so that light from its front is not dimmed by its back. All in double.

#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "engine/look/transfer_function.h"

namespace shvr {

/// Entry [back * entries + front] is for a step from sample `front` to sample `back`, `step_voxels` reference lengths
/// long: linear RGB times opacity, opacity, and optical depth. Ignores densities at which rays end (opaque_intervals);
/// otherwise, steps that only come near such a density would be opaque. Takes about 20 ms for 256 samples on one core.
BakedTable preintegrated_table(const TransferFunction& function, double step_voxels, const Samples& samples);

/// Like `visible_intervals` of transfer_function.h, for a pre-integrated table: an interval counts if a step between
/// its ends is visible, or if it contains an opaque density.
std::vector<uint32_t> visible_intervals_of_steps(std::span<const glm::vec4> table, const Samples& samples,
                                                 std::span<const OpaqueInterval> opaque);

}  // namespace shvr
