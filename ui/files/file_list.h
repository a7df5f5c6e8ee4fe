#pragma once
// Rows of a file chooser: the files of a folder, their kinds by name, and the meaning of a typed path. A folder
// is read in the background (folder_reader.h); details of a file are requested once its row is shown. Paths and
// names in UTF-8. Not thread-safe.

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

    /// Starts to list `folder`, and waits an unnoticeable time (AT_ONCE) for the list. See `failure`.
    void enter(const std::filesystem::path& folder, size_t at_once = FolderReader::READ_AT_ONCE);
    /// Takes entries read since the last call. Returns whether more will follow.
    bool read_on();
    bool is_reading() const { return is_reading_; }
    /// Returns whether a request is unanswered.
    bool is_waiting() const { return is_reading_ || unanswered_ > 0; }
    const std::filesystem::path& folder() const { return folder_; }
    /// Returns why the folder, or the rest of it, cannot be listed, in a sentence; empty if it can be.
    const std::string& failure() const { return failure_; }

    /// Selects which names become rows. `all_files`: also files whose names do not look like files that SHVR opens.
    void show(bool all_files, bool hidden);
    /// Returns the number of rows. Folders come first, then files; "slice2" comes before "slice10".
    size_t size() const { return rows_.size(); }
    const Entry& at(size_t row) const { return entries_[rows_[row]]; }
    size_t left_out() const { return entries_.size() - rows_.size(); }
    /// Returns details of a row. The first call requests them, and a later `read_on` delivers them; until
    /// then they are unknown.
    const FileDetails& details(size_t row);

    std::optional<size_t> row_of(std::string_view name) const;
    /// Returns the next row from `from` on, with wrap-around, whose name begins with `text`, ignoring case.
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

/// Compares names, with digits in them compared as numbers; upper and lower case decide last.
bool is_naturally_before(std::string_view a, std::string_view b);
std::string size_text(int64_t bytes);  ///< "1.4 GB": 1000 bytes are 1 kB

/// Returns $HOME, or the root if it is unknown.
std::filesystem::path home_folder();
/// Returns the path that a typed text means: "~" is home, surrounding quotes and spaces are dropped, and relative paths
/// start at `folder`. The result has no "." or "..".
std::filesystem::path typed_path(std::string_view typed, const std::filesystem::path& folder);
/// Returns the typed text, completed as far as all matching names agree; a single matching folder ends in "/".
std::string completed(const std::string& typed, const std::filesystem::path& folder);

enum class Wanted {
    scan,      ///< something that SHVR opens
    file,      ///< any existing file
    new_file,  ///< name of a file that does not exist yet
    any,       ///< a file or a folder, existing or not
};
/// Result of the check of a chosen path.
struct Verdict {
    bool enters = false;  ///< true: a folder to enter instead
    std::string failure;  ///< why the path is refused, in a sentence; empty: the path is accepted
};
/// `enters_folders`: folders are entered unless they are opened as a whole. Asks the file system.
Verdict verdict_on(const std::filesystem::path& path, Wanted wanted, bool enters_folders);

/// Returns the names of the formats that a chosen file may have, "TIFF, NRRD and DICOM" with the conjunction "and".
std::string names_of_formats(std::string_view conjunction);
/// Returns whether the path leads into a zipped volume, as scan.ozx/0 does.
bool is_within_archive(const std::filesystem::path& path);

struct Place {
    std::string name;
    std::filesystem::path folder;
};
/// Returns home, the open document's folder (empty path: none), and the folders of recently opened paths, each once.
std::vector<Place> places(const std::filesystem::path& open, const std::vector<std::filesystem::path>& recent);

}  // namespace shvr::ui
