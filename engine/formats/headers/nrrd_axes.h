#pragma once
// What an NRRD header says of its axes: which of them are space, how long they are, where they lie. For
// source_nrrd.cpp. Any thread may call these.

#include <vector>

#include "engine/formats/header_fields.h"

namespace shvr {

/// Three axes of space, and at most one more: before them (values of a voxel) or behind them (points in time).
struct NrrdAxes {
    size_t dimension = 3;
    size_t first = 0;  ///< of the axes of space, among all
    Size3 size{0};
    int64_t channels = 1;
    int64_t frames = 1;
    bool channels_are_colors = false;
};

NrrdAxes read_nrrd_axes(const HeaderFields& fields);

/// Spacing, unit and orientation, with what has to be said about them.
void read_nrrd_space(const HeaderFields& fields, const NrrdAxes& axes, VolumeInfo& info);

}  // namespace shvr
