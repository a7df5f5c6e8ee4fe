// Threshold to a group. Reads the volume in pieces of whole file blocks, and only where intensities may be in range.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <set>

#include "engine/annotation/operations/group_bricks.h"
#include "engine/annotation/operations/run_operation.h"
#include "engine/volume/voxel_numbers.h"

namespace shvr {

namespace {

constexpr int64_t MAX_PIECE_BYTES = int64_t{128} << 20;

/// The size of pieces to read, in bricks: enough to cover a block of the file, unless that exceeds MAX_PIECE_BYTES.
Size3 piece_of(const VolumeSource& source)
{
    const Size3 bricks = brick_grid(source.info().size);
    const auto bytes = int64_t(bytes_of(source.info().type)) * BRICK_SIDE * BRICK_SIDE * BRICK_SIDE;
    Size3 piece = glm::min((source.block() + (BRICK_SIDE - 1)) / BRICK_SIDE, bricks);
    for (const int axis : {2, 1, 0})
        while (piece[axis] > 1 && piece.x * piece.y * piece.z * bytes > MAX_PIECE_BYTES)
            piece[axis] = (piece[axis] + 1) / 2;
    return piece;
}

/// Intensities that are bytes: from `lower` to `lower + most`, or none.
struct ByteRange {
    ByteRange(double from, double to) : is_empty(from > 255.0 || to < 0.0 || std::ceil(from) > std::floor(to))
    {
        if (is_empty) return;
        lower = uint8_t(std::ceil(std::max(from, 0.0)));
        most = uint8_t(std::floor(std::min(to, 255.0)) - lower);
    }
    bool is_empty;
    uint8_t lower = 0, most = 0;
};

/// Gives the voxels of a row whose intensities are in range to the group.
void mark_bytes(const std::byte* intensities, const ByteRange& range, uint8_t group, std::span<uint8_t> row)
{
    if (range.is_empty) return;
    const uint8_t lower = range.lower, most = range.most;
    // A row of a whole brick, since the compiler then compares many bytes in an instruction.
    std::array<uint8_t, size_t(BRICK_SIDE)> values{}, groups{};
    std::memcpy(values.data(), intensities, row.size());
    std::ranges::copy(row, groups.begin());
    for (size_t x = 0; x < groups.size(); ++x) {
        const auto above = uint8_t(values[x] - lower);  // wraps below it
        groups[x] = above <= most ? group : groups[x];
    }
    std::copy_n(groups.begin(), row.size(), row.begin());
}

class ThresholdSearch {
public:
    ThresholdSearch(const ThresholdOp& op, MaskEdit& edit)
        : edit_(edit),
          source_(edit.source()),
          counts_(edit.mask().brick_counts()),
          group_(uint8_t(op.group)),
          from_(op.from.value_or(-std::numeric_limits<double>::infinity())),
          to_(op.to.value_or(std::numeric_limits<double>::infinity())),
          bytes_(from_, to_)
    {}
    void search(const Progress& progress);

private:
    bool may_occur(const Size3& brick) const;
    bool holds(double value) const { return value >= from_ && value <= to_; }
    std::vector<VoxelBox> pieces() const;
    void search_piece(const VoxelBox& bricks);
    void search_brick(const Size3& brick, const VoxelBox& read, std::span<const std::byte> voxels);

