#pragma once
// The connected object that a hand follows: the relevant voxels connected through faces to those that the hand touched.
// The object grows within the servo's tick, on the bits of a `RelevancePatch`, so that it never lags behind the bits.
//
// A new patch is seeded with all of the object's voxels that lie in the patch and are still relevant. The first touch,
// and a touch after RECONTACT_NS off the object, seeds with the relevant voxel in the ball that is nearest to the
// ball's centre. Until RECONTACT_NS is over, a probe off its object feels nothing, even next to other objects.
//
// Words of rows wait in a list; each word's bits are propagated to the four neighbouring rows and the two neighbouring
// words, where they fill the runs that they touch. This takes 10 us for tubes in 64^3 voxels. Solid or noisy cubes need
// more than GROWTH_STEPS and are finished in the next ticks, while the previous object stays in use.
//
// Never allocates; the caller owns the memory (1 MiB). One thread.

#include <array>
#include <cstdint>

#include "haptics/relevance.h"

namespace shvr {

/// Words of rows whose bits are still to be propagated. Each word is queued at most once.
struct GrowthList {
    std::array<uint32_t, RelevancePatch::MAX_WORDS> ring{};
    std::array<uint32_t, RelevancePatch::MAX_WORDS / 32> waits{};  ///< a bit per word: whether the word is queued
    uint32_t first = 0, count = 0;
};

/// Empties `grown`, and gives it the position of `mask`.
void begin_growth(const RelevancePatch& mask, RelevancePatch& grown, GrowthList& list) noexcept;
/// Seeds `grown` with the voxels of `object` that are set in `mask`. If the levels of these patches differ, seeds only
/// voxels whose centres lie in the ball. Returns the number of words that contain seeds.
uint32_t seed_from_object(const RelevancePatch& object, const RelevancePatch& mask, const glm::dvec3& centre,
                          double radius, RelevancePatch& grown, GrowthList& list) noexcept;
/// Seeds `grown` with the voxel of `mask` in the ball that is nearest to the ball's centre. Returns false if none is.
bool seed_nearest(const RelevancePatch& mask, const glm::dvec3& centre, double radius, RelevancePatch& grown,
                  GrowthList& list) noexcept;
/// Processes up to `steps` words of the list. The list is empty when `grown` holds all voxels connected to its seeds.
uint32_t grow(const RelevancePatch& mask, RelevancePatch& grown, GrowthList& list, uint32_t steps) noexcept;

inline constexpr uint32_t GROWTH_STEPS = 8192;         ///< words per tick: 0.2 ms at most
inline constexpr uint64_t RECONTACT_NS = 100'000'000;  ///< time without contact after which the next touch is a new one

struct GrowthMemory {
    std::array<RelevancePatch, 2> patches;  ///< the object, and the patch that is being grown
    uint32_t current = 0;                   ///< index into `patches`: the object
    RelevancePatch mask;                    ///< copy of the bits in which the object grows, if that takes several ticks
    GrowthList list;
    bool is_growing = false;
    bool has_mask = false;       ///< true: the object grows in `mask`; false: in the servo's patch of this tick
    uint64_t seen_sequence = 0;  ///< sequence of the last patch in which the object grew
    uint64_t off_since_ns = 0;   ///< time when the ball lost contact with the object; 0: in contact
    uint32_t contacts = 0;       ///< objects touched so far
    bool has_object = false;
    bool is_new_contact = false;  ///< another object is being grown

    const RelevancePatch& object() const { return patches[current]; }
};

/// Forgets the object, but keeps the count.
void forget_object(GrowthMemory& memory) noexcept;
/// Carries the object over to `patch` if that patch is new, and continues to grow the object. Returns the object now in
/// use; its sequence is 0 while there is no object.
const RelevancePatch& advance_object(const RelevancePatch& patch, const glm::dvec3& centre, double radius,
                                     GrowthMemory& memory) noexcept;
/// Call once per tick. `in_contact`: the ball contains part of the object. After RECONTACT_NS without contact, the ball
/// may touch another object, which then replaces the present one.
void keep_contact(const RelevancePatch& patch, const glm::dvec3& centre, double radius, bool in_contact,
                  uint64_t now_ns, GrowthMemory& memory) noexcept;

}  // namespace shvr
