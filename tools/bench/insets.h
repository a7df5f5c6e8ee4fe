#pragma once
// Insets: enlarged parts of pictures, where their errors are largest. Pure; any thread.

#include "tools/bench/measure.h"

namespace shvr::bench {

/// A rectangle of a picture, in its pixels.
struct Window {
    int x = 0, y = 0, width = 0, height = 0;
    bool operator==(const Window&) const = default;
};

/// Returns the window with the largest sum of squared errors. Its sides are a quarter of the picture's sides. If
/// several windows tie, returns the topmost.
Window worst_window(const ImageF& picture, const ImageF& truth);
/// Returns the window's pixels as displayed (8 bits), each enlarged to a square of `times` x `times` pixels.
Image8 enlarged(const ImageF& picture, const Window& window, int times);
/// Returns the root mean square error in linear light, over the window only.
double rmse_in(const ImageF& picture, const ImageF& truth, const Window& window);

/// The insets of one scene: those of the reference, of each quality, and of the comparison program.
struct Insets {
    Window window;
    std::vector<std::pair<std::string, const ImageF*>> pictures;  ///< refer to the pictures that they were made from
};
/// Returns the insets of a scene, at the window where the quality `interactive` has the largest errors.
Insets insets_of(const Pictures& pictures);
/// Returns the insets of all scenes as one picture: a row per scene, with a title above each inset.
Image8 sheet_of(const Results& results, const std::vector<Pictures>& pictures);

}  // namespace shvr::bench
