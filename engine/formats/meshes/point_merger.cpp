#include "engine/formats/meshes/point_merger.h"

#include <algorithm>
#include <bit>

namespace shvr {
namespace {

constexpr uint32_t EMPTY = UINT32_MAX;
constexpr uint64_t MIN_SLOTS = 64;

/// Mixes the bits of a position (the finalizer of MurmurHash3, for each coordinate).
uint64_t hash_of(const glm::vec3& at)
{
    uint64_t hash = 0;
    for (int axis = 0; axis < 3; ++axis) {
        hash = (hash ^ std::bit_cast<uint32_t>(at[axis])) * 0xff51afd7ed558ccdULL;
        hash ^= hash >> 33;
        hash *= 0xc4ceb9fe1a85ec53ULL;
        hash ^= hash >> 33;
    }
    return hash;
}

}  // namespace

PointMerger::PointMerger(MeshBuilder& builder, MeshMemory& memory, uint64_t points) : builder_(builder), memory_(memory)
{
    resize(std::bit_ceil(std::max(MIN_SLOTS, 2 * points)));
}

size_t PointMerger::slot_of(const glm::vec3& at) const
{
    size_t slot = hash_of(at) & (slots_.size() - 1);
    while (slots_[slot] != EMPTY && builder_.point(slots_[slot]) != at) slot = (slot + 1) & (slots_.size() - 1);
    return slot;
}

void PointMerger::resize(uint64_t slots)
{
    memory_.release(slots_.size() * sizeof(uint32_t));
    slots_ = {};
    memory_.take(slots * sizeof(uint32_t));
    slots_.assign(slots, EMPTY);
    for (uint32_t index = 0; index < builder_.points(); ++index) slots_[slot_of(builder_.point(index))] = index;
}

uint32_t PointMerger::index_of(glm::vec3 at)
{
    at += 0.0f;  // -0 becomes 0
    if (2 * builder_.points() >= slots_.size()) resize(2 * slots_.size());
    uint32_t& slot = slots_[slot_of(at)];
    if (slot == EMPTY) slot = builder_.add_point(at);
    return slot;
}

}  // namespace shvr
