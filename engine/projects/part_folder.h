#pragma once
// A folder that appears atomically: it is built next to its final place, as NAME.part, and renamed at the end.
// Unfinished work stays in NAME.part, to be resumed. The folder is locked while a process works on it; the lock is
// released if the process dies.

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/base/file.h"

namespace shvr {

class PartFolder {
public:
    /// Creates NAME.part if necessary, and locks it. Fails if `target` exists and is not an empty folder.
    /// With `overwrites`, `target` may also be a project or another Zarr folder, unless it contains foreign
    /// files, which would be lost. Fails if NAME.part was not left by an import, or if another process works
    /// on it.
    PartFolder(const std::filesystem::path& target, bool overwrites);

    const std::filesystem::path& path() const { return part_; }
    /// The name of the target.
    std::string name() const { return target_.filename().string(); }
    /// Returns the path of the saved state, which need not exist.
    std::filesystem::path state() const;

    /// Deletes all content of NAME.part.
    void clear() const;
    /// Deletes temporary files left by a process that died while writing.
    void clear_temporary() const;
    /// Returns once everything written to this file system so far is on the disk.
    void sync() const;
    /// Moves the folder to the target's path, replacing a folder there, and deletes the
    /// state.
    void finish();
    /// Deletes unfinished work, as far as possible.
    void abandon();

private:
    std::filesystem::path target_, part_;
    bool overwrites_;
    std::optional<FileDescriptor> lock_;
};

/// What is at the path of a folder that is to be made.
struct FoundTarget {
    bool is_taken = false;    ///< something other than an empty folder
    bool is_project = false;  ///< a project or another Zarr folder, which may be replaced
    /// Entries of other programs, which would be lost with the folder; at most MAX_FOREIGN_NAMES (foreign_content.h).
    std::vector<std::string> foreign{};
};
FoundTarget found_at(const std::filesystem::path& target);
/// Whether something other than an empty folder is at the path.
bool is_target_taken(const std::filesystem::path& target);
/// Fails if PartFolder would refuse a target with this path because of what is there.
void check_target(const std::filesystem::path& target, bool overwrites);

/// Returns the path without ".", ".." and trailing slash: a path with a slash at its end would be its own parent.
std::filesystem::path plain_path(const std::filesystem::path& path);

/// Writes a whole file into a folder under construction: neither synced nor atomic. Creates parent folders.
void write_part_file(const std::filesystem::path& path, std::span<const std::byte> content);

}  // namespace shvr
