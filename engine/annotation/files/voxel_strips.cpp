#include "engine/annotation/files/voxel_strips.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>

#include "engine/base/atomic_writer.h"
#include "engine/base/error.h"

namespace shvr {

std::optional<int64_t> bytes_of_voxels(const Size3& size, int64_t bytes_per_voxel)
{
    const std::optional<int64_t> voxels = multiplied(size.x * size.y, size.z);
    return voxels ? multiplied(*voxels, bytes_per_voxel) : std::nullopt;
}

FileDescriptor open_voxels(const std::filesystem::path& path, const Size3& size, int64_t bytes_per_voxel,
                           const char* kind)
{
    // Without O_NONBLOCK, opening a FIFO would block until a writer appears, before its type can be checked.
    FileDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
    if (!file) fail(path.string(), ": cannot be opened: ", reason_of(errno));
    struct stat status {};
    if (::fstat(file.number(), &status) != 0) fail(path.string(), ": cannot be examined: ", reason_of(errno));
    if (!S_ISREG(status.st_mode))
        fail(path.string(), ": is a folder, device, pipe or socket; expected a ", kind, " file");
    const std::optional<int64_t> bytes = bytes_of_voxels(size, bytes_per_voxel);
    const std::string count = bytes_per_voxel == 1 ? "one" : std::to_string(bytes_per_voxel);
    if (status.st_size != bytes)
        fail(path.string(), ": holds ", status.st_size, " bytes; expected ",
             bytes ? std::to_string(*bytes) : std::string("more than 2^63 - 1"), ", ", count, " for each voxel of ",
             size.x, " x ", size.y, " x ", size.z);
    return file;
}

void read_next(const FileDescriptor& file, const std::filesystem::path& path, std::span<std::byte> bytes)
{
    while (!bytes.empty()) {
        const ssize_t count = ::read(file.number(), bytes.data(), bytes.size());
        if (count < 0 && errno == EINTR) continue;
        if (count < 0) fail(path.string(), ": cannot be read: ", reason_of(errno));
        if (count == 0) fail(path.string(), ": was truncated while it was read; expected no other program to write it");
        bytes = bytes.subspan(size_t(count));
    }
}

}  // namespace shvr
