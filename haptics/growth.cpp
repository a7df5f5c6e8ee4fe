#include "haptics/growth.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>

namespace shvr {
namespace {

/// Returns the runs of `mask` that contain a bit of `seeds`, a subset of `mask`, by shifts of doubling width.
uint32_t fill_runs(uint32_t seeds, uint32_t mask)
{
    uint32_t up = seeds, down = seeds, up_mask = mask, down_mask = mask;
    for (int shift = 1; shift < 32; shift *= 2) {
        up |= up_mask & (up << shift);
        up_mask &= up_mask << shift;
        down |= down_mask & (down >> shift);
        down_mask &= down_mask >> shift;
    }
    return up | down;
}

/// Returns the mask of those bits in word `word` of a row that stand for voxels: the last word may have unused bits.
uint32_t valid_bits(const RelevancePatch& patch, int32_t word)
{
    const int32_t rest = patch.size.x - 32 * word;
    return rest >= 32 ? ~0u : rest <= 0 ? 0u : ~0u >> (32 - rest);
}

struct Growing {
    const RelevancePatch& mask;
    RelevancePatch& grown;
    GrowthList& list;

    void push(uint32_t at)
    {
        uint32_t& waits = list.waits[at / 32];
        if (waits >> (at % 32) & 1u) return;
        waits |= 1u << (at % 32);
        list.ring[(list.first + list.count) % RelevancePatch::MAX_WORDS] = at;
        ++list.count;
    }
    uint32_t pop()
    {
        const uint32_t at = list.ring[list.first];
        list.first = (list.first + 1) % RelevancePatch::MAX_WORDS;
        --list.count;
        list.waits[at / 32] &= ~(1u << (at % 32));
        return at;
    }
    /// Adds seeds to word `at` and queues the word; returns whether a voxel was added. `word`: its index in the row.
    bool seed(uint32_t at, int32_t word, uint32_t seeds)
    {
        const uint32_t allowed = mask.words[at] & valid_bits(mask, word);
        const uint32_t fresh = seeds & allowed & ~grown.words[at];
        if (fresh == 0) return false;
        grown.words[at] |= fill_runs(fresh, allowed);
        push(at);
        return true;
    }
};

/// Returns the 32 bits of a row that begin at bit `x`; bits outside the row are 0.
uint32_t bits_from(const uint32_t* row, int32_t words, int32_t x)
{
    const int32_t word = x >> 5;  // rounds down
    const auto shift = uint32_t(x & 31);
    const auto at = [&](int32_t i) { return i >= 0 && i < words ? row[i] : 0u; };
    return shift == 0 ? at(word) : at(word) >> shift | at(word + 1) << (32 - shift);
}

struct Box {
    glm::ivec3 lower{0}, upper{0};  ///< half-open
};
/// Returns the voxels of a patch that the ball may contain.
Box voxels_around(const RelevancePatch& patch, const glm::dvec3& centre, double radius)
{
    const glm::dvec3 lower = (centre - radius) / patch.spacing - glm::dvec3(patch.origin);
    const glm::dvec3 upper = (centre + radius) / patch.spacing - glm::dvec3(patch.origin);
    const glm::dvec3 size(patch.size);
    return {glm::ivec3(glm::clamp(glm::floor(lower), glm::dvec3(0.0), size)),
            glm::ivec3(glm::clamp(glm::ceil(upper), glm::dvec3(0.0), size))};
}

/// Calls `take(voxel, middle)` for each set voxel whose centre lies in the ball.
template <class Take>
void each_voxel_in_ball(const RelevancePatch& patch, const glm::dvec3& centre, double radius, const Take& take)
{
    if (!std::isfinite(centre.x + centre.y + centre.z + radius) || !patch.is_well_formed()) return;
    const Box box = voxels_around(patch, centre, radius);
    for (int32_t z = box.lower.z; z < box.upper.z; ++z) {
        for (int32_t y = box.lower.y; y < box.upper.y; ++y) {
            for (int32_t word = box.lower.x / 32; 32 * word < box.upper.x; ++word) {
                for (uint32_t bits = patch.row_word(word, y, z) & valid_bits(patch, word); bits; bits &= bits - 1) {
                    const glm::ivec3 voxel(32 * word + std::countr_zero(bits), y, z);
                    const glm::dvec3 middle = (glm::dvec3(patch.origin + voxel) + 0.5) * patch.spacing;
                    const glm::dvec3 away = middle - centre;
                    if (glm::dot(away, away) <= radius * radius) take(voxel, middle);
                }
            }
        }
    }
}

uint32_t seed_across_levels(const RelevancePatch& object, const glm::dvec3& centre, double radius, Growing& growing)
{
    uint32_t seeded = 0;
    const RelevancePatch& mask = growing.mask;
    const auto seed_at = [&](const glm::dvec3& point) {
        const glm::ivec3 voxel = glm::ivec3(glm::floor(point / mask.spacing)) - mask.origin;
        if (glm::any(glm::lessThan(voxel, glm::ivec3(0))) || glm::any(glm::greaterThanEqual(voxel, mask.size))) return;
        const uint32_t at = uint32_t(voxel.x / 32 + mask.words_per_row * (voxel.y + mask.size.y * voxel.z));
        seeded += growing.seed(at, voxel.x / 32, 1u << (voxel.x % 32));
    };
    // Iterates over the patch with the smaller voxels, so that no voxel of the other patch is missed.
    if (object.spacing.x <= mask.spacing.x) {
        each_voxel_in_ball(object, centre, radius, [&](const glm::ivec3&, const glm::dvec3& p) { seed_at(p); });
        return seeded;
    }
    each_voxel_in_ball(mask, centre, radius, [&](const glm::ivec3&, const glm::dvec3& p) {
        const glm::ivec3 voxel = glm::ivec3(glm::floor(p / object.spacing)) - object.origin;
        if (glm::any(glm::lessThan(voxel, glm::ivec3(0))) || glm::any(glm::greaterThanEqual(voxel, object.size)))
            return;
        if (object.row_word(voxel.x / 32, voxel.y, voxel.z) >> (voxel.x % 32) & 1u) seed_at(p);
    });
    return seeded;
}

void begin(const RelevancePatch& patch, GrowthMemory& memory)
{
    memory.has_mask = false;
    memory.seen_sequence = patch.sequence;
    begin_growth(patch, memory.patches[1 - memory.current], memory.list);
}

std::optional<glm::ivec3> nearest_voxel(const RelevancePatch& mask, const glm::dvec3& centre, double radius)
{
    double nearest = INFINITY;
    std::optional<glm::ivec3> found;
    each_voxel_in_ball(mask, centre, radius, [&](const glm::ivec3& voxel, const glm::dvec3& middle) {
        const glm::dvec3 away = middle - centre;
        if (!(glm::dot(away, away) < nearest)) return;
        nearest = glm::dot(away, away);
        found = voxel;
    });
    return found;
}

bool seed_voxel(const RelevancePatch& mask, const glm::ivec3& voxel, RelevancePatch& grown, GrowthList& list)
{
    const uint32_t at = uint32_t(voxel.x / 32 + mask.words_per_row * (voxel.y + mask.size.y * voxel.z));
    return Growing{mask, grown, list}.seed(at, voxel.x / 32, 1u << (voxel.x % 32));
}

}  // namespace

void begin_growth(const RelevancePatch& mask, RelevancePatch& grown, GrowthList& list) noexcept
{
    grown.take_place_of(mask);
    std::fill_n(grown.words.begin(), mask.word_count(), 0u);
    while (list.count > 0) {  // left over from an earlier growth
        const uint32_t at = list.ring[list.first];
        list.waits[at / 32] = 0;
        list.first = (list.first + 1) % RelevancePatch::MAX_WORDS;
        --list.count;
    }
}

uint32_t seed_from_object(const RelevancePatch& object, const RelevancePatch& mask, const glm::dvec3& centre,
                          double radius, RelevancePatch& grown, GrowthList& list) noexcept
{
    Growing growing{mask, grown, list};
    if (object.spacing != mask.spacing) return seed_across_levels(object, centre, radius, growing);
    const glm::ivec3 shift = mask.origin - object.origin;
    uint32_t seeded = 0;
    for (int32_t z = std::max(0, -shift.z); z < std::min(mask.size.z, object.size.z - shift.z); ++z) {
        for (int32_t y = std::max(0, -shift.y); y < std::min(mask.size.y, object.size.y - shift.y); ++y) {
            const uint32_t* row = &object.words[size_t(object.words_per_row) *
                                                (size_t(y + shift.y) + size_t(object.size.y) * size_t(z + shift.z))];
            const uint32_t at = uint32_t(mask.words_per_row * (y + mask.size.y * z));
            for (int32_t word = 0; word < mask.words_per_row; ++word)
                seeded +=
                    growing.seed(at + uint32_t(word), word, bits_from(row, object.words_per_row, 32 * word + shift.x));
        }
    }
    return seeded;
}

bool seed_nearest(const RelevancePatch& mask, const glm::dvec3& centre, double radius, RelevancePatch& grown,
                  GrowthList& list) noexcept
{
    const std::optional<glm::ivec3> found = nearest_voxel(mask, centre, radius);
    return found && seed_voxel(mask, *found, grown, list);
}

uint32_t grow(const RelevancePatch& mask, RelevancePatch& grown, GrowthList& list, uint32_t steps) noexcept
{
    Growing growing{mask, grown, list};
    const auto words = uint32_t(mask.words_per_row), rows = uint32_t(mask.size.y), slices = uint32_t(mask.size.z);
    uint32_t done = 0;
    for (; done < steps && list.count > 0; ++done) {
        const uint32_t at = growing.pop();
        const uint32_t row = at / words, y = row % rows, z = row / rows;
        const auto word = int32_t(at - row * words);
        const uint32_t bits = grown.words[at];
        if (y > 0) growing.seed(at - words, word, bits);
        if (y + 1 < rows) growing.seed(at + words, word, bits);
        if (z > 0) growing.seed(at - words * rows, word, bits);
        if (z + 1 < slices) growing.seed(at + words * rows, word, bits);
        if (word > 0) growing.seed(at - 1, word - 1, bits << 31);
        if (word + 1 < int32_t(words)) growing.seed(at + 1, word + 1, bits >> 31);
    }
    return done;
}

void forget_object(GrowthMemory& memory) noexcept
{
    memory.has_object = memory.is_growing = memory.has_mask = memory.is_new_contact = false;
    memory.seen_sequence = memory.off_since_ns = 0;
    memory.patches[memory.current].sequence = 0;
}

const RelevancePatch& advance_object(const RelevancePatch& patch, const glm::dvec3& centre, double radius,
                                     GrowthMemory& memory) noexcept
{
    // If a newer patch replaced a new contact's patch before growth began, drops the contact; the next tick retries.
    if (memory.is_growing && !memory.has_mask && patch.sequence != memory.seen_sequence)
        memory.is_growing = memory.is_new_contact = false;
    const bool is_new = patch.sequence != 0 && patch.sequence != memory.seen_sequence && patch.is_well_formed();
    if (!memory.is_growing && is_new && memory.has_object) {
        begin(patch, memory);
        RelevancePatch& next = memory.patches[1 - memory.current];
        memory.is_growing = seed_from_object(memory.object(), patch, centre, radius, next, memory.list) > 0;
        memory.is_new_contact = false;
        if (!memory.is_growing) {  // nothing of the object is left, or the hand jumped out of the region
            memory.has_object = false;
            memory.patches[memory.current].sequence = 0;
        }
    }
    RelevancePatch& held = memory.patches[memory.current];
    // If the same bits have a newer time stamp, the grown object remains valid for longer.
    if (patch.sequence == held.sequence && patch.settings == held.settings)
        held.time_ns = std::max(held.time_ns, patch.time_ns);
    if (!memory.is_growing) return memory.object();
    RelevancePatch& next = memory.patches[1 - memory.current];
    grow(memory.has_mask ? memory.mask : patch, next, memory.list, GROWTH_STEPS);
    if (memory.list.count > 0) {
        if (memory.has_mask) return memory.object();
        memory.mask.take_place_of(patch);
        std::copy_n(patch.words.begin(), patch.word_count(), memory.mask.words.begin());
        memory.has_mask = true;
        return memory.object();
    }
    memory.current = 1 - memory.current;
    memory.is_growing = memory.has_mask = false;
    memory.has_object = true;
    memory.contacts += memory.is_new_contact;
    memory.is_new_contact = false;
    return memory.object();
}

void keep_contact(const RelevancePatch& patch, const glm::dvec3& centre, double radius, bool in_contact,
                  uint64_t now_ns, GrowthMemory& memory) noexcept
{
    if (in_contact) {
        memory.off_since_ns = 0;
        return;
    }
    if (memory.off_since_ns == 0) memory.off_since_ns = now_ns;
    if (memory.is_growing || patch.sequence == 0 || !patch.is_well_formed()) return;
    if (memory.contacts > 0 && now_ns - memory.off_since_ns < RECONTACT_NS) return;
    const std::optional<glm::ivec3> touched = nearest_voxel(patch, centre, radius);
    if (!touched) return;
    begin(patch, memory);
    memory.is_growing = memory.is_new_contact =
        seed_voxel(patch, *touched, memory.patches[1 - memory.current], memory.list);
}

}  // namespace shvr
