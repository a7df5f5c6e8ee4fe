// Tubes like the vascular bundles of a stem: eight curved tubes that fan out from bottom to top, and five thinner
// branches. Centre lines are cubic Bezier curves split into short straight segments; a tube is everything within its
// radius of its centre line. The noise is one random number per voxel, constant within the voxel.

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "engine/volume/procedural/procedural_hash.h"
#include "engine/volume/procedural/procedural_kind.h"
#include "engine/volume/procedural/tubes_truth.h"

namespace shvr {
namespace {

constexpr double BACKGROUND = 40.0;
constexpr double TUBE = 220.0;
constexpr double NOISE_DEVIATION = 0.03 * (TUBE - BACKGROUND);
constexpr uint32_t BUNDLES = 8;
constexpr uint32_t BRANCHES = 5;

/// Returns approximately normal noise: the sum of a hash's four bytes has mean 510 and variance 4 (256^2 - 1) / 12.
double noise_of(uint32_t hash)
{
    constexpr double DEVIATION = 147.8016689;
    const uint32_t sum = (hash & 0xffu) + (hash >> 8 & 0xffu) + (hash >> 16 & 0xffu) + (hash >> 24);
    return (double(sum) - 510.0) * (NOISE_DEVIATION / DEVIATION);
}

/// Converts the signed distance from the nearest tube's surface to an intensity. The edge is two voxels wide.
double profile(double distance)
{
    const double t = std::clamp(0.5 * (1.0 - distance), 0.0, 1.0);
    return BACKGROUND + (TUBE - BACKGROUND) * (t * t * (3.0 - 2.0 * t));
}

double profile_slope(double distance)
{
    const double t = std::clamp(0.5 * (1.0 - distance), 0.0, 1.0);
    return (TUBE - BACKGROUND) * -3.0 * t * (1.0 - t);
}

struct Segment {
    glm::dvec3 begin, along;
    double inverse_length_squared;
    double radius;
    glm::dvec3 lower, upper;  ///< outside this box, the segment has no influence

    Segment(const glm::dvec3& from, const glm::dvec3& to, double tube_radius)
        : begin(from), along(to - from), inverse_length_squared(1.0 / glm::dot(along, along)), radius(tube_radius)
    {
        const double reach = radius + 1.01;
        lower = glm::min(from, to) - reach;
        upper = glm::max(from, to) + reach;
    }

    bool is_near(const glm::dvec3& p) const
    {
        return p.x >= lower.x && p.x <= upper.x && p.y >= lower.y && p.y <= upper.y && p.z >= lower.z && p.z <= upper.z;
    }
    /// Returns the vector from the nearest point of the centre line to `p`.
    glm::dvec3 offset(const glm::dvec3& p) const
    {
        const glm::dvec3 d = p - begin;
        const double t = (d.x * along.x + d.y * along.y + d.z * along.z) * inverse_length_squared;
        return d - along * std::clamp(t, 0.0, 1.0);
    }
    double distance(const glm::dvec3& p) const
    {
        const glm::dvec3 d = offset(p);
        return std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z) - radius;
    }
};

/// Control points in the volume's unit cube [0,1]^3. The end points lie slightly outside of it.
using Bezier = std::array<glm::dvec3, 4>;

glm::dvec3 point_on(const Bezier& c, double t)
{
    const double s = 1.0 - t;
    return c[0] * (s * s * s) + c[1] * (3.0 * s * s * t) + c[2] * (3.0 * s * t * t) + c[3] * (t * t * t);
}

class Tubes final : public ProceduralKind {
public:
    Tubes(const Size3& size, uint32_t seed) : size_(size), seed_(seed) { make_segments(); }

    double value(const glm::dvec3& voxel) const override
    {
        const glm::dvec3 index = glm::floor(voxel);
        const uint32_t hash =
            hash_of(seed_, uint32_t(int64_t(index.x)), uint32_t(int64_t(index.y)), uint32_t(int64_t(index.z)));
        double nearest = 1.0;
        for (const Segment& segment : segments_) {
            if (segment.is_near(voxel)) nearest = std::min(nearest, segment.distance(voxel));
        }
        return profile(nearest) + noise_of(hash);
    }

    /// Excludes the noise from the gradient: noise is constant within a voxel and jumps at the voxel's faces.
    glm::dvec3 gradient(const glm::dvec3& voxel) const override
    {
        double nearest = 1.0;
        const Segment* owner = nullptr;
        for (const Segment& segment : segments_) {
            if (!segment.is_near(voxel)) continue;
            const double distance = segment.distance(voxel);
            if (distance < nearest) {
                nearest = distance;
                owner = &segment;
            }
        }
        if (owner == nullptr) return glm::dvec3(0.0);
        const glm::dvec3 offset = owner->offset(voxel);
        const double length = glm::length(offset);
        return length > 0.0 ? offset * (profile_slope(nearest) / length) : glm::dvec3(0.0);
    }

