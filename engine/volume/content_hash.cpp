#include "engine/volume/content_hash.h"

#include <xxhash.h>

#include <algorithm>
#include <cstring>

#include "engine/base/error.h"

namespace shvr {
namespace {

constexpr int64_t PIECE_BYTES = int64_t{32} << 20;

SliceHash canonical(const XXH128_hash_t& hash)
{
    XXH128_canonical_t bytes;
    XXH128_canonicalFromHash(&bytes, hash);
    SliceHash result;
    static_assert(sizeof(bytes) == sizeof(result));
    std::memcpy(result.data(), &bytes, sizeof(bytes));
    return result;
}

}  // namespace

struct SliceHasher::State {
    State() : xxh(XXH3_createState()) { XXH3_128bits_reset(xxh); }
    ~State() { XXH3_freeState(xxh); }
    State(const State&) = delete;
    XXH3_state_t* xxh;
};

SliceHasher::SliceHasher() : state_(std::make_unique<State>()) {}
SliceHasher::~SliceHasher() = default;
SliceHasher::SliceHasher(SliceHasher&&) noexcept = default;

void SliceHasher::add(std::span<const std::byte> voxels)
{
    XXH3_128bits_update(state_->xxh, voxels.data(), voxels.size());
}

SliceHash SliceHasher::finish()
{
    const SliceHash hash = canonical(XXH3_128bits_digest(state_->xxh));
    XXH3_128bits_reset(state_->xxh);
    return hash;
}

std::string content_hash(std::span<const SliceHash> slices)
{
    const SliceHash hash = canonical(XXH3_128bits(slices.data(), slices.size_bytes()));
    std::string text = "xxh3-128:";
    for (const std::byte byte : hash) {
        constexpr const char* DIGITS = "0123456789abcdef";
        text += DIGITS[std::to_integer<int>(byte) >> 4];
        text += DIGITS[std::to_integer<int>(byte) & 15];
    }
    return text;
}

std::string content_hash(const VolumeSource& source)
{
    const HashedSource hashed(source);
    const Size3 size = source.info().size;
    const int64_t row_bytes = size.x * int64_t(bytes_of(source.info().type));
    // Whole blocks along z, so that a chunked source decodes nothing twice.
    const int64_t slices = std::min(size.z, source.block().z);
    const int64_t rows = std::clamp<int64_t>(PIECE_BYTES / (row_bytes * slices), 1, size.y);
    std::vector<std::byte> piece(size_t(row_bytes * rows * slices));
    for (int64_t z = 0; z < size.z; z += slices) {
        for (int64_t y = 0; y < size.y; y += rows) {
            const VoxelBox box{{0, y, z}, {size.x, std::min(size.y, y + rows), std::min(size.z, z + slices)}};
            hashed.read(box, std::span(piece).first(size_t(row_bytes * box.size().y * box.size().z)));
        }
    }
    return hashed.hash();
}

HashedSource::HashedSource(const VolumeSource& source) : VolumeSource(source.info()), source_(source) {}

void HashedSource::read(const VoxelBox& box, std::span<std::byte> voxels) const
{
    source_.read(box, voxels);
    if (is_out_of_order_ || int64_t(slices_.size()) == info().size.z) return;
    const Size3 extent = box.size();
    is_out_of_order_ = extent.x != info().size.x || box.lower.z != int64_t(slices_.size()) || box.lower.y != rows_ ||
                       (rows_ > 0 && extent.z != int64_t(hashers_.size()));
    if (is_out_of_order_) return;
    hashers_.resize(size_t(extent.z));
    rows_ = box.upper.y % info().size.y;
    const size_t slice_bytes = voxels.size() / hashers_.size();
    for (size_t slice = 0; slice < hashers_.size(); ++slice) {
        hashers_[slice].add(voxels.subspan(slice * slice_bytes, slice_bytes));
        if (rows_ == 0) slices_.push_back(hashers_[slice].finish());
    }
}

std::string HashedSource::hash() const
{
    return int64_t(slices_.size()) == info().size.z ? content_hash(slices_) : std::string();
}

}  // namespace shvr
