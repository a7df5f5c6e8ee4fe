#pragma once
// Lines over a picture: outlines of the volume and of the main camera's frustum in maps, the positions of slices, and
// the probe if it is hidden or out of sight. They are computed once, as straight strokes in pixels. The window draws
// these with its own renderer; `draw_strokes` draws them into image files. Pure functions; any thread.

#include <optional>
#include <span>
#include <vector>

#include "engine/base/image.h"
#include "engine/look/panes.h"
#include "engine/look/settings.h"

namespace shvr {

struct Stroke {
    glm::dvec2 from{0.0}, to{0.0};  ///< in pixels of the pane, y down, pixel centres at + 0.5
    glm::dvec3 color{1.0};          ///< linear light
    double width = 1.5;             ///< pixels
    bool has_flat_ends = false;     ///< ends at `from` and `to`; else round ends lie around these
};

/// The objects from which strokes are made.
struct OverlayScene {
    Camera main;                ///< the main camera, whose frustum is drawn in maps
    glm::uvec2 main_pixels{1};  ///< size of the main pane
    struct Probe {
        glm::dvec3 center{0.0};   ///< volume space
        double radius = 1.0;      ///< physical units
        glm::dvec3 color{1.0};    ///< linear light
        bool is_outlined = true;  ///< draws the probe's silhouette
        bool has_arrow = true;    ///< draws an arrow towards the probe if it is out of sight
    };
    Probe probe;
    std::optional<glm::dvec3> cross{};  ///< where the slices meet, in volume space; null: at the probe
    /// Highlighted parts of the trace: nodes as rings, internodes as lines along their axes.
    struct Ball {
        glm::dvec3 center{0.0};  ///< volume space
        double radius = 1.0;     ///< physical units
        glm::dvec3 color{1.0};   ///< linear light
    };
    struct Line {
        glm::dvec3 from{0.0}, to{0.0};
        glm::dvec3 color{1.0};
    };
    std::vector<Ball> balls{};
    std::vector<Line> lines{};
    /// The box, in volume space, that remains after cutting; its edges are drawn.
    struct Box {
        glm::dvec3 lower{0.0}, upper{0.0};
    };
    std::optional<Box> box{};
};
/// Returns what pictures draw lines of: all but the probe. `main_pixels`: the size of the main pane.
OverlayScene overlay_of(const ViewSettings& view, const CutBox& cut, const Camera& main, const glm::uvec2& main_pixels,
                        const glm::dvec3& probe_voxel, const VolumeInfo& volume);
/// Returns the part of a volume that remains after cutting.
OverlayScene::Box box_of(const CutBox& cut, const VolumeInfo& volume);

std::vector<Stroke> strokes_of(const Pane& pane, const OverlayScene& scene, const VolumeInfo& volume);

/// Returns the silhouette of a ball as a closed line: the circle in which lines from the eye touch the ball. Empty if
/// the eye is inside the ball, or if any part of the ball is level with or behind the eye.
std::vector<glm::dvec2> silhouette_of(const Camera& camera, const glm::uvec2& pixels, const glm::dvec3& center,
                                      double radius);

/// Draws anti-aliased strokes over premultiplied light. `pane`: the part of the picture in which stroke coordinates
/// count and to which strokes are clipped. `image` holds some or all rows of the picture, from `first_row` on.
void draw_strokes(ImageF& image, std::span<const Stroke> strokes, const PixelBox& pane, uint32_t first_row = 0);
/// Likewise, but over a screen's opaque pixels.
void draw_strokes(Image8& image, std::span<const Stroke> strokes, const PixelBox& pane);

}  // namespace shvr
