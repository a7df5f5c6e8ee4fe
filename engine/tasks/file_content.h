#pragma once
// Identifies a file by its content rather than its name, for files dropped onto the window. Reads only the file's first
// bytes, a small JSON file, or a volume's header. Any thread.

#include <filesystem>
#include <optional>
#include <string>

#include "engine/volume/source.h"

namespace shvr {

enum class FileContent {
    volume,  ///< a volume: a file, a folder of slices or an OME-Zarr image
    session,
    project,
    picture,  ///< a picture that contains a session
    mask,
    offsets,
    trace,
    transfer_function,
    mesh,
};
struct WhatItIs {
    std::optional<FileContent> content;
    /// Whether the file may be another scan, a mask or offsets: it has the size of the open volume, and does not state
    /// what it contains. If true, `content` is empty, and the user is asked.
    bool may_be_annotation = false;
    std::string why_not{};  ///< if the content is unknown: the reason, as a sentence with the path
};
/// `open`: the open volume or null. Files of its size are recognised as masks or offsets.
WhatItIs what_is(const std::filesystem::path& path, const VolumeInfo* open);
/// Determines the content of a file that is to be loaded as annotation of the open volume: never a volume, session,
/// project or picture. A volume of unsigned integers is a mask. A volume of another size is refused with both sizes.
WhatItIs what_annotation_is(const std::filesystem::path& path, const VolumeInfo& open);

/// Returns why a volume without a session looks like a label image, as part of a sentence: "it states that it is a
/// mask". Returns an empty text if the volume looks like a scan, has a session or is a project. A session or project
/// already says how to read the volume.
std::string why_labels(const std::filesystem::path& path, const VolumeSource& source,
                       const VolumeStatistics& statistics);

}  // namespace shvr
