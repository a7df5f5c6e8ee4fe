#include "engine/formats/voxel_bytes.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <mutex>
#include <utility>

#include "engine/base/error.h"

namespace shvr {
namespace {

class FileBytes final : public VoxelBytes {
public:
    FileBytes(InputFile file, int64_t offset) : file_(std::move(file)), offset_(offset) {}

    void read(int64_t offset, std::span<std::byte> bytes) const override
    {
        const size_t count = file_.read_some(offset_ + offset, bytes);
        if (count == bytes.size()) return;
        const int64_t end = offset_ + offset + int64_t(count);
        fail(file_.path.string(), ": ended after ", end, " bytes; expected ", offset_ + offset + int64_t(bytes.size()),
             ": it was truncated while open");
    }

private:
    InputFile file_;
    int64_t offset_;
};

class PartBytes final : public VoxelBytes {
public:
    PartBytes(size_t count, int64_t share_bytes, std::function<std::unique_ptr<VoxelBytes>(size_t)> open)
        : count_(count), share_bytes_(share_bytes), open_(std::move(open))
    {}

    void read(int64_t offset, std::span<std::byte> bytes) const override
    {
        while (!bytes.empty()) {
            const int64_t within = offset % share_bytes_;
            const auto here = std::min(bytes.size(), size_t(share_bytes_ - within));
            part(size_t(offset / share_bytes_))->read(within, bytes.first(here));
            bytes = bytes.subspan(here);
            offset += int64_t(here);
        }
    }

private:
    struct Open {
        size_t number = 0;
        std::shared_ptr<const VoxelBytes> bytes{};
    };

    /// Maximum number of open files: enough for threads that read different parts, but far fewer than a stack's slices.
    static constexpr size_t MAX_OPEN_FILES = 16;

    std::shared_ptr<const VoxelBytes> part(size_t number) const
    {
        SHVR_CHECK(number < count_, number, " of ", count_);
        const std::lock_guard lock(mutex_);
        auto found =
            std::find_if(parts_.begin(), parts_.end(), [&](const Open& open) { return open.number == number; });
        if (found == parts_.end()) {
            std::shared_ptr<const VoxelBytes> opened = open_(number);
            if (parts_.size() == MAX_OPEN_FILES) parts_.pop_back();
            found = parts_.insert(parts_.end(), {number, std::move(opened)});
        }
        std::rotate(parts_.begin(), found, found + 1);  // most recently used first
        return parts_.front().bytes;
    }

    size_t count_;
    int64_t share_bytes_;
    std::function<std::unique_ptr<VoxelBytes>(size_t)> open_;
    mutable std::mutex mutex_;
    mutable std::vector<Open> parts_;
};

}  // namespace

size_t InputFile::read_some(int64_t offset, std::span<std::byte> buffer) const
{
    size_t done = 0;
    while (done < buffer.size()) {
        const ssize_t count =
            ::pread(descriptor.number(), buffer.data() + done, buffer.size() - done, offset + int64_t(done));
        if (count < 0 && errno == EINTR) continue;
        if (count < 0) fail(path.string(), ": cannot be read: ", reason_of(errno));
        if (count == 0) break;
        done += size_t(count);
    }
    return done;
}

InputFile open_input_file(const std::filesystem::path& path)
{
    // Without O_NONBLOCK, opening a FIFO would block until a writer appears, before it can be recognised as a FIFO.
    InputFile file{.path = path, .descriptor = FileDescriptor(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK))};
    if (!file.descriptor) fail(path.string(), ": cannot be opened: ", reason_of(errno));
    struct stat status {};
    if (::fstat(file.descriptor.number(), &status) != 0)
        fail(path.string(), ": cannot be examined: ", reason_of(errno));
    if (!S_ISREG(status.st_mode)) {
        fail(path.string(), ": is ", S_ISDIR(status.st_mode) ? "a folder" : "a pipe or device", "; expected a file");
    }
    file.bytes = status.st_size;
    return file;
}

std::unique_ptr<VoxelBytes> bytes_of_file(InputFile file, int64_t offset)
{
    return std::make_unique<FileBytes>(std::move(file), offset);
}

std::unique_ptr<VoxelBytes> bytes_of_parts(size_t count, int64_t share_bytes,
                                           std::function<std::unique_ptr<VoxelBytes>(size_t)> open)
{
    return std::make_unique<PartBytes>(count, share_bytes, std::move(open));
}

}  // namespace shvr
