#pragma once
// The host memory of an import, estimated from sizes alone before any of it is taken. Any thread may call these.

#include <filesystem>

#include "engine/projects/import_prepare.h"
#include "engine/volume/stored_chunks.h"

namespace shvr {

/// The rows of a slab of 64 slices that are held at once, twice: one batch is read while the previous one is
/// compressed. Whole chunks, or all rows.
int64_t import_rows(const VolumeInfo& info);

/// An upper bound of the memory, in bytes, of an import that reads every slab. `keeps_state`: whether it can be
/// resumed, for which its levels are written as they are. As double, since sizes that would overflow are to be
/// refused, too.
double dense_import_bytes(const Preparation& preparation, int threads, bool keeps_state);

/// The same of an import of stored chunks alone.
double sparse_import_bytes(const VolumeSource& source, const VolumeInfo& info, const StoredChunks& stored, int threads);

/// The program, its libraries and the memory that freed blocks leave unusable.
inline constexpr double IMPORT_PROGRAM_BYTES = double(48 << 20);

/// `wanted`, or three quarters of the machine's memory if that is 0.
double import_budget(int64_t wanted);

/// Fails, naming size, estimate, budget and the options that help, if `bytes` exceed the budget. `info` describes the
/// volume as it would be stored.
void check_import_budget(const std::filesystem::path& project, const VolumeInfo& info, double bytes, int64_t wanted);

}  // namespace shvr
