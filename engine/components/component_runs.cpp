#include "engine/components/component_runs.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
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

void SliceRuns::add_row(uint32_t y, std::span<const uint32_t> ends, uint32_t label)
{
    const size_t first = steps.size();
    steps.resize(first + ends.size());
    uint8_t* const to = steps.data() + first;
    uint32_t longest = 0, before = 0;
    for (size_t i = 0; i < ends.size(); ++i) {
        const uint32_t step = ends[i] - before;
        before = ends[i];
        to[i] = uint8_t(step);
        longest = std::max(longest, step);
    }
    if (longest >= LONG_STEP) {
        steps.resize(first);
        before = 0;
        for (const uint32_t end : ends) {
            const uint32_t step = end - std::exchange(before, end);
            steps.push_back(uint8_t(std::min<uint32_t>(step, LONG_STEP)));
            const auto* const bytes = reinterpret_cast<const uint8_t*>(&step);
            if (step >= LONG_STEP) steps.insert(steps.end(), bytes, bytes + sizeof step);
        }
    }
    labels.resize(labels.size() + ends.size() / 2, label);
    rows.push_back({y, uint32_t(labels.size()), steps.size()});
}

void SliceRuns::get_row(size_t i, std::vector<LabelledRun>& runs) const
{
    runs.clear();
    uint32_t at = 0;
    const uint8_t* step = steps.data() + (i == 0 ? 0 : rows[i - 1].steps_end);
    const uint8_t* const end = steps.data() + rows[i].steps_end;
    const auto next = [&] {
        if (step == end) return at;
        uint32_t distance = *step++;
        if (distance == LONG_STEP) {
            const size_t bytes = std::min(sizeof distance, size_t(end - step));
            std::memcpy(&distance, step, bytes);
            step += bytes;
        }
        return at += distance;
    };
    for (size_t label = first_of(i); label < rows[i].end; ++label) {
        const uint32_t begin = next();
        runs.push_back({begin, next(), labels[label]});
    }
}

RunFile::RunFile(const std::filesystem::path& folder, int64_t lower, int64_t slices)
    : folder_(folder.empty() ? "." : folder), file_(nameless_file(folder)), lower_(lower), places_(size_t(slices))
{}

RunFile::RunFile(const std::filesystem::path& file, int64_t lower, std::vector<Place> places)
    : folder_(file), file_(::open(file.c_str(), O_RDONLY | O_CLOEXEC)), lower_(lower), places_(std::move(places))
{
    if (!file_) fail(file.string(), ": cannot be read: ", reason_of(errno));
    end_ = ::lseek(file_.number(), 0, SEEK_END);
}

void RunFile::write(int64_t z, const SliceRuns& slice)
{
    if (slice.rows.empty()) return;
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
    const std::span<const std::byte> parts[] = {std::as_bytes(std::span(slice.rows)),
                                                std::as_bytes(std::span(slice.steps)),
                                                std::as_bytes(std::span(slice.labels))};
    const int64_t place = end_.fetch_add(int64_t(parts[0].size() + parts[1].size() + parts[2].size()));
    int64_t at = place;
    for (const std::span<const std::byte> part : parts) {
        put(part, at);
        at += int64_t(part.size());
    }
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
    const SliceRuns::Row all = rows.back();
    const SliceRuns::Row first = begin == rows.begin() ? SliceRuns::Row() : *(begin - 1);
    rows.erase(end, rows.end());
    rows.erase(rows.begin(), begin);
    SliceRuns::Row before = first;
    for (const SliceRuns::Row& row : rows) {
        // A piece of another process may be damaged.
        if (row.end < before.end || row.steps_end < before.steps_end || row.steps_end > all.steps_end ||
            all.steps_end > uint64_t(end_) || row.end > uint64_t(end_))
            fail(folder_.string(), ": the runs of slice ", z, " are damaged; expected those that its task has made");
        before = row;
    }
    const SliceRuns::Row& last = rows.back();
    slice.steps.resize(last.steps_end - first.steps_end);
    slice.labels.resize(last.end - first.end);
    for (SliceRuns::Row& row : rows) {
        row.end -= first.end;
        row.steps_end -= first.steps_end;
    }
    const int64_t steps = place.offset + place.rows * int64_t(sizeof(SliceRuns::Row));
    get(std::as_writable_bytes(std::span(slice.steps)), steps + int64_t(first.steps_end));
    get(std::as_writable_bytes(std::span(slice.labels)),
        steps + int64_t(all.steps_end) + first.end * int64_t(sizeof(uint32_t)));
}

}  // namespace shvr
