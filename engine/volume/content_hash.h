#pragma once
// A number that says whether two volumes hold the same voxels, whatever the files they come from: XXH3-128 of every slice
// along z (its voxels x fastest, then y, little-endian), and of those hashes in their order, each in its canonical form.
// It finds changes and mistakes, not forgery. Written "xxh3-128:" and 32 hexadecimal digits.

#include <array>
#include <memory>
#include <span>
#include <string>

#include "engine/volume/source.h"

namespace shvr {

using SliceHash = std::array<std::byte, 16>;

/// The hash of one slice, whose rows come in pieces, in order. One thread at a time.
class SliceHasher {
public:
    SliceHasher();
    ~SliceHasher();
    SliceHasher(SliceHasher&&) noexcept;

    void add(std::span<const std::byte> voxels);
    /// The hash of what was added; the next slice can begin.
    SliceHash finish();

private:
    struct State;
    std::unique_ptr<State> state_;
};

std::string content_hash(std::span<const SliceHash> slices);

/// Reads the whole of level 0, slice by slice. Any thread may call it.
std::string content_hash(const VolumeSource& source);

}  // namespace shvr
