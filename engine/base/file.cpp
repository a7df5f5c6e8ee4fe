#include "engine/base/file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "engine/base/error.h"

namespace shvr {
namespace {

const char* kind_of(mode_t mode)
{
    if (S_ISDIR(mode)) return "a folder";
    if (S_ISFIFO(mode)) return "a pipe";
    if (S_ISSOCK(mode)) return "a socket";
    return "a device";
}

template <class Container>
Container read_whole(const std::filesystem::path& path, int64_t max_bytes)
{
    // Without O_NONBLOCK, opening a FIFO blocks until a writer appears, before we can detect that it is a FIFO.
    const FileDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
    if (!file) fail(path.string(), ": cannot be opened: ", reason_of(errno));
    struct stat status {};
    if (::fstat(file.number(), &status) != 0) fail(path.string(), ": cannot be examined: ", reason_of(errno));
    if (!S_ISREG(status.st_mode)) fail(path.string(), ": is ", kind_of(status.st_mode), "; expected a file");
    if (status.st_size > max_bytes) {
        fail(path.string(), ": holds ", status.st_size, " bytes; expected at most ", max_bytes);
    }
    Container content;
    content.resize(size_t(status.st_size));
    for (size_t done = 0; done < content.size();) {
        const ssize_t count = ::read(file.number(), content.data() + done, content.size() - done);
        if (count < 0 && errno == EINTR) continue;
        if (count < 0) fail(path.string(), ": cannot be read: ", reason_of(errno));
        if (count == 0) fail(path.string(), ": ended after ", done, " bytes; expected ", content.size());
        done += size_t(count);
    }
    return content;
}

}  // namespace

std::vector<std::byte> read_file(const std::filesystem::path& path, int64_t max_bytes)
{
    return read_whole<std::vector<std::byte>>(path, max_bytes);
}

std::string read_text(const std::filesystem::path& path, int64_t max_bytes)
{
    return read_whole<std::string>(path, max_bytes);
}

bool is_file(const std::filesystem::path& path)
{
    std::error_code error;
    return std::filesystem::is_regular_file(path, error);
}

std::string reason_of(int error_number)
{
    return std::generic_category().message(error_number);
}

FileDescriptor::~FileDescriptor()
{
    if (number_ >= 0) ::close(number_);
}

}  // namespace shvr
