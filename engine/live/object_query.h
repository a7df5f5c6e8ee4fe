#pragma once
// Grows the touched object on the device: among the bits in a cube, of any level, those joined through faces to the
// seeds, which are the bits of the previous object that lie in the same cube. The result equals what the servo grows in
// its tick (haptics/growth.h); the device needs the same few passes however convoluted an object is, whereas the servo
// spreads noisy cubes over several ticks.
//
// One query in flight per object. One thread, the renderer's.

#include <span>
#include <vector>

#include "engine/live/relevance.h"

namespace shvr {

class ObjectQuery {
public:
    /// Boxes are in voxels of one level.
    struct Growth {
        const RelevanceBits& mask;
        const RelevanceBits& seeds;  ///< may have another box than the mask; seeds outside the mask's box are ignored
    };
    explicit ObjectQuery(Renderer& renderer) : renderer_(renderer) {}
    /// Submits at least one growth. Drops an earlier query. Fails if seeds and mask are of different levels.
    void ask(std::span<const Growth> growths);
    bool is_asking() const { return bool(frame_); }
    /// Whether `answer` would return without waiting.
    bool is_answered() const { return frame_ && frame_.done(); }
    /// The objects, in order, with the boxes of their masks. Waits if necessary.
    std::vector<RelevanceBits> answer();

private:
    Renderer& renderer_;
    std::vector<RelevanceBits> places_;  ///< boxes and levels without words
    gpu::Submission frame_;
};

}  // namespace shvr
