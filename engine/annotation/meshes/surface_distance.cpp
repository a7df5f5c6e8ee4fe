#include "engine/annotation/meshes/surface_distance.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace shvr {

namespace {

/// Pieces of a triangle within this share of the reach are not cut further.
constexpr double MIN_PIECE_RADIUS = 0.25;

struct Piece {
    TriangleCorners corners;
    uint32_t nearest = 0;  ///< a triangle of the surface that may be near
    glm::dvec3 middle{0.0};
    double radius = 0.0;  ///< the piece is within it around the middle

    Piece(const TriangleCorners& t, uint32_t near_it) : corners(t), nearest(near_it), middle((t[0] + t[1] + t[2]) / 3.0)
    {
        for (const glm::dvec3& corner : t) radius = std::max(radius, glm::distance(middle, corner));
    }
};

/// Appends the halves of a piece, cut at its longest side.
void cut(const Piece& piece, std::vector<Piece>& pieces)
{
    const TriangleCorners& t = piece.corners;
    size_t longest = 0;
    for (size_t i = 1; i < 3; ++i)
        if (glm::distance(t[i], t[(i + 1) % 3]) > glm::distance(t[longest], t[(longest + 1) % 3])) longest = i;
    const glm::dvec3 &from = t[longest], &to = t[(longest + 1) % 3], &top = t[(longest + 2) % 3];
    const glm::dvec3 middle = 0.5 * (from + to);
    pieces.push_back({{from, middle, top}, piece.nearest});
    pieces.push_back({{middle, to, top}, piece.nearest});
}

}  // namespace

double squared_distance(const glm::dvec3& p, const TriangleCorners& triangle)
{
    const auto& [a, b, c] = triangle;
    const glm::dvec3 ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
    const auto squared = [](const glm::dvec3& v) { return glm::dot(v, v); };
    const double d1 = glm::dot(ab, ap), d2 = glm::dot(ac, ap), d3 = glm::dot(ab, bp), d4 = glm::dot(ac, bp),
                 d5 = glm::dot(ab, cp), d6 = glm::dot(ac, cp);
    if (d1 <= 0.0 && d2 <= 0.0) return squared(ap);
    if (d3 >= 0.0 && d4 <= d3) return squared(bp);
    if (d6 >= 0.0 && d5 <= d6) return squared(cp);
    const double va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
    if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return squared(ap - d1 / (d1 - d3) * ab);
    if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return squared(ap - d2 / (d2 - d6) * ac);
    if (va <= 0.0 && d4 >= d3 && d5 >= d6) return squared(bp - (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b));
    return squared(ap - (vb * ab + vc * ac) / (va + vb + vc));
}

