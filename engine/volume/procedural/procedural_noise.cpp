// The procedural volumes that are random everywhere: speckles and fog.

#include <array>
#include <cmath>
#include <vector>

#include "engine/volume/procedural/procedural_hash.h"
#include "engine/volume/procedural/procedural_kind.h"

namespace shvr {
namespace {

uint32_t bits_of(int64_t index)
{
    return uint32_t(uint64_t(index));
}

int64_t floor_of(double coordinate)
{
    return int64_t(std::floor(coordinate));
}

/// A quarter of all cells of 8^3 voxels, chosen at random, contain a ball. Balls stay a voxel away from the faces of
/// their cell, so that each is a component of its own. Lengths are in sixteenths of a voxel, so distances are exact.
class Speckles final : public ProceduralKind {
public:
    Speckles(const Size3& size, uint32_t seed) : size_(size), seed_(seed) {}

    double value(const glm::dvec3& voxel) const override
    {
        const Size3 cell(floor_of(voxel.x / CELL), floor_of(voxel.y / CELL), floor_of(voxel.z / CELL));
        const std::optional<Ball> ball = ball_in(cell);
        if (!ball) return BACKGROUND;
        double squared = 0.0;
        for (int axis = 0; axis < 3; ++axis) {
            const double offset = 16.0 * (voxel[axis] - CELL * double(cell[axis])) - ball->centre[axis];
            squared += offset * offset;
        }
        return squared <= ball->radius * ball->radius ? BALL : BACKGROUND;
    }
    bool has_gradient() const override { return false; }
    glm::dvec3 gradient(const glm::dvec3&) const override { return glm::dvec3(0.0); }

    /// Returns a node for each ball that lies entirely in the volume; null if the volume has more than MAX_CELLS cells.
    std::optional<ProceduralTruth> truth() const override
    {
        ProceduralTruth truth;
        truth.group = [kind = *this](const glm::dvec3& voxel) { return uint8_t(kind.value(voxel) == BALL); };
        const Size3 cells = (size_ + Size3(int64_t(CELL) - 1)) / int64_t(CELL);
        if (cells.x * cells.y > MAX_CELLS || cells.x * cells.y * cells.z > MAX_CELLS) return truth;
        for (int64_t z = 0; z < cells.z; ++z)
            for (int64_t y = 0; y < cells.y; ++y)
                for (int64_t x = 0; x < cells.x; ++x) {
                    const std::optional<Ball> ball = ball_in({x, y, z});
                    if (!ball) continue;
                    const glm::dvec3 centre = CELL * glm::dvec3(x, y, z) + ball->centre / 16.0;
                    const double radius = ball->radius / 16.0;
                    if (glm::all(glm::lessThanEqual(centre + radius, glm::dvec3(size_))))
                        truth.nodes.push_back({centre, radius, 1});
                }
        return truth;
    }

private:
    /// A ball, in sixteenths of a voxel; its centre is relative to the lower corner of its cell.
    struct Ball {
        glm::dvec3 centre;
        double radius;
    };
    std::optional<Ball> ball_in(const Size3& cell) const
    {
        const uint32_t hash = hash_of(seed_, bits_of(cell.x), bits_of(cell.y), bits_of(cell.z));
        if (hash % 4 != 0) return std::nullopt;
        const uint32_t radius = 15 + (hash >> 2) % 26;  // 0.94 ... 2.5 voxels
        const uint32_t room = 112 - 16 - 2 * radius + 1;
        Ball ball{.centre = {}, .radius = double(radius)};
        uint32_t bits = hash;
        for (int axis = 0; axis < 3; ++axis) {
            bits = mixed(bits + 1);
            ball.centre[axis] = double(16 + radius + bits % room);
        }
        return ball;
    }

    static constexpr int64_t MAX_CELLS = int64_t{1} << 20;
    static constexpr double CELL = 8.0;
    static constexpr double BACKGROUND = 20.0;
    static constexpr double BALL = 200.0;

    Size3 size_;
    uint32_t seed_;
};

double smooth(double t)
{
    return t * t * (3.0 - 2.0 * t);
}
double smooth_slope(double t)
{
    return 6.0 * t * (1.0 - t);
}
double mix(double a, double b, double t)
{
    return a + (b - a) * t;
}

/// Value noise in [0, 1): random values on a lattice, interpolated smoothly between lattice points.
class Octave {
public:
    Octave(uint32_t seed, double period) : seed_(seed), period_(period) {}

    struct Place {
        int64_t index;
        double fraction;
    };
    Place place(double coordinate) const
    {
        const double scaled = coordinate / period_;
        const double index = std::floor(scaled);
        return {int64_t(index), scaled - index};
    }

