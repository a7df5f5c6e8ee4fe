#pragma once
// The rows of a file chooser: the files of a folder and their kinds by name; and the meaning of a typed path. A folder
// is read in the background (folder_reader.h); details of a file are requested once its row is shown. Paths and names
// are in UTF-8. Not thread-safe.

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "ui/files/folder_reader.h"

namespace shvr::ui {

class FileList {
public:
    using Entry = FolderEntry;

    /// Starts to list `folder`, and waits for the list for a time too short to be noticed (AT_ONCE). See `failure`.
    void enter(const std::filesystem::path& folder, size_t at_once = FolderReader::READ_AT_ONCE);
    /// Takes the entries read since the last call. Returns whether more entries will follow.
    bool read_on();
    bool is_reading() const { return is_reading_; }
    /// Returns whether a request is unanswered.
    bool is_waiting() const { return is_reading_ || unanswered_ > 0; }
    const std::filesystem::path& folder() const { return folder_; }
    /// Returns why the folder, or the rest of it, cannot be listed, as a sentence; empty if there was no error.
    const std::string& failure() const { return failure_; }

    /// Selects which names get rows. `all_files`: also files whose names do not look like a format that SHVR opens.
    void show(bool all_files, bool hidden);
    /// Returns the number of rows. Folders come first, then files; "slice2" comes before "slice10".
    size_t size() const { return rows_.size(); }
    const Entry& at(size_t row) const { return entries_[rows_[row]]; }
    size_t left_out() const { return entries_.size() - rows_.size(); }
    /// Returns the details of a row. They are unknown until a `read_on` after the first call for that row delivers
    /// them.
    const FileDetails& details(size_t row);

    std::optional<size_t> row_of(std::string_view name) const;
    /// Returns the first row from `from` on, with wrap-around, whose name begins with `text`, ignoring case.
    std::optional<size_t> row_beginning(std::string_view text, size_t from) const;

private:
    bool is_shown(const Entry& entry) const;
    bool is_before(uint32_t a, uint32_t b) const;
    void take(size_t first_new);

    std::filesystem::path folder_;
    std::unique_ptr<FolderReader> reader_;
    size_t unanswered_ = 0;
    bool is_reading_ = false, shows_all_files_ = false, shows_hidden_ = false;
    std::string failure_;
    std::vector<Entry> entries_;  ///< as they were read
    std::vector<uint32_t> rows_;  ///< indices into entries_, in row order
    std::unordered_map<std::string, FileDetails> details_;
};

/// Compares names in natural order: numbers by value, letters regardless of case, which only breaks ties.
bool is_naturally_before(std::string_view a, std::string_view b);
std::string size_text(int64_t bytes);  ///< "1.4 GB": 1000 bytes are 1 kB

/// Returns $HOME, or the root if it is unknown.
std::filesystem::path home_folder();
/// Returns the path that a typed text means: "~" is home, surrounding quotes and spaces are dropped, and relative paths
/// are relative to `folder`. The result has no "." or "..".
std::filesystem::path typed_path(std::string_view typed, const std::filesystem::path& folder);
/// Returns whether a typed text or a path is the address of a volume, https://... or s3://..., and not a path.
bool is_typed_address(std::string_view typed);
/// Returns a typed path or address without the address's query; the same for what is no address at all.
std::string without_query(const std::string& typed);
/// Returns the typed address without its query, which is a credential and is kept in memory. Fails if no volume can be
/// read from there.
std::string typed_address(std::string_view typed);
/// Returns the typed text with the common beginning of all matching names; a single matching folder gets a slash.
std::string completed(const std::string& typed, const std::filesystem::path& folder);

enum class Wanted {
    scan,      ///< something that SHVR opens
    file,      ///< any existing file
    new_file,  ///< name of a file that does not exist yet
    any,       ///< a file or a folder, existing or not
};
/// Result of checking a chosen path.
struct Verdict {
    bool enters = false;  ///< true: a folder to enter instead
    std::string failure;  ///< why the path is refused, in a sentence; empty: the path is accepted
};
/// Checks a chosen path in the file system. `enters_folders`: folders are entered unless they are opened as a whole.
Verdict verdict_on(const std::filesystem::path& path, Wanted wanted, bool enters_folders);

/// Returns the formats that a chosen file may have, joined by commas and the conjunction: "TIFF, NRRD and DICOM".
std::string names_of_formats(std::string_view conjunction);
/// Returns whether the path leads into a zipped volume, as scan.ozx/0 does into scan.ozx.
bool is_within_archive(const std::filesystem::path& path);

struct Place {
    std::string name;
    std::filesystem::path folder;
};
/// Returns home, the open document's folder (empty path: none) and the folders of recent paths, without duplicates.
std::vector<Place> places(const std::filesystem::path& open, const std::vector<std::filesystem::path>& recent);

}  // namespace shvr::ui