    /// Evaluates only those segments that come near the row. Elsewhere in the row there is only noise.
    class BinnedRows final : public Rows {
    public:
        BinnedRows(const Tubes& kind, const VoxelBox& box)
            : kind_(kind), first_x_(box.lower.x), first_z_(box.lower.z), near_(size_t(box.size().z))
        {
            for (size_t slice = 0; slice < near_.size(); ++slice) {
                const double z = double(first_z_ + int64_t(slice)) + 0.5;
                for (const Segment& segment : kind_.segments_) {
                    if (z >= segment.lower.z && z <= segment.upper.z) near_[slice].push_back(&segment);
                }
            }
        }

        void evaluate(int64_t y, int64_t z, std::span<double> values) override
        {
            glm::dvec3 p(0.0, double(y) + 0.5, double(z) + 0.5);
            std::fill(values.begin(), values.end(), 1.0);
            const auto width = int64_t(values.size());
            int64_t begin = width;
            int64_t end = 0;
            for (const Segment* segment : near_[size_t(z - first_z_)]) {
                if (p.y < segment->lower.y || p.y > segment->upper.y) continue;
                const auto first = std::max<int64_t>(0, int64_t(segment->lower.x) - first_x_);
                const auto last = std::min<int64_t>(width - 1, int64_t(segment->upper.x) - first_x_);
                for (int64_t x = first; x <= last; ++x) {
                    p.x = double(first_x_ + x) + 0.5;
                    double& nearest = values[size_t(x)];
                    nearest = std::min(nearest, segment->distance(p));
                }
                begin = std::min(begin, first);
                end = std::max(end, last + 1);
            }
            const uint32_t row = row_hash(kind_.seed_, uint32_t(y), uint32_t(z));
            for (int64_t x = 0; x < width; ++x) {
                double& value = values[size_t(x)];
                value = x >= begin && x < end ? profile(value) : BACKGROUND;
                value += noise_of(mixed(uint32_t(first_x_ + x) ^ row));
            }
        }

    private:
        const Tubes& kind_;
        int64_t first_x_;
        int64_t first_z_;
        std::vector<std::vector<const Segment*>> near_;  ///< by slice of the box
    };
    std::unique_ptr<Rows> rows(const VoxelBox& box) const override { return std::make_unique<BinnedRows>(*this, box); }

    /// Like BinnedRows, but tubes are at least MIN_THICKNESS voxels of the coarser level thick.
    class CoarseRows final : public Rows {
    public:
        CoarseRows(const Tubes& kind, double side, const Size3& size, int64_t first_x)
            : kind_(kind), side_(side), size_(size), first_x_(first_x)
        {}

        void evaluate(int64_t y, int64_t z, std::span<double> values) override
        {
            const auto x_of = [&](size_t x) {
                return std::min(side_ * (double(first_x_ + int64_t(x)) + 0.5), size_.x);
            };
            glm::dvec3 p(0.0, std::min(side_ * (double(y) + 0.5), size_.y),
                         std::min(side_ * (double(z) + 0.5), size_.z));
            std::fill(values.begin(), values.end(), 1.0);
            for (const Segment& segment : kind_.segments_) {
                const double thicker = std::max(0.0, 0.5 * MIN_THICKNESS * side_ - segment.radius);
                if (p.y < segment.lower.y - thicker || p.y > segment.upper.y + thicker) continue;
                if (p.z < segment.lower.z - thicker || p.z > segment.upper.z + thicker) continue;
                for (size_t x = 0; x < values.size(); ++x) {
                    p.x = x_of(x);
                    if (p.x < segment.lower.x - thicker || p.x > segment.upper.x + thicker) continue;
                    values[x] = std::min(values[x], segment.distance(p) - thicker);
                }
            }
            for (size_t x = 0; x < values.size(); ++x) {
                const uint32_t hash =
                    hash_of(kind_.seed_, uint32_t(int64_t(x_of(x))), uint32_t(int64_t(p.y)), uint32_t(int64_t(p.z)));
                values[x] = profile(values[x]) + noise_of(hash);
            }
        }

    private:
        static constexpr double MIN_THICKNESS = 1.5;
        const Tubes& kind_;
        double side_;
        glm::dvec3 size_;
        int64_t first_x_;
    };
    std::unique_ptr<Rows> coarse_rows(double side, const Size3& size, const VoxelBox& box) const override
    {
        return std::make_unique<CoarseRows>(*this, side, size, box.lower.x);
    }

