#pragma once
// Writing a file so that it is either all there or not there: the bytes go into a temporary file beside the target,
// which is synced and renamed over it at the end. Without `commit` the target stays as it was and the temporary goes.
//
// Every failure is one sentence with the target's path and the system's reason. One thread at a time.

#include <sys/types.h>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>

#include "engine/base/file.h"

namespace shvr {

/// Makes a new or renamed file survive a power cut: syncs the folder that holds it.
void sync_folder(const std::filesystem::path& path);

class AtomicWriter {
public:
    /// Refuses what is neither a regular file nor absent. A symbolic link will be replaced, not followed.
    explicit AtomicWriter(const std::filesystem::path& path);
    ~AtomicWriter();
    AtomicWriter(const AtomicWriter&) = delete;
    AtomicWriter& operator=(const AtomicWriter&) = delete;

    void append(std::span<const std::byte> content);
    /// For formats that go back and change what they wrote. Not together with `append`.
    void write_at(int64_t offset, std::span<const std::byte> content);
    /// Fails where not so much was written.
    void read_back(int64_t offset, std::span<std::byte> content) const;
    /// Syncs, renames, and syncs the folder, so that the new file survives a power cut. Keeps the old one's
    /// permissions.
    void commit();

private:
    FileDescriptor create();
    [[noreturn]] void refuse(int error_number) const;

    std::filesystem::path target_;
    std::filesystem::path temporary_;
    std::optional<mode_t> old_permissions_;
    FileDescriptor descriptor_;
    bool is_renamed_ = false;
};

}  // namespace shvr
