#pragma once
// What a file chooser shows: the files of a folder, what they are by their names, and what a typed path means. A folder
// is read beside the main thread (folder_reader.h); nothing is asked about a file until its row is shown. Paths and
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

    /// Begins to list that folder, and waits for it as long as nobody notices (AT_ONCE). See `failure`.
    void enter(const std::filesystem::path& folder, size_t at_once = FolderReader::READ_AT_ONCE);
    /// Takes what has been read meanwhile. Returns whether there is more.
    bool read_on();
    bool is_reading() const { return is_reading_; }
    /// Something has been asked that was not answered yet.
    bool is_waiting() const { return is_reading_ || unanswered_ > 0; }
    const std::filesystem::path& folder() const { return folder_; }
    /// Why the folder, or the rest of it, cannot be listed, as a sentence; empty: it can.
    const std::string& failure() const { return failure_; }

    /// Which of the names are rows. `all_files`: not only what SHVR opens, by its name.
    void show(bool all_files, bool hidden);
    /// Folders first, then files; "slice2" before "slice10".
    size_t size() const { return rows_.size(); }
    const Entry& at(size_t row) const { return entries_[rows_[row]]; }
    size_t left_out() const { return entries_.size() - rows_.size(); }
    /// Asks the file system at the first call for a row, and keeps the answer, which a later `read_on` brings; until
    /// then nothing is known.
    const FileDetails& details(size_t row);

    std::optional<size_t> row_of(std::string_view name) const;
    /// The next row from `from` on, and then from the top, whose name begins so, whatever the case of its letters.
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
    std::vector<uint32_t> rows_;  ///< their numbers, in order
    std::unordered_map<std::string, FileDetails> details_;
};

/// Numbers within names count as numbers; the case of letters decides last.
bool is_naturally_before(std::string_view a, std::string_view b);
std::string size_text(int64_t bytes);  ///< "1.4 GB": 1000 bytes are 1 kB

/// $HOME, or the root where it is not known.
std::filesystem::path home_folder();
/// The path that a person means: "~" is home, quotes and spaces about it are dropped, and other than absolute paths
/// lead from `folder`. Without "." and "..".
std::filesystem::path typed_path(std::string_view typed, const std::filesystem::path& folder);
/// The typed text, continued as far as all names agree that begin so; a folder that is the only one ends in "/".
std::string completed(const std::string& typed, const std::filesystem::path& folder);

enum class Wanted {
    scan,      ///< something that SHVR opens
    file,      ///< any file that is there
    new_file,  ///< the name of a file that is not there yet
    any,       ///< a file or a folder, there or not
};
/// Whether a path can be taken as what is wanted.
struct Verdict {
    bool enters = false;  ///< it is a folder to look into instead
    std::string failure;  ///< why not, as a sentence; empty: it can
};
/// `enters_folders`: any folder is looked into, unless it is opened as a whole. Asks the file system.
Verdict verdict_on(const std::filesystem::path& path, Wanted wanted, bool enters_folders);

/// Whether it leads into a zipped volume, as scan.ozx/0 does.
bool is_within_archive(const std::filesystem::path& path);

struct Place {
    std::string name;
    std::filesystem::path folder;
};
/// Home, the folder of what is open (an empty path: nothing is), and those of what was opened last, each once.
std::vector<Place> places(const std::filesystem::path& open, const std::vector<std::filesystem::path>& recent);

}  // namespace shvr::ui
