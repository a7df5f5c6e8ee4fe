#pragma once
// Identifies a file by its contents rather than its name, for files dropped onto the window. Reads its first bytes, a
// small JSON file, or a volume's header. Any thread.

#include <filesystem>
#include <optional>
#include <string>

#include "engine/volume/source.h"

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
    /// Whether the file is a volume of the open volume's size that does not state whether it is another scan, a mask or
    /// offsets. If so, `content` is empty, and the user is asked.
    bool may_be_annotation = false;
    std::string why_not{};  ///< if the content is unknown: a sentence about it, with the path
};
/// `open`: the currently open volume, whose size identifies masks and offsets; null: none.
WhatItIs what_is(const std::filesystem::path& path, const VolumeInfo* open);
/// Determines the content of a file that is to be loaded into the open volume: never a volume, session, project or
/// picture. Refuses a volume of another size, stating both sizes; a volume of unsigned integers is a mask.
WhatItIs what_annotation_is(const std::filesystem::path& path, const VolumeInfo& open);

/// Returns why a volume without a session looks like a label image, as a part of a sentence: "it states that it is a
/// mask". Empty if it does not, or if it has a session or is a project: then it is about a scan, or the user knows
/// better.
std::string why_labels(const std::filesystem::path& path, const VolumeSource& source,
                       const VolumeStatistics& statistics);

}  // namespace shvr
