#pragma once
// Describes in words and numbers what loading annotation is going to change. Pure; any thread.

#include <span>

#include "engine/annotation/work/change.h"
#include "engine/workbench/models/opening_model.h"

namespace shvr::ui {

/// `changes`: the changes of `part` from `before` to `after` (changes_between). Does not fill in path and notes.
LoadPreview preview_of(Part part, const shvr::Document& before, const shvr::Document& after,
                       std::span<const Change> changes);

}  // namespace shvr::ui
