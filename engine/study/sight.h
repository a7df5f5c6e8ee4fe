#pragma once
// What an annotator sees: orthographic pictures from a few fixed directions, in which surfaces at the transfer
// function's threshold hide everything behind them; and the error with which the eye locates a visible place.

#include <optional>

#include "engine/study/hand.h"
#include "engine/study/scene.h"

namespace shvr {

/// A direction of view: along x, y or z, or half-way between two of these. The whole section fits into the picture.
struct StudyView {
    glm::dvec3 to_eye{0.0, -1.0, 0.0};  ///< unit vector from the volume to the eye
    glm::dvec3 right{1.0, 0.0, 0.0};    ///< unit vector in the picture
    glm::dvec3 up() const { return glm::cross(to_eye, right); }
};
/// The views that annotators use; they start with the first. From the front, from below, as figure 6.7 of the thesis
/// shows the section, from behind and from both sides. Never from above, where florets hide the section.
std::span<const StudyView> study_views();

class StudySight {
public:
    StudySight(const StudyScene& scene, const HandTraits& traits) : scene_(scene), traits_(traits) {}

    /// Whether a bundle's surface is visible next to a point of its axis: no other surface lies between eye and bundle.
    /// `radius`: radius of the bundle, voxels.
    bool shows(const StudyView& view, const glm::dvec3& voxel, double radius) const;
    /// Whether a point on a surface is visible: no other surface lies in front of it.
    bool shows_surface_at(const StudyView& view, const glm::dvec3& voxel) const { return shows(view, voxel, 1.0); }
    /// Returns the index of the view in which most of the places are visible; `present` if no other view is better.
    size_t best_view(size_t present, std::span<const glm::dvec3> voxels, double radius) const;
    double visible_share(const StudyView& view, std::span<const glm::dvec3> voxels, double radius) const;
    /// Returns a random error, in voxels, of where the eye sees a place: larger along the line of sight than across it.
    glm::dvec3 error_of_glance(const StudyView& view, StudyRandom& random) const;

private:
    const StudyScene& scene_;
    HandTraits traits_;
};

}  // namespace shvr
