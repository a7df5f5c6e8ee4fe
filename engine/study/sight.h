#pragma once
// What an annotator sees: orthographic pictures from a few stated directions, in which surfaces at the transfer
// function's threshold hide what lies behind them; and how far off the eye takes a visible place to be.

#include <optional>

#include "engine/study/hand.h"
#include "engine/study/scene.h"

namespace shvr {

/// A direction from which the section is seen: along x, y or z or half-way between. All of it fits the picture.
struct StudyView {
    glm::dvec3 to_eye{0.0, -1.0, 0.0};  ///< unit vector from the volume to the eye
    glm::dvec3 right{1.0, 0.0, 0.0};    ///< unit vector in the picture
    glm::dvec3 up() const { return glm::cross(to_eye, right); }
};
/// The views that annotators use, the first one first: from the front, as in figure 6.2 of the thesis, from below, as
/// in figure 6.7, from behind and from both sides; never from above, where the florets are.
std::span<const StudyView> study_views();

class StudySight {
public:
    StudySight(const StudyScene& scene, const HandTraits& traits) : scene_(scene), traits_(traits) {}

    /// Whether the surface of a bundle is visible at a place of its axis: no other surface lies between the eye and the
    /// bundle. `radius`: of the bundle, voxels.
    bool shows(const StudyView& view, const glm::dvec3& voxel, double radius) const;
    /// Whether a place on a surface is visible: nothing lies in front of it.
    bool shows_surface_at(const StudyView& view, const glm::dvec3& voxel) const { return shows(view, voxel, 1.0); }
    /// Returns the number of the view in which most of the places are visible, the present one if that is as good.
    size_t best_view(size_t present, std::span<const glm::dvec3> voxels, double radius) const;
    double visible_share(const StudyView& view, std::span<const glm::dvec3> voxels, double radius) const;
    /// Returns how far off a place is taken to be, voxels: more along the line of sight than across it.
    glm::dvec3 error_of_glance(const StudyView& view, StudyRandom& random) const;

private:
    const StudyScene& scene_;
    HandTraits traits_;
};

}  // namespace shvr
