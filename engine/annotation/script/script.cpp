#include "engine/annotation/script/script.h"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <sstream>

#include "engine/base/file.h"
#include "engine/base/json.h"
#include "engine/session/fields.h"

namespace shvr {

namespace {

constexpr int64_t MAX_SCRIPT_BYTES = int64_t{256} << 20;
constexpr int64_t MAX_COUNT = int64_t{1} << 62;
/// Limits far above the size of any volume, yet small enough that their squares do not overflow.
const NumberRange COORDINATE{-1e12, 1e12};
const NumberRange LENGTH{5e-324, 1e12, "a number above 0, up to 1e12"};

std::optional<double> read_length(const JsonNode& node)
{
    return node.exists() ? std::optional(node.number(LENGTH)) : std::nullopt;
}

uint8_t read_group(const JsonNode& node)
{
    return uint8_t(node.whole(0, 255));
}

/// Refuses all keys except `keys`, "op", and the "time" in lines of a log, which replays ignore.
void allow(const JsonNode& line, std::vector<std::string_view> keys)
{
    keys.insert(keys.begin(), "op");
    if (line["time"].exists()) keys.push_back("time");  // otherwise error messages would suggest it
    line.allow(keys);
}

/// Returns which of `keys` is present; refuses lines with none or several.
std::string_view one_of(const JsonNode& line, std::initializer_list<std::string_view> keys)
{
    std::string_view found;
    std::string known;
    for (const std::string_view key : keys) {
        known += sentence(known.empty() ? "" : ", ", key);
        if (!line[key].exists()) continue;
        if (!found.empty())
            line.refuse_because(sentence("keys ", found, " and ", key, " are both given; expected one of them"));
        found = key;
    }
    if (found.empty()) line.refuse_because(sentence("none of these keys is given: ", known, "; expected one of them"));
    return found;
}

std::vector<glm::dvec3> read_path(const JsonNode& node)
{
    if (node.count() == 0) node.refuse("[[x,y,z], ...] with at least one point");
    std::vector<glm::dvec3> points;
    points.reserve(node.count());
    for (const JsonNode& point : node.elements()) points.push_back(point.vector(any_number()));
    if (const double count = stroke_position_count(points); !(count <= double(MAX_STROKE_POSITIONS)))
        node.refuse_because(sentence(count, " positions a voxel apart; expected at most ", MAX_STROKE_POSITIONS));
    return points;
}

/// The keys that select voxels.
PaintOp read_brush(const JsonNode& line)
{
    PaintOp op;
    op.brush = line["brush"].choice<Brush>();
    op.region = line["region"].choice_or(op.region);
    op.threshold = line["threshold"].number(any_number());
    op.radius_voxels = line["radius"].number({5e-324, std::nextafter(128.0, 0.0), "a number above 0, below 128"});
    op.connectivity = int(line["connectivity"].whole(op.connectivity, 6, 26));
    if (op.connectivity != 6 && op.connectivity != 26) line["connectivity"].refuse("6 or 26");
    op.path = read_path(line["path"]);
    return op;
}

uint32_t read_number(const JsonNode& node)
{
    return uint32_t(node.whole(0, 4294967295));
}

NodeOp read_node(const JsonNode& line)
{
    allow(line, {"at", "radius", "group", "divides"});
    NodeOp op{line["at"].vector(COORDINATE), read_length(line["radius"]), {}};
    if (line["group"].exists()) op.group = read_group(line["group"]);
    if (line["divides"].exists()) op.divides = read_number(line["divides"]);
    return op;
}

/// Reads the search distance "within"; `key`, the key of the position, must be "near" or begin with it.
std::optional<double> read_within(const JsonNode& line, std::string_view key)
{
    const JsonNode within = line["within"];
    if (within.exists() && !key.starts_with("near"))
        line.refuse_because(sentence("key within is given with ", key, "; expected it with near"));
    return read_length(within);
}

SelectOp read_select(const JsonNode& line)
{
    allow(line, {"near", "near_internode", "within", "node", "internode"});
    const std::string_view key = one_of(line, {"near", "near_internode", "node", "internode"});
    SelectOp op;
    op.is_internode = key == "near_internode" || key == "internode";
    if (key.starts_with("near"))
        op.near = line[key].vector(COORDINATE);
    else
        op.number = read_number(line[key]);
    op.within_voxels = read_within(line, key);
    return op;
}

LinkOp read_link(const JsonNode& line)
{
    allow(line, {"near", "within", "node"});
    const std::string_view key = one_of(line, {"near", "node"});
    LinkOp op;
    if (key == "near")
        op.near = line["near"].vector(COORDINATE);
    else
        op.node = read_number(line["node"]);
    op.within_voxels = read_within(line, key);
    return op;
}

RadiusOp read_radius(const JsonNode& line)
{
    allow(line, {"radius", "group", "of"});
    RadiusOp op;
    const JsonNode of = line["of"];
    if (line["group"].exists()) {
        op.group = read_group(line["group"]);
        op.of = RadiusOp::Of::nodes;
        const std::array<std::string_view, 2> names{"nodes", "internodes"};
        if (of.exists() && of.choice(names) == 1) op.of = RadiusOp::Of::internodes;
    } else if (of.exists()) {
        line.refuse_because("key of is given without group; expected both, or neither for what is selected");
    }
    // A radius of null makes internodes taper from node to node.
    const bool tapers = op.of == RadiusOp::Of::internodes && line["radius"].is_null();
    if (!tapers) op.radius_voxels = line["radius"].number(LENGTH);
    return op;
}

bool read_only_unpainted(const JsonNode& line, const PaintOp& op)
{
    const bool only_unpainted = line["only_unpainted"].flag(op.only_unpainted);
    if (only_unpainted && !op.paints_group)
        line.refuse_because("key only_unpainted is true without group; expected a group, since offsets heed no paint");
    if (only_unpainted && op.group == 0)
        line.refuse_because(
            "key only_unpainted is true with group 0; expected a group from 1, since what is unpainted "
            "cannot be erased");
    return only_unpainted;
}

PaintOp read_paint(const JsonNode& line)
{
    allow(line, {"brush", "region", "group", "threshold", "radius", "connectivity", "path", "only_unpainted"});
    PaintOp op = read_brush(line);
    op.group = read_group(line["group"]);
    op.only_unpainted = read_only_unpainted(line, op);
    return op;
}

PaintOp read_density(const JsonNode& line)
{
    allow(line, {"brush", "region", "group", "threshold", "radius", "connectivity", "path", "only_unpainted", "offset",
                 "falloff"});
    PaintOp op = read_brush(line);
    op.paints_group = line["group"].exists();
    if (op.paints_group) op.group = read_group(line["group"]);
    op.only_unpainted = read_only_unpainted(line, op);
    op.density.emplace();
    op.density->falloff = line["falloff"].choice_or(op.density->falloff);
    const JsonNode offset = line["offset"];
    if (!offset.exists() || offset.is("automatic")) return op;
    if (!offset.is_number()) offset.refuse("a number or \"automatic\"");
    op.density->offset = offset.number(any_number());
    return op;
}

int read_count(const JsonNode& line)
{
    allow(line, {"count"});
    return int(line["count"].whole(1, 1, 1000000000));
}

/// The group that a key such as "3" names; null if the key is not the number of a group.
std::optional<uint8_t> group_of(const std::string& key)
{
    uint8_t group = 0;
    const auto result = std::from_chars(key.data(), key.data() + key.size(), group);
    const bool is_whole = result.ec == std::errc() && result.ptr == key.data() + key.size();
    return is_whole && (key.size() == 1 || key[0] != '0') ? std::optional(group) : std::nullopt;
}

std::optional<int64_t> read_expected(const JsonNode& node)
{
    return node.exists() ? std::optional(node.whole(0, MAX_COUNT)) : std::nullopt;
}

ExpectOp read_expect(const JsonNode& line)
{
    allow(line, {"voxels_in_group", "voxels_with_offset", "nodes", "internodes"});
    ExpectOp op;
    const JsonNode groups = line["voxels_in_group"];
    if (groups.exists() && !groups.is_object()) groups.refuse("an object such as {\"3\": 1234}");
    for (const std::string& key : groups.exists() ? groups.names() : std::vector<std::string>()) {
        const std::optional<uint8_t> group = group_of(key);
        if (!group) groups[key].refuse("a group, 0 ... 255, as its name");
        op.voxels_in_group[*group] = groups[key].whole(0, MAX_COUNT);
    }
    op.voxels_with_offset = read_expected(line["voxels_with_offset"]);
    op.nodes = read_expected(line["nodes"]);
    op.internodes = read_expected(line["internodes"]);
    return op;
}

/// An operation without keys of its own.
template <class Op>
Op read_bare(const JsonNode& line)
{
    allow(line, {});
    return Op{};
}

MoveOp read_move(const JsonNode& line)
{
    allow(line, {"to", "from"});
    MoveOp op{.to = line["to"].vector(COORDINATE)};
    if (const JsonNode from = line["from"]; from.exists()) op.from = from.vector(COORDINATE);
    return op;
}

GroupOp read_group_op(const JsonNode& line)
{
    allow(line, {"group"});
    return {read_group(line["group"])};
}

/// An operation and its reader, the more common ones first, because messages list them in this order.
struct OpReader {
    std::string_view name;
    ScriptOp (*read)(const JsonNode& line);
};
constexpr OpReader OPS[] = {
    {"paint", [](const JsonNode& line) -> ScriptOp { return read_paint(line); }},
    {"density", [](const JsonNode& line) -> ScriptOp { return read_density(line); }},
    {"node", [](const JsonNode& line) -> ScriptOp { return read_node(line); }},
    {"select", [](const JsonNode& line) -> ScriptOp { return read_select(line); }},
    {"select_segment", [](const JsonNode& line) -> ScriptOp { return read_bare<SelectSegmentOp>(line); }},
    {"deselect", [](const JsonNode& line) -> ScriptOp { return read_bare<DeselectOp>(line); }},
    {"link", [](const JsonNode& line) -> ScriptOp { return read_link(line); }},
    {"move", [](const JsonNode& line) -> ScriptOp { return read_move(line); }},
    {"delete", [](const JsonNode& line) -> ScriptOp { return read_bare<DeleteOp>(line); }},
    {"group", [](const JsonNode& line) -> ScriptOp { return read_group_op(line); }},
    {"radius", [](const JsonNode& line) -> ScriptOp { return read_radius(line); }},
    {"undo", [](const JsonNode& line) -> ScriptOp { return UndoOp{read_count(line)}; }},
    {"redo", [](const JsonNode& line) -> ScriptOp { return RedoOp{read_count(line)}; }},
    {"save", [](const JsonNode& line) -> ScriptOp { return read_bare<SaveOp>(line); }},
    {"revert", [](const JsonNode& line) -> ScriptOp { return read_bare<RevertOp>(line); }},
    {"expect", [](const JsonNode& line) -> ScriptOp { return read_expect(line); }},
};

/// Reads an operation on groups. The keys are those that its row of the operation table visits.
template <size_t INDEX = 0>
ScriptOp read_operation(const JsonNode& line, std::string_view name)
{
    if constexpr (INDEX < std::variant_size_v<GroupOperation>) {
        if (OPERATION_ROWS[INDEX].id != name && OPERATION_ROWS[INDEX].alias != name)
            return read_operation<INDEX + 1>(line, name);
        std::variant_alternative_t<INDEX, GroupOperation> op;
        std::string id;
        read_fields(line, {}, [&](Fields& f) {
            f.text("op", id, {.is_required = true});
            operation_fields(f, op);
        });
        return op;
    } else {
        line["op"].refuse("an operation");
    }
}

/// Reads standard input ("-") or a pipe to its end.
std::string read_stream(const std::filesystem::path& path, const std::string& name)
{
    const FileDescriptor pipe(path == "-" ? ::dup(STDIN_FILENO) : ::open(path.c_str(), O_RDONLY | O_CLOEXEC));
    if (!pipe) fail(name, ": cannot be opened: ", reason_of(errno));
    std::string text;
    std::vector<char> piece(size_t{1} << 16);
    for (;;) {
        const ssize_t count = ::read(pipe.number(), piece.data(), piece.size());
        if (count < 0 && errno == EINTR) continue;
        if (count < 0) fail(name, ": cannot be read: ", reason_of(errno));
        if (count == 0) return text;
        text.append(piece.data(), size_t(count));
        if (text.size() > size_t(MAX_SCRIPT_BYTES))
            fail(name, ": holds more than ", MAX_SCRIPT_BYTES, " bytes; expected at most that");
    }
}

}  // namespace

std::vector<std::string_view> script_op_names()
{
    std::vector<std::string_view> names;
    for (const OpReader& op : OPS) names.push_back(op.name);
    for (const OperationRow& row : OPERATION_ROWS) names.emplace_back(row.id);
    return names;
}

ScriptOp read_script_op(const JsonNode& line, std::span<const std::string_view> others)
{
    if (!line.is_object()) line.refuse("an object such as {\"op\":\"save\"}");
    std::vector<std::string_view> names = script_op_names();
    for (const OperationRow& row : OPERATION_ROWS)
        if (*row.alias != 0) names.emplace_back(row.alias);
    names.insert(names.end(), others.begin(), others.end());
    const size_t chosen = line["op"].choice(names);
    SHVR_CHECK(chosen + others.size() < names.size());
    return chosen < std::size(OPS) ? OPS[chosen].read(line) : read_operation(line, names[chosen]);
}

bool changes_work(const ScriptOp& op)
{
    const auto is_one_of = [&]<class... Op>(std::variant<Op...>) { return (std::holds_alternative<Op>(op) || ...); };
    return !is_one_of(std::variant<SelectOp, SelectSegmentOp, DeselectOp, ExpectOp>());
}

std::string name_of_script(const std::filesystem::path& path)
{
    return path == "-" ? "standard input" : path.string();
}

void for_each_line(const std::filesystem::path& path, const std::function<void(const JsonNode& line, int number)>& take)
{
    const std::string name = name_of_script(path);
    std::error_code ignored;
    const bool is_pipe = path == "-" || std::filesystem::is_fifo(path, ignored);
    std::istringstream text(is_pipe ? read_stream(path, name) : read_text(path, MAX_SCRIPT_BYTES));
    std::string line;
    for (int number = 1; std::getline(text, line); ++number) {
        const size_t start = line.find_first_not_of(" \t\r");
        if (start == std::string::npos || line.compare(start, 2, "//") == 0) continue;
        const JsonDocument document(line, sentence(name, ":", number),
                                    {.depth = 16, .expected = "an object on the line"});
        take(document.root(), number);
    }
}

std::vector<ScriptLine> read_script(const std::filesystem::path& path)
{
    std::vector<ScriptLine> script;
    for_each_line(path, [&](const JsonNode& line, int number) { script.push_back({number, read_script_op(line)}); });
    return script;
}

}  // namespace shvr
