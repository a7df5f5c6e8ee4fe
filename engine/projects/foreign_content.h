#pragma once
// Finds content of an image's folder that SHVR has not written: arrays, levels, attributes, consolidated metadata and
// files of other programs. A folder with such content is not deleted when it would be replaced: a save keeps the folder
// under another name, and an export is refused.
//
// Compares names, metadata and the keys of attributes, but reads no chunks. Costs as much as listing the folder. Any
// thread.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace shvr {

/// Whether file browsers leave files of that name in folders that they show, such as .DS_Store and Thumbs.db. Such
/// files reappear after they are removed, so they are no reason to keep or to refuse a folder.
bool is_desktop_file(const std::filesystem::path& path);

struct ForeignContent {
    /// Foreign entries (relative to the folder) and attributes (as "omero in .zattrs"); at most MAX_FOREIGN_NAMES.
    std::vector<std::string> names;
    /// Files for which `is_desktop_file` is true, relative to the folder. `names` does not include them.
    std::vector<std::filesystem::path> desktop_files;
};
inline constexpr size_t MAX_FOREIGN_NAMES = 4;
/// Returns "a, b", followed by "and more" if there may be others.
std::string in_words(const std::vector<std::string>& foreign);

/// `attributes`: the text of .zattrs or zarr.json to be written; attributes with other values are foreign, except
/// values that change with every save. Null: compares only keys, since another export may have written other values.
ForeignContent foreign_content(const std::filesystem::path& image, const std::optional<std::string>& attributes = {});

/// Returns only the file browsers' files that lie directly in the folder: for images without foreign content.
ForeignContent desktop_files_in(const std::filesystem::path& image);

/// Fails if an image to be replaced has foreign content.
void expect_no_foreign_content(const std::filesystem::path& image);

/// Copies `desktop_files` from an image to the image that replaces it. `inner`: the folder of the new image's levels.
void carry_over(const ForeignContent& content, const std::filesystem::path& from, const std::filesystem::path& to,
                const std::string& inner);

}  // namespace shvr
