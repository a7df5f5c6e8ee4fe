#pragma once
// Outlines drawn over a pane, as parameters of an operation that no longer depends on the pane. Pure; any thread.

#include <optional>
#include <span>
#include <vector>

#include "engine/annotation/operations/lasso_op.h"
#include "engine/look/panes.h"
#include "engine/look/settings.h"

namespace shvr::ui {

/// Sets what the operation takes from the view: the outline through `drawn` (pixels of the pane) and how far it cuts.
/// `depth`: in 3-D from where the part of the volume within the cutting planes begins, in a slice half to either side
/// of it; null: through everything.
void set_outline(LassoOp& op, const Pane& pane, std::span<const glm::dvec2> drawn, std::optional<double> depth,
                 const CutBox& cut, const VolumeInfo& volume);

/// The corners of the rectangle with these two opposite corners.
std::vector<glm::dvec2> rectangle_of(const glm::dvec2& from, const glm::dvec2& to);

}  // namespace shvr::ui