    MaskEdit& edit_;
    const VolumeSource& source_;
    Size3 counts_;
    uint8_t group_;
    double from_, to_;
    ByteRange bytes_;
};

bool ThresholdSearch::may_occur(const Size3& brick) const
{
    if (!edit_.may_change(index_of(brick, counts_))) return false;
    const std::optional<ValueRange> range = source_.brick_range(0, brick);
    return !range || (range->lower <= to_ && range->upper >= from_);
}

/// The boxes to read, in bricks. If the source is sparse and its fill value is out of range, only boxes with stored
/// blocks.
std::vector<VoxelBox> ThresholdSearch::pieces() const
{
    const Size3 size = source_.info().size, piece = piece_of(source_);
    const auto piece_box = [&](const Size3& at) {
        return VoxelBox{at * piece, glm::min((at + int64_t{1}) * piece, counts_)};
    };
    std::set<std::array<int64_t, 3>> places;
    const auto add = [&](const VoxelBox& voxels) {
        if (!glm::all(glm::lessThan(voxels.lower, voxels.upper))) return;
        const Size3 first = voxels.lower / BRICK_SIDE / piece, last = (voxels.upper - int64_t{1}) / BRICK_SIDE / piece;
        for (int64_t z = first.z; z <= last.z; ++z)
            for (int64_t y = first.y; y <= last.y; ++y)
                for (int64_t x = first.x; x <= last.x; ++x) places.insert({z, y, x});
    };
    VoxelBox whole{Size3(0), size};
    if (const auto& box = edit_.limits().box) whole = {glm::max(box->lower, Size3(0)), glm::min(box->upper, size)};
    const std::optional<StoredBlocks> stored = source_.stored_blocks(0, MAX_STORED_BLOCKS);
    if (stored && !holds(stored->fill)) {
        for (const glm::ivec3& block : stored->blocks) {
            const Size3 lower = Size3(block) * stored->block;
            add({glm::max(lower, whole.lower), glm::min(lower + stored->block, whole.upper)});
        }
    } else {
        add(whole);
    }
    std::vector<VoxelBox> pieces;
    for (const auto& [z, y, x] : places) pieces.push_back(piece_box({x, y, z}));
    return pieces;
}

void ThresholdSearch::search(const Progress& progress)
{
    const std::vector<VoxelBox> all = pieces();
    for (size_t done = 0; done < all.size(); ++done) {
        search_piece(all[done]);
        tell(progress, double(done + 1) / double(all.size()));
    }
}

void ThresholdSearch::search_piece(const VoxelBox& bricks)
{
    std::vector<Size3> wanted;
    VoxelBox read{bricks.upper, bricks.lower};
    for (int64_t z = bricks.lower.z; z < bricks.upper.z; ++z)
        for (int64_t y = bricks.lower.y; y < bricks.upper.y; ++y)
            for (int64_t x = bricks.lower.x; x < bricks.upper.x; ++x) {
                const Size3 brick(x, y, z);
                if (!may_occur(brick)) continue;
                wanted.push_back(brick);
                read = {glm::min(read.lower, brick), glm::max(read.upper, brick + int64_t{1})};
            }
    if (wanted.empty()) return;
    const VoxelBox box{read.lower * BRICK_SIDE, glm::min(read.upper * BRICK_SIDE, source_.info().size)};
    const Size3 size = box.size();
    std::vector<std::byte> voxels(size_t(size.x * size.y * size.z) * bytes_of(source_.info().type));
    source_.read(box, voxels);
    for (const Size3& brick : wanted) search_brick(brick, box, voxels);
    edit_.count_intensities(int64_t(wanted.size()));
}

void ThresholdSearch::search_brick(const Size3& brick, const VoxelBox& read, std::span<const std::byte> voxels)
{
    const int64_t index = index_of(brick, counts_);
    const VoxelBox box = edit_.mask().box_of(index);
    const Size3 size = box.size();
    const VoxelType type = source_.info().type;
    MaskBrick wanted = edit_.read(index);
    std::array<double, size_t(BRICK_SIDE)> values{};
    for (int64_t z = 0; z < size.z; ++z)
        for (int64_t y = 0; y < size.y; ++y) {
            const int64_t first = index_of(box.lower + Size3(0, y, z) - read.lower, read.size());
            const std::byte* const intensities = voxels.data() + size_t(first) * bytes_of(type);
            const auto row = std::span(wanted).subspan(size_t(BRICK_SIDE * (y + BRICK_SIDE * z)), size_t(size.x));
            if (type == VoxelType::uint8) {
                mark_bytes(intensities, bytes_, group_, row);
                continue;
            }
            load_voxels(type, intensities, std::span(values).first(row.size()));
            for (size_t x = 0; x < row.size(); ++x)
                if (holds(values[x])) row[x] = group_;
        }
    edit_.want(index, wanted);
}

}  // namespace

void perform(const ThresholdOp& op, MaskEdit& edit, const Progress& progress)
{
    ThresholdSearch(op, edit).search(progress);
}

}  // namespace shvr
