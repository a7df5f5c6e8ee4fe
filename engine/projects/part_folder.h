#pragma once
// A folder that appears complete or not at all: it is built next to its final place, as NAME.part, and renamed at the
// end. Unfinished work stays in NAME.part, so that it can be resumed. Only one process at a time works on it: the
// folder is locked, and the lock is released if the process dies.

#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include "engine/base/file.h"

namespace shvr {

class PartFolder {
public:
    /// Creates NAME.part if it does not exist yet, and locks it. Fails if `target` exists and is not an empty folder.
    /// With `overwrites`, fails only if `target` is neither a project nor another Zarr folder, or has files foreign to
    /// such a folder, which would be lost. Fails if NAME.part was not left by an import, or if another process works on
    /// it.
    PartFolder(const std::filesystem::path& target, bool overwrites);

    const std::filesystem::path& path() const { return part_; }
    /// The name of the target.
    std::string name() const { return target_.filename().string(); }
    /// The path of the saved state; the file need not exist.
    std::filesystem::path state() const;

    /// Deletes all content of NAME.part.
    void clear() const;
    /// Deletes temporary files left by a process that died while writing.
    void clear_temporary() const;
    /// Returns once everything written so far, and every other pending write to this file system, is on the disk.
    void sync() const;
    /// Moves the folder to the target's place, replacing an existing folder, and deletes the state. After this call,
    /// the folder is at the target's path.
    void finish();
    /// Deletes unfinished work, as far as possible.
    void abandon();

private:
    void refuse_target() const;

    std::filesystem::path target_, part_;
    bool overwrites_;
    std::optional<FileDescriptor> lock_;
};

/// Returns the path without "." and "..", and without a trailing slash: with the slash, it would be its own parent.
std::filesystem::path plain_path(const std::filesystem::path& path);

/// Writes a whole file into a folder that is still being built: neither synced nor atomic. Creates parent folders.
void write_part_file(const std::filesystem::path& path, std::span<const std::byte> content);

}  // namespace shvr
