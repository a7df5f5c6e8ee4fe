#include "engine/formats/tiff/tiff_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>

#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/formats/tiff/tiff_numbers.h"

namespace shvr {

TiffFile::TiffFile(std::filesystem::path path)
    // Without O_NONBLOCK, opening a FIFO would block until a writer appears, before it can be recognised as a FIFO.
    : path_(std::move(path)), file_(::open(path_.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK))
{
    const std::string name = path_.string();
    if (!file_) fail(name, ": cannot be opened: ", reason_of(errno));
    struct stat status {};
    if (::fstat(file_.number(), &status) != 0) fail(name, ": cannot be examined: ", reason_of(errno));
    if (!S_ISREG(status.st_mode)) {
        fail(name, ": is ", S_ISDIR(status.st_mode) ? "a folder" : "a pipe or device", "; expected a file");
    }
    size_bytes_ = status.st_size;

    std::array<std::byte, 16> head{};
    const size_t length = read_some(0, head);
    const std::string_view text(reinterpret_cast<const char*>(head.data()), length);
    if (!begins(text)) {
        fail(name, ": begins with ", in_quotes(text.substr(0, 4)), "; expected the first bytes of a TIFF, II or MM");
    }
    is_big_endian_ = text[0] == 'M';
    has_wide_offsets_ = text[is_big_endian_ ? 3 : 2] == '+';
    if (length < (has_wide_offsets_ ? 16 : 8)) {
        fail(name, ": holds ", length, " bytes; expected a TIFF's header of ", has_wide_offsets_ ? 16 : 8);
    }
    first_directory_ = has_wide_offsets_ ? tiff_number(head.data() + 8, 8, is_big_endian_)
                                         : tiff_number(head.data() + 4, 4, is_big_endian_);
}

bool TiffFile::begins(std::string_view head)
{
    using namespace std::string_view_literals;
    for (const std::string_view start : {"II*\0"sv, "MM\0*"sv, "II+\0"sv, "MM\0+"sv}) {
        if (head.starts_with(start)) return true;
    }
    return false;
}

size_t TiffFile::read_some(int64_t offset, std::span<std::byte> bytes) const
{
    size_t done = 0;
    while (done < bytes.size()) {
        const ssize_t count = ::pread(file_.number(), bytes.data() + done, bytes.size() - done, offset + int64_t(done));
        if (count < 0 && errno == EINTR) continue;
        if (count < 0) fail(path_.string(), ": cannot be read: ", reason_of(errno));
        if (count == 0) break;
        done += size_t(count);
    }
    return done;
}

void TiffFile::read(int64_t offset, std::span<std::byte> bytes) const
{
    const size_t done = read_some(offset, bytes);
    if (done == bytes.size()) return;
    fail(path_.string(), ": ended after ", offset + int64_t(done), " bytes; expected ", offset + int64_t(bytes.size()),
         ": it was truncated while open");
}

bool TiffFile::holds(uint64_t offset, uint64_t bytes) const
{
    const auto size = uint64_t(size_bytes_);
    return offset <= size && bytes <= size - offset;
}

}  // namespace shvr
