#pragma once
// Numbers that files store but no voxel type holds: integers of 64 bits and floats of 16 bits. A reader reads their
// bits as a type of the same size, and `widened` converts them to floats, failing for values that floats cannot hold.
// Any thread may call these.

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "engine/volume/source.h"

namespace shvr {

enum class StoredNumber { plain, int64, uint64, float16 };
const char* name_of(StoredNumber number);
/// The 64-bit integer type that a text header names: "int64", "long long", "MET_ULONG_LONG"; null for other types.
std::optional<StoredNumber> wide_integer_of(std::string_view name);

/// The voxel type used to read a number's bits: float64 for integers of 64 bits, uint16 for float16. Not for `plain`.
VoxelType bits_type(StoredNumber number);

float float_of_half(uint16_t half);
/// The nearest 16-bit float; null if `value` is too large.
std::optional<uint16_t> half_of(double value);

/// Converts 64-bit integers to doubles in place. Fails, naming `file`, at the first value beyond 2^53, from where
/// doubles do not represent each integer.
void widen_integers(StoredNumber number, std::span<std::byte> voxels, const std::string& file);

/// Returns `source` for `plain`; otherwise a source of its numbers as float64 (float32 for float16), with a warning.
std::unique_ptr<VolumeSource> widened(std::unique_ptr<VolumeSource> source, StoredNumber number,
                                      const std::string& file);

}  // namespace shvr
