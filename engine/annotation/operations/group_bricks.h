#pragma once
// Steps shared by operations.

#include "engine/annotation/operations/mask_edit.h"
#include "engine/base/progress.h"

namespace shvr {

/// Calls `visit(brick)` for each of the bricks, and reports progress.
template <class Visit>
void for_each_brick(std::span<const int64_t> bricks, const Progress& progress, const Visit& visit)
{
    for (size_t done = 0; done < bricks.size(); ++done) {
        visit(bricks[done]);
        tell(progress, double(done + 1) / double(bricks.size()));
    }
}
template <class Visit>
void for_each_brick(const Mask& mask, const Progress& progress, const Visit& visit)
{
    for_each_brick(mask.painted_bricks(), progress, visit);
}

}  // namespace shvr
