#pragma once
// Grows the touched object on the device: in a cube of any level, the set bits that are joined through faces to the
// seeds. Seeds are the bits of the previous object inside the same cube. The result equals the object that the servo
// grows in its tick (haptics/growth.h). The device needs the same few passes however convoluted an object is; the servo
// spreads noisy cubes over several ticks.
//
// One query in flight per object. One thread, the renderer's.

#include <span>
#include <vector>

#include "engine/live/relevance.h"

namespace shvr {

class ObjectQuery {
public:
    /// One object to grow. The boxes of mask and seeds are in voxels of one level.
    struct Growth {
        const RelevanceBits& mask;
        const RelevanceBits& seeds;  ///< may have another box than the mask; seeds outside the mask's box are ignored
    };
    explicit ObjectQuery(Renderer& renderer) : renderer_(renderer) {}
    /// Submits growths, at least one. Drops an earlier query. Fails if a mask and its seeds are of different levels.
    void ask(std::span<const Growth> growths);
    bool is_asking() const { return bool(frame_); }
    /// Whether `answer` would return without waiting.
    bool is_answered() const { return frame_ && frame_.done(); }
    /// Returns the objects, in order, each with the box of its mask. Waits if necessary.
    std::vector<RelevanceBits> answer();

private:
    Renderer& renderer_;
    std::vector<RelevanceBits> places_;  ///< the masks' boxes and levels, without words
    gpu::Submission frame_;
};

}  // namespace shvr
