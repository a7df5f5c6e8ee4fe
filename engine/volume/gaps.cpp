#include "engine/volume/gaps.h"

#include <algorithm>
#include <limits>
#include <type_traits>

#include "engine/volume/grid.h"
#include "engine/volume/voxel_dispatch.h"

namespace shvr {
namespace {

/// Returns the size of the file's blocks. For a file without blocks: the size of a slice.
Size3 piece_of(const VolumeSource& source)
{
    const Size3 size = source.info().size, block = source.block();
    return block == Size3(1) ? Size3(size.x, size.y, 1) : glm::min(block, size);
}

/// Visits each piece that intersects the box, and its intersection with the box.
template <class Visit>
void for_each_piece(const VoxelBox& box, const Size3& piece, const Visit& visit)
{
    const Size3 first = box.lower / piece * piece;
    for (int64_t z = first.z; z < box.upper.z; z += piece.z)
        for (int64_t y = first.y; y < box.upper.y; y += piece.y)
            for (int64_t x = first.x; x < box.upper.x; x += piece.x)
                visit(VoxelBox{Size3(x, y, z), Size3(x, y, z) + piece},
                      VoxelBox{glm::max(box.lower, Size3(x, y, z)), glm::min(box.upper, Size3(x, y, z) + piece)});
}

int64_t count_of(const VoxelBox& box)
{
    const Size3 size = box.size();
    return size.x * size.y * size.z;
}

template <class T>
constexpr T lowest_of()
{
    return std::is_floating_point_v<T> ? std::numeric_limits<T>::quiet_NaN() : std::numeric_limits<T>::lowest();
}

}  // namespace

void Gaps::expect_none(const std::string& reason) const
{
    if (refused_with_.empty()) return;
    has_refused_ = true;
    fail(reason, "; ", refused_with_);
}

void Gaps::add(const VoxelBox& block, const std::string& reason)
{
    const std::scoped_lock lock(mutex_);
    if (voxels_.empty()) first_reason_ = reason;
    // A key that is unique for each voxel of volumes of up to 2^20 voxels a side.
    const int64_t first = (block.lower.z << 40) + (block.lower.y << 20) + block.lower.x;
    if (voxels_.try_emplace(first, count_of(block)).second) sum_ += count_of(block);
}

int64_t Gaps::voxels() const
{
    const std::scoped_lock lock(mutex_);
    return sum_;
}

std::string Gaps::in_words() const
{
    const std::scoped_lock lock(mutex_);
    if (voxels_.empty()) return {};
    return sentence(sum_, sum_ == 1 ? " voxel cannot be read (" : " voxels cannot be read (", first_reason_,
                    voxels_.size() > 1 ? sentence("; and ", voxels_.size() - 1, " more") : "", ")");
}

void read_parts(const VolumeSource& source, const VoxelBox& box, std::span<std::byte> voxels, Gaps* gaps,
                const TakePart& take)
{
    const auto why_not_read = [&](const VoxelBox& part, std::span<std::byte> into) -> std::string {
        try {
            source.read(part, into);
            return {};
        } catch (const Stopped&) {
            throw;
        } catch (const Error& error) {
            if (gaps == nullptr) throw;
            gaps->expect_none(error.what());
            return error.what();
        }
    };
    if (why_not_read(box, voxels).empty()) return take(box, voxels);
    const size_t voxel_bytes = bytes_of(source.info().type);
    for_each_piece(box, piece_of(source), [&](const VoxelBox& piece, const VoxelBox& part) {
        const std::span<std::byte> into = voxels.first(size_t(count_of(part)) * voxel_bytes);
        const std::string reason = why_not_read(part, into);
        if (reason.empty())
            take(part, into);
        else
            gaps->add({piece.lower, glm::min(piece.upper, source.info().size)}, reason);
    });
}

void GapSource::read(const VoxelBox& box, std::span<std::byte> voxels) const
{
    const size_t voxel_bytes = bytes_of(info().type);
    const Size3 extent = box.size();
    std::vector<std::byte> pieces;
    bool is_whole = false;
    // If the whole box could be read, its voxels are already in `voxels`; otherwise the readable pieces are copied.
    const auto take = [&](const VoxelBox& part, std::span<const std::byte> read) {
        is_whole = part.lower == box.lower && part.upper == box.upper;
        if (is_whole) return;
        if (pieces.empty()) {
            pieces.resize(voxels.size());
            fill_with_lowest(pieces);
        }
        const Size3 at = part.lower - box.lower, size = part.size();
        const size_t row = size_t(size.x) * voxel_bytes;
        for (int64_t z = 0; z < size.z; ++z)
            for (int64_t y = 0; y < size.y; ++y, read = read.subspan(row))
                std::ranges::copy(read.first(row),
                                  pieces.begin() + index_of(at + Size3(0, y, z), extent) * int64_t(voxel_bytes));
    };
    read_parts(source_, box, voxels, &gaps_, take);
    if (is_whole) return;
    if (pieces.empty())
        fill_with_lowest(voxels);
    else
        std::ranges::copy(pieces, voxels.begin());
}

void GapSource::fill_with_lowest(std::span<std::byte> voxels) const
{
    with_voxel_type(info().type, [&]<class T>(T) {
        const T lowest = lowest_of<T>();
        const auto bytes = std::as_bytes(std::span(&lowest, 1));
        for (size_t at = 0; at < voxels.size(); at += sizeof(T)) std::ranges::copy(bytes, voxels.begin() + int64_t(at));
    });
}

}  // namespace shvr
