#pragma once
// Numbers in files that no voxel type holds: integers of 64 bits and floats of 16. A reader reads their bits as a type
// of the same size, and `widened` turns them into floats, which hold every value or refuse it. Any thread may call
// these.

#include <memory>
#include <span>
#include <string>

#include "engine/volume/source.h"

namespace shvr {

enum class StoredNumber { plain, int64, uint64, float16 };
const char* name_of(StoredNumber number);

/// The type with which their bits are read: float64 for integers of 64 bits, uint16 for float16. Not for `plain`.
VoxelType bits_type(StoredNumber number);

float float_of_half(uint16_t half);
/// The nearest float of 16 bits; null: it is too large.
std::optional<uint16_t> half_of(double value);

/// Turns the bits of integers of 64 bits into doubles, in place. Fails, naming `file`, at the first value beyond 2^53,
/// which doubles do not hold.
void widen_integers(StoredNumber number, std::span<std::byte> voxels, const std::string& file);

/// `source` for `plain`; otherwise its numbers as float64, or float32 for float16, with a warning.
std::unique_ptr<VolumeSource> widened(std::unique_ptr<VolumeSource> source, StoredNumber number,
                                      const std::string& file);

}  // namespace shvr
