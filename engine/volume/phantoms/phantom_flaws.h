#pragma once
// Flaws of scanners and samples, as functions of the position. Any thread may call these.

#include "engine/volume/phantoms/phantom.h"

namespace shvr {

class FlawedIntensity {
public:
    FlawedIntensity(const PhantomFlaws& flaws, const Size3& size, uint32_t seed);

    /// Returns the value that a scan has at the centre of a voxel whose true intensity is `intensity`.
    double operator()(double intensity, const glm::dvec3& voxel) const;

private:
    double with_specks(double intensity, const glm::dvec3& voxel) const;
    double rings(const glm::dvec3& voxel) const;
    double streaks(const glm::dvec3& voxel) const;

    struct Streak {
        glm::dvec3 through;
        glm::dvec2 across;  ///< unit vector
    };
    PhantomFlaws flaws_;
    glm::dvec3 centre_;
    double radius_;  ///< in voxels: half of the shorter side of a slice
    uint32_t seed_;
    std::vector<Streak> streaks_;
};

}  // namespace shvr
