#pragma once
// Estimates the host memory of an import from sizes alone, before any memory is taken. Any thread may call these.

#include <filesystem>

#include "engine/projects/import_prepare.h"
#include "engine/volume/stored_chunks.h"

namespace shvr {

/// Returns the number of rows of a slab of 64 slices that are in memory at once, in whole chunks, or all rows. Memory
/// holds two such batches: one is read while the previous one is compressed.
int64_t import_rows(const VolumeInfo& info);

/// An upper bound of the memory, in bytes, of an import that reads every slab. `keeps_state`: whether the import can be
/// resumed; its state then contains copies of its levels. The result is double, so that sizes that would overflow an
/// integer are refused, too.
double dense_import_bytes(const Preparation& preparation, int threads, bool keeps_state);

/// An upper bound of the memory, in bytes, of an import that reads only stored chunks.
double sparse_import_bytes(const VolumeSource& source, const VolumeInfo& info, const StoredChunks& stored, int threads);

/// Memory of the program, its libraries and the heap fragmentation that freed blocks leave.
inline constexpr double IMPORT_PROGRAM_BYTES = double(48 << 20);

/// Returns `wanted`, or three quarters of the machine's memory if `wanted` is 0.
double import_budget(int64_t wanted);

/// Fails if `bytes` exceed the budget; the message has size, estimate, budget and the options that help. `info`
/// describes the volume as it would be stored.
void check_import_budget(const std::filesystem::path& project, const VolumeInfo& info, double bytes, int64_t wanted);

}  // namespace shvr
