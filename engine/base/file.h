#pragma once
// Reads whole files, with a clear message for anything that is not a regular file: opening a FIFO would block for ever
// and /dev/zero never ends. The size is checked before memory is allocated. Any thread may call these.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace shvr {

/// The whole file. Fails if it is missing, not a regular file, unreadable, larger than `max_bytes`, or shrinks while it
/// is read.
std::vector<std::byte> read_file(const std::filesystem::path& path, int64_t max_bytes);
/// Like `read_file`, but returns the bytes as text. Encoding and line ends are unchanged.
std::string read_text(const std::filesystem::path& path, int64_t max_bytes);

/// Whether the path leads to a regular file; false if that cannot be determined.
bool is_file(const std::filesystem::path& path);

/// The text of an error number, such as "No space left on device" for ENOSPC. Unlike strerror, shares no state.
std::string reason_of(int error_number);

/// Owns a POSIX file descriptor.
class FileDescriptor {
public:
    /// If the number is negative, as returned by failing calls, the object owns nothing.
    explicit FileDescriptor(int number) : number_(number) {}
    FileDescriptor(FileDescriptor&& other) noexcept : number_(other.number_) { other.number_ = -1; }
    FileDescriptor& operator=(FileDescriptor&&) = delete;
    ~FileDescriptor();

    int number() const { return number_; }
    explicit operator bool() const { return number_ >= 0; }

private:
    int number_;
};

}  // namespace shvr
