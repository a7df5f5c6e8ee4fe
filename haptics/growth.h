#pragma once
// The connected object that a hand follows: relevant voxels joined through faces to those it touched. It is grown
// within the servo's tick, on the bits of a `RelevancePatch`, so that it never lags behind them.
//
// Seeds are a set: when a new patch comes, all voxels of the object that lie in it and are still relevant. The first
// touch, and a new one after the hand has been off the object for RECONTACT_NS, takes the relevant voxel nearest to the
// probe's middle, within its ball. Until then a probe off its object feels nothing, also next to other objects.
//
// Words of rows wait in a list; each is handed to its four neighbouring rows and two neighbouring words, where it fills
// the runs it touches. 10 us for tubes in 64^3 voxels; solid or noisy cubes take more than GROWTH_STEPS and are
// finished in the next ticks while the former object stays in force.
//
// Never allocates; the caller owns the memory (1 MiB). One thread.

#include <array>
#include <cstdint>

#include "haptics/relevance.h"

namespace shvr {

/// Words of rows from which growing goes on: each waits at most once.
struct GrowthList {
    std::array<uint32_t, RelevancePatch::MAX_WORDS> ring{};
    std::array<uint32_t, RelevancePatch::MAX_WORDS / 32> waits{};  ///< a bit for each word
    uint32_t first = 0, count = 0;
};

/// Makes `grown` empty, with the place of `mask`.
void begin_growth(const RelevancePatch& mask, RelevancePatch& grown, GrowthList& list) noexcept;
/// Seeds with the voxels of `object` that are set in `mask`. Patches of different levels share only what lies in the
/// ball, by the voxels' middles. The number of words that hold seeds.
uint32_t seed_from_object(const RelevancePatch& object, const RelevancePatch& mask, const glm::dvec3& centre,
                          double radius, RelevancePatch& grown, GrowthList& list) noexcept;
/// Seeds with the voxel set in `mask` whose middle is nearest to `centre`, and in the ball. False if there is none.
bool seed_nearest(const RelevancePatch& mask, const glm::dvec3& centre, double radius, RelevancePatch& grown,
                  GrowthList& list) noexcept;
/// At most `steps` words of the list. The list is empty when `grown` holds all that is joined to its seeds.
uint32_t grow(const RelevancePatch& mask, RelevancePatch& grown, GrowthList& list, uint32_t steps) noexcept;

inline constexpr uint32_t GROWTH_STEPS = 8192;         ///< words per tick: 0.2 ms at most
inline constexpr uint64_t RECONTACT_NS = 100'000'000;  ///< off the object for that long: the next touch is a new one

struct GrowthMemory {
    std::array<RelevancePatch, 2> patches;  ///< the object, and the one that is being grown
    uint32_t current = 0;                   ///< of `patches`: the object
    RelevancePatch mask;                    ///< what it is grown in, where that takes several ticks
    GrowthList list;
    bool is_growing = false;
    bool has_mask = false;       ///< `mask` holds what is grown in; otherwise the servo's patch of this tick does
    uint64_t seen_sequence = 0;  ///< of the last patch that was grown in
    uint64_t off_since_ns = 0;   ///< the ball has been without the object since then; 0: it holds some of it
    uint32_t contacts = 0;       ///< objects touched so far
    bool has_object = false;
    bool is_new_contact = false;  ///< what is being grown is another object

    const RelevancePatch& object() const { return patches[current]; }
};

/// Forgets the object, but not how many there were.
void forget_object(GrowthMemory& memory) noexcept;
/// Carries the object over to `patch` if that is new, and grows. The object in force afterwards; its sequence is 0
/// while there is none.
const RelevancePatch& advance_object(const RelevancePatch& patch, const glm::dvec3& centre, double radius,
                                     GrowthMemory& memory) noexcept;
/// To be told once a tick whether the ball holds some of the object: lets go of it, and touches another.
void keep_contact(const RelevancePatch& patch, const glm::dvec3& centre, double radius, bool in_contact,
                  uint64_t now_ns, GrowthMemory& memory) noexcept;

}  // namespace shvr
