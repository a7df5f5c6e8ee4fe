#pragma once
// Runs frame graphs: looks up kernels and objects by name, records barriers, dispatches and copies, and returns
// read-backs, times and work counters.
//
//     gpu::Submission frame = executor.submit(std::move(graph));      // returns at once
//     if (frame.done()) use(frame.finish());                          // or finish(), which waits
//
// Frames run on the device in submission order, and each frame knows which accesses earlier frames left in flight. A
// frame is one queue submission unless the past costs of its passes predict a long run (pass_costs.h). Then it is split
// into several submissions, between the tiles of passes and the parts of copies. Callers that must let other work run
// in between submit several small frames and keep few of them in flight. Used by one thread at a time.

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "engine/gpu/frame_objects.h"
#include "engine/gpu/kernel.h"
#include "engine/gpu/memory.h"
#include "engine/gpu/pass_costs.h"

namespace shvr::gpu {

/// Number of work counters per pass (shaders/counters.h names the counters). Kernels increment them.
inline constexpr size_t COUNTERS = 16;
/// Number of counter rows (a power of two) of a pass that counts the work of every thread. Kernels spread their groups
/// over the rows to reduce contention; the report holds the sums of all rows.
inline constexpr size_t COUNTER_ROWS = 64;

struct PassReport {
    std::string name;
    std::string kernel;     ///< empty for copies and fills
    double start_ms = 0.0;  ///< from the start of the frame's first pass to the start of this pass
    double gpu_ms = 0.0;    ///< device time; 0 if the device has no timestamps (see `timed`)
    bool timed = false;
    std::chrono::steady_clock::time_point recorded{};  ///< when the host began to record the pass
    double record_ms = 0.0;                            ///< host time to bind and record the pass
    uint32_t dispatches = 0;
    uint32_t tiles = 0;              ///< number of dispatches that the pass declares; slow devices split the pass into
                                     ///< more
    uint32_t submissions = 0;        ///< number of submissions that contain parts of the pass
    uint64_t bytes = 0;              ///< total size of the bound resources: an upper bound of the bytes
                                     ///< that the pass accesses
    std::string barrier;             ///< such as "compute -> transfer"; empty if there is no barrier
    std::vector<uint64_t> counters;  ///< empty if the kernel has no counters
    uint32_t counted_rows = 0;       ///< number of counter rows that have non-zero counts
    /// Number of threads that ran, as counted by the device. Null if not requested or not supported, or if the pass is
    /// split into too many submissions.
    std::optional<uint64_t> invocations;
};

struct FrameResult {
    std::vector<std::vector<std::byte>> read_backs;  ///< by index, as returned by FrameGraph::read_back
    std::vector<PassReport> passes;                  ///< in order of execution
    double gpu_ms = 0.0;                             ///< first pass's start to last pass's end; 0: not measured
    double wall_ms = 0.0;                            ///< first submission to completion, on the host's clock
};

class Executor;

/// A frame in flight. Move-only. The destructor waits for the frame. Must not outlive the executor.
class Submission {
public:
    Submission();
    ~Submission();
    Submission(Submission&&) noexcept;
    Submission& operator=(Submission&&) noexcept;

    explicit operator bool() const { return frame_ != nullptr; }
    /// Returns whether the device has finished the frame; never waits.
    bool done() const;
    void wait() const;
    /// Waits for the frame if necessary, and returns its result; this object is then empty.
    FrameResult finish();
    const FrameGraph& graph() const;

private:
    friend class Executor;
    struct Frame;
    explicit Submission(std::unique_ptr<Frame> frame);
    std::unique_ptr<Frame> frame_;
};

class Executor {
public:
    struct Options {
        bool timestamps = true;
        bool statistics = false;  ///< whether invocations are counted
        bool serialize = false;   ///< adds a full barrier between passes, so each measured time covers one pass
    };

    Executor(Device& device, Memory& memory);
    ~Executor();
    Executor(const Executor&) = delete;
    Executor& operator=(const Executor&) = delete;

    /// Compiles, records and submits the graph. The recorded states of imported objects are then those in which the
    /// frame will leave the objects. On failure the frame is discarded, and the graph's rollbacks run when the graph is
    /// destroyed (FrameGraph::unless_submitted).
    Submission submit(FrameGraph graph, const Options& options);
    Submission submit(FrameGraph graph) { return submit(std::move(graph), Options{}); }
    /// Submits and waits.
    FrameResult run(FrameGraph graph, const Options& options) { return submit(std::move(graph), options).finish(); }
    FrameResult run(FrameGraph graph) { return run(std::move(graph), Options{}); }

    /// Number of kernels that graphs expect (FrameGraph::expect) but that are not compiled yet.
    size_t expected_kernels() const { return kernels_.expected(); }

    /// Frees transient resources that the last `runs` frames did not use.
    void trim(uint64_t runs = 0);

private:
    friend struct Submission::Frame;
    struct Transient {
        ResourceDesc desc;
        Placement placement;
        uint64_t last_run = 0;
        bool taken = false;
        bool is_counted_in = false;  ///< kernels add to counters in this resource
        Storage storage;
    };
    /// Returns a free or new transient resource. Host-visible storage may be larger than `wanted`.
    Storage& take_transient(const std::string& name, const ResourceDesc& wanted, Placement placement,
                            bool is_counted_in = false);

    Device& device_;
    Memory& memory_;
    Kernels kernels_;
    VkSampler sampler_ = VK_NULL_HANDLE;
    uint64_t runs_ = 0;
    PassCosts costs_;
    std::vector<std::unique_ptr<FrameObjects>> idle_objects_;  ///< ready for reuse by later frames
    std::vector<std::unique_ptr<Transient>> transients_;
};

}  // namespace shvr::gpu
