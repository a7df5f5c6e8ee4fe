#include "engine/formats/meshes/mesh_input.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

#include "engine/base/error.h"
#include "engine/base/text.h"

namespace shvr {
namespace {

constexpr std::string_view SPACES = " \t\r\n\v\f";

}  // namespace

MeshInput::MeshInput(const std::filesystem::path& path, MeshMemory& memory, const Progress& progress)
    : name_(path.string()),
      // Without O_NONBLOCK, opening a FIFO would block until a writer appears.
      file_(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)),
      progress_(progress)
{
    if (!file_) fail(name_, ": cannot be opened: ", reason_of(errno));
    struct stat status {};
    if (::fstat(file_.number(), &status) != 0) fail(name_, ": cannot be examined: ", reason_of(errno));
    if (!S_ISREG(status.st_mode)) fail(name_, ": is not a regular file; expected a file of a mesh");
    size_ = uint64_t(status.st_size);
    const size_t bytes = size_t(std::clamp<uint64_t>(size_, 1, MAX_BUFFER_BYTES));
    memory.take(bytes);
    buffer_.resize(bytes);
}

void MeshInput::fail_at_end() const
{
    fail(name_, ": ends after ", size_, " bytes, before all that it announces; expected the whole file: copy it again");
}

/// Buffers at least `wanted` bytes, unless the file ends earlier.
void MeshInput::fill(size_t wanted)
{
    if (end_ - begin_ >= wanted) return;
    std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
    end_ -= begin_;
    begin_ = 0;
    while (end_ < wanted && offset_ < size_) {
        const size_t bytes = size_t(std::min<uint64_t>(buffer_.size() - end_, size_ - offset_));
        const ssize_t count = ::pread(file_.number(), buffer_.data() + end_, bytes, off_t(offset_));
        if (count < 0 && errno == EINTR) continue;
        if (count < 0) fail(name_, ": cannot be read: ", reason_of(errno));
        if (count == 0) fail(name_, ": ended after ", offset_, " bytes; expected ", size_);
        end_ += size_t(count);
        offset_ += uint64_t(count);
        read_ += uint64_t(count);
        tell(progress_, std::min(1.0, double(read_) / double(size_)));
    }
}

void MeshInput::seek(uint64_t position)
{
    if (position > size_) fail_at_end();
    if (position >= offset_ - end_ && position <= offset_) {
        begin_ = end_ - size_t(offset_ - position);
        return;
    }
    begin_ = end_ = 0;
    offset_ = position;
}

std::string_view MeshInput::peek(size_t bytes)
{
    fill(std::min(bytes, buffer_.size()));
    return buffered().substr(0, bytes);
}

void MeshInput::read(std::span<char> bytes)
{
    while (!bytes.empty()) {
        fill(std::min(bytes.size(), buffer_.size()));
        const size_t count = std::min(bytes.size(), end_ - begin_);
        if (count == 0) fail_at_end();
        std::memcpy(bytes.data(), buffer_.data() + begin_, count);
        begin_ += count;
        bytes = bytes.subspan(count);
    }
}

void MeshInput::skip(uint64_t bytes)
{
    if (bytes > rest()) fail_at_end();
    seek(position() + bytes);
}

std::optional<std::string_view> MeshInput::line()
{
    size_t end = buffered().find('\n');
    if (end == std::string_view::npos) {
        fill(buffer_.size());
        end = buffered().find('\n');
    }
    if (end == std::string_view::npos && rest() == 0) return std::nullopt;
    line_ = ++line_ends_;
    if (end == std::string_view::npos && rest() > end_ - begin_)
        fail(place(), ": is longer than ", MAX_BUFFER_BYTES, " bytes; expected a shorter line");
    std::string_view line = buffered().substr(0, end);
    begin_ += std::min(line.size() + 1, end_ - begin_);
    if (line.ends_with('\r')) line.remove_suffix(1);
    return line;
}

std::string_view MeshInput::word()
{
    for (;;) {
        fill(1);
        const std::string_view rest = buffered();
        const size_t first = std::min(rest.find_first_not_of(SPACES), rest.size());
        line_ends_ += uint64_t(std::count(rest.begin(), rest.begin() + ptrdiff_t(first), '\n'));
        begin_ += first;
        if (begin_ < end_ || offset_ == size_) break;
    }
    line_ = line_ends_ + 1;
    size_t end = buffered().find_first_of(SPACES);
    if (end == std::string_view::npos) {
        fill(buffer_.size());
        end = buffered().find_first_of(SPACES);
    }
    if (end == std::string_view::npos && rest() > end_ - begin_)
        fail(place(), ": has a word of more than ", MAX_BUFFER_BYTES, " bytes; expected numbers and short words");
    const std::string_view word = buffered().substr(0, end);
    begin_ += word.size();
    return word;
}

}  // namespace shvr
