#include "engine/annotation/mask_preview.h"

namespace shvr {

void MaskPreview::add(const MaskBrickChange& change)
{
    for (const MaskRun& run : change.runs) {
        const int64_t voxels = int64_t{run.last} - run.first + 1;
        lost_[run.before] += voxels;
        gained_[run.after] += voxels;
        voxels_ += voxels;
    }
}

std::vector<MaskPreview::Group> MaskPreview::groups() const
{
    std::vector<Group> changed;
    for (size_t group = 1; group < before_.size(); ++group)
        if (gained_[group] > 0 || lost_[group] > 0)
            changed.push_back({int(group), before_[group], gained_[group], lost_[group]});
    return changed;
}

}  // namespace shvr