    std::optional<ProceduralTruth> truth() const override { return truth_of_tubes(strands_, size_); }

private:
    /// Returns the n-th random number of a tube, from -1 to 1.
    double random(uint32_t tube, uint32_t n) const
    {
        return 2.0 * unit_of(hash_of(seed_ ^ 0x5eed70beu, n, tube, 0)) - 1.0;
    }

    void make_segments();
    void add_tube(const Bezier& curve, double radius, std::optional<size_t> parent = {});

    Size3 size_;
    uint32_t seed_;
    std::vector<Segment> segments_;
    std::vector<TubeStrand> strands_;  ///< centre lines of `segments_`
};

void Tubes::make_segments()
{
    constexpr double DIAGONAL = 0.70710678118654752;
    constexpr std::array<glm::dvec2, BUNDLES> OUTWARD = {{{1.0, 0.0},
                                                          {DIAGONAL, DIAGONAL},
                                                          {0.0, 1.0},
                                                          {-DIAGONAL, DIAGONAL},
                                                          {-1.0, 0.0},
                                                          {-DIAGONAL, -DIAGONAL},
                                                          {0.0, -1.0},
                                                          {DIAGONAL, -DIAGONAL}}};
    constexpr std::array<double, BUNDLES> THICKNESS = {3, 6, 1, 4, 7, 0, 5, 2};
    constexpr double BOTTOM = -0.02;
    constexpr double TOP = 1.02;
    const auto inside = [](double x, double y, double z) {
        return glm::dvec3(std::clamp(x, 0.06, 0.94), std::clamp(y, 0.06, 0.94), z);
    };
    // Radii are 2 to 6 voxels for a shortest side of 128 voxels, and grow with the fourth root of that side.
    const double scale = std::sqrt(std::sqrt(double(std::min({size_.x, size_.y, size_.z})) / 128.0));
    std::array<Bezier, BUNDLES> bundles;
    std::array<double, BUNDLES> radii{};
    for (uint32_t i = 0; i < BUNDLES; ++i) {
        const auto r = [&](uint32_t n) { return random(i, n); };
        const glm::dvec2 low = 0.5 + OUTWARD[i] * (0.17 + 0.05 * r(0));
        const glm::dvec2 high = 0.5 + OUTWARD[i] * (0.33 + 0.08 * r(1)) + 0.05 * glm::dvec2(r(2), r(3));
        bundles[i] = {inside(low.x, low.y, BOTTOM), inside(low.x + 0.2 * r(4), low.y + 0.2 * r(5), 0.327),
                      inside(high.x + 0.25 * r(6), high.y + 0.25 * r(7), 0.673), inside(high.x, high.y, TOP)};
        radii[i] = std::max(1.0, scale * (2.0 + 4.0 * (THICKNESS[i] + 0.5 + 0.5 * r(8)) / BUNDLES));
        add_tube(bundles[i], radii[i]);
    }
    for (uint32_t j = 0; j < BRANCHES; ++j) {
        const uint32_t parent = (3 * j + 1) % BUNDLES;
        const auto r = [&](uint32_t n) { return random(BUNDLES + j, n); };
        const glm::dvec3 from = point_on(bundles[parent], 0.4 + 0.2 * r(0));
        const glm::dvec2 outward = OUTWARD[(parent + (r(1) > 0.0 ? 1 : BUNDLES - 1)) % BUNDLES];
        const glm::dvec2 high = 0.5 + outward * (0.25 + 0.2 * r(2));
        const glm::dvec3 to = inside(high.x, high.y, TOP);
        const auto between = [&](double share, uint32_t n) {
            const glm::dvec3 point = from + (to - from) * share;
            return inside(point.x + 0.1 * r(n), point.y + 0.1 * r(n + 1), point.z);
        };
        add_tube({from, between(0.333, 3), between(0.667, 5), to}, std::max(1.0, radii[parent] * (0.65 + 0.1 * r(7))),
                 parent);
    }
}

void Tubes::add_tube(const Bezier& curve, double radius, std::optional<size_t> parent)
{
    TubeStrand& strand = strands_.emplace_back(TubeStrand{.radius = radius, .parent = parent});
    const auto pieces = std::clamp<int64_t>(std::max({size_.x, size_.y, size_.z}) / 8, 8, 256);
    glm::dvec3 from = curve[0] * glm::dvec3(size_);
    strand.points.push_back(from);
    for (int64_t piece = 1; piece <= pieces; ++piece) {
        const glm::dvec3 to = point_on(curve, double(piece) / double(pieces)) * glm::dvec3(size_);
        segments_.emplace_back(from, to, radius);
        strand.points.push_back(to);
        from = to;
    }
}

}  // namespace

std::unique_ptr<ProceduralKind> make_tubes(const Size3& size, uint32_t seed)
{
    return std::make_unique<Tubes>(size, seed);
}

}  // namespace shvr
