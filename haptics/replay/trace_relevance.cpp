#include "haptics/replay/trace_relevance.h"

#include <algorithm>
#include <bit>
#include <string_view>

namespace shvr {
namespace {

constexpr std::string_view DIGITS = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";
constexpr uint32_t MORE = 32;

/// Returns the bits of `before` at the 32 voxels of the word that starts at `first_voxel`.
uint32_t word_before(const RelevancePatch& before, int32_t level, const glm::ivec3& first_voxel)
{
    if (before.sequence == 0 || before.level != level) return 0;
    const glm::ivec3 at = first_voxel - before.origin;
    if (at.y < 0 || at.z < 0 || at.y >= before.size.y || at.z >= before.size.z) return 0;
    const auto word = [&](int32_t w) {
        return w >= 0 && w < before.words_per_row ? before.row_word(w, at.y, at.z) : 0;
    };
    const int32_t w = at.x >> 5, shift = at.x & 31;  // rounds down, also below 0
    return shift == 0 ? word(w) : word(w) >> shift | word(w + 1) << (32 - shift);
}

/// Calls `each(word, bits of before)` for every word of `patch`, in the order of storage.
template <class Patch, class Each>
void for_words(Patch& patch, const RelevancePatch& before, const Each& each)
{
    size_t i = 0;
    for (int32_t z = 0; z < patch.size.z; ++z)
        for (int32_t y = 0; y < patch.size.y; ++y)
            for (int32_t w = 0; w < patch.words_per_row; ++w, ++i)
                each(patch.words[i], word_before(before, patch.level, patch.origin + glm::ivec3(32 * w, y, z)));
}

void put_length(uint32_t length, std::string& runs)
{
    for (; length >= MORE; length /= MORE) runs += DIGITS[MORE + length % MORE];
    runs += DIGITS[length];
}

/// Parses the next run length. Returns false at the end, on other characters, and if the length has too many digits.
bool take_length(std::string_view& runs, uint32_t& length)
{
    length = 0;
    for (uint32_t shift = 0; shift <= 20 && !runs.empty(); shift += 5) {
        const size_t digit = DIGITS.find(runs.front());
        if (digit == DIGITS.npos) return false;
        runs.remove_prefix(1);
        length |= uint32_t(digit) % MORE << shift;
        if (digit < MORE) return true;
    }
    return false;
}

bool has_place(const RelevancePatch& patch)
{
    // Positions must stay far enough from the limits of int32_t that their sums do not overflow.
    const auto fits = [](int32_t n) { return n >= 0 && n <= (1 << 30); };
    bool is_right = patch.sequence > 0 && patch.is_well_formed() && patch.level >= 0 && patch.level < 31;
    for (int axis = 0; axis < 3; ++axis)
        is_right = is_right && fits(patch.origin[axis]) && fits(patch.volume_size[axis]) && patch.spacing[axis] > 0.0;
    return is_right;
}

}  // namespace

TraceRelevance note_relevance(const RelevancePatch& patch, const RelevancePatch& before)
{
    TraceRelevance noted{.sequence = patch.sequence,
                         .origin = patch.origin,
                         .size = patch.size,
                         .words_per_row = patch.words_per_row,
                         .spacing = patch.spacing,
                         .volume_size = patch.volume_size,
                         .level = patch.level,
                         .settings = patch.settings,
                         .limits = patch.limits,
                         .runs = {}};
    uint32_t length = 0;
    bool differs = false;
    for_words(patch, before, [&](uint32_t word, uint32_t other) {
        uint32_t left = 32;
        for (uint32_t bits = word ^ other; left > 0;) {
            const uint32_t ahead = uint32_t(differs ? std::countr_one(bits) : std::countr_zero(bits));
            const uint32_t run = std::min(left, ahead);
            length += run;
            left -= run;
            if (left == 0) break;
            bits = run == 0 ? bits : bits >> run;
            put_length(length, noted.runs);
            length = 0;
            differs = !differs;
        }
    });
    put_length(length, noted.runs);
    return noted;
}

bool read_relevance(const TraceRelevance& noted, const RelevancePatch& before, RelevancePatch& patch)
{
    patch.sequence = noted.sequence;
    patch.origin = noted.origin;
    patch.size = noted.size;
    patch.words_per_row = noted.words_per_row;
    patch.spacing = noted.spacing;
    patch.volume_size = noted.volume_size;
    patch.level = noted.level;
    patch.settings = noted.settings;
    patch.limits = noted.limits;
    if (!has_place(patch)) return false;
    std::string_view runs = noted.runs;
    uint32_t length = 0;
    bool differs = true, fits = true;
    const auto next_run = [&] {
        fits = take_length(runs, length);
        differs = !differs;
    };
    next_run();
    for_words(patch, before, [&](uint32_t& word, uint32_t other) {
        uint32_t difference = 0;
        for (uint32_t bit = 0; fits && bit < 32;) {
            if (length == 0) {
                next_run();
                continue;
            }
            const uint32_t run = std::min(length, 32 - bit);
            if (differs) difference |= (run == 32 ? ~0u : (1u << run) - 1u) << bit;
            bit += run;
            length -= run;
        }
        word = other ^ difference;
    });
    return fits && length == 0 && runs.empty();
}

}  // namespace shvr
