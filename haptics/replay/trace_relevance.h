#pragma once
// The relevance that a servo had, as stored in a trace: its position, and its bits as runs of differences from the
// previous relevance, which shares most bits as a hand moves. Decoding restores all words, bit for bit.
//
// Runs are alternating lengths of equal and different bits, beginning with equal ones, along all words of a patch. Bits
// are compared with those of the same voxels in the previous patch, or with 0 outside it and after a change of level. A
// length is written five bits at a time, lowest first, each as a character of A-Z, a-z, 0-9, '-' and '_'; 32 is added
// to all characters but the last.
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
    uint32_t limits = 0;
    std::string runs;
};

/// `before`: the patch encoded last; its sequence is 0 if there is none.
TraceRelevance note_relevance(const RelevancePatch& patch, const RelevancePatch& before);
/// Decodes all of `patch` except its time. Returns false, with `patch` unusable, if position or runs are inconsistent.
bool read_relevance(const TraceRelevance& noted, const RelevancePatch& before, RelevancePatch& patch);

}  // namespace shvr
