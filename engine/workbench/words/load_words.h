#pragma once
// What loading annotation would change, in numbers and words, before it does. Pure; any thread.

#include <span>

#include "engine/annotation/work/change.h"
#include "engine/workbench/models/opening_model.h"

namespace shvr::ui {

/// `changes`: those of the part that turn `before` into `after` (changes_between). Leaves out path and notes.
LoadPreview preview_of(Part part, const shvr::Document& before, const shvr::Document& after,
                       std::span<const Change> changes);

}  // namespace shvr::ui
