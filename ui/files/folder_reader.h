#pragma once
// Reads the names in a folder, and requested details, on a thread of its own. A folder that does not answer therefore
// blocks no caller, and its results are dropped with the reader. Each reader is used by one thread.

#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace shvr::ui {

/// Kinds of files and folders; those before `folder` are opened as a whole, as a volume or a project.
enum class FileKind { project, zarr, dicom_series, slices, folder, volume, session, annotation, other };
inline bool is_opened_whole(FileKind kind)
{
    return kind < FileKind::folder;
}

struct FileDetails {
    FileKind kind = FileKind::other;
    std::string kind_text;         ///< "NRRD volume", "folder"
    std::optional<int64_t> bytes;  ///< size of a file
    std::string changed;           ///< local time of the last change, "2026-11-22 17:49"; empty if unknown
};
/// Determines a file's kind from its name, and a folder's kind from a few names in it. Asks the file system.
FileDetails details_of(const std::filesystem::path& path);

struct FolderEntry {
    std::string name;
    bool is_folder = false;
};

class FolderReader {
public:
    /// Number of names listed between two checks for requests; they take a few milliseconds.
    static constexpr size_t READ_AT_ONCE = 4096;

    explicit FolderReader(std::filesystem::path folder, size_t at_once = READ_AT_ONCE);
    ~FolderReader();
    FolderReader(const FolderReader&) = delete;

    struct News {
        std::vector<FolderEntry> entries;
        std::vector<std::pair<std::string, FileDetails>> details;
        std::string failure;  ///< why the folder, or the rest of it, cannot be listed, as a sentence; empty: no error
        bool is_reading = true;
    };
    /// Returns results since the last call.
    News take();
    void ask_about(std::string name);
    /// Returns once all names are read, or after `patience`.
    void wait(std::chrono::milliseconds patience);

private:
    struct Shared {
        std::filesystem::path folder;
        std::mutex mutex;
        std::condition_variable changed;
        News news;
        std::vector<std::string> wanted;
        bool is_abandoned = false;
    };
    static void read(Shared& shared, size_t at_once);
    static bool answer(Shared& shared);

    std::shared_ptr<Shared> shared_;
};

}  // namespace shvr::ui
