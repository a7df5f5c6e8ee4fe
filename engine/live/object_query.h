#pragma once
// Grows the touched object on the device: in a cube of any level, the set bits connected through faces to the seeds.
// Seeds are the bits of the previous object inside this cube. The result equals the object that the servo grows in its
// tick (haptics/growth.h). The device needs the same few passes for objects of any shape; the servo spreads noisy cubes
// over several ticks.
//
// Each instance has at most one query in flight. Used only by the renderer's thread.

#include <span>
#include <vector>

#include "engine/live/relevance.h"

namespace shvr {

class ObjectQuery {
public:
    /// One object to grow. The boxes of mask and seeds are in voxels of the same level.
    struct Growth {
        const RelevanceBits& mask;
        const RelevanceBits& seeds;  ///< box may differ from the mask's; seeds outside the mask's box are ignored
    };
    explicit ObjectQuery(Renderer& renderer) : renderer_(renderer) {}
    /// Submits growths (at least one); drops an earlier query. Fails if the levels of a mask and its seeds differ.
    void ask(std::span<const Growth> growths);
    bool is_asking() const { return bool(frame_); }
    /// Whether `answer` would return without waiting.
    bool is_answered() const { return frame_ && frame_.done(); }
    /// Waits if necessary. Returns the objects in order, each with the box of its mask.
    std::vector<RelevanceBits> answer();

private:
    Renderer& renderer_;
    std::vector<RelevanceBits> places_;  ///< the masks' boxes and levels, without words
    gpu::Submission frame_;
};

}  // namespace shvr
