// The procedural volumes that use no random numbers.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "engine/volume/procedural/procedural_kind.h"
#include "engine/volume/procedural/turns.h"

namespace shvr {
namespace {

constexpr double FULL = 250.0;
constexpr double PI = std::numbers::pi;

class Constant final : public ProceduralKind {
public:
    double value(const glm::dvec3&) const override { return 128.0; }
    glm::dvec3 gradient(const glm::dvec3&) const override { return glm::dvec3(0.0); }
};

class Ramp final : public ProceduralKind {
public:
    explicit Ramp(const Size3& size) : last_(double(size.x - 1)) {}

    double value(const glm::dvec3& voxel) const override
    {
        return last_ > 0.0 ? FULL * std::clamp(voxel.x - 0.5, 0.0, last_) / last_ : 0.0;
    }
    glm::dvec3 gradient(const glm::dvec3& voxel) const override
    {
        const bool is_inside = voxel.x >= 0.5 && voxel.x <= last_ + 0.5 && last_ > 0.0;
        return {is_inside ? FULL / last_ : 0.0, 0.0, 0.0};
    }

private:
    double last_;  ///< index
};

class Sphere final : public ProceduralKind {
public:
    explicit Sphere(const Size3& size)
        : centre_(0.5 * glm::dvec3(size)),
          radius_(0.35 * double(std::min({size.x, size.y, size.z}))),
          slope_(1000.0 / double(std::min({size.x, size.y, size.z})))
    {}

    double value(const glm::dvec3& voxel) const override { return std::clamp(unclamped(voxel), 0.0, FULL); }
    glm::dvec3 gradient(const glm::dvec3& voxel) const override
    {
        const double ramp = unclamped(voxel);
        if (ramp < 0.0 || ramp > FULL) return glm::dvec3(0.0);
        return -slope_ * glm::normalize(voxel - centre_);
    }

private:
    double unclamped(const glm::dvec3& voxel) const
    {
        const glm::dvec3 offset = voxel - centre_;
        return 125.0 + (radius_ - std::sqrt(offset.x * offset.x + offset.y * offset.y + offset.z * offset.z)) * slope_;
    }

    glm::dvec3 centre_;
    double radius_;
    double slope_;
};

/// The test signal of Marschner and Lobb, "An evaluation of reconstruction filters for volume rendering", 1994.
class MarschnerLobb final : public ProceduralKind {
public:
    explicit MarschnerLobb(const Size3& size) : scale_(2.0 / glm::dvec3(size)) {}

    double value(const glm::dvec3& voxel) const override { return sum(ring(voxel.x, voxel.y), wave(voxel.z)); }
    glm::dvec3 gradient(const glm::dvec3& voxel) const override
    {
        const glm::dvec3 p = scale_ * voxel - 1.0;
        const double radius = std::sqrt(p.x * p.x + p.y * p.y);
        const glm::dvec2 bend = direction_of(0.25 * radius);
        const double ring_slope = ALPHA * direction_of(FREQUENCY * bend.x).y * PI * PI * FREQUENCY * bend.y;
        const glm::dvec2 outward = radius > 0.0 ? glm::dvec2(p) / radius : glm::dvec2(0.0);
        const glm::dvec3 slope(ring_slope * outward, -0.5 * PI * direction_of(0.25 * p.z).x);
        return FULL / (2.0 * (1.0 + ALPHA)) * slope * scale_;
    }

    /// Precomputes the part that depends only on x and y, which is equal in every slice.
    class PlaneRows final : public Rows {
    public:
        PlaneRows(const MarschnerLobb& kind, const VoxelBox& box)
            : kind_(kind), first_x_(box.lower.x), rings_(size_t(box.size().x))
        {}

        void evaluate(int64_t y, int64_t z, std::span<double> values) override
        {
            if (y != y_) {
                for (size_t x = 0; x < rings_.size(); ++x) {
                    rings_[x] = kind_.ring(double(first_x_ + int64_t(x)) + 0.5, double(y) + 0.5);
                }
                y_ = y;
            }
            const double wave = kind_.wave(double(z) + 0.5);
            for (size_t x = 0; x < rings_.size(); ++x) values[x] = kind_.sum(rings_[x], wave);
        }

    private:
        const MarschnerLobb& kind_;
        int64_t first_x_;
        int64_t y_ = -1;
        std::vector<double> rings_;
    };
    std::unique_ptr<Rows> rows(const VoxelBox& box) const override { return std::make_unique<PlaneRows>(*this, box); }

private:
    static constexpr double FREQUENCY = 6.0;
    static constexpr double ALPHA = 0.25;

    double ring(double x, double y) const
    {
        const double px = scale_.x * x - 1.0;
        const double py = scale_.y * y - 1.0;
        const double radius = std::sqrt(px * px + py * py);
        return ALPHA * (1.0 + direction_of(FREQUENCY * direction_of(0.25 * radius).x).x);
    }
    double wave(double z) const { return 1.0 - direction_of(0.25 * (scale_.z * z - 1.0)).y; }
    double sum(double ring, double wave) const { return FULL * ((wave + ring) / (2.0 * (1.0 + ALPHA))); }

    glm::dvec3 scale_;  ///< voxel -> [-1,1]
};

/// A checkerboard of voxels; between voxel centres, values are interpolated trilinearly.
class Checker final : public ProceduralKind {
public:
    double value(const glm::dvec3& voxel) const override
    {
        return 125.0 - 75.0 * (wave(voxel.x).value * wave(voxel.y).value * wave(voxel.z).value);
    }
    glm::dvec3 gradient(const glm::dvec3& voxel) const override
    {
        const Wave x = wave(voxel.x);
        const Wave y = wave(voxel.y);
        const Wave z = wave(voxel.z);
        return -75.0 *
               glm::dvec3(x.slope * y.value * z.value, x.value * y.slope * z.value, x.value * y.value * z.slope);
    }

private:
    struct Wave {
        double value, slope;
    };
    /// A triangle wave: 1 at the centres of even voxels, -1 at the centres of odd ones.
    static Wave wave(double coordinate)
    {
        const double centre = std::floor(coordinate - 0.5);
        const double fraction = coordinate - 0.5 - centre;
        const bool is_even = (int64_t(centre) & 1) == 0;
        return is_even ? Wave{1.0 - 2.0 * fraction, -2.0} : Wave{2.0 * fraction - 1.0, 2.0};
    }
};

}  // namespace

std::unique_ptr<ProceduralKind> make_constant(const Size3&, uint32_t)
{
    return std::make_unique<Constant>();
}

std::unique_ptr<ProceduralKind> make_ramp(const Size3& size, uint32_t)
{
    return std::make_unique<Ramp>(size);
}

std::unique_ptr<ProceduralKind> make_sphere(const Size3& size, uint32_t)
{
    return std::make_unique<Sphere>(size);
}

std::unique_ptr<ProceduralKind> make_marschner_lobb(const Size3& size, uint32_t)
{
    return std::make_unique<MarschnerLobb>(size);
}

std::unique_ptr<ProceduralKind> make_checker(const Size3&, uint32_t)
{
    return std::make_unique<Checker>();
}

}  // namespace shvr
