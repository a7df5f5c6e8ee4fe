#pragma once
// Sends data to Tracy (https://github.com/wolfpld/tracy), a profiler that watches a program while it runs: host spans,
// device passes, window frames. Compiled only in builds with -DSHVR_TRACY=FOLDER, where FOLDER holds Tracy's sources.
// Other builds contain no call, no branch and no byte of it (tests/cli/instruments/test_live_trace.py).

#include <cstdint>
#include <span>
#include <string_view>

namespace shvr::gpu {

#ifdef SHVR_TRACY
inline constexpr bool IS_TRACED = true;
#else
inline constexpr bool IS_TRACED = false;
#endif

/// A host span, from its construction to the end of the block. Any thread.
class TraceSpan {
public:
#ifdef SHVR_TRACY
    explicit TraceSpan(std::string_view name);
    ~TraceSpan();
    TraceSpan(const TraceSpan&) = delete;
    TraceSpan& operator=(const TraceSpan&) = delete;

private:
    uint32_t id_ = 0;
    int32_t is_active_ = 0;
#else
    explicit constexpr TraceSpan(std::string_view) {}
#endif
};

/// A device pass. Its times are in ticks of the device's clock.
struct TracedPass {
    std::string_view name;
    uint64_t begin = 0, end = 0;
};
/// How a device's ticks are read.
struct DeviceClock {
    uint64_t device = 0;  ///< distinguishes devices
    double nanoseconds_per_tick = 1.0;
    uint64_t mask = ~uint64_t{0};  ///< the valid bits
};

#ifdef SHVR_TRACY
/// Sends a finished frame's passes in order of execution. The clocks of host and device are not calibrated: a device's
/// first frame is shown as if it ended when the host noticed its end, and later frames are placed by the device's
/// ticks. Used by one thread only.
void trace_passes(const DeviceClock& clock, std::span<const TracedPass> passes);
/// Tells Tracy that the window shows its next frame.
void trace_frame();
#else
inline void trace_passes(const DeviceClock&, std::span<const TracedPass>) {}
constexpr void trace_frame() {}
#endif

}  // namespace shvr::gpu
