#pragma once
// Writes a folder all or nothing: its content is built in a hidden folder next to the target, and takes the target's
// place at the end, in one exchange of names. At every moment a reader finds either the old or the new folder, even if
// the program is killed. Without `commit` the target stays as it was.
//
// A folder that was moved away while it was written, with the folders around it, is not made again at its old place:
// `commit` fails, and what is there then is left as it is.
//
// The hidden folder `.NAME.shvr-part` has no content of its own that readers of Zarr would list. It is locked while
// a process works on it; what a killed process left there is cleared by the next one.
//
// Some network file systems cannot exchange names. There a folder that exists keeps its place: new content comes into
// a folder inside it, under a free name (`inner`), and counts from the moment that one file, which names it, is
// replaced. Old content that is to be kept is copied first.
//
// Symbolic links are followed, and stay. Every failure is one sentence with the target's path and the system's reason.
// One thread at a time.

#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include "engine/base/file.h"

namespace shvr {

class AtomicFolder {
public:
    /// Creates the target's parent folders. Fails if another process is writing the same folder.
    explicit AtomicFolder(const std::filesystem::path& target);
    ~AtomicFolder();
    AtomicFolder(const AtomicFolder&) = delete;
    AtomicFolder& operator=(const AtomicFolder&) = delete;

    /// The new content's folder, empty at first.
    const std::filesystem::path& path() const { return path_; }
    /// Empty if `commit` exchanges names. Otherwise "v1" or the like: everything but the entry file and the files
    /// that are equal in every version belongs into this folder inside `path`.
    const std::string& inner() const { return inner_; }
    /// Syncs the content, and puts it into the target's place; deletes the old content. `entry`: the file, directly in
    /// the folder, that leads readers to all other content.
    void commit(const std::string& entry);
    /// The same, but keeps the old content under another name, which is returned (free_old_name).
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
};

/// "paint.old", or "paint.old2" and so on: the first name that is free.
std::filesystem::path free_old_name(const std::filesystem::path& path);
/// Renames a folder of this process to the `free_old_name` of a path, and returns that.
std::filesystem::path move_to_old_name(const std::filesystem::path& folder, const std::filesystem::path& path);

}  // namespace shvr