    /// Returns the value at lattice column `x`, interpolated along y and z.
    double column(int64_t x, const Place& y, const Place& z) const
    {
        const double wy = smooth(y.fraction);
        return mix(mix(corner(x, y.index, z.index), corner(x, y.index + 1, z.index), wy),
                   mix(corner(x, y.index, z.index + 1), corner(x, y.index + 1, z.index + 1), wy), smooth(z.fraction));
    }

    double value(const glm::dvec3& voxel) const
    {
        const Place x = place(voxel.x);
        const Place y = place(voxel.y);
        const Place z = place(voxel.z);
        return mix(column(x.index, y, z), column(x.index + 1, y, z), smooth(x.fraction));
    }

    glm::dvec3 gradient(const glm::dvec3& voxel) const
    {
        const std::array<Place, 3> places = {place(voxel.x), place(voxel.y), place(voxel.z)};
        glm::dvec3 sum(0.0);
        for (int i = 0; i < 8; ++i) {
            glm::dvec3 weight(0.0), slope(0.0);
            for (int axis = 0; axis < 3; ++axis) {
                const double fraction = places[size_t(axis)].fraction;
                const bool is_upper = (i >> axis & 1) != 0;
                weight[axis] = is_upper ? smooth(fraction) : 1.0 - smooth(fraction);
                slope[axis] = (is_upper ? 1.0 : -1.0) * smooth_slope(fraction);
            }
            const double value =
                corner(places[0].index + (i & 1), places[1].index + (i >> 1 & 1), places[2].index + (i >> 2 & 1));
            sum += value * glm::dvec3(slope.x * weight.y * weight.z, weight.x * slope.y * weight.z,
                                      weight.x * weight.y * slope.z);
        }
        return sum / period_;
    }

private:
    double corner(int64_t x, int64_t y, int64_t z) const
    {
        return unit_of(hash_of(seed_, bits_of(x), bits_of(y), bits_of(z)));
    }

    uint32_t seed_;
    double period_;  ///< in voxels: a power of two, so that fractions of it are exact
};

class Fog final : public ProceduralKind {
public:
    explicit Fog(uint32_t seed) : coarse_(seed, 32.0), fine_(seed + 1, 8.0) {}

    double value(const glm::dvec3& voxel) const override { return sum(coarse_.value(voxel), fine_.value(voxel)); }
    glm::dvec3 gradient(const glm::dvec3& voxel) const override
    {
        return COARSE * coarse_.gradient(voxel) + FINE * fine_.gradient(voxel);
    }

    class LatticeRows final : public Rows {
    public:
        LatticeRows(const Fog& kind, const VoxelBox& box)
            : kind_(kind), first_x_(box.lower.x), noise_(size_t(box.size().x))
        {}

        void evaluate(int64_t y, int64_t z, std::span<double> values) override
        {
            const glm::dvec2 yz(double(y) + 0.5, double(z) + 0.5);
            evaluate(kind_.coarse_, yz, noise_);
            evaluate(kind_.fine_, yz, values);
            for (size_t x = 0; x < values.size(); ++x) values[x] = sum(noise_[x], values[x]);
        }

    private:
        void evaluate(const Octave& octave, const glm::dvec2& yz, std::span<double> values) const
        {
            const Octave::Place y = octave.place(yz.x);
            const Octave::Place z = octave.place(yz.y);
            int64_t index = octave.place(double(first_x_) + 0.5).index;
            double left = octave.column(index, y, z);
            double right = octave.column(index + 1, y, z);
            for (size_t i = 0; i < values.size(); ++i) {
                const Octave::Place x = octave.place(double(first_x_ + int64_t(i)) + 0.5);
                if (x.index != index) {
                    index = x.index;
                    left = right;
                    right = octave.column(index + 1, y, z);
                }
                values[i] = mix(left, right, smooth(x.fraction));
            }
        }

        const Fog& kind_;
        int64_t first_x_;
        std::vector<double> noise_;
    };
    std::unique_ptr<Rows> rows(const VoxelBox& box) const override { return std::make_unique<LatticeRows>(*this, box); }

private:
    static constexpr double COARSE = 75.0;
    static constexpr double FINE = 25.0;

    static double sum(double coarse, double fine) { return 60.0 + COARSE * coarse + FINE * fine; }

    Octave coarse_;
    Octave fine_;
};

}  // namespace

std::unique_ptr<ProceduralKind> make_speckles(const Size3& size, uint32_t seed)
{
    return std::make_unique<Speckles>(size, seed);
}

std::unique_ptr<ProceduralKind> make_fog(const Size3&, uint32_t seed)
{
    return std::make_unique<Fog>(seed);
}

}  // namespace shvr
