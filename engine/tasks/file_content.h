#pragma once
// Identifies a file by its contents rather than its name, for files dropped onto the window. Reads its first bytes, a
// small JSON file, or a volume's header. Any thread.

#include <filesystem>
#include <optional>
#include <string>

#include "engine/volume/volume.h"

namespace shvr {

enum class FileContent {
    volume,  ///< a volume; also a folder of slices, or an OME-Zarr image
    session,
    project,
    picture,  ///< a picture that contains a session
    mask,
    offsets,
    trace,
    transfer_function,
};
struct WhatItIs {
    std::optional<FileContent> content;
    std::string why_not{};  ///< if the content is none of these: a sentence with the path
};
/// `open`: the currently open volume, whose size identifies bare masks and offsets; null: none.
WhatItIs what_is(const std::filesystem::path& path, const VolumeInfo* open);

}  // namespace shvr
