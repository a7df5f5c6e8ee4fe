#pragma once
// Numbers that files store but no voxel type holds: 64-bit integers and 16-bit floats. A reader reads their bits as a
// voxel type of the same size, and `widened` converts them to float64 or float32. It fails for values that floats
// cannot hold. Any thread may call these.

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "engine/volume/source.h"

namespace shvr {

enum class StoredNumber { plain, int64, uint64, float16 };
const char* name_of(StoredNumber number);
/// Returns the 64-bit integer type that a header names: "int64", "long long", "MET_ULONG_LONG"; null for other types.
std::optional<StoredNumber> wide_integer_of(std::string_view name);

/// Returns the voxel type for reading the bits: float64 for 64-bit integers, uint16 for float16. Not for `plain`.
VoxelType bits_type(StoredNumber number);

float float_of_half(uint16_t half);
/// Returns the nearest 16-bit float; null if `value` is too large.
std::optional<uint16_t> half_of(double value);

/// Converts 64-bit integers to doubles in place. Fails, naming `file`, at the first value beyond 2^53, the limit up to
/// which doubles represent all integers.
void widen_integers(StoredNumber number, std::span<std::byte> voxels, const std::string& file);

/// Returns `source` for `plain`; otherwise a source that converts to float64 (float16: to float32), with a warning.
std::unique_ptr<VolumeSource> widened(std::unique_ptr<VolumeSource> source, StoredNumber number,
                                      const std::string& file);

}  // namespace shvr