SurfaceDistance::SurfaceDistance(std::vector<glm::dvec3> positions, std::vector<glm::uvec3> triangles, double reach)
    : positions_(std::move(positions)), triangles_(std::move(triangles)), reach_(reach)
{
    // A triangle near a point has the middle of its box in the point's cell or in one next to it.
    glm::dvec3 largest(0.0);
    const auto lower = [&](uint32_t i) {
        const TriangleCorners t = corners(i);
        return glm::min(t[0], glm::min(t[1], t[2]));
    };
    const auto upper = [&](uint32_t i) {
        const TriangleCorners t = corners(i);
        return glm::max(t[0], glm::max(t[1], t[2]));
    };
    const uint32_t count = uint32_t(triangles_.size());
    for (uint32_t i = 0; i < count; ++i) largest = glm::max(largest, upper(i) - lower(i));
    half_ = 0.5 * largest;
    side_ = 1.0001 * (reach + half_);
    if (count != 0) origin_ = lower(0);
    first_.assign(std::bit_ceil(size_t(count) + 1) + 1, 0);
    const auto bucket = [&](uint32_t i) { return bucket_of(cell_of(0.5 * (lower(i) + upper(i)))); };
    for (uint32_t i = 0; i < count; ++i) ++first_[bucket(i)];
    for (size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
    sorted_.resize(count);
    for (uint32_t i = count; i-- > 0;) sorted_[--first_[bucket(i)]] = i;
}

size_t SurfaceDistance::bucket_of(const glm::ivec3& cell) const
{
    const uint64_t hash = uint64_t(uint32_t(cell.x)) * 0x9E3779B97F4A7C15U +
                          uint64_t(uint32_t(cell.y)) * 0xC2B2AE3D27D4EB4FU +
                          uint64_t(uint32_t(cell.z)) * 0x165667B19E3779F9U;
    return size_t(hash ^ hash >> 32) & (first_.size() - 2);
}

TriangleCorners SurfaceDistance::corners(uint32_t triangle) const
{
    const glm::uvec3& t = triangles_[triangle];
    return {positions_[t.x], positions_[t.y], positions_[t.z]};
}

double SurfaceDistance::from(const glm::dvec3& point, double enough, uint32_t& nearest) const
{
    double least = squared_distance(point, corners(nearest));
    if (least <= enough * enough) return std::sqrt(least);
    const glm::ivec3 cell = cell_of(point);
    // How far the triangles in a cell below, in the same one and in the one above are, at least, along each axis.
    const glm::dvec3 place = point - origin_ - glm::dvec3(cell) * side_;
    const std::array gaps{glm::max(place - half_, 0.0), glm::dvec3(0.0), glm::max(side_ - place - half_, 0.0)};
    for (int i = 0; i < 27; ++i) {
        const int k = (i + 13) % 27;  // the point's own cell first
        const glm::ivec3 step(k % 3, k / 3 % 3, k / 9);
        const glm::dvec3 gap(gaps[size_t(step.x)].x, gaps[size_t(step.y)].y, gaps[size_t(step.z)].z);
        if (glm::dot(gap, gap) > std::min(least, reach_ * reach_)) continue;
        const size_t bucket = bucket_of(cell + step - 1);
        for (uint32_t at = first_[bucket]; at < first_[bucket + 1]; ++at) {
            const double squared = squared_distance(point, corners(sorted_[at]));
            if (!(squared < least)) continue;
            least = squared;
            nearest = sorted_[at];
            if (least <= enough * enough) return std::sqrt(least);
        }
    }
    return least <= reach_ * reach_ ? std::sqrt(least) : std::numeric_limits<double>::infinity();
}

double SurfaceDistance::squared_bound(const TriangleCorners& piece, uint32_t triangle) const
{
    // The distance from a triangle is a convex function, so it is largest at a corner.
    const TriangleCorners from = corners(triangle);
    return std::max(
        {squared_distance(piece[0], from), squared_distance(piece[1], from), squared_distance(piece[2], from)});
}

bool SurfaceDistance::reaches(const TriangleCorners& triangle) const
{
    std::vector<Piece> pieces{{triangle, sorted_.front()}};
    while (!pieces.empty()) {
        Piece piece = pieces.back();
        pieces.pop_back();
        if (squared_bound(piece.corners, piece.nearest) <= reach_ * reach_) continue;
        if (piece.radius < 2.0 * reach_) {
            const double enough = std::max(0.0, reach_ - piece.radius);
            const double distance = from(piece.middle, enough, piece.nearest);
            if (distance <= enough) continue;
            if (distance > reach_) return false;
            if (squared_bound(piece.corners, piece.nearest) <= reach_ * reach_) continue;
            if (piece.radius < MIN_PIECE_RADIUS * reach_) return false;
        }
        cut(piece, pieces);
    }
    return true;
}

double SurfaceDistance::farthest(const TriangleCorners& triangle, double& least) const
{
    double most = 0.0;
    std::vector<Piece> pieces{{triangle, sorted_.front()}};
    while (!pieces.empty()) {
        Piece piece = pieces.back();
        pieces.pop_back();
        if (squared_bound(piece.corners, piece.nearest) <= least * least) continue;
        if (piece.radius < 2.0 * reach_) {
            const double distance =
                std::min(reach_, from(piece.middle, std::max(0.0, least - piece.radius), piece.nearest));
            least = std::max(least, distance);
            const double bound =
                std::min(distance + piece.radius, std::sqrt(squared_bound(piece.corners, piece.nearest)));
            if (bound <= least || piece.radius <= MIN_PIECE_RADIUS * reach_) {
                most = std::max(most, std::min(reach_, bound));
                continue;
            }
        }
        cut(piece, pieces);
    }
    return most;
}

}  // namespace shvr
