#pragma once
// Grows the connected object of touch on the device: of the bits in a cube, of any level, those joined through faces to
// the seeds, which are the bits of the object before that lie in the same cube. The bits are those that the servo grows
// in its tick (haptics/growth.h); the device takes the same few passes however winding an object is, where the servo
// spreads noisy cubes over several ticks.
//
// One query in flight per object. One thread, the renderer's.

#include <span>
#include <vector>

#include "engine/live/relevance.h"

namespace shvr {

class ObjectQuery {
public:
    /// In the voxels of one level.
    struct Growth {
        const RelevanceBits& mask;
        const RelevanceBits& seeds;  ///< need not have the same box; what lies outside the mask's is not used
    };
    explicit ObjectQuery(Renderer& renderer) : renderer_(renderer) {}
    /// At least one. Drops an earlier query. Fails where seeds are of another level than their mask.
    void ask(std::span<const Growth> growths);
    bool is_asking() const { return bool(frame_); }
    /// Whether `answer` would not wait.
    bool is_answered() const { return frame_ && frame_.done(); }
    /// The objects, in order, with the boxes of their masks. Waits if necessary.
    std::vector<RelevanceBits> answer();

private:
    Renderer& renderer_;
    std::vector<RelevanceBits> places_;  ///< without words
    gpu::Submission frame_;
};

}  // namespace shvr
