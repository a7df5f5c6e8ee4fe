#pragma once
// Sessions that are wrong on purpose, which goldens must notice: golden_test.cpp draws each for the golden that it
// names, mutations_slow_test.cpp for every golden.

#include <cmath>
#include <functional>

#include "tools/golden/run.h"

namespace shvr::test {

struct Mutation {
    const char* name;
    const char* golden;  ///< one that must notice
    std::function<void(Session&, Camera&)> apply;
};

/// Moves the eye about the upward axis through the target.
inline void turn(Camera& camera, double degrees)
{
    const glm::dvec3 axis = glm::normalize(camera.up), arm = camera.eye - camera.target;
    const double angle = glm::radians(degrees), cosine = std::cos(angle);
    camera.eye = camera.target + arm * cosine + glm::cross(axis, arm) * std::sin(angle) +
                 axis * glm::dot(axis, arm) * (1.0 - cosine);
}

/// Moves the middle point by 2 % of the range, and pushes along the points that it would pass.
inline void move_a_point(Session& session)
{
    const std::span<const ControlPoint> old = session.transfer_function.points();
    std::vector<ControlPoint> points(old.begin(), old.end());
    const size_t middle = points.size() / 2;
    points[middle].intensity += 0.02 * (points.back().intensity - points.front().intensity);
    for (size_t i = middle + 1; i < points.size(); ++i)
        points[i].intensity = std::max(points[i].intensity, points[middle].intensity);
    session.transfer_function = TransferFunction(std::move(points));
}

inline const Mutation MUTATIONS[] = {
    {"steps twice as long", "step_fine", [](Session& session, Camera&) { session.render.step_voxels *= 2.0; }},
    {"steps 1 % longer", "step_coarse", [](Session& session, Camera&) { session.render.step_voxels *= 1.01; }},
    {"shading left out or put in", "tubes_opaque",
     [](Session& session, Camera&) { session.light.shaded = !session.light.shaded; }},
    {"rays stop at an opacity of 0.9", "fog_unshaded",
     [](Session& session, Camera&) { session.render.opacity_limit = 0.9; }},
    {"gradients fade later", "tubes_translucent",
     [](Session& session, Camera&) { session.light.gradient_fade *= 1.25; }},
    {"0.02 more ambient light", "tubes_opaque", [](Session& session, Camera&) { session.light.ambient += 0.02; }},
    {"a duller highlight", "tubes_opaque", [](Session& session, Camera&) { session.light.shininess *= 0.9; }},
    {"light from another side", "tubes_opaque",
     [](Session& session, Camera&) {
         session.light.direction = {0.3, 0.5, 0.9};
     }},
    {"the cut half a voxel off", "tubes_cut", [](Session& session, Camera&) { session.cut.lower += glm::dvec3(0.5); }},
    {"the camera 0.3 degrees off", "tubes_opaque", [](Session&, Camera& camera) { turn(camera, 0.3); }},
    {"a view 0.5 % higher", "tubes_opaque",
     [](Session&, Camera& camera) {
         camera.fov_y_degrees *= 1.005;
         camera.height *= 1.005;
     }},
    {"the near plane left out", "sphere_orthographic", [](Session&, Camera& camera) { camera.near_distance = 0.0; }},
    {"a point of the transfer function 2 % off", "step_fine", [](Session& session, Camera&) { move_a_point(session); }},
    {"the background opaque", "background_alpha", [](Session& session, Camera&) { session.render.background.a = 1.0; }},
    {"hidden groups shown", "painted",
     [](Session& session, Camera&) {
         for (auto& [group, look] : session.groups) look.visible = true;
     }},
    {"groups forgotten", "painted", [](Session& session, Camera&) { session.groups.clear(); }},
    {"the probe left out", "surfaces", [](Session& session, Camera&) { session.probe.shown = false; }},
    {"surfaces half a voxel off", "surfaces",
     [](Session& session, Camera&) {
         for (SurfaceLook& surface : session.surfaces) surface.from.x += 0.5;
     }},
    {"surfaces a quarter of a voxel thicker", "surfaces",
     [](Session& session, Camera&) {
         for (SurfaceLook& surface : session.surfaces) surface.radius_to += 0.25;
     }},
};

/// Why the picture of a golden with this mutation is not the blessed one; null where it passes.
inline std::optional<std::string> why_noticed(const Mutation& mutation, const golden::Golden& one,
                                              golden::Studio& studio, const Image8& blessed)
{
    Session session = studio.session();
    Camera camera = studio.camera();
    mutation.apply(session, camera);
    studio.renderer().scene().set_surfaces(session.surfaces);
    return golden::why_different(studio.draw(session, camera), blessed, one.strictness);
}

}  // namespace shvr::test
