#pragma once
// A small picture of a figure's page, with all of its elements where they will be. The volume is the window's picture
// at a low resolution, cut to the page's shape, so that it takes no work of the device. Main thread; `page_of` is pure.

#include <span>
#include <vector>

#include "engine/base/image.h"
#include "engine/workbench/actions/picture_actions.h"
#include "engine/workbench/models/model.h"

namespace shvr::ui {

/// Returns the panes of a page from the pictures of the same panes in the window: as high, and cut, or continued by
/// stripes on both sides. `background`: linear light. `has_unseen`: receives whether there are stripes.
Image8 page_of(std::span<const Pane> panes, const glm::uvec2& pixels, std::span<const Image8> shown,
               const glm::dvec3& background, bool* has_unseen = nullptr);

/// Draws the preview of a figure as a row of its dialog. `begins`: the dialog has just been shown.
void figure_preview(const FigureTask& task, const Model& model, bool begins);

}  // namespace shvr::ui
