#pragma once
// Counts how changes of a mask would affect its groups, before the changes are made. Any thread.

#include <array>
#include <cstdint>
#include <vector>

#include "engine/annotation/mask.h"

namespace shvr {

class MaskPreview {
public:
    /// `before`: the mask as it is.
    explicit MaskPreview(const Mask& before) : before_(before.voxels_by_group()) {}
    /// Adds a change. Each voxel may be in one change only.
    void add(const MaskBrickChange& change);

    struct Group {
        int group = 0;
        int64_t before = 0, gained = 0, lost = 0;
        int64_t after() const { return before + gained - lost; }
        bool operator==(const Group&) const = default;
    };
    /// The groups that gain or lose voxels, in ascending order; unpainted voxels do not count as a group.
    std::vector<Group> groups() const;
    /// Number of voxels that change their group, including those that become painted or unpainted.
    int64_t voxels() const { return voxels_; }

private:
    std::array<int64_t, 256> before_;
    std::array<int64_t, 256> gained_{}, lost_{};
    int64_t voxels_ = 0;
};

}  // namespace shvr
