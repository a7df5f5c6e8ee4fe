#pragma once
// Finds content in an image's folder that SHVR has not written: arrays, levels, attributes, consolidated metadata and
// files of other programs. An image with such content must not be deleted when it is replaced: a save keeps it under
// another name, and an export is refused.
//
// Compares names, metadata and attributes, but reads no chunks; takes about as long as listing the folder. Any
// thread.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace shvr {

/// Whether file browsers leave files with that name, such as .DS_Store and Thumbs.db, in folders that they show. Such
/// files are created again if deleted, so they are no reason to keep a folder or to refuse an export.
bool is_desktop_file(const std::filesystem::path& path);

struct ForeignContent {
    /// Foreign files (relative to the folder) and attributes ("omero in .zattrs"); at most MAX_FOREIGN_NAMES.
    std::vector<std::string> names;
    /// Files for which `is_desktop_file` is true, relative to the folder. `names` does not include them.
    std::vector<std::filesystem::path> desktop_files;
};
inline constexpr size_t MAX_FOREIGN_NAMES = 4;
/// Joins names as in "a, b"; adds "and more" if the list was truncated.
std::string in_words(const std::vector<std::string>& foreign);

/// `attributes`: the text of .zattrs or zarr.json to be written. Attributes with other values are foreign, except those
/// that every save changes. Null: compares keys only, since another export may have written other values.
ForeignContent foreign_content(const std::filesystem::path& image, const std::optional<std::string>& attributes = {});

/// Returns only file browsers' files directly in the folder, for images that are known to have no foreign content.
ForeignContent desktop_files_in(const std::filesystem::path& image);

/// Fails if an image to be replaced has foreign content.
void expect_no_foreign_content(const std::filesystem::path& image);

/// Copies `desktop_files` from an image to the image that replaces it. `inner`: the folder of the new image's levels.
void carry_over(const ForeignContent& content, const std::filesystem::path& from, const std::filesystem::path& to,
                const std::string& inner);

}  // namespace shvr
