#pragma once
// What a file is, by its contents and not by its name: for what somebody drops onto the window. Reads its first bytes,
// a small JSON file, or a volume's header. Any thread.

#include <filesystem>
#include <optional>
#include <string>

#include "engine/volume/volume.h"

namespace shvr {

enum class FileContent {
    volume,  ///< also a folder of slices or an OME-Zarr image
    session,
    project,
    picture,  ///< with a session in it
    mask,
    offsets,
    trace,
    transfer_function,
};
struct WhatItIs {
    std::optional<FileContent> content;
    std::string why_not{};  ///< of what is nothing of all that: a sentence with the path
};
/// `open`: the volume that is open, whose size tells bare masks and offsets; null: none.
WhatItIs what_is(const std::filesystem::path& path, const VolumeInfo* open);

}  // namespace shvr
