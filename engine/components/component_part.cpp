#include "engine/components/component_part.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <limits>
#include <span>

#include "engine/base/atomic_writer.h"
#include "engine/base/machine/machine.h"
#include "engine/base/text.h"
#include "engine/base/waits/work_pool.h"

// The file: the runs of each slice, then the description (places of these, ranges), and its length in 8 bytes.

namespace shvr {

namespace {

/// Ranges per thread (several, to balance the load, as some ranges hold more runs), and a range's minimum thickness.
constexpr int64_t RANGES_PER_THREAD = 4, THINNEST_RANGE = 16;
/// Maximum size of a slice stored as bits: 2^33 voxels.
constexpr int64_t MAX_SLICE_BYTES = int64_t{1} << 30;
constexpr uint64_t MAGIC = 0x3274726170766873;  // "shvpart2", byte by byte

/// Values and lists of plain values, each list preceded by its length.
class Description {
public:
    template <class T>
    void put(const T& value)
    {
        const auto bytes = std::as_bytes(std::span(&value, 1));
        bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
    }
    template <class T>
    void put_all(std::span<const T> elements)
    {
        put(uint64_t{elements.size()});
        const auto bytes = std::as_bytes(elements);
        bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
    }
    const std::vector<std::byte>& bytes() const { return bytes_; }

private:
    std::vector<std::byte> bytes_;
};

/// Reads what Description holds; `is_good` turns false where bytes are missing.
class DescriptionReader {
public:
    explicit DescriptionReader(std::span<const std::byte> bytes) : rest_(bytes) {}

    template <class T>
    T take()
    {
        T value{};
        is_good = is_good && rest_.size() >= sizeof(T);
        if (!is_good) return value;
        std::memcpy(&value, rest_.data(), sizeof(T));
        rest_ = rest_.subspan(sizeof(T));
        return value;
    }
    template <class T>
    std::vector<T> take_all()
    {
        const auto count = take<uint64_t>();
        is_good = is_good && count <= rest_.size() / sizeof(T);
        if (!is_good) return {};
        std::vector<T> elements(count);
        if (count > 0) std::memcpy(elements.data(), rest_.data(), count * sizeof(T));
        rest_ = rest_.subspan(count * sizeof(T));
        return elements;
    }
    std::span<const std::byte> rest() const { return rest_; }

