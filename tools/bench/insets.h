#pragma once
// Parts of pictures, enlarged: where they err most, what they look like there. Pure; any thread.

#include "tools/bench/measure.h"

namespace shvr::bench {

/// A rectangle of a picture, in its pixels.
struct Window {
    int x = 0, y = 0, width = 0, height = 0;
    bool operator==(const Window&) const = default;
};

/// A quarter of the sides, where the squares of the errors sum up to most; the first such one from the top.
Window worst_window(const ImageF& picture, const ImageF& truth);
/// As people see it, each pixel as `times` x `times` ones.
Image8 enlarged(const ImageF& picture, const Window& window, int times);
/// In linear light, within the window alone.
double rmse_in(const ImageF& picture, const ImageF& truth, const Window& window);

/// One scene's insets, of what is worth a look: the reference, each quality, another program.
struct Insets {
    Window window;
    std::vector<std::pair<std::string, const ImageF*>> pictures;  ///< into what they were made of
};
/// Where `interactive` errs most.
Insets insets_of(const Pictures& pictures);
/// All of them as one picture: a row for each scene, what it is above each.
Image8 sheet_of(const Results& results, const std::vector<Pictures>& pictures);

}  // namespace shvr::bench
