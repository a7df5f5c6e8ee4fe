#include "engine/components/component_runs.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>

#include "engine/base/error.h"

namespace shvr {
namespace {

FileDescriptor nameless_file(const std::filesystem::path& folder)
{
    const std::filesystem::path place = folder.empty() ? "." : folder;
    const int number = ::open(place.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
    if (number >= 0) return FileDescriptor(number);
    // Some file systems do not support unnamed files.
    std::string pattern = (place / ".shvr-runs-XXXXXX").string();
    FileDescriptor file(::mkostemp(pattern.data(), O_CLOEXEC));
    if (!file) fail(place.string(), ": no file can be made in it: ", reason_of(errno));
    ::unlink(pattern.c_str());
    return file;
}

}  // namespace

RunFile::RunFile(const std::filesystem::path& folder, const Size3& size)
    : folder_(folder.empty() ? "." : folder),
      file_(nameless_file(folder)),
      rows_bytes_((size.y + 1) * int64_t(sizeof(uint32_t))),
      places_(size_t(size.z), int64_t{-1})
{}

void RunFile::write(int64_t z, const SliceRuns& slice)
{
    if (slice.runs.empty()) return;
    const auto put = [&](std::span<const std::byte> bytes, int64_t at) {
        while (!bytes.empty()) {
            const ssize_t count = ::pwrite(file_.number(), bytes.data(), bytes.size(), at);
            if (count < 0 && errno == EINTR) continue;
            if (count <= 0)
                fail(folder_.string(),
                     ": the runs of components cannot be kept in it: ", reason_of(count < 0 ? errno : ENOSPC));
            bytes = bytes.subspan(size_t(count));
            at += count;
        }
    };
    const auto rows = std::as_bytes(std::span(slice.rows));
    const auto runs = std::as_bytes(std::span(slice.runs));
    const int64_t place = end_.fetch_add(int64_t(rows.size() + runs.size()));
    put(rows, place);
    put(runs, place + int64_t(rows.size()));
    places_[size_t(z)] = place;
}

void RunFile::read(int64_t z, int64_t lower, int64_t upper, SliceRuns& slice) const
{
    slice.rows.assign(size_t(upper - lower + 1), 0);
    slice.runs.clear();
    const int64_t place = places_[size_t(z)];
    if (place < 0) return;
    const auto get = [&](std::span<std::byte> bytes, int64_t at) {
        while (!bytes.empty()) {
            const ssize_t count = ::pread(file_.number(), bytes.data(), bytes.size(), at);
            if (count < 0 && errno == EINTR) continue;
            if (count <= 0)
                fail(folder_.string(),
                     ": the runs of components cannot be read from it: ", reason_of(count < 0 ? errno : EIO));
            bytes = bytes.subspan(size_t(count));
            at += count;
        }
    };
    constexpr auto ROW = int64_t(sizeof(uint32_t));
    constexpr auto RUN = int64_t(sizeof(LabelledRun));
    get(std::as_writable_bytes(std::span(slice.rows)), place + lower * ROW);
    const uint32_t first = slice.rows.front();
    for (uint32_t& row : slice.rows) row -= first;
    slice.runs.resize(slice.rows.back());
    get(std::as_writable_bytes(std::span(slice.runs)), place + rows_bytes_ + first * RUN);
}

}  // namespace shvr
