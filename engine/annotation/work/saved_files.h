#pragma once
// The files in which an annotation is saved, one per
// part: their contents, and their differences from a
// document.

#include <array>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "engine/annotation/trace/trace_file.h"
#include "engine/annotation/work/change.h"
#include "engine/annotation/work/journal_record.h"

namespace shvr {

struct WorkFiles {
    std::filesystem::path journal{};                   ///< empty: work is kept in memory only
    std::filesystem::path mask{}, trace{}, density{};  ///< empty: not saved
    /// A mask in a read-only format, from which the work starts until `mask` has been saved; empty if there is none.
    /// Set by `Work`, which then also gives `mask` another name (saved_mask_path).
    std::filesystem::path mask_to_read{};
    /// A mask other than `mask` whose header the next save keeps (mask_segments.h): the mask saved before under another
    /// name, a file of another program that was renamed, or an imported mask. Set by `Work`.
    std::filesystem::path mask_before{};
    std::string volume_hash{};  ///< Session::volume_hash
    /// Returns whether `hash` is another hash of the same voxels; may read all voxels to find out. Empty: never.
    std::function<bool(const std::string& hash)> is_other_name{};
    VolumeInfo volume{};       ///< the annotated volume
    SettingValues settings{};  ///< the session's settings, as read from its file
    /// Converts settings to the spelling of this version, so that files and journals of different versions can be
    /// compared. Fails if the settings cannot be read.
    std::function<SettingValues(const SettingValues&)> normalized{};
    /// Like `settings` and `normalized`, for kept settings (Work::keep_settings); empty if the caller keeps none.
    SettingValues kept{};
    std::function<SettingValues(const SettingValues&)> normalized_kept{};
};

enum class Part { mask, trace, offsets };
inline constexpr std::array<Part, 3> PARTS{Part::mask, Part::trace, Part::offsets};

/// "mask", "trace", "density offsets"
const char* name_of(Part part);
const std::filesystem::path& file_of(const WorkFiles& files, Part part);
std::optional<uint64_t>& digest_of(SavedFiles& digests, Part part);
inline const std::optional<uint64_t>& digest_of(const SavedFiles& digests, Part part)
{
    return digest_of(const_cast<SavedFiles&>(digests), part);
}

/// Whether a part of the document has any content to save.
bool holds_any(const Document& document, Part part);

bool is_there(const std::filesystem::path& path);

/// Sentences about a file that was read.
struct LoadNotes {
    std::vector<std::string> losses{};   ///< content that the document lacks; keep the file before saving over it
    std::vector<std::string> remarks{};  ///< how it was read
};
/// The file from which a part is read. For a mask this is `mask_to_read`, if there is one, until `mask` has been saved.
const std::filesystem::path& file_to_read(const WorkFiles& files, Part part);
/// The mask whose header a save or an export keeps; the file may not exist.
const std::filesystem::path& mask_of_header(const WorkFiles& files);
/// Reads the file of a part into a document in which this part is empty. Fails if the file is malformed, or belongs to
/// another volume or image.
LoadNotes load(Part part, const WorkFiles& files, Document& into);

/// The changes that turn a part of one document into that of another document of the same volume; none if the parts are
/// equal. Ignores the selection.
std::vector<Change> changes_between(Part part, const Document& from, const Document& to);

/// The digest that a trace's saved file would have; null if the file's format cannot hold the trace.
std::optional<uint64_t> trace_digest(const WorkFiles& files, const TraceGraph& trace);

/// A file's times, size and inode, as the system states them. A file whose stamp is unchanged is not read again.
struct FileStamp {
    int64_t written_ns = 0, changed_ns = 0;
    uint64_t bytes = 0, inode = 0;
    bool operator==(const FileStamp&) const = default;
};
/// Null for folders and missing files.
std::optional<FileStamp> stamp_of(const std::filesystem::path& path);

/// The first free name for an old file: "paint.mask.old", then "paint.mask.old2" and so on.
std::filesystem::path old_of(const std::filesystem::path& path);
/// Renames a file or folder to its `old_of`, and returns this new name; null if another process has moved the file
/// meanwhile. Fails if renaming fails.
std::optional<std::filesystem::path> set_aside(const std::filesystem::path& path);
/// Like `set_aside`, but renames `file` to `old_of(path)`, where `path` may be another path.
std::optional<std::filesystem::path> rename_to_old(const std::filesystem::path& file,
                                                   const std::filesystem::path& path);

}  // namespace shvr
