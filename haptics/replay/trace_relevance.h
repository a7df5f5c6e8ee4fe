#pragma once
// The relevance that a servo had, as a trace holds it: its place, and its bits as runs of what differs from those
// before it, which a hand that moves on mostly shares. Read back, all words are the same, bit for bit.
//
// Runs are lengths of equal and different bits in turn, beginning with equal ones, along all words of a patch. The bits
// that they are compared with are those of the same voxels in the patch before, or 0 outside it and after another
// level. A length is written five bits at a time, the lowest first, each as a character of A-Z, a-z, 0-9, '-' and '_';
// 32 is added to all but the last.
//
// Any thread.

#include <string>

#include "haptics/relevance.h"

namespace shvr {

struct TraceRelevance {
    size_t from_tick = 0;
    uint64_t sequence = 0;
    glm::ivec3 origin{0}, size{0};
    int32_t words_per_row = 0;
    glm::dvec3 spacing{1.0};
    glm::ivec3 volume_size{0};
    int32_t level = 0;
    uint32_t settings = 0;
    std::string runs;
};

/// `before`: the one noted last; its sequence is 0 where there is none.
TraceRelevance note_relevance(const RelevancePatch& patch, const RelevancePatch& before);
/// All of `patch` but its time. False where place or runs do not fit, and `patch` is of no use.
bool read_relevance(const TraceRelevance& noted, const RelevancePatch& before, RelevancePatch& patch);

}  // namespace shvr
