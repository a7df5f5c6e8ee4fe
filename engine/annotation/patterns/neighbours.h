#pragma once
// Florets near one. Any thread.

#include <vector>

#include "engine/annotation/trace/trace_index.h"

namespace shvr {

/// Indices of the places around a place, including its own: at least `count` others, unless fewer are within a distance
/// of 4. `index` holds the places by their indices.
inline std::vector<uint32_t> neighbours_of(const TraceIndex& index, const std::vector<glm::dvec3>& places,
                                           uint32_t place, size_t count)
{
    const auto nearest = index.nearest(places[place], place);
    if (!nearest) return {place};
    for (double distance = 1e-6 + 1.5 * glm::length(places[*nearest] - places[place]);; distance *= 1.5) {
        std::vector<uint32_t> found = index.within(places[place], distance);
        if (found.size() > count || !(distance < 4.0)) return found;
    }
}

}  // namespace shvr
