#pragma once
// A volume as a person's density offsets make it, for who reads its voxels and has no device: value + offset, clamped to the
// type (engine/volume/offset_source.h).

#include "engine/annotation/work/work.h"
#include "engine/volume/offset_source.h"

namespace shvr {

/// The bricks that hold offsets, as a source takes them.
std::vector<OffsetSource::Brick> offset_bricks(const DensityField& field);

/// `base` with the field's offsets; `base` itself where there are none. The field, of the volume's size and type, may change
/// afterwards.
std::shared_ptr<const VolumeSource> with_offsets(std::shared_ptr<const VolumeSource> base, const DensityField& field);

/// The offsets that `Work::open` would find, of which only they are wanted: without a journal no other file is looked at, and
/// without any file nothing is done. Fails as it does, and appends its sentences to `messages`. One thread.
DensityField offsets_of(const WorkFiles& files, std::vector<std::string>& messages);

}  // namespace shvr
