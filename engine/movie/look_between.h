#pragma once
// Looks between those of two views of a movie. Pure functions; any thread. `share`: 0 ... 1, the share of the second
// look. At 0 and 1, and where both are equal, results are exactly those of the two views.

#include "engine/session/session.h"

namespace shvr {

/// Functions with equally many points: each point moves linearly in intensity, colour and opacity. Otherwise the two
/// functions mix at the intensities of all points: opacity linearly, colour by the share of each in the opacity.
TransferFunction function_between(const TransferFunction& from, const TransferFunction& to, double share);

/// The planes move linearly; those outside of the volume start at its border.
CutBox cut_between(const CutBox& from, const CutBox& to, double share, const VolumeInfo& volume);

/// Colours and opacities mix linearly, of inherited settings the effective ones; a hidden group counts as transparent.
/// Balls and rods of a group are drawn until it is hidden in both.
Groups groups_between(const Groups& from, const Groups& to, double share);

/// All numbers mix linearly, except the number of rays and the curves of ambient occlusion, which remain those of
/// `from`.
Light light_between(const Light& from, const Light& to, double share);

/// Returns `from` with what movies mix (KeyLook): transfer function, groups, unpainted voxels, light, distance
/// blending, and cut. Size, background, quality, panes, probe, meshes and measurements remain those of `from`.
Session session_between(const Session& from, const Session& to, double share, const VolumeInfo& volume);

}  // namespace shvr
