#pragma once
// Replays a trace through the servo's own `step()`, without a clock: the same trace and relevance give the same forces,
// bit for bit. A trace that contains the relevance reproduces the forces of its session. One thread.

#include <functional>

#include "haptics/replay/late_relevance.h"
#include "haptics/replay/modelled_touch.h"
#include "haptics/replay/trace.h"

namespace shvr {

/// One tick of a replay, as passed to `ReplayOptions::note_tick`.
struct ReplayedTick {
    uint64_t now_ns = 0;  ///< the servo's clock
    ReadResult read = ReadResult::fresh;
    DeviceState device;
    ForceStep step;
    double energy_j = 0.0;  ///< as ReplayResult::energy_j, up to this tick
};

struct ReplayOptions {
    std::optional<TouchMode> mode;  ///< replaces the trace's
    std::optional<ProxyLaw> law;
    std::optional<double> stiffness, damping;
    std::optional<double> probe_radius;  ///< physical units; recorded relevance may not cover a larger ball
    std::optional<double> surface_share, strength;
    /// Device model that a modelled hand leads along the trace's path; null: the device answers as in the trace.
    std::optional<TouchModel> touch;
    bool relevance_anew = false;  ///< recomputes relevance even if the trace contains it
    /// Recomputed relevance is requested as in the window (engine/touch/region_wish.h) and felt after this delay.
    double relevance_latency_s = WINDOW_LATENCY_S;
    uint32_t relevance_every = 0;  ///< ticks between updates of relevance, each felt without delay; 0: as in the window
    std::function<void(const ReplayedTick& tick)> note_tick{};  ///< called after each tick, in order
};

struct ReplayResult {
    uint64_t ticks = 0;
    uint64_t late = 0;  ///< ticks whose `now` was more than one period late
    double largest_force_n = 0.0;
    double largest_step_n = 0.0;  ///< between ticks
    double energy_j = 0.0;        ///< work of the forces along the hand's path; positive if the forces drove the hand
    double proxy_rms = 0.0;       ///< RMS distance between probe and proxy in contact, physical units
    uint64_t contact_ticks = 0, patches = 0;
    uint64_t assisted_ticks = 0;        ///< in which the settings had assistance on; without it, forces are 0
    uint32_t objects = 0, swaps = 0;    ///< number of objects touched on the last device; number of device changes
    bool is_recorded = false;           ///< relevance came from the trace; false: it was recomputed
    uint64_t hash = 0;                  ///< FNV-1a of all forces' bits
    uint64_t told = 0, told_equal = 0;  ///< ticks with a recorded force; ticks replayed to equal bits
    std::vector<uint64_t> tick_ns;      ///< time that each step() took on the real clock
    std::vector<ForceStep> steps;       ///< if requested
};
/// Returns whether the trace's relevance is used. It is not used with a modelled hand, whose path leaves its region.
bool replays_relevance(const Trace& trace, const ReplayOptions& options);
/// If the trace's relevance is not used, calls `make_relevance` for new relevance, also when the threshold changes.
/// Fails if that function is needed but empty.
ReplayResult replay_trace(const Trace& trace, const ReplayOptions& options, const MakeRelevance& make_relevance,
                          bool keep_steps = false);

}  // namespace shvr
