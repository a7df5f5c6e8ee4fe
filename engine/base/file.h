#pragma once
// Reading whole files, with words for everything that is not one. Only regular files are read: opening a FIFO would
// wait for ever and /dev/zero never ends. The size is checked before memory is taken. Any thread may call these.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace shvr {

/// The whole file. Fails where there is none, where it is no regular file, cannot be read, holds more than `max_bytes`
/// or became shorter meanwhile.
std::vector<std::byte> read_file(const std::filesystem::path& path, int64_t max_bytes);
/// The same bytes as text; neither encoding nor line ends are changed.
std::string read_text(const std::filesystem::path& path, int64_t max_bytes);

/// Whether there is a regular file; whatever keeps that from being known means no.
bool is_file(const std::filesystem::path& path);

/// "No space left on device" for ENOSPC; unlike strerror free of shared state.
std::string reason_of(int error_number);

/// Owns a POSIX file descriptor.
class FileDescriptor {
public:
    /// A negative number, as failing calls return it, owns nothing.
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
