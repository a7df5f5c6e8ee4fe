#pragma once
// Lines over a picture: where the camera of an overview looks, where slices cut, and the probe where something hides it
// or where it is out of sight. Made once, as straight strokes in pixels; the window draws them with its own means,
// pictures in files with `draw_strokes`. Pure; any thread.

#include <span>
#include <vector>

#include "engine/base/image.h"
#include "engine/look/panes.h"

namespace shvr {

struct Stroke {
    glm::dvec2 from{0.0}, to{0.0};  ///< pixels of the pane, y down, centres at + 0.5
    glm::dvec3 color{1.0};          ///< linear light
    double width = 1.5;             ///< pixels
};

/// What the strokes tell of.
struct OverlayScene {
    Camera main;                ///< whose frustum maps show
    glm::uvec2 main_pixels{1};  ///< of its pane
    struct Probe {
        glm::dvec3 center{0.0};   ///< volume space
        double radius = 1.0;      ///< physical units
        glm::dvec3 color{1.0};    ///< linear light
        bool is_outlined = true;  ///< by its silhouette, or an arrow where it is out of sight
    };
    Probe probe;
    /// What stands out of the trace: nodes in rings, internodes along their middles.
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
};
std::vector<Stroke> strokes_of(const Pane& pane, const OverlayScene& scene, const VolumeInfo& volume);

/// The silhouette of a ball, as a closed line: the circle in which lines from the eye touch it. Empty where the eye
/// lies inside it, or where some of it is seen beside or behind the eye.
std::vector<glm::dvec2> silhouette_of(const Camera& camera, const glm::uvec2& pixels, const glm::dvec3& center,
                                      double radius);

/// Anti-aliased, over light that is premultiplied with its opacity. `pane`: pixels of the picture that the strokes are
/// reckoned from, and none are drawn outside.
void draw_strokes(ImageF& image, std::span<const Stroke> strokes, const PixelBox& pane);
/// The same on a screen's pixels, which are opaque.
void draw_strokes(Image8& image, std::span<const Stroke> strokes, const PixelBox& pane);

}  // namespace shvr
