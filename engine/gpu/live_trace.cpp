#include "engine/gpu/live_trace.h"

#ifdef SHVR_TRACY

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>

#include <tracy/TracyC.h>

namespace shvr::gpu {

namespace {

constexpr uint8_t CONTEXT = 0, VULKAN = 2;  // numbers of device kinds in TracyQueue.hpp

/// Allocates Tracy's source location for a name; Tracy copies the name.
uint64_t place_of(std::string_view name)
{
    constexpr std::string_view FILE = "engine", FUNCTION = "shvr";
    return ___tracy_alloc_srcloc_name(0, FILE.data(), FILE.size(), FUNCTION.data(), FUNCTION.size(), name.data(),
                                      name.size(), 0);
}

int64_t host_nanoseconds()
{
    return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

/// Converts a device's ticks to monotonic nanoseconds. A tick may have fewer valid bits than 64, and wrap around.
struct Timeline {
    bool has_begun = false;
    uint64_t device = 0, last_tick = 0;
    int64_t last_ns = 0;

    int64_t at(const DeviceClock& clock, uint64_t tick) const
    {
        const uint64_t ahead = (tick - last_tick) & clock.mask;
        // A tick that seems to be more than half the range ahead is actually slightly behind.
        const bool is_behind = ahead > clock.mask / 2;
        const double ticks = is_behind ? -double((last_tick - tick) & clock.mask) : double(ahead);
        return last_ns + std::llround(ticks * clock.nanoseconds_per_tick);
    }
};

void tell_pass(const TracedPass& pass, int64_t begin, int64_t end)
{
    static uint16_t query = 0;  // wraps around; Tracy allows reuse, since it only tracks queries in flight
    const uint16_t first = query++, second = query++;
    ___tracy_emit_gpu_zone_begin_alloc({place_of(pass.name), first, CONTEXT});
    ___tracy_emit_gpu_zone_end({second, CONTEXT});
    ___tracy_emit_gpu_time({begin, first, CONTEXT});
    ___tracy_emit_gpu_time({end, second, CONTEXT});
}

}  // namespace

TraceSpan::TraceSpan(std::string_view name)
{
    const TracyCZoneCtx context = ___tracy_emit_zone_begin_alloc(place_of(name), 1);
    id_ = context.id;
    is_active_ = context.active;
}

TraceSpan::~TraceSpan()
{
    TracyCZoneCtx context{};
    context.id = id_;
    context.active = is_active_;
    ___tracy_emit_zone_end(context);
}

void trace_passes(const DeviceClock& clock, std::span<const TracedPass> passes)
{
    if (passes.empty()) return;
    static Timeline timeline;
    if (!timeline.has_begun) {
        constexpr std::string_view NAME = "Vulkan";
        ___tracy_emit_gpu_new_context({host_nanoseconds(), 1.0f, CONTEXT, 0, VULKAN});
        ___tracy_emit_gpu_context_name({CONTEXT, NAME.data(), uint16_t(NAME.size())});
    }
    if (!timeline.has_begun || timeline.device != clock.device) {
        timeline.last_ns = std::max(timeline.last_ns, host_nanoseconds());
        timeline.last_tick = passes.back().end;
        timeline.has_begun = true;
        timeline.device = clock.device;
    }
    // Reports passes that overlap on the device as consecutive, since spans in one row of Tracy must not overlap.
    int64_t last = timeline.at(clock, passes.front().begin);
    for (const TracedPass& pass : passes) {
        const int64_t begin = std::max(last, timeline.at(clock, pass.begin));
        last = std::max(begin, timeline.at(clock, pass.end));
        if (___tracy_connected() != 0) tell_pass(pass, begin, last);
    }
    timeline.last_ns = timeline.at(clock, passes.back().end);
    timeline.last_tick = passes.back().end;
}

void trace_frame()
{
    ___tracy_emit_frame_mark(nullptr);
}

}  // namespace shvr::gpu

#endif
