#pragma once
// Enlarged parts of pictures at their largest errors. Pure; any thread.

#include "tools/bench/measure.h"

namespace shvr::bench {

/// A rectangle of a picture, in its pixels.
struct Window {
    int x = 0, y = 0, width = 0, height = 0;
    bool operator==(const Window&) const = default;
};

/// Returns the window with the largest sum of squared errors; its sides are a quarter of the picture's. If several
/// windows tie, returns the first one from the top.
Window worst_window(const ImageF& picture, const ImageF& truth);
/// Returns the window's pixels as displayed (8 bits), each enlarged to `times` x `times`.
Image8 enlarged(const ImageF& picture, const Window& window, int times);
/// Returns the RMSE in linear light, within the window only.
double rmse_in(const ImageF& picture, const ImageF& truth, const Window& window);

/// One scene's insets: of the reference, of each quality, and of another program.
struct Insets {
    Window window;
    std::vector<std::pair<std::string, const ImageF*>> pictures;  ///< refer to the pictures that they were made from
};
/// Returns a scene's insets, of the window where `interactive` has the largest errors.
Insets insets_of(const Pictures& pictures);
/// Returns the insets of all scenes as one picture: a row per scene, with a title above each inset.
Image8 sheet_of(const Results& results, const std::vector<Pictures>& pictures);

}  // namespace shvr::bench
