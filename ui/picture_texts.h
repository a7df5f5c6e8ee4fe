#pragma once
// Texts for picture files, in the window's fonts, without a window. Main thread.

#include <span>
#include <string>
#include <vector>

#include "engine/workbench/sight/figure.h"

namespace shvr::ui {

/// Renders each text `pixels` high (TextDrawer). Characters that no font of this machine has become boxes.
std::vector<TextImage> draw_picture_texts(std::span<const std::string> texts, double pixels);

}  // namespace shvr::ui
