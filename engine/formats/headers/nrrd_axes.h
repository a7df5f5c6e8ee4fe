#pragma once
// The axes of an NRRD header: which of them are spatial, their lengths, and their positions in space. For
// source_nrrd.cpp. Any thread may call these.

#include <vector>

#include "engine/formats/header_fields.h"

namespace shvr {

/// The axes of a file: three spatial axes, and at most one other, either first (several values per voxel) or last (time
/// points). A picture has an axis of channels, two spatial axes, and a single slice.
struct NrrdAxes {
    size_t dimension = 3;
    size_t first = 0;  ///< index of the first spatial axis
    Size3 size{0};
    int64_t channels = 1;
    int64_t frames = 1;
    bool channels_are_colors = false;
    bool is_picture = false;

    int spatial() const { return is_picture ? 2 : 3; }
};

NrrdAxes read_nrrd_axes(const HeaderFields& fields);

/// Sets spacing, unit and orientation, and adds warnings about them.
void read_nrrd_space(const HeaderFields& fields, const NrrdAxes& axes, VolumeInfo& info);

}  // namespace shvr
