#pragma once
// Annotation at random, for tests of what must hold whatever a person does: commands of all kinds on a small volume,
// and a number that tells two documents apart. Equal seeds, equal commands.

#include <cstdint>
#include <random>

#include "engine/annotation/work/work.h"

namespace shvr::test {

inline constexpr Size3 ANNOTATED_SIZE(45, 40, 35);  // no multiple of a brick's side
inline constexpr VoxelType ANNOTATED_TYPE = VoxelType::int16;

/// What is annotated.
VolumeInfo annotated_volume();
Document unannotated();
/// Where work on it is kept, in `folder`.
WorkFiles files_in(const std::filesystem::path& folder);

/// Differs (but for one chance in 2^64) where any group, offset, node, internode or size differs, or what exists.
uint64_t hash_of(const Mask& mask);
uint64_t hash_of(const DensityField& field);
uint64_t hash_of(const TraceGraph& trace);
uint64_t hash_of(const Document& document);

/// Paints or erases random parts of a random region: groups, offsets, or both in one command. May change nothing.
Command random_painting(const Document& document, std::mt19937& random);
/// Adds, links, moves, deletes, or sets groups and sizes, of whatever is nearest to a random place.
Command random_tracing(const Document& document, std::mt19937& random);
/// Either.
Command random_command(const Document& document, std::mt19937& random);

}  // namespace shvr::test
