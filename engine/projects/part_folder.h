#pragma once
// A folder that appears whole or not at all: it is made beside its place, as NAME.part, and renamed at the end. What
// was begun and not finished stays there, so that it can be gone on with. One process at a time works on it: the folder
// is locked, and the lock of a process that died is gone with it.

#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include "engine/base/file.h"

namespace shvr {

class PartFolder {
public:
    /// Makes NAME.part where it is not there yet, and locks it. Fails where `target` is there already and is no empty
    /// folder; with `overwrites` only where it is neither a project nor another Zarr folder. Fails where NAME.part is
    /// something else than an import left, or another process works on it.
    PartFolder(const std::filesystem::path& target, bool overwrites);

    const std::filesystem::path& path() const { return part_; }
    /// Of the target.
    std::string name() const { return target_.filename().string(); }
    /// Where the state is kept; there is none at first.
    std::filesystem::path state() const;

    /// Takes away everything in it.
    void clear() const;
    /// Takes away what a process that died was just writing.
    void clear_temporary() const;
    /// What was written so far is on the disk when this returns (with all else that waits for this file system).
    void sync() const;
    /// Puts the folder in its place, in exchange for what was there, and takes the state away. The folder is the target
    /// then.
    void finish();
    /// Takes away what was begun, as far as that can be.
    void abandon();

private:
    void refuse_target() const;

    std::filesystem::path target_, part_;
    bool overwrites_;
    std::optional<FileDescriptor> lock_;
};

/// Writes a whole file into a folder that is not in its place yet: not synced, not atomic. Makes the folders on its
/// way.
void write_part_file(const std::filesystem::path& path, std::span<const std::byte> content);

}  // namespace shvr
