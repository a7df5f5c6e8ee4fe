#pragma once
// Keeps the voxels that can be felt around the probe up to date, on a thread of its own, so that forces do not fade
// when the main thread hangs. The engine does not depend on the servo; `Ends` connect this class to a servo.
//
//   main thread: choose() ----------+                       +-> Ends::publish
//   device (a frame or so later):   +-> bits of one cube ---+   each iteration, with the time up to which the bits
//     wanted() -> Relevance -> offer()   or the host's own      are known to be true
//
// Bits stay valid until the user changes the threshold or voxels, so the thread renews their time stamp in each
// iteration. Limits of what can be felt (felt_limits.h) are applied to a copy of the bits, again whenever the limits
// change, so moving a cut needs no new answer. Limits by intensity need bits made by the host. wanted() names a new
// cube for the device's compute pass if something changed, or if the ball is near the cube's border or will cross it
// before an answer arrives (region_wish.h). The latency is measured. The thread reads the voxels itself, which gives
// the same bits (relevance_host.h), if no answer came within DEVICE_NS (four times that while the held bits
// suffice), if the cube is of a coarser level, or if the device declined.
//
// Any thread may call choose(), wanted(), offer(), decline() and trouble(). Only this object's thread calls `Ends`.

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "engine/annotation/density.h"
#include "engine/live/relevance_host.h"

namespace shvr {

/// The user's choice of what can be felt. The shared objects must not change any more.
struct RelevanceChoice {
    std::shared_ptr<const VolumeSource> source;     ///< without offsets; null: nothing is mirrored
    std::shared_ptr<const DensityField> offsets{};  ///< null: none
    std::shared_ptr<const Mask> mask{};             ///< needed only if `limits` depend on it
    FeltLimits limits{};                            ///< which voxels at or above the threshold can be felt
    double threshold = 0.0;                         ///< intensity
    double radius = 1.0;                            ///< radius of the ball, in physical units
    uint32_t settings = 0;                          ///< counts changes of the threshold
    uint64_t voxels = 0;                            ///< counts changes of offsets, the mask and `limits.unpainted`
    bool has_device = true;                         ///< whether another thread polls wanted() and offers answers
};

struct ProbeMotion {
    glm::dvec3 point{0.0};     ///< physical
    glm::dvec3 velocity{0.0};  ///< physical units per second
};

/// A mirrored cube, as published.
struct MirroredRelevance {
    RelevancePlace place;
    RelevanceBits bits;
    uint64_t sequence = 0;  ///< number of the published bits, from 1; unchanged if only `true_at_ns` changes
    uint64_t true_at_ns = 0;
    uint32_t settings = 0;
    uint64_t voxels = 0;
    uint32_t limits = 0;  ///< counts changes of the limits that decide what can be felt
    double threshold = 0.0;
    bool is_from_host = false;
};

class RelevanceMirror {
public:
    static constexpr uint64_t TURN_NS = 8'000'000;
    static constexpr uint64_t DEVICE_NS = 25'000'000;      ///< how long the thread waits for the device
    static constexpr double MAX_LATENCY_S = 0.1;           ///< after this time the force has faded out
    static constexpr uint64_t TROUBLE_NS = 1'000'000'000;  ///< pause before the thread retries a failed read of
                                                           ///< voxels

    struct Ends {
        std::function<std::optional<ProbeMotion>()> probe;  ///< null: not known yet
        std::function<void(const MirroredRelevance&)> publish;
        std::function<uint64_t()> now_ns;               ///< a steady clock
        std::function<void(uint64_t until_ns)> wait{};  ///< for tests; may return early
    };
    explicit RelevanceMirror(Ends ends);
    /// Stops the thread and waits until it has ended; a read of voxels in progress is completed first.
    ~RelevanceMirror();
    RelevanceMirror(const RelevanceMirror&) = delete;
    RelevanceMirror& operator=(const RelevanceMirror&) = delete;

    void choose(RelevanceChoice choice);
    /// The cube for which the device should be queried now.
    struct Wanted {
        RelevancePlace place;
        double threshold = 0.0;
        uint32_t settings = 0;
        uint64_t voxels = 0;
        bool operator==(const Wanted&) const = default;
    };
    std::optional<Wanted> wanted() const;
    /// Delivers the device's bits for the cube that wanted() named.
    void offer(const Wanted& wanted, RelevanceBits bits);
    /// Reports that the device cannot answer, so the host computes the bits without waiting for the device.
    void decline(const Wanted& wanted);
    /// Returns, as a sentence, why the last attempt to read voxels failed; empty if it succeeded.
    std::string trouble() const;
    /// Number of cubes that the host has computed so far.
    uint64_t made_on_host() const;

private:
    struct Offered {
        Wanted wanted;
        RelevanceBits bits;
    };
    void run();
    void turn(uint64_t now_ns);
    void take_offer();
    bool is_of(const Wanted& wanted) const;
    void measure_latency();
    void hold(const Wanted& wanted, RelevanceBits bits, bool is_from_host);
    void limit();
    void make_on_host(const Wanted& wanted, uint64_t now_ns);
    void set_wanted(const std::optional<Wanted>& wanted);
    std::shared_ptr<const VolumeSource> source_with_offsets();
    void sleep_until(uint64_t until_ns);

    Ends ends_;

    mutable std::mutex mutex_;  ///< protects the following members; never held for long
    std::condition_variable woken_;
    bool ends_now_ = false, is_woken_ = false;
    std::shared_ptr<const RelevanceChoice> choice_;
    std::optional<Wanted> wanted_, declined_;
    std::optional<Offered> offered_;
    std::string trouble_;
    uint64_t made_on_host_ = 0;

    // Owned by the thread
    std::shared_ptr<const RelevanceChoice> now_;
    MirroredRelevance held_;
    RelevanceBits unlimited_;            ///< the bits of `held_` without limits; empty if there are none
    FeltLimits limits_;                  ///< the limits that were applied to `held_`
    std::optional<Wanted> waiting_for_;  ///< requested from the device
    uint64_t waiting_since_ns_ = 0, failed_ns_ = 0;
    double latency_s_ = WINDOW_LATENCY_S;  ///< smoothed time from requesting a cube until its bits arrive
    std::shared_ptr<const VolumeSource> with_offsets_;
    std::shared_ptr<const DensityField> offsets_of_it_;

    std::thread thread_;  ///< last, because it uses all other members
};

}  // namespace shvr
