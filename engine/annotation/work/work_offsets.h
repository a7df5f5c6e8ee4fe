#pragma once
// A volume with the user's density offsets added, for callers without a device: value + offset, clamped to the type
// (engine/volume/offset_source.h).

#include "engine/annotation/work/work.h"
#include "engine/volume/offset_source.h"

namespace shvr {

/// The bricks with offsets, in the form that OffsetSource takes.
std::vector<OffsetSource::Brick> offset_bricks(const DensityField& field);

/// Returns `base` with the field's offsets added, or `base` itself if there are no offsets. The field must have the
/// volume's size and type. Later changes of the field do not affect the result.
std::shared_ptr<const VolumeSource> with_offsets(std::shared_ptr<const VolumeSource> base, const DensityField& field);

/// Reads the offsets that `Work::open` would load; without a journal, does not read mask and trace. Fails like
/// `Work::open`; fails with Disputed if another program has changed the offsets' file and `belief` does not decide.
/// Appends messages to `notices`. One thread.
DensityField offsets_of(const WorkFiles& files, Belief belief, std::vector<Notice>& notices);

}  // namespace shvr
