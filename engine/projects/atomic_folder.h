#pragma once
// Writes a folder atomically: builds its content in a hidden folder next to the target, and finally exchanges the names
// of the two. At every moment readers find either the old or the new folder, even if the program is killed. Without
// `commit` the target stays unchanged.
//
// If the target, or a folder that contains it, is moved during writing, it is not created again at its old place:
// `commit` fails and leaves both places unchanged.
//
// The hidden folder `.NAME.shvr-part` has no content at its top that readers of Zarr would list. The writing process
// locks it. If a process is killed, the next writer of the same target deletes its remains. So does an opening
// (`clear_remains`).
//
// Some network file systems cannot exchange names. There, an existing folder keeps its place: new content goes into a
// folder inside it with a free name (`inner`). The content becomes valid when the entry file, which names the inner
// folder, is replaced. Old content to be kept is copied first.
//
// Symbolic links are followed, not replaced. Every failure is a sentence with the target's path and the system's text.
// One thread at a time.

#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include "engine/base/file.h"
#include "engine/base/waits/unfinished_work.h"

namespace shvr {

class AtomicFolder {
public:
    /// Creates the target's parent folders. Fails if another process is writing the same folder.
    explicit AtomicFolder(const std::filesystem::path& target);
    ~AtomicFolder();
    AtomicFolder(const AtomicFolder&) = delete;
    AtomicFolder& operator=(const AtomicFolder&) = delete;

    /// The folder for the new content, empty at first.
    const std::filesystem::path& path() const { return path_; }
    /// Empty if `commit` exchanges names. Otherwise "v1" or the like: the folder inside `path` for everything except
    /// the entry file and the files that are equal in every version.
    const std::string& inner() const { return inner_; }
    /// Syncs the content to disk, moves it to the target's place, and deletes the old content. `entry`: name of the
    /// file, directly in the folder, from which readers find all other content.
    void commit(const std::string& entry);
    /// Like commit(), but keeps the old content under another name, and returns that name (free_old_name).
    std::filesystem::path commit_and_keep_old(const std::string& entry);

private:
    void expect_in_place();
    void sync();
    void exchange(const std::filesystem::path& with);
    void enter(const std::string& entry);
    std::filesystem::path copy_old();
    void move_out(const std::filesystem::path& inside) const;
    void remove_remains();

    std::filesystem::path target_, container_, path_;
    std::string inner_;
    std::optional<FileDescriptor> lock_;
    std::optional<UnfinishedWork> unfinished_;
};

/// Removes what a killed writer of `target` has left next to it, unless another process writes it or the file system
/// has no locks. Never fails.
void clear_remains(const std::filesystem::path& target);

/// Returns "paint.old", "paint.old2" and so on for "paint": the first name that is not taken.
std::filesystem::path free_old_name(const std::filesystem::path& path);
/// Renames a folder made by this process to the `free_old_name` of `path`, and returns the new name.
std::filesystem::path move_to_old_name(const std::filesystem::path& folder, const std::filesystem::path& path);

}  // namespace shvr
