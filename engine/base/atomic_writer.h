#pragma once
// Writes a file all or nothing: the bytes go into a temporary file next to the target. At the end this file is synced
// and renamed over the target. Without `commit` the target stays as it was and the temporary file is removed.
//
// Every failure is one sentence with the target's path and the system's reason. One thread at a time.

#include <sys/types.h>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>

#include "engine/base/file.h"

namespace shvr {

/// Syncs the folder that contains `path`, so that a new or renamed file survives a power cut.
void sync_folder(const std::filesystem::path& path);

/// Returns the file to which a path leads, following symbolic links, even dangling ones. Writers replace a link itself.
/// To write the file where a link leads, callers first resolve an output path that the user gave.
std::filesystem::path link_target(const std::filesystem::path& path);

/// Removes the temporary files that killed writers left in a folder: those of dead processes of this host, and those of
/// other hosts that are older than a day. Never fails.
void collect_temporary_files(const std::filesystem::path& folder);

/// The product, or null if it exceeds 2^63 - 1.
std::optional<int64_t> multiplied(int64_t a, int64_t b);
/// Fails, stating both sizes, if the file's disk has less free space than `bytes` (null: more than 2^63 - 1). Does
/// nothing if the file system does not report its free space. `remedy` ends the message: "free some of it".
void expect_space(const std::filesystem::path& path, std::optional<int64_t> bytes, const char* remedy);

/// Removes the temporary files of all writers that have not committed. Meant for signal handlers: calls only
/// async-signal-safe functions. The program must terminate afterwards.
void remove_temporary_files();

class AtomicWriter {
public:
    /// Refuses an existing path that is not a regular file. A symbolic link will be replaced, not followed.
    explicit AtomicWriter(const std::filesystem::path& path);
    ~AtomicWriter();
    AtomicWriter(const AtomicWriter&) = delete;
    AtomicWriter& operator=(const AtomicWriter&) = delete;

    void append(std::span<const std::byte> content);
    /// Overwrites bytes already written, for formats that have to do so. Must not be combined with `append`.
    void write_at(int64_t offset, std::span<const std::byte> content);
    /// Fails if fewer bytes were written.
    void read_back(int64_t offset, std::span<std::byte> content) const;
    /// Syncs, renames, and syncs the folder, so that the new file survives a power cut. Keeps the permissions of the
    /// old file.
    void commit();

private:
    FileDescriptor create();
    [[noreturn]] void refuse(int error_number) const;

    std::filesystem::path target_;
    std::filesystem::path temporary_;
    std::optional<mode_t> old_permissions_;
    std::atomic<const char*>* listed_ = nullptr;  ///< the slot in which remove_temporary_files finds the file's name
    FileDescriptor descriptor_;
    bool is_renamed_ = false;
    uint64_t unsynced_bytes_ = 0;
};

}  // namespace shvr
