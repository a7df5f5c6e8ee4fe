#pragma once
// Runs a trace through the servo's own `step()`, without a clock: the same trace and relevance give the same forces,
// bit for bit. A trace that holds the relevance gives those of its session. One thread.

#include <functional>

#include "haptics/replay/modelled_touch.h"
#include "haptics/replay/trace.h"

namespace shvr {

struct ReplayOptions {
    std::optional<HapticMode> mode;  ///< instead of the trace's
    std::optional<ProxyLaw> law;
    std::optional<double> stiffness, damping;
    /// A hand draws this device along the trace; without it, the device's answers are those of the trace.
    std::optional<TouchModel> touch;
    bool relevance_anew = false;   ///< also where the trace holds what the servo had
    uint32_t relevance_every = 0;  ///< ticks; 0: when the ball leaves the last one
};

/// Fills `patch` with what is relevant around `point` for a ball of `radius` (physical) at or above `threshold`. The
/// caller keeps place and level as it likes; sequence, time and settings are set afterwards.
using MakeRelevance =
    std::function<void(const glm::dvec3& point, double radius, double threshold, RelevancePatch& patch)>;

struct ReplayResult {
    uint64_t ticks = 0;
    uint64_t late = 0;  ///< whose `now` came more than one period after it was due
    double largest_force_n = 0.0;
    double largest_step_n = 0.0;  ///< between ticks
    double energy_j = 0.0;        ///< work of the forces along the way of the hand: above 0, it was driven
    double proxy_rms = 0.0;       ///< distance of probe and proxy in contact, physical units
    uint64_t contact_ticks = 0, patches = 0;
    uint32_t objects = 0, swaps = 0;    ///< of the last device; devices after the first
    bool is_recorded = false;           ///< what was felt is the trace's; otherwise it was made
    uint64_t hash = 0;                  ///< FNV-1a of all forces' bits
    uint64_t told = 0, told_equal = 0;  ///< ticks whose force the trace holds, and those with the same bits
    std::vector<uint64_t> tick_ns;      ///< time that each step() took on the real clock
    std::vector<ForceStep> steps;       ///< if asked for
};
/// Whether the relevance of the trace is used: a modelled hand goes elsewhere, where none is known.
bool replays_relevance(const Trace& trace, const ReplayOptions& options);
/// `make_relevance` is asked where that of the trace is not used, also when the threshold changes, which takes effect
/// at once; empty: fails there.
ReplayResult replay_trace(const Trace& trace, const ReplayOptions& options, const MakeRelevance& make_relevance,
                          bool keep_steps = false);

}  // namespace shvr
