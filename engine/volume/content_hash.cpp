#include "engine/volume/content_hash.h"

#include <xxhash.h>

#include <algorithm>
#include <cstring>

#include "engine/base/error.h"
#include "engine/volume/grid.h"
#include "engine/volume/stored_chunks.h"
#include "engine/volume/voxel_walk.h"

namespace shvr {
namespace {

constexpr int64_t PIECE_BYTES = int64_t{16} << 20;
/// If a volume stores more blocks than this, they are not listed, and all slices are read.
constexpr int64_t MAX_BLOCKS_LISTED = int64_t{1} << 20;
/// Limit of the bytes to read (2^38), which takes minutes. Longer hashing would look like a hang.
constexpr double MAX_BYTES_HASHED = 274877906944.0;
constexpr double CHUNK_VOXELS = double(STORED_CHUNK * STORED_CHUNK * STORED_CHUNK);
constexpr const char* SLICES = "xxh3-128:";
constexpr const char* CHUNKS = "xxh3-128-chunks:";

Size3 chunk_counts(const Size3& size)
{
    return (size + (STORED_CHUNK - 1)) / STORED_CHUNK;
}

SliceHash canonical(const XXH128_hash_t& hash)
{
    XXH128_canonical_t bytes;
    XXH128_canonicalFromHash(&bytes, hash);
    SliceHash result;
    static_assert(sizeof(bytes) == sizeof(result));
    std::memcpy(result.data(), &bytes, sizeof(bytes));
    return result;
}

std::string digits_of_hash(const SliceHash& hash)
{
    std::string text;
    for (const std::byte byte : hash) {
        constexpr const char* DIGITS = "0123456789abcdef";
        text += DIGITS[std::to_integer<int>(byte) >> 4];
        text += DIGITS[std::to_integer<int>(byte) & 15];
    }
    return text;
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
    return SLICES + digits_of_hash(canonical(XXH3_128bits(slices.data(), slices.size_bytes())));
}

std::optional<HashKind> kind_of(std::string_view hash)
{
    if (hash.starts_with(CHUNKS)) return HashKind::chunks;
    if (hash.starts_with(SLICES)) return HashKind::slices;
    return std::nullopt;
}

HashKind kind_for(const VolumeInfo& info, int64_t varied_chunks)
{
    const Size3 counts = chunk_counts(info.size);
    const bool is_large = voxel_count(info) > MAX_VOXELS_IN_SLICES;
    return is_large && varied_chunks <= counts.x * counts.y * counts.z / 8 ? HashKind::chunks : HashKind::slices;
}

// ---- In slices ------------------------------------------------------------------------------------------------------

namespace {

/// Hashes slices in pieces (rows, or parts of rows, of one or more slices), which stay small for rows of any length.
void hash_slab(const VolumeSource& source, int64_t lower, int64_t upper, std::vector<SliceHash>& hashes)
{
    const Size3 size = source.info().size;
    const int64_t column_bytes = (upper - lower) * int64_t(bytes_of(source.info().type));
    const int64_t width = std::clamp<int64_t>(PIECE_BYTES / column_bytes, 1, size.x);
    const int64_t rows = width < size.x ? 1 : std::clamp<int64_t>(PIECE_BYTES / (column_bytes * width), 1, size.y);
    std::vector<SliceHasher> hashers(size_t(upper - lower));
    std::vector<std::byte> piece(size_t(column_bytes * width * rows));
    for (int64_t y = 0; y < size.y; y += rows)
        for (int64_t x = 0; x < size.x; x += width) {
            const VoxelBox box{{x, y, lower}, {std::min(size.x, x + width), std::min(size.y, y + rows), upper}};
            const Size3 extent = box.size();
            const size_t slice_bytes = size_t(extent.x * extent.y) * bytes_of(source.info().type);
            const std::span<std::byte> part = std::span(piece).first(slice_bytes * hashers.size());
            source.read(box, part);
            for (size_t slice = 0; slice < hashers.size(); ++slice)
                hashers[slice].add(part.subspan(slice * slice_bytes, slice_bytes));
        }
    for (SliceHasher& hasher : hashers) hashes.push_back(hasher.finish());
}

/// Returns for each slice whether the source may store something in it.
std::vector<bool> stored_slices(const VolumeSource& source)
{
    const Size3 size = source.info().size;
    const std::optional<StoredBlocks> stored = source.stored_blocks(0, MAX_BLOCKS_LISTED);
    std::vector<bool> is_stored(size_t(size.z), !stored);
    if (!stored) return is_stored;
    for (const glm::ivec3& block : stored->blocks) {
        const VoxelBox box = box_of_block(*stored, block, size);
        std::fill(is_stored.begin() + box.lower.z, is_stored.begin() + box.upper.z, true);
    }
    return is_stored;
}

std::string hash_in_slices(const VolumeSource& source, const std::vector<bool>& is_stored)
{
    const Size3 size = source.info().size;
    const int64_t step = std::min(size.z, source.block().z);  // reads whole blocks, so that none is decoded twice
    std::vector<SliceHash> hashes;
    std::vector<SliceHash> empty;
    for (int64_t z = 0; z < size.z; z += step) {
        const int64_t upper = std::min(size.z, z + step);
        const bool any = std::any_of(is_stored.begin() + z, is_stored.begin() + upper, [](bool is) { return is; });
        if (any) {
            hash_slab(source, z, upper, hashes);
            continue;
        }
        if (empty.empty()) hash_slab(source, z, z + 1, empty);
        hashes.insert(hashes.end(), size_t(upper - z), empty.front());
    }
    return content_hash(hashes);
}

// ---- In chunks ------------------------------------------------------------------------------------------------------

/// Returns null if the voxels that must be read exceed MAX_BYTES_HASHED.
std::optional<std::string> hash_in_chunks(const VolumeSource& source)
{
    const VolumeInfo& info = source.info();
    const auto voxel_bytes = int64_t(bytes_of(info.type));
    const VoxelBox whole{Size3(0), info.size};
    const std::optional<StoredChunks> stored = chunks_in(source, whole, MAX_STORED_BLOCKS);
    const Size3 counts = chunk_counts(info.size);
    const double chunks = stored ? double(stored->keys.size()) : double(counts.x) * double(counts.y) * double(counts.z);
    if (chunks * double(voxel_bytes) * CHUNK_VOXELS > MAX_BYTES_HASHED) return std::nullopt;
    ChunkHasher hasher(info);
    std::vector<std::byte> voxels;
    for (int64_t i = 0; i < int64_t(chunks); ++i) {
        const Size3 chunk = stored ? stored->at(size_t(i)) : position_of(i, counts);
        const Size3 lower = chunk * STORED_CHUNK, upper = glm::min(lower + STORED_CHUNK, info.size);
        const Size3 extent = upper - lower;
        voxels.resize(size_t(extent.x * extent.y * extent.z * voxel_bytes));
        source.read({lower, upper}, voxels);
        hasher.add(chunk, voxels.data(), size_t(extent.x * voxel_bytes), size_t(extent.x * extent.y * voxel_bytes));
    }
    const std::array<std::byte, 8> none{};
    return hasher.hash(std::span(stored ? stored->fill : none).first(size_t(voxel_bytes)));
}

}  // namespace

ChunkHasher::ChunkHasher(const VolumeInfo& info) : size_(info.size), counts_(chunk_counts(info.size)), type_(info.type)
{}

void ChunkHasher::add(const Size3& chunk, const std::byte* voxels, size_t row_bytes, size_t slice_bytes)
{
    const Size3 extent = glm::min(Size3(STORED_CHUNK), size_ - chunk * STORED_CHUNK);
    const size_t voxel_bytes = bytes_of(type_), length = size_t(extent.x) * voxel_bytes;
    Digest digest{.chunk = uint64_t(index_of(chunk, counts_)), .is_varied = 0, .bytes = {}};
    SliceHasher hasher;
    for (int64_t z = 0; z < extent.z; ++z)
        for (int64_t y = 0; y < extent.y; ++y) {
            const std::byte* const row = voxels + size_t(z) * slice_bytes + size_t(y) * row_bytes;
            hasher.add({row, length});
            // All voxels are equal if the row starts with the first voxel and equals itself shifted by one voxel.
            const bool is_uniform = std::memcmp(row, voxels, voxel_bytes) == 0 &&
                                    std::memcmp(row, row + voxel_bytes, length - voxel_bytes) == 0;
            if (!is_uniform) digest.is_varied = 1;
        }
    if (digest.is_varied != 0)
        digest.bytes = hasher.finish();
    else
        std::memcpy(digest.bytes.data(), voxels, voxel_bytes);
    const std::scoped_lock lock(mutex_);
    digests_.push_back(digest);
}

int64_t ChunkHasher::varied() const
{
    return std::ranges::count_if(digests_, [](const Digest& digest) { return digest.is_varied != 0; });
}

std::string ChunkHasher::hash(std::span<const std::byte> rest) const
{
    std::vector<Digest> sorted = digests_;
    std::ranges::sort(sorted, {}, &Digest::chunk);
    SliceHasher hasher;
    const auto put = [&](const auto& value) { hasher.add(std::as_bytes(std::span(&value, 1))); };
    put(size_);
    put(uint64_t(type_));
    Digest run{.chunk = 0, .is_varied = 0, .bytes = {}};  // here, `chunk` is the number of chunks
    const auto add = [&](const Digest& digest, uint64_t count) {
        if (digest.is_varied != run.is_varied || digest.bytes != run.bytes) {
            if (run.chunk > 0) put(run);
            run = {.chunk = 0, .is_varied = digest.is_varied, .bytes = digest.bytes};
        }
        run.chunk += count;
    };
    Digest uniform{.chunk = 0, .is_varied = 0, .bytes = {}};
    std::ranges::copy(rest, uniform.bytes.begin());
    uint64_t next = 0;
    for (const Digest& digest : sorted) {
        if (digest.chunk > next) add(uniform, digest.chunk - next);
        add(digest, 1);
        next = digest.chunk + 1;
    }
    const auto all = uint64_t(counts_.x * counts_.y * counts_.z);
    if (all > next) add(uniform, all - next);
    put(run);
    return CHUNKS + digits_of_hash(hasher.finish());
}

std::string content_hash(const VolumeSource& source)
{
    return hash_in_slices(source, stored_slices(source));
}

std::optional<std::string> content_hash(const VolumeSource& source, HashKind kind)
{
    if (kind == HashKind::chunks) return hash_in_chunks(source);
    const std::vector<bool> is_stored = stored_slices(source);
    const Size3 size = source.info().size;
    const double slice_bytes = double(size.x) * double(size.y) * double(bytes_of(source.info().type));
    const double slices = 1.0 + double(std::ranges::count(is_stored, true));
    if (slices * slice_bytes > MAX_BYTES_HASHED) return std::nullopt;
    return hash_in_slices(source, is_stored);
}

bool is_same_content(const std::string& stated, const std::string& known, const VolumeSource* source)
{
    if (stated == known) return true;
    const std::optional<HashKind> kind = kind_of(stated);
    if (!kind || kind == kind_of(known) || source == nullptr) return false;
    return content_hash(*source, *kind) == stated;
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
