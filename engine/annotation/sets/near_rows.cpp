#include "engine/annotation/sets/near_rows.h"

#include <algorithm>

#include "engine/base/error.h"

namespace shvr {

NearRows::NearRows(const BrickSet& set, bool is_inverted, const Reach& reach)
    : set_(set),
      is_inverted_(is_inverted),
      size_(reach.mask.size()),
      counts_(reach.mask.brick_counts()),
      reach_(reach.voxels()),
      ball_(ball_rows(reach)),
      window_(BRICK_SIDE + int64_t{2} * reach_),
      rows_(size_t(window_.y * window_.z)),
      spread_(rows_.size()),
      has_any_(size_t(window_.z))
{
    SHVR_CHECK(std::max({reach_.x, reach_.y, reach_.z}) <= MAX_ROW_REACH);
    std::ranges::stable_sort(ball_, {}, &BallRow::half);
}

/// The row at (y, z) from the brick's first, with MAX_ROW_REACH voxels on either side.
uint64_t NearRows::row(const Neighbours& bricks, const Size3& brick, int64_t y, int64_t z) const
{
    const auto word = [&](const BrickBits* bits) { return uint64_t{bits ? (*bits)[size_t(y + BRICK_SIDE * z)] : 0u}; };
    const uint64_t row = word(bricks[0]) >> (BRICK_SIDE - MAX_ROW_REACH) | word(bricks[1]) << MAX_ROW_REACH |
                         word(bricks[2]) << (BRICK_SIDE + MAX_ROW_REACH);
    if (!is_inverted_) return row;
    const int64_t beyond = std::max<int64_t>(BRICK_SIDE * (brick.x + 1) + MAX_ROW_REACH - size_.x, 0);
    const uint64_t inside = ~uint64_t{0} >> beyond & ~uint64_t{0} << (brick.x == 0 ? MAX_ROW_REACH : 0);
    return ~row & inside;
}

/// Reads the rows around a brick; returns whether any voxel is there.
bool NearRows::gather(const Size3& brick)
{
    const Size3 corner = BRICK_SIDE * brick - reach_, lower = glm::max(corner, Size3(0)),
                upper = glm::min(corner + window_, size_);
    std::ranges::fill(rows_, 0);
    std::ranges::fill(has_any_, 0);
    for (int64_t z = lower.z / BRICK_SIDE; z <= (upper.z - 1) / BRICK_SIDE; ++z)
        for (int64_t y = lower.y / BRICK_SIDE; y <= (upper.y - 1) / BRICK_SIDE; ++y) {
            Neighbours bricks{};
            for (int64_t x = -1; x <= 1; ++x) {
                if (brick.x + x < 0 || brick.x + x >= counts_.x) continue;
                const auto found = set_.find(index_of(Size3(brick.x + x, y, z), counts_));
                if (found != set_.end()) bricks[size_t(x + 1)] = &found->second;
            }
            if (!is_inverted_ && bricks == Neighbours{}) continue;
            const Size3 first = glm::max(lower, BRICK_SIDE * Size3(0, y, z)),
                        end = glm::min(upper, BRICK_SIDE * Size3(1, y + 1, z + 1));
            for (int64_t at_z = first.z; at_z < end.z; ++at_z)
                for (int64_t at_y = first.y; at_y < end.y; ++at_y) {
                    const uint64_t found = row(bricks, brick, at_y % BRICK_SIDE, at_z % BRICK_SIDE);
                    rows_[size_t(at_y - corner.y + window_.y * (at_z - corner.z))] = found;
                    has_any_[size_t(at_z - corner.z)] |= uint8_t(found != 0);
                }
        }
    return std::ranges::any_of(has_any_, [](uint8_t has) { return has != 0; });
}

/// Adds what the rows of the ball, all of one length, reach in the brick's slice z.
void NearRows::add(std::span<const BallRow> ball, int64_t z, BrickBits& near) const
{
    std::array<uint32_t, size_t(BRICK_SIDE)> slice{};
    for (const BallRow& row : ball) {
        const int64_t from_z = z + reach_.z + row.z;
        if (has_any_[size_t(from_z)] == 0) continue;
        const uint32_t* const from = &spread_[size_t(reach_.y + row.y + window_.y * from_z)];
        for (size_t y = 0; y < slice.size(); ++y) slice[y] |= from[y];
    }
    for (size_t y = 0; y < slice.size(); ++y) near[y + slice.size() * size_t(z)] |= slice[y];
}

BrickBits NearRows::search(int64_t brick, const BrickBits& wanted)
{
    BrickBits near{};
    if (!gather(position_of(brick, counts_))) return near;
    std::vector<int64_t> slices;
    for (int64_t z = 0; z < BRICK_SIDE; ++z)
        if (!is_empty(std::span(wanted).subspan(size_t(BRICK_SIDE * z), size_t(BRICK_SIDE)))) slices.push_back(z);
    size_t next = 0;
    for (int64_t half = 0; next < ball_.size(); ++half) {
        if (half > 0)
            for (uint64_t& row : rows_) row |= row << 1 | row >> 1;
        size_t end = next;
        while (end < ball_.size() && ball_[end].half == half) ++end;
        if (end == next) continue;
        for (size_t row = 0; row < rows_.size(); ++row) spread_[row] = uint32_t(rows_[row] >> MAX_ROW_REACH);
        for (const int64_t z : slices) add(std::span(ball_).subspan(next, end - next), z, near);
        next = end;
    }
    for (size_t row = 0; row < near.size(); ++row) near[row] &= wanted[row];
    return near;
}

}  // namespace shvr
