// The procedural volume that reveals exchanged axes and mirror images.

#include <algorithm>

#include "engine/volume/procedural/procedural_kind.h"

namespace shvr {
namespace {

/// Intensities by group: background; arms along x, y and z; ball.
constexpr double INTENSITIES[] = {20.0, 200.0, 150.0, 100.0, 250.0};
constexpr uint8_t BALL_GROUP = 4;
/// Positions as fractions of the volume's size along each axis.
constexpr glm::dvec3 BALL(0.25, 0.3, 0.35);
constexpr glm::dvec3 ARM_ENDS(0.85, 0.7, 0.6);
/// Fraction of the volume's shortest side. The arms meet inside the ball, and are less than half as thick as the ball.
constexpr double ARM_RADIUS = 0.05;

class Chirality final : public ProceduralKind {
public:
    explicit Chirality(const Size3& size)
        : ball_(BALL * glm::dvec3(size)),
          ends_(ARM_ENDS * glm::dvec3(size)),
          arm_radius_(std::max(ARM_RADIUS * double(std::min({size.x, size.y, size.z})), 1.0))
    {}

    double value(const glm::dvec3& voxel) const override { return INTENSITIES[group(voxel)]; }
    bool has_gradient() const override { return false; }
    glm::dvec3 gradient(const glm::dvec3&) const override { return glm::dvec3(0.0); }

    std::optional<ProceduralTruth> truth() const override
    {
        ProceduralTruth truth;
        truth.group = [kind = *this](const glm::dvec3& voxel) { return kind.group(voxel); };
        truth.nodes.push_back({ball_, ball_radius(), BALL_GROUP});
        for (int axis = 0; axis < 3; ++axis) {
            glm::dvec3 end = ball_;
            end[axis] = ends_[axis];
            truth.nodes.push_back({end, arm_radius_, uint8_t(axis + 1)});
            truth.links.push_back({0, size_t(axis) + 1});
        }
        return truth;
    }

private:
    double ball_radius() const { return 2.0 * arm_radius_; }

    uint8_t group(const glm::dvec3& voxel) const
    {
        const glm::dvec3 offset = voxel - ball_;
        const auto is_within = [](const glm::dvec3& v, double radius) {
            return v.x * v.x + v.y * v.y + v.z * v.z <= radius * radius;
        };
        if (is_within(offset, ball_radius())) return BALL_GROUP;
        for (int axis = 0; axis < 3; ++axis) {
            glm::dvec3 from_arm = offset;
            from_arm[axis] -= std::clamp(offset[axis], 0.0, ends_[axis] - ball_[axis]);
            if (is_within(from_arm, arm_radius_)) return uint8_t(axis + 1);
        }
        return 0;
    }

    glm::dvec3 ball_, ends_;  ///< voxel coordinates; component i of `ends_` is where the arm along axis i ends
    double arm_radius_;       ///< voxels
};

}  // namespace

std::unique_ptr<ProceduralKind> make_chirality(const Size3& size, uint32_t)
{
    return std::make_unique<Chirality>(size);
}

}  // namespace shvr