    bool is_good = true;

private:
    std::span<const std::byte> rest_;
};

void put_slice(Description& to, const SliceRuns& slice)
{
    to.put_all(std::span(slice.rows));
    to.put_all(std::span(slice.steps));
    to.put_all(std::span(slice.labels));
}

/// Returns whether rows and runs of a slice fit together, with labels below `labels`.
bool is_sound(const SliceRuns& slice, uint64_t labels)
{
    SliceRuns::Row before;
    for (const SliceRuns::Row& row : slice.rows) {
        if (row.end < before.end || row.steps_end < before.steps_end) return false;
        before = row;
    }
    return before.end == slice.labels.size() && before.steps_end == slice.steps.size() &&
           std::ranges::all_of(slice.labels, [&](uint32_t label) { return label < labels; });
}

SliceRuns take_slice(DescriptionReader& from)
{
    SliceRuns slice;
    slice.rows = from.take_all<SliceRuns::Row>();
    slice.steps = from.take_all<uint8_t>();
    slice.labels = from.take_all<uint32_t>();
    return slice;
}

void put_range(Description& to, LabelledRange& range)
{
    to.put(range.lower_slice());
    to.put(range.upper_slice());
    to.put(range.foreground_voxels);
    std::vector<uint32_t> parents;
    std::vector<int64_t> voxels;
    for (uint64_t label = 0; label < range.forest.size(); ++label) {
        parents.push_back(range.forest.parent(uint32_t(label)));
        voxels.push_back(range.forest.voxels(uint32_t(label)));
    }
    to.put_all(std::span<const uint32_t>(parents));
    to.put_all(std::span<const int64_t>(voxels));
    put_slice(to, range.first);
    put_slice(to, range.last);
}

/// Appends the runs of all slices to the file, and returns where they are.
std::vector<RunFile::Place> append_runs(const RunFile& runs, const SliceRange& slices, AtomicWriter& file)
{
    std::vector<RunFile::Place> places(size_t(slices.upper - slices.lower));
    int64_t at = 0;
    SliceRuns slice;
    for (int64_t z = slices.lower; z < slices.upper; ++z) {
        runs.read(z, 0, std::numeric_limits<int64_t>::max(), slice);
        if (slice.rows.empty()) continue;
        places[size_t(z - slices.lower)] = {at, uint32_t(slice.rows.size())};
        for (const std::span<const std::byte> bytes :
             {std::as_bytes(std::span(slice.rows)), std::as_bytes(std::span(slice.steps)),
              std::as_bytes(std::span(slice.labels))}) {
            file.append(bytes);
            at += int64_t(bytes.size());
        }
    }
    return places;
}

}  // namespace

std::optional<StoredBlocks> stored_above(const VolumeSource& source, double threshold)
{
    const Size3& size = source.info().size;
    std::optional<StoredBlocks> stored = source.stored_blocks(0, MAX_STORED_BLOCKS);
    if (stored && !(stored->fill >= threshold)) {
        stored->fill = 0.0;  // fill value of the volume of labels
        return stored;
    }
    const int64_t bytes = words_of_row(size.x) * size.y * 8;
    if (bytes > MAX_SLICE_BYTES && stored)
        fail(source.info().name, ": holds ", stored->fill, " wherever nothing is stored, and the threshold is ",
             threshold, "; expected one above that, or a volume whose slices have at most ", 8 * MAX_SLICE_BYTES,
             " voxels");
    if (bytes > MAX_SLICE_BYTES)
        fail(source.info().name, ": a slice has ", size.x, " x ", size.y, " voxels; expected at most ",
             8 * MAX_SLICE_BYTES, " in all, or a part of the volume");
    return std::nullopt;
}

SlicesDone label_slices(const VolumeSource& source, const ComponentOptions& options,
                        const std::optional<StoredBlocks>& stored, const SliceRange& slices, RunFile* runs)
{
    const Size3& size = source.info().size;
    const int threads = options.threads > 0 ? options.threads : processors_allowed();
    const ThresholdBits bits(source.info().type, options.threshold);
    const BitLayout layout(size, stored);
    std::vector<BitSlab> slabs(size_t(threads), BitSlab(source, bits, layout));
    // Each range consists of whole blocks, so that no block is decoded twice.
    const int64_t count = slices.upper - slices.lower;
    const int64_t block = std::min(source.block().z, size.z);
    const int64_t wanted = threads == 1 ? 1 : threads * RANGES_PER_THREAD;
    const int64_t thickness = (std::max((count + wanted - 1) / wanted, THINNEST_RANGE) + block - 1) / block * block;
    SlicesDone done;
    for (int64_t z = slices.lower; z < slices.upper; z += thickness)
        done.ranges.emplace_back(z, std::min(slices.upper, z + thickness));

    HeldBytes held;
    std::atomic<int64_t> words_done = 0;
    const double words = std::max(double(layout.words()) * double(count) / double(size.z), 1.0);
    std::atomic<bool> is_stopped = false;
    WorkPool pool(threads, [&] {
        try {
            tell(options.progress, std::min(double(words_done) / words, 1.0));
        } catch (...) {
            is_stopped = true;  // makes the other threads stop soon; a range can take long
            throw;
        }
    });
    pool.run(int64_t(done.ranges.size()), [&](int64_t task, int worker) {
        done.ranges[size_t(task)].label(slabs[size_t(worker)], options.connectivity, runs, held, words_done,
                                        is_stopped);
    });
    done.peak_bytes = held.peak();
    return done;
}

void write_component_part(const VolumeSource& source, const ComponentOptions& options, const SliceRange& slices,
                          const std::filesystem::path& file, const std::function<std::string()>& note)
{
    const std::optional<StoredBlocks> stored = stored_above(source, options.threshold);
    AtomicWriter writer(file);
    std::optional<RunFile> runs;
    if (options.run_folder) runs.emplace(*options.run_folder, slices.lower, slices.upper - slices.lower);
    SlicesDone done = label_slices(source, options, stored, slices, runs ? &*runs : nullptr);
    const Size3& size = source.info().size;
    const std::string text = note ? note() : std::string();
    Description description;
    description.put(MAGIC);
    for (const int64_t number : {size.x, size.y, size.z, slices.lower, slices.upper}) description.put(number);
    description.put_all(std::span<const char>(text));
    const std::vector<RunFile::Place> places =
        runs ? append_runs(*runs, slices, writer) : std::vector<RunFile::Place>();
    description.put_all(std::span(places));
    description.put(uint64_t{done.ranges.size()});
    for (LabelledRange& range : done.ranges) {
        put_range(description, range);
        range.forest = LabelForest();
    }
    const uint64_t length = description.bytes().size();
    writer.append(description.bytes());
    writer.append(std::as_bytes(std::span(&length, 1)));
    writer.commit();
}

ComponentPart::ComponentPart(const std::filesystem::path& file, const Size3& size) : file_(file), size_(size)
{
    const FileDescriptor opened(::open(file.c_str(), O_RDONLY | O_CLOEXEC));
    const off_t bytes = opened ? ::lseek(opened.number(), 0, SEEK_END) : -1;
    const auto get = [&](void* to, size_t count, off_t at) {
        for (size_t done = 0; done < count;) {
            const ssize_t read =
                ::pread(opened.number(), static_cast<char*>(to) + done, count - done, at + off_t(done));
            if (read < 0 && errno == EINTR) continue;
            if (read <= 0) refuse();
            done += size_t(read);
        }
    };
    uint64_t length = 0;
    if (bytes < off_t(sizeof length)) refuse();
    get(&length, sizeof length, bytes - off_t(sizeof length));
    if (length > uint64_t(bytes) - sizeof length) refuse();
    std::vector<std::byte> description(length);
    get(description.data(), length, bytes - off_t(sizeof length) - off_t(length));
    DescriptionReader reader(description);
    if (reader.take<uint64_t>() != MAGIC) refuse();
    Size3 found;
    for (int axis = 0; axis < 3; ++axis) found[axis] = reader.take<int64_t>();
    slices_.lower = reader.take<int64_t>();
    slices_.upper = reader.take<int64_t>();
    const std::vector<char> text = reader.take_all<char>();
    note_.assign(text.begin(), text.end());
    places_ = reader.take_all<RunFile::Place>();
    if (!reader.is_good || slices_.lower > slices_.upper) refuse();
    if (found != size)
        fail(file.string(), ": is part of a volume of ", found.x, " x ", found.y, " x ", found.z, " voxels; expected ",
             size.x, " x ", size.y, " x ", size.z, ": remove it, and run its task again");
    ranges_.assign(reader.rest().begin(), reader.rest().end());
}

void ComponentPart::refuse() const
{
    fail(file_.string(), ": is not a part of a volume's components; expected what a task of shvr label writes: remove ",
         "it, and run the task again");
}

std::deque<LabelledRange> ComponentPart::read_ranges() const
{
    DescriptionReader reader(ranges_);
    std::deque<LabelledRange> ranges;
    int64_t next = slices_.lower;
    for (uint64_t left = reader.take<uint64_t>(); left > 0 && reader.is_good; --left) {
        const auto lower = reader.take<int64_t>(), upper = reader.take<int64_t>();
        if (lower != next || upper <= lower) refuse();
        next = upper;
        LabelledRange& range = ranges.emplace_back(lower, upper);
        range.foreground_voxels = reader.take<int64_t>();
        const std::vector<uint32_t> parents = reader.take_all<uint32_t>();
        const std::vector<int64_t> voxels = reader.take_all<int64_t>();
        if (voxels.size() != parents.size()) refuse();
        for (size_t i = 0; i < parents.size(); ++i) {
            const uint32_t label = range.forest.add();
            if (parents[i] > label || voxels[i] < 0) refuse();
            range.forest.parent(label) = parents[i];
            range.forest.add_voxels(label, voxels[i]);
        }
        range.first = take_slice(reader);
        range.last = take_slice(reader);
        if (!is_sound(range.first, parents.size()) || !is_sound(range.last, parents.size())) refuse();
    }
    if (!reader.is_good || next != slices_.upper) refuse();
    return ranges;
}

void ComponentPart::add_runs(std::deque<RunFile>& files) const
{
    if (slices_.lower == slices_.upper) return;
    if (places_.size() != size_t(slices_.upper - slices_.lower)) refuse();
    files.emplace_back(file_, slices_.lower, places_);
}

}  // namespace shvr
