#pragma once
// Estimates the host memory of an import from sizes alone, before memory is allocated. Any thread may call these.

#include <filesystem>

#include "engine/projects/import_prepare.h"
#include "engine/volume/stored_chunks.h"

namespace shvr {

/// Returns how many rows of a slab of 64 slices are in memory at once: whole chunks, or all rows. Memory holds two such
/// batches, since one is read while the previous one is compressed.
int64_t import_rows(const VolumeInfo& info);

/// Returns an upper bound, in bytes, of the memory of an import that reads every slab. `keeps_state`: the import can be
/// resumed, so that its state, with copies of its levels, needs memory. The result is a double, so that sizes that
/// would overflow an integer are refused, too.
double dense_import_bytes(const Preparation& preparation, int threads, bool keeps_state);

/// Returns an upper bound, in bytes, of the memory of an import that reads only stored chunks.
double sparse_import_bytes(const VolumeSource& source, const VolumeInfo& info, const StoredChunks& stored, int threads);

/// Memory of the program and its libraries, and of heap fragmentation by freed blocks.
inline constexpr double IMPORT_PROGRAM_BYTES = double(48 << 20);

/// Returns `wanted`, or three quarters of the memory that the process was given if `wanted` is 0.
double import_budget(int64_t wanted);

/// Fails if `bytes` exceed the budget. The message states the size, the estimate, the budget and the options that help.
/// `info` describes the volume as it will be stored.
void check_import_budget(const std::filesystem::path& project, const VolumeInfo& info, double bytes, int64_t wanted);

}  // namespace shvr
