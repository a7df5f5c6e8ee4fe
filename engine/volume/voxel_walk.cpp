#include "engine/volume/voxel_walk.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <condition_variable>
#include <mutex>
#include <thread>

#include "engine/base/waits/waits.h"

namespace shvr {
namespace {

constexpr int64_t SLAB_BYTES = int64_t{16} << 20;  // read_boxes holds two
constexpr int64_t PIECES = 256, PIECE_VOXELS = int64_t{1} << 18;
/// If more blocks are stored, they are not listed: listing would take longer than reading a sample should.
constexpr int64_t MAX_BLOCKS_SAMPLED = int64_t{1} << 20;

int64_t count_of(const Size3& extent)
{
    return extent.x * extent.y * extent.z;
}

/// Returns the size of a slab: whole slices, or some rows of a slice if a slice is too large. If the file stores
/// blocks, slabs are as thick as a block and consist of rows of whole blocks.
Size3 slab_of(const VolumeSource& source)
{
    const Size3 size = source.info().size;
    const Size3 block = glm::min(source.block(), size);
    const int64_t row_bytes = size.x * int64_t(bytes_of(source.info().type));
    int64_t rows = std::min(size.y, std::max<int64_t>(1, SLAB_BYTES / (row_bytes * block.z)));
    if (rows < size.y) rows = std::max(rows / block.y, int64_t{1}) * block.y;
    int64_t slices = block.z;
    if (rows >= size.y) slices *= std::max<int64_t>(1, SLAB_BYTES / (row_bytes * size.y * block.z));
    return {size.x, std::min(rows, size.y), std::min(slices, size.z)};
}

/// Rounds `wanted` up to a multiple of `block`, but not above `size`.
int64_t whole_blocks(int64_t wanted, int64_t block, int64_t size)
{
    return std::clamp((wanted + block - 1) / block * block, int64_t{1}, size);
}

}  // namespace

VoxelBox box_of_block(const StoredBlocks& stored, const glm::ivec3& block, const Size3& size)
{
    const Size3 lower = Size3(block) * stored.block;
    return {lower, glm::min(lower + stored.block, size)};
}

int64_t voxels_stored(const StoredBlocks& stored, const Size3& size)
{
    int64_t voxels = 0;
    for (const glm::ivec3& block : stored.blocks) voxels += count_of(box_of_block(stored, block, size).size());
    return voxels;
}

VoxelWalk VoxelWalk::all(const VolumeSource& source)
{
    VoxelWalk walk;
    walk.size_ = source.info().size;
    walk.step_ = slab_of(source);
    walk.voxels_ = voxel_count(source.info());
    return walk;
}

VoxelWalk VoxelWalk::stored(const VolumeSource& source, StoredBlocks blocks)
{
    VoxelWalk walk;
    walk.size_ = source.info().size;
    walk.voxels_ = voxels_stored(blocks, walk.size_);
    walk.rest_ = voxel_count(source.info()) - walk.voxels_;
    walk.fill_ = blocks.fill;
    walk.boxes_.emplace();
    walk.boxes_->reserve(blocks.blocks.size());
    for (const glm::ivec3& block : blocks.blocks) walk.boxes_->push_back(box_of_block(blocks, block, walk.size_));
    return walk;
}

namespace {

/// Keeps every n-th block, such that about `voxels` voxels remain.
void thin_out(std::vector<glm::ivec3>& blocks, int64_t voxels)
{
    const auto count = int64_t(blocks.size());
    const int64_t wanted =
        std::clamp<int64_t>(count * (PIECES * PIECE_VOXELS) / std::max<int64_t>(voxels, 1), 1, count);
    for (int64_t i = 0; i < wanted; ++i) blocks[size_t(i)] = blocks[size_t(i * count / wanted)];
    blocks.resize(size_t(wanted));
}

}  // namespace

VoxelWalk VoxelWalk::sample(const VolumeSource& source)
{
    VoxelWalk walk;
    if (std::optional<StoredBlocks> blocks = source.stored_blocks(0, MAX_BLOCKS_SAMPLED);
        blocks && !blocks->blocks.empty()) {
        const int64_t all = voxels_stored(*blocks, source.info().size);
        thin_out(blocks->blocks, all);
        walk = stored(source, *std::move(blocks));
        walk.rest_ = int64_t(double(voxel_count(source.info()) - all) * (double(walk.voxels_) / double(all)));
        return walk;
    }
    const Size3 size = walk.size_ = source.info().size;
    const Size3 block = glm::min(source.block(), size);
    Size3 piece(0, block.y, block.z);
    piece.x = whole_blocks(PIECE_VOXELS / (block.y * block.z), block.x, size.x);
    piece.y = whole_blocks(PIECE_VOXELS / (piece.x * block.z), block.y, size.y);
    // Pieces are evenly spaced along z. Along y and x they follow Roberts' R2 sequence, which is even for any count.
    const Size3 places = (size - piece) / block + int64_t{1};
    walk.boxes_.emplace();
    for (int64_t i = 0; i < PIECES; ++i) {
        const auto share = [](double fraction) { return fraction - std::floor(fraction); };
        const glm::dvec3 at(share(0.5 + 0.5698402909980532 * double(i)), share(0.5 + 0.7548776662466927 * double(i)),
                            (double(i) + 0.5) / double(PIECES));
        const Size3 lower = glm::min(Size3(at * glm::dvec3(places)), places - int64_t{1}) * block;
        walk.boxes_->push_back({lower, glm::min(lower + piece, size)});
        walk.voxels_ += count_of(walk.boxes_->back().size());
    }
    // Sorts boxes by position, so that reads advance through the file even if a slice has several pieces.
    std::ranges::sort(*walk.boxes_, {}, [](const VoxelBox& box) {
        return std::array{box.lower.z, box.lower.y, box.lower.x};
    });
    return walk;
}

int64_t VoxelWalk::boxes() const
{
    if (boxes_) return int64_t(boxes_->size());
    return ((size_.y - 1) / step_.y + 1) * ((size_.z - 1) / step_.z + 1);
}

VoxelBox VoxelWalk::box(int64_t index) const
{
    if (boxes_) return (*boxes_)[size_t(index)];
    const int64_t bands = (size_.y - 1) / step_.y + 1;
    const Size3 lower(0, index % bands * step_.y, index / bands * step_.z);
    return {lower, glm::min(lower + step_, size_)};
}

namespace {

struct ReadBox {
    VoxelBox box{};
    std::vector<std::byte> voxels{};
    std::exception_ptr failure{};
};

void read(const VolumeSource& source, const VoxelBox& box, ReadBox& into)
{
    into.box = box;
    into.failure = nullptr;
    try {
        into.voxels.resize(size_t(count_of(box.size())) * bytes_of(source.info().type));
        source.read(box, into.voxels);
    } catch (...) {
        into.failure = std::current_exception();
    }
}

/// Reads the boxes of a walk in order into two buffers, on a thread of its own. After a box that cannot be read it
/// waits until that is given back, since the thread that takes it may read its parts.
class ReadAhead {
public:
    ReadAhead(const VolumeSource& source, const VoxelWalk& walk) : source_(source), walk_(walk)
    {
        thread_ = std::jthread([this, waits_are_over = waits_of_this_thread()](const std::stop_token& stop) {
            const WaitsUntil waits([&] { return stop.stop_requested() || waits_are_over(); });
            read_all(stop);
        });
    }
    /// Waits for the next box; it stays until give_back().
    ReadBox& wait()
    {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [&] { return read_ > taken_; });
        return buffers_[size_t(taken_ % 2)];
    }
    void give_back()
    {
        const std::lock_guard lock(mutex_);
        ++taken_;
        changed_.notify_all();
    }

private:
    void read_all(const std::stop_token& stop)
    {
        int64_t ahead = 2;
        for (int64_t i = 0; i < walk_.boxes(); ++i) {
            {
                std::unique_lock lock(mutex_);
                if (!changed_.wait(lock, stop, [&] { return taken_ + ahead > i; })) return;
            }
            ReadBox& next = buffers_[size_t(i % 2)];
            read(source_, walk_.box(i), next);
            ahead = next.failure ? 1 : 2;
            const std::lock_guard lock(mutex_);
            ++read_;
            changed_.notify_all();
        }
    }

    const VolumeSource& source_;
    const VoxelWalk& walk_;
    std::array<ReadBox, 2> buffers_;
    std::mutex mutex_;
    std::condition_variable_any changed_;
    int64_t read_ = 0, taken_ = 0;  ///< numbers of boxes
    std::jthread thread_;           ///< declared last, so that it ends before the members that it uses are destroyed
};

}  // namespace

void read_boxes(const VolumeSource& source, const VoxelWalk& walk, const TakeBox& take)
{
    if (walk.boxes() == 0) return;  // nothing is stored
    const auto bytes = uint64_t(count_of(walk.box(0).size())) * bytes_of(source.info().type);
    if (walk.boxes() == 1 || bytes > uint64_t(SLAB_BYTES)) {  // one buffer, where a row of blocks is large
        ReadBox only;
        for (int64_t i = 0; i < walk.boxes(); ++i) {
            read(source, walk.box(i), only);
            take(only.box, only.voxels, only.failure);
        }
        return;
    }
    ReadAhead ahead(source, walk);
    for (int64_t i = 0; i < walk.boxes(); ++i) {
        ReadBox& next = ahead.wait();
        take(next.box, next.voxels, next.failure);
        ahead.give_back();
    }
}

}  // namespace shvr
