#include "engine/components/component_runs.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <utility>

#include "engine/base/error.h"

namespace shvr {
namespace {

FileDescriptor nameless_file(const std::filesystem::path& folder)
{
    const std::filesystem::path place = folder.empty() ? "." : folder;
    const int number = ::open(place.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
    if (number >= 0) return FileDescriptor(number);
    // A named file that is unlinked at once, since some file systems do not support unnamed files.
    std::string pattern = (place / ".shvr-runs-XXXXXX").string();
    FileDescriptor file(::mkostemp(pattern.data(), O_CLOEXEC));
    if (!file) fail(place.string(), ": no file can be made in it: ", reason_of(errno));
    ::unlink(pattern.c_str());
    return file;
}

}  // namespace

RunFile::RunFile(const std::filesystem::path& folder, int64_t lower, int64_t slices)
    : folder_(folder.empty() ? "." : folder), file_(nameless_file(folder)), lower_(lower), places_(size_t(slices))
{}

RunFile::RunFile(const std::filesystem::path& file, int64_t lower, std::vector<Place> places)
    : folder_(file), file_(::open(file.c_str(), O_RDONLY | O_CLOEXEC)), lower_(lower), places_(std::move(places))
{
    if (!file_) fail(file.string(), ": cannot be read: ", reason_of(errno));
    for (const Place& place : places_) end_ = std::max<int64_t>(end_, place.offset);
}

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
    places_[size_t(z - lower_)] = {place, uint32_t(slice.rows.size())};
}

void RunFile::get(std::span<std::byte> bytes, int64_t at) const
{
    while (!bytes.empty()) {
        const ssize_t count = ::pread(file_.number(), bytes.data(), bytes.size(), at);
        if (count < 0 && errno == EINTR) continue;
        if (count <= 0)
            fail(folder_.string(),
                 ": the runs of components cannot be read from it: ", reason_of(count < 0 ? errno : EIO));
        bytes = bytes.subspan(size_t(count));
        at += count;
    }
}

void RunFile::read(int64_t z, int64_t lower, int64_t upper, SliceRuns& slice) const
{
    slice.clear();
    if (z < lower_ || z >= lower_ + int64_t(places_.size())) return;
    const Place& place = places_[size_t(z - lower_)];
    if (place.rows == 0) return;
    std::vector<SliceRuns::Row>& rows = slice.rows;
    rows.resize(place.rows);
    get(std::as_writable_bytes(std::span(rows)), place.offset);
    const auto begin = std::ranges::lower_bound(rows, lower, {}, &SliceRuns::Row::y);
    const auto end = std::ranges::lower_bound(rows, upper, {}, &SliceRuns::Row::y);
    if (begin == end) return slice.clear();
    const uint32_t first = begin == rows.begin() ? 0 : (begin - 1)->end;
    rows.erase(end, rows.end());
    rows.erase(rows.begin(), begin);
    for (SliceRuns::Row& row : rows) row.end -= first;
    slice.runs.resize(rows.back().end);
    const int64_t rows_bytes = place.rows * int64_t(sizeof(SliceRuns::Row));
    get(std::as_writable_bytes(std::span(slice.runs)),
        place.offset + rows_bytes + first * int64_t(sizeof(LabelledRun)));
}

}  // namespace shvr
