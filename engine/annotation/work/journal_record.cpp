#include "engine/annotation/work/journal_record.h"

#include <bit>
#include <cmath>
#include <cstring>
#include <utility>

#include "engine/base/error.h"

namespace shvr {

namespace {

enum class Tag : uint8_t { mask_brick = 1, density_brick, node, internode, size, selection, setting };

class Writer {
public:
    void byte(uint8_t value) { bytes_.push_back(std::byte(value)); }
    void whole(uint64_t value)
    {
        for (; value >= 128; value >>= 7) byte(uint8_t(value | 128));
        byte(uint8_t(value));
    }
    void fixed(uint64_t value, int bytes)
    {
        for (int i = 0; i < bytes; ++i) byte(uint8_t(value >> (8 * i)));
    }
    void real(double value) { fixed(std::bit_cast<uint64_t>(value), 8); }
    void text(const std::string& value)
    {
        whole(value.size());
        const auto bytes = std::as_bytes(std::span(value));
        bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
    }
    std::vector<std::byte> take() { return std::move(bytes_); }

private:
    std::vector<std::byte> bytes_;
};

class Reader {
public:
    explicit Reader(std::span<const std::byte> bytes) : bytes_(bytes) {}

    bool at_end() const { return bytes_.empty(); }
    uint8_t byte()
    {
        if (bytes_.empty()) fail("it ends too early");
        const auto value = uint8_t(bytes_[0]);
        bytes_ = bytes_.subspan(1);
        return value;
    }
    uint64_t whole()
    {
        uint64_t value = 0;
        for (int shift = 0; shift < 64; shift += 7) {
            const uint8_t next = byte();
            if (shift == 63 && next > 1) break;
            value |= uint64_t(next & 127) << shift;
            if (next < 128) return value;
        }
        fail("a number has more than 64 bits");
    }
    uint64_t whole(uint64_t most)
    {
        const uint64_t value = whole();
        if (value > most) fail("a number is ", value, "; expected at most ", most);
        return value;
    }
    /// Reads the number of the items that follow; each item has at least `bytes_each` bytes.
    size_t count(size_t bytes_each)
    {
        const uint64_t value = whole();
        if (value > bytes_.size() / bytes_each)
            fail(value, " elements are said to follow in ", bytes_.size(), " bytes; expected at most ",
                 bytes_.size() / bytes_each);
        return size_t(value);
    }
    uint64_t fixed(int bytes)
    {
        uint64_t value = 0;
        for (int i = 0; i < bytes; ++i) value |= uint64_t(byte()) << (8 * i);
        return value;
    }
    double real() { return std::bit_cast<double>(fixed(8)); }
    std::string text()
    {
        std::string value(count(1), '\0');
        if (!value.empty()) std::memcpy(value.data(), bytes_.data(), value.size());
        bytes_ = bytes_.subspan(value.size());
        return value;
    }
    void expect_end() const
    {
        if (!bytes_.empty()) fail(bytes_.size(), " bytes are left at its end");
    }

private:
    std::span<const std::byte> bytes_;
};

// ---- Bricks: each run as its distance from the previous one -----

void write(Writer& out, const MaskRun& run)
{
    out.byte(run.before);
    out.byte(run.after);
}

void write(Writer& out, const DensityRun& run)
{
    out.fixed(run.before, 4);
    out.fixed(run.after, 4);
}

void read(Reader& in, MaskRun& run)
{
    run.before = in.byte();
    run.after = in.byte();
}

void read(Reader& in, DensityRun& run)
{
    run.before = uint32_t(in.fixed(4));
    run.after = uint32_t(in.fixed(4));
}

template <class BrickChange>
void write_brick(Writer& out, Tag tag, const BrickChange& change)
{
    out.byte(uint8_t(tag));
    out.whole(uint64_t(change.brick));
    out.whole(change.runs.size());
    uint32_t free_from = 0;
    for (const auto& run : change.runs) {
        out.whole(uint64_t(run.first - free_from));
        out.whole(uint64_t(run.last - run.first));
        write(out, run);
        free_from = run.last + 1u;
    }
}

template <class BrickChange>
BrickChange read_brick(Reader& in)
{
    BrickChange change;
    change.brick = int64_t(in.whole(uint64_t{1} << 62));
    change.runs.resize(in.count(4));
    uint64_t free_from = 0;
    for (auto& run : change.runs) {
        const uint64_t first = free_from + in.whole(VOXELS_PER_BRICK);
        const uint64_t last = first + in.whole(VOXELS_PER_BRICK);
        if (last >= VOXELS_PER_BRICK) fail("a run ends at ", last, "; expected below ", VOXELS_PER_BRICK);
        run.first = uint16_t(first);
        run.last = uint16_t(last);
        read(in, run);
        free_from = last + 1;
    }
    return change;
}

// ---- The trace ----

void write(Writer& out, const TraceNode& node)
{
    for (int axis = 0; axis < 3; ++axis) out.real(node.position[axis]);
    out.real(node.radius);
    out.byte(node.group);
}

void write(Writer& out, const TraceInternode& internode)
{
    out.whole(internode.a);
    out.whole(internode.b);
    out.byte(internode.group);
}

void write(Writer& out, double radius)
{
    out.real(radius);
}

constexpr uint64_t LAST_NUMBER = 0xffffffffu;

void read(Reader& in, TraceNode& node)
{
    for (int axis = 0; axis < 3; ++axis) node.position[axis] = in.real();
    node.radius = in.real();
    node.group = in.byte();
}

void read(Reader& in, TraceInternode& internode)
{
    internode.a = uint32_t(in.whole(LAST_NUMBER));
    internode.b = uint32_t(in.whole(LAST_NUMBER));
    internode.group = in.byte();
}

void read(Reader& in, double& radius)
{
    radius = in.real();
}

template <class Value>
void write_both(Writer& out, const std::optional<Value>& before, const std::optional<Value>& after)
{
    out.byte(uint8_t(int(before.has_value()) + 2 * int(after.has_value())));
    for (const auto& value : {before, after})
        if (value) write(out, *value);
}

template <class Value>
void read_both(Reader& in, std::optional<Value>& before, std::optional<Value>& after)
{
    const uint8_t there = in.byte();
    if (there > 3) fail("values before and after are marked ", int(there), "; expected 0 to 3");
    if ((there & 1) != 0) read(in, before.emplace());
    if ((there & 2) != 0) read(in, after.emplace());
}

void write(Writer& out, const std::vector<uint32_t>& ascending)
{
    out.whole(ascending.size());
    uint64_t free_from = 0;
    for (const uint32_t number : ascending) {
        out.whole(number - free_from);
        free_from = uint64_t{number} + 1;
    }
}

std::vector<uint32_t> read_numbers(Reader& in)
{
    std::vector<uint32_t> ascending(in.count(1));
    uint64_t free_from = 0;
    for (uint32_t& number : ascending) {
        const uint64_t next = free_from + in.whole(LAST_NUMBER);
        if (next > LAST_NUMBER) fail("a number is ", next, "; expected at most ", LAST_NUMBER);
        number = uint32_t(next);
        free_from = next + 1;
    }
    return ascending;
}

void write(Writer& out, const TraceSelection& selection)
{
    write(out, selection.nodes);
    write(out, selection.internodes);
}

TraceSelection read_selection(Reader& in)
{
    TraceSelection selection;
    selection.nodes = read_numbers(in);
    selection.internodes = read_numbers(in);
    return selection;
}

// ---- Changes ----

class ChangeWriter {
public:
    explicit ChangeWriter(Writer& out) : out_(out) {}

