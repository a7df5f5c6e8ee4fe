#pragma once
// Actions on the probe.

#include "engine/workbench/actions/action_row.h"

namespace shvr::ui {

class Prober;

/// Limits of the probe's radius in the interface, in voxels along x. Sessions and scripts may use other radii.
inline constexpr double MIN_RADIUS_VOXELS = 0.5, MAX_RADIUS_VOXELS = 60.0;

struct ProbeTo {  ///< moves the probe to the mouse, within the plane through the probe that is parallel to the screen
    size_t pane = 0;
    glm::dvec2 pixel{0.0};
    bool jumps = false;   ///< true: a stroke in progress does not paint between the old and the new position
    bool hovers = false;  ///< true: slices stay where they are; false: they go through the new position
};

/// Moves the probe onto the visible structure: to the steepest rise of opacity along the ray (Renderer::pick).
struct ProbeOnto {
    size_t pane = 0;
    glm::dvec2 pixel{0.0};
};

/// Moves the probe to the mouse, on the visible surface. While a stroke is open, the probe's depth may change by no
/// more than its radius plus its motion across the picture, so that the stroke stays on the surface where it began. If
/// nothing is visible at the mouse, the depth stays.
struct ProbeAlong {
    size_t pane = 0;
    glm::dvec2 pixel{0.0};
    bool jumps = false;
    bool hovers = false;  ///< as for ProbeTo
};

/// Moves the probe, and the slices with it, by voxels in the directions of a pane's view: away from the viewer, right,
/// up.
struct PushProbe {
    size_t pane = 0;
    double voxels = 0.0, right = 0.0, up = 0.0;
};

struct PlaceProbe {  ///< extends an open stroke
    glm::dvec3 voxel{0.0};
    bool jumps = false;   ///< the stroke paints nothing in between
    bool hovers = false;  ///< as for ProbeTo
};

struct ScaleProbe {
    double factor = 1.0;
};

inline constexpr const char* PROBE_GROUP = "Probe";

inline constexpr auto PROBE_ACTIONS =
    std::tuple{row<ProbeTo, Prober>(
                   {"probe_to", "Move the probe", PROBE_GROUP, "moves the probe to a pixel of a pane, in its plane"},
                   [](auto& f, ProbeTo& a) {
                       pane_field(f, a.pane);
                       pixel_field(f, "pixel", a.pixel);
                       f.flag("jumps", a.jumps, {});
                       f.flag("hovers", a.hovers, {});
                   }),
               row<ProbeOnto, Prober>({"probe_onto", "Put the probe onto the surface", PROBE_GROUP,
                                       "moves the probe onto the surface seen at a pixel of a pane"},
                                      [](auto& f, ProbeOnto& a) {
                                          pane_field(f, a.pane);
                                          pixel_field(f, "pixel", a.pixel);
                                      }),
               row<ProbeAlong, Prober>({"probe_along", "Move the probe along the surface", PROBE_GROUP,
                                        "moves the probe along the visible surface, as a stroke does"},
                                       [](auto& f, ProbeAlong& a) {
                                           pane_field(f, a.pane);
                                           pixel_field(f, "pixel", a.pixel);
                                           f.flag("jumps", a.jumps, {});
                                           f.flag("hovers", a.hovers, {});
                                       }),
               row<PushProbe, Prober>({"push_probe", "Push the probe", PROBE_GROUP,
                                       "moves the probe away from the viewer of a pane, to the right and up"},
                                      [](auto& f, PushProbe& a) {
                                          pane_field(f, a.pane);
                                          f.number("voxels", a.voxels, VOXELS, {"away"});
                                          f.number("right", a.right, VOXELS, {});
                                          f.number("up", a.up, VOXELS, {});
                                      }),
               row<PlaceProbe, Prober>({"place_probe", "Place the probe", PROBE_GROUP, "moves the probe to a voxel"},
                                       [](auto& f, PlaceProbe& a) {
                                           f.vector("voxel", a.voxel, VOXELS, {.is_required = true});
                                           f.flag("jumps", a.jumps, {});
                                           f.flag("hovers", a.hovers, {});
                                       }),
               row<ScaleProbe, Prober>(
                   {"scale_probe", "Resize the probe", PROBE_GROUP, "scales the probe and its brush by a factor"},
                   [](auto& f, ScaleProbe& a) { f.number("factor", a.factor, FACTOR, {.is_required = true}); })};

}  // namespace shvr::ui
