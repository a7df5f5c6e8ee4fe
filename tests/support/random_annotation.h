#pragma once
// Random annotation, for tests of properties that hold whatever the user does: commands of all kinds on a small volume,
// and a hash that distinguishes two documents. Equal seeds give equal commands.

#include <cstdint>
#include <random>

#include "engine/annotation/painting.h"
#include "engine/annotation/work/work.h"

namespace shvr::test {

inline constexpr Size3 ANNOTATED_SIZE(45, 40, 35);  // not multiples of a brick's side
inline constexpr VoxelType ANNOTATED_TYPE = VoxelType::int16;

/// The volume that is annotated.
VolumeInfo annotated_volume();
Document unannotated();
/// The files of work on it, in `folder`.
WorkFiles files_in(const std::filesystem::path& folder);
/// The same with mask and offsets as OME-Zarr.
WorkFiles sparse_files_in(const std::filesystem::path& folder);

/// Differs (except for one chance in 2^64) if any group, offset, node, internode or size differs, or which of them
/// exist.
uint64_t hash_of(const Mask& mask);
uint64_t hash_of(const DensityField& field);
uint64_t hash_of(const TraceGraph& trace);
uint64_t hash_of(const Document& document);

/// The groups that the document's settings lock: none, or a quarter of all.
GroupSet locks_of(const Document& document);
/// The changes that lead from one document back to the other; none if they are equal.
std::vector<Change> all_changes_between(const Document& from, const Document& to);

/// Paints or erases random parts of a random region: groups, offsets, or both in one command, by a brush that is held
/// to unpainted voxels or not, and with the locks there are. May change nothing.
Command random_painting(const Document& document, std::mt19937& random);
/// Adds, links, moves or deletes whatever is nearest to a random position, or sets its group or size.
Command random_tracing(const Document& document, std::mt19937& random);
/// Sets one of a few sections to one of a few texts; one of them, the locks.
Command random_setting(const Document& document, std::mt19937& random);
/// One of a few sections with one of a few texts, as settings to keep.
SettingValues random_kept(std::mt19937& random);
/// Painting, tracing or setting.
Command random_command(const Document& document, std::mt19937& random);

}  // namespace shvr::test