    void operator()(const MaskBrickChange& change) const { write_brick(out_, Tag::mask_brick, change); }
    void operator()(const DensityBrickChange& change) const { write_brick(out_, Tag::density_brick, change); }
    void operator()(const TraceChange& change) const { std::visit(*this, change); }
    void operator()(const TraceNodeChange& change) const { number(Tag::node, change.node, change); }
    void operator()(const TraceInternodeChange& change) const { number(Tag::internode, change.internode, change); }
    void operator()(const TraceSizeChange& change) const { number(Tag::size, change.group, change); }
    void operator()(const TraceSelectionChange& change) const
    {
        out_.byte(uint8_t(Tag::selection));
        write(out_, change.before);
        write(out_, change.after);
    }

    void operator()(const SettingChange& change) const
    {
        out_.byte(uint8_t(Tag::setting));
        for (const std::string& text : {change.name, change.before, change.after}) out_.text(text);
    }

private:
    template <class Record>
    void number(Tag tag, uint64_t number, const Record& record) const
    {
        out_.byte(uint8_t(tag));
        out_.whole(number);
        write_both(out_, record.before, record.after);
    }
    Writer& out_;
};

template <class Record, class Number>
TraceChange read_traced(Reader& in, Number Record::*number, uint64_t most)
{
    Record record;
    record.*number = Number(in.whole(most));
    read_both(in, record.before, record.after);
    return record;
}

Change read_change(Reader& in)
{
    const uint8_t tag = in.byte();
    switch (Tag(tag)) {
        case Tag::mask_brick: return read_brick<MaskBrickChange>(in);
        case Tag::density_brick: return read_brick<DensityBrickChange>(in);
        case Tag::node: return read_traced(in, &TraceNodeChange::node, LAST_NUMBER);
        case Tag::internode: return read_traced(in, &TraceInternodeChange::internode, LAST_NUMBER);
        case Tag::size: return read_traced(in, &TraceSizeChange::group, 255);
        case Tag::selection: {
            TraceSelectionChange record;
            record.before = read_selection(in);
            record.after = read_selection(in);
            return TraceChange(std::move(record));
        }
        case Tag::setting: {
            SettingChange record;
            for (std::string* text : {&record.name, &record.before, &record.after}) *text = in.text();
            return record;
        }
    }
    fail("a change is of kind ", int(tag), "; expected 1 to 7");
}

/// The records that recreate all bricks.
template <class Value>
void write_bricks(const ChangeWriter& change, const SparseBricks<Value>& bricks)
{
    for (const int64_t index : bricks.painted_bricks()) {
        BrickChange<Value> record{index, {}};
        append_painted_runs(record.runs, *bricks.brick(index), 0);
        change(record);
    }
}

}  // namespace

std::vector<std::byte> bytes_of(const JournalSubject& subject)
{
    Writer out;
    for (int axis = 0; axis < 3; ++axis) out.whole(uint64_t(subject.size[axis]));
    out.text(name_of(subject.type));
    out.text(subject.image);
    return out.take();
}

JournalSubject subject_of(std::span<const std::byte> bytes)
{
    Reader in(bytes);
    JournalSubject subject;
    for (int axis = 0; axis < 3; ++axis) subject.size[axis] = int64_t(in.whole(uint64_t{1} << 40));
    const std::string type = in.text();
    const std::optional<VoxelType> known = voxel_type_of(type);
    if (!known) fail("the volume's voxels are of type \"", type, "\", which is not known");
    subject.type = *known;
    subject.image = in.text();
    in.expect_end();
    return subject;
}

std::vector<std::byte> bytes_of(const JournalSpace& space)
{
    Writer out;
    for (int axis = 0; axis < 3; ++axis) out.real(space.spacing[axis]);
    out.text(space.unit);
    return out.take();
}

JournalSpace space_of(std::span<const std::byte> bytes)
{
    Reader in(bytes);
    JournalSpace space;
    for (int axis = 0; axis < 3; ++axis) {
        space.spacing[axis] = in.real();
        if (!(space.spacing[axis] > 0.0 && space.spacing[axis] < INFINITY))
            fail("a voxel's side is ", space.spacing[axis], "; expected a number above 0");
    }
    space.unit = in.text();
    in.expect_end();
    return space;
}

std::vector<std::byte> bytes_of(const JournalTime& time)
{
    Writer out;
    out.fixed(uint64_t(time.time_ms), 8);
    return out.take();
}

JournalTime time_of(std::span<const std::byte> bytes)
{
    Reader in(bytes);
    const JournalTime time{int64_t(in.fixed(8))};
    in.expect_end();
    return time;
}

// ---- Saved files and settings ----

namespace {

void write(Writer& out, const SettingValues& values)
{
    out.whole(values.size());
    for (const auto& [name, value] : values) {
        out.text(name);
        out.text(value);
    }
}

SettingValues read_settings(Reader& in)
{
    SettingValues values;
    for (size_t count = in.count(2); count > 0; --count) {
        std::string name = in.text();
        values[std::move(name)] = in.text();
    }
    in.expect_end();
    return values;
}

}  // namespace

std::vector<std::byte> bytes_of(const SettingValues& values)
{
    Writer out;
    write(out, values);
    return out.take();
}

SettingValues setting_values_of(std::span<const std::byte> bytes)
{
    Reader in(bytes);
    return read_settings(in);
}

std::vector<std::byte> bytes_of(const SavedFiles& files)
{
    Writer out;
    for (const std::optional<uint64_t>& file : {files.mask, files.trace, files.density}) {
        out.byte(file ? 1 : 0);
        out.fixed(file.value_or(0), 8);
    }
    if (files.settings) write(out, *files.settings);
    return out.take();
}

SavedFiles saved_files_of(std::span<const std::byte> bytes)
{
    Reader in(bytes);
    SavedFiles files;
    for (std::optional<uint64_t>* file : {&files.mask, &files.trace, &files.density}) {
        const bool is_there = in.byte() != 0;
        const uint64_t digest = in.fixed(8);
        if (is_there) *file = digest;
    }
    if (!in.at_end()) files.settings = read_settings(in);
    return files;
}

std::vector<std::byte> bytes_of(std::span<const Change> changes)
{
    Writer out;
    for (const Change& change : changes) std::visit(ChangeWriter(out), change);
    return out.take();
}

std::vector<Change> changes_of(std::span<const std::byte> bytes)
{
    std::vector<Change> changes;
    for (Reader in(bytes); !in.at_end();) changes.push_back(read_change(in));
    return changes;
}

std::vector<std::byte> bytes_of(const Document& document)
{
    Writer out;
    out.whole(document.trace.next_node());
    out.whole(document.trace.next_internode());
    const ChangeWriter change(out);
    write_bricks(change, document.mask);
    write_bricks(change, document.density);
    const TraceGraph& trace = document.trace;
    for (const auto& [number, node] : trace.nodes()) change(TraceNodeChange{number, {}, node});
    for (const auto& [number, internode] : trace.internodes()) change(TraceInternodeChange{number, {}, internode});
    for (const auto& [group, radius] : trace.internode_radii()) change(TraceSizeChange{group, {}, radius});
    change(TraceSelectionChange{{}, trace.selection()});
    for (const auto& [name, value] : document.settings.values()) change(SettingChange{name, {}, value});
    return out.take();
}

Document document_of(std::span<const std::byte> bytes, Document empty, const std::function<void(Change&)>& convert)
{
    Reader in(bytes);
    constexpr uint64_t MAX_NUMBERS = LAST_NUMBER + 1;
    const uint64_t next_node = in.whole(MAX_NUMBERS), next_internode = in.whole(MAX_NUMBERS);
    while (!in.at_end()) {
        Change change = read_change(in);
        if (convert) convert(change);
        apply_if_it_fits(empty, std::span(&change, 1), Direction::forwards);
    }
    empty.trace.reserve_numbers(next_node, next_internode);
    return empty;
}

}  // namespace shvr
