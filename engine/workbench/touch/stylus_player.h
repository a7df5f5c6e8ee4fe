#pragma once
// Replays a recorded stylus with the present guidance, in the servo's own code, without a device or a clock: the same
// recording, volume and settings give the same path, bit for bit. One thread. Reads the volume's file.

#include <vector>

#include "engine/annotation/work/work.h"
#include "engine/live/felt_limits.h"
#include "engine/session/session.h"
#include "haptics/replay/replay.h"

namespace shvr::ui {

/// Guidance settings as the servo receives them.
struct GuideSettings {
    bool assists = false;
    ProxyLaw law = ProxyLaw::potential;
    TouchMode mode = TouchMode::proximity;
    double threshold = 0.0;     ///< intensity
    double probe_radius = 1.0;  ///< physical units
    FeelSettings feel;
    FeltLimits limits;  ///< which of the voxels at or above the threshold can be felt
};
GuideSettings guide_settings(const Session& session, double probe_radius, FeltLimits limits);

struct StylusPoint {
    glm::dvec3 probe{0.0}, middle{0.0};  ///< in physical units; they differ only in contact, and only with `at_proxy`
    bool in_contact = false;
    double relevant_share = 0.0;
    bool is_pressed = false;  ///< state of the first button
};
/// Returns the probe's path. `by_hand`: the recording pulls a simulated hand and stylus; if false, the probe follows
/// the recording. `source` must include offsets. For recordings of older versions, hidden voxels are felt, too.
std::vector<StylusPoint> play_stylus(const Trace& trace, const GuideSettings& guide, bool by_hand,
                                     std::shared_ptr<const VolumeSource> source, const Mask& mask);

}  // namespace shvr::ui
