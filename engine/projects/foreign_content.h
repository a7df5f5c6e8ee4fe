#pragma once
// The content of an image's folder that SHVR has not written: arrays, levels, attributes, consolidated metadata and
// files of other programs. A folder that holds any is not deleted when it is replaced: a save keeps it under another
// name, an export is refused.
//
// Compared are names, metadata and the keys of attributes; chunks are not read. The cost is that of listing the folder.
// Any thread.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace shvr {

/// Whether file browsers leave files of that name in folders that they show, such as .DS_Store and Thumbs.db. They come
/// again where they are removed, so they are no reason to keep or to refuse a folder.
bool is_desktop_file(const std::filesystem::path& path);

struct ForeignContent {
    /// Entries, relative to the folder, and attributes, as "omero in .zattrs"; at most MAX_FOREIGN_NAMES.
    std::vector<std::string> names;
    /// Files of `is_desktop_file`, relative to the folder. They are not among `names`.
    std::vector<std::filesystem::path> desktop_files;
};
inline constexpr size_t MAX_FOREIGN_NAMES = 4;
/// "a, b", with "and more" if there may be others.
std::string in_words(const std::vector<std::string>& foreign);

/// `attributes`: the text of .zattrs or zarr.json to be written. Other values of an attribute are then foreign, except
/// what changes with every save. Null: only the keys are compared, since another export may have written other values.
ForeignContent foreign_content(const std::filesystem::path& image, const std::optional<std::string>& attributes = {});

/// The files of file browsers directly in the folder, and nothing else: for images that hold no foreign content.
ForeignContent desktop_files_in(const std::filesystem::path& image);

/// Fails if an image that is to be replaced holds foreign content.
void expect_no_foreign_content(const std::filesystem::path& image);

/// Copies `desktop_files` of an image into the one that replaces it. `inner`: the folder of its levels.
void carry_over(const ForeignContent& content, const std::filesystem::path& from, const std::filesystem::path& to,
                const std::string& inner);

}  // namespace shvr
