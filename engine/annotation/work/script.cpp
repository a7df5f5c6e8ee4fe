#include "engine/annotation/work/script.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <iterator>
#include <set>
#include <sstream>
#include <utility>

#include <nlohmann/json.hpp>

#include "engine/base/error.h"
#include "engine/base/file.h"

namespace shvr {

namespace {

using Json = nlohmann::json;

constexpr int64_t MOST_SCRIPT_BYTES = int64_t{256} << 20;

/// A key or value as a message shows it: at most 60 characters of ASCII, on one line.
std::string shown(const Json& value)
{
    constexpr size_t LONGEST = 60;
    const std::string text = value.dump(-1, ' ', true, Json::error_handler_t::replace);
    return text.size() <= LONGEST ? text : text.substr(0, LONGEST - 3) + "...";
}

/// The same for a key, without its quotation marks.
std::string shown_key(const std::string& key)
{
    const std::string quoted = shown(key);
    return quoted.back() == '"' ? quoted.substr(1, quoted.size() - 2) : quoted.substr(1);
}

/// Reads the keys of one line and refuses what is unknown.
class Fields {
public:
    Fields(const Json& object, std::string where) : object_(object), where_(std::move(where)) {}

    template <class... Parts>
    [[noreturn]] void refuse(const Parts&... parts) const
    {
        fail(where_, ": ", parts...);
    }

    void allow(std::initializer_list<const char*> names) const
    {
        for (const auto& [key, value] : object_.items()) {
            if (key == "op" || std::any_of(names.begin(), names.end(), [&, &k = key](const char* n) { return k == n; }))
                continue;
            if (names.size() == 0) refuse("unknown key ", shown_key(key), "; expected none but op");
            std::string known;
            for (const char* name : names) known += (known.empty() ? "" : ", ") + std::string(name);
            refuse("unknown key ", shown_key(key), "; expected one of: ", known);
        }
    }

    const Json* find(const char* key) const
    {
        const auto found = object_.find(key);
        return found == object_.end() ? nullptr : &*found;
    }
    const Json& need(const char* key) const
    {
        const Json* value = find(key);
        if (!value) refuse("key ", key, " is missing");
        return *value;
    }

    double number(const char* key, const Json& value) const
    {
        if (!value.is_number() || !std::isfinite(value.get<double>()))
            refuse("key ", key, " is ", shown(value), "; expected a number");
        return value.get<double>();
    }
    int64_t whole(const std::string& key, const Json& value, int64_t least, int64_t most) const
    {
        // What does not fit into int64_t is unsigned and larger than any `most`.
        const bool fits = value.is_number_integer() &&
                          !(value.is_number_unsigned() && value.get<uint64_t>() > uint64_t(most)) &&
                          value.get<int64_t>() >= least && value.get<int64_t>() <= most;
        if (!fits) refuse("key ", key, " is ", shown(value), "; expected a whole number from ", least, " to ", most);
        return value.get<int64_t>();
    }
    /// The index of the value among `names`.
    size_t choice(const char* key, const Json& value, const std::vector<const char*>& names) const
    {
        std::string known;
        size_t index = 0;
        for (const char* name : names) {
            if (value.is_string() && value.get<std::string>() == name) return index;
            known += (index++ == 0 ? "" : ", ") + std::string(name);
        }
        refuse("key ", key, " is ", shown(value), "; expected one of: ", known);
    }
    /// Far beyond any volume, and far below where squares overflow.
    static constexpr double FARTHEST = 1e12;
    glm::dvec3 point(const char* key) const
    {
        const Json& value = need(key);
        const auto is_coordinate = [](const Json& c) { return c.is_number() && std::abs(c.get<double>()) <= FARTHEST; };
        if (!value.is_array() || value.size() != 3 || !std::all_of(value.begin(), value.end(), is_coordinate))
            refuse("key ", key, " is ", shown(value), "; expected three numbers [x,y,z] from -1e12 to 1e12");
        return {value[0].get<double>(), value[1].get<double>(), value[2].get<double>()};
    }
    /// Nothing where the key is missing.
    std::optional<double> radius(const char* key) const
    {
        const Json* value = find(key);
        if (!value) return std::nullopt;
        if (number(key, *value) <= 0.0 || number(key, *value) > FARTHEST)
            refuse("key ", key, " is ", shown(*value), "; expected a number above 0, up to 1e12");
        return number(key, *value);
    }
    std::optional<uint8_t> group(const char* key) const
    {
        const Json* value = find(key);
        return value ? std::optional(uint8_t(whole(key, *value, 0, 255))) : std::nullopt;
    }
    /// The one of `keys` that is there.
    const char* one_of(std::initializer_list<const char*> keys) const
    {
        const char* found = nullptr;
        std::string known;
        for (const char* key : keys) {
            known += (known.empty() ? "" : ", ") + std::string(key);
            if (!find(key)) continue;
            if (found) refuse("keys ", found, " and ", key, " are both given; expected one of them");
            found = key;
        }
        if (!found) refuse("none of these keys is given: ", known, "; expected one of them");
        return found;
    }
    uint32_t item(const char* key) const { return uint32_t(whole(key, need(key), 0, 4294967295)); }

    std::vector<glm::dvec3> path(const char* key, const Json& value) const
    {
        const auto is_coordinate = [](const Json& c) { return c.is_number() && std::isfinite(c.get<double>()); };
        if (!value.is_array() || value.empty())
            refuse("key ", key, " is ", shown(value), "; expected [[x,y,z], ...] with at least one point");
        std::vector<glm::dvec3> points;
        points.reserve(value.size());
        for (const Json& p : value) {
            if (!p.is_array() || p.size() != 3 || !std::all_of(p.begin(), p.end(), is_coordinate))
                refuse("key ", key, ".", points.size(), " is ", shown(p), "; expected three numbers [x,y,z]");
            points.emplace_back(p[0].get<double>(), p[1].get<double>(), p[2].get<double>());
        }
        return points;
    }

private:
    const Json& object_;
    std::string where_;
};

std::vector<const char*> brush_keys()
{
    std::vector<const char*> keys;
    for (const BrushRow& row : BRUSHES) keys.push_back(row.key);
    return keys;
}

/// The keys that say which voxels are meant.
PaintOp read_brush(const Fields& fields)
{
    PaintOp op;
    op.brush = BRUSHES.at(fields.choice("brush", fields.need("brush"), brush_keys())).brush;
    if (const Json* region = fields.find("region"))
        op.region = RegionShape(fields.choice("region", *region, {"ball", "box"}));
    op.threshold = fields.number("threshold", fields.need("threshold"));
    op.radius_voxels = fields.number("radius", fields.need("radius"));
    if (op.radius_voxels <= 0.0 || op.radius_voxels >= 128.0)
        fields.refuse("key radius is ", shown(fields.need("radius")), "; expected a number above 0, below 128");
    if (const Json* connectivity = fields.find("connectivity")) {
        op.connectivity = int(fields.whole("connectivity", *connectivity, 6, 26));
        if (op.connectivity != 6 && op.connectivity != 26)
            fields.refuse("key connectivity is ", op.connectivity, "; expected 6 or 26");
    }
    op.path = fields.path("path", fields.need("path"));
    if (const double count = stroke_position_count(op.path); !(count <= double(MOST_STROKE_POSITIONS)))
        fields.refuse("key path makes ", count, " positions a voxel apart; expected at most ", MOST_STROKE_POSITIONS);
    return op;
}

NodeOp read_node(const Fields& fields)
{
    fields.allow({"at", "radius", "group"});
    return {fields.point("at"), fields.radius("radius"), fields.group("group")};
}

/// How far what is near may be; `key` is the one that says where it is.
std::optional<double> read_within(const Fields& fields, const std::string& key)
{
    if (fields.find("within") && !key.starts_with("near"))
        fields.refuse("key within is given with ", key, "; expected it with near");
    return fields.radius("within");
}

SelectOp read_select(const Fields& fields)
{
    fields.allow({"near", "near_internode", "within", "node", "internode"});
    const std::string key = fields.one_of({"near", "near_internode", "node", "internode"});
    SelectOp op;
    op.is_internode = key == "near_internode" || key == "internode";
    if (key == "near" || key == "near_internode")
        op.near = fields.point(key.c_str());
    else
        op.number = fields.item(key.c_str());
    op.within_voxels = read_within(fields, key);
    return op;
}

LinkOp read_link(const Fields& fields)
{
    fields.allow({"near", "within", "node"});
    const std::string key = fields.one_of({"near", "node"});
    LinkOp op;
    if (key == "near")
        op.near = fields.point("near");
    else
        op.node = fields.item("node");
    op.within_voxels = read_within(fields, key);
    return op;
}

RadiusOp read_radius(const Fields& fields)
{
    fields.allow({"radius", "group", "of"});
    RadiusOp op;
    if (const std::optional<uint8_t> group = fields.group("group")) {
        op.group = *group;
        op.of = RadiusOp::Of::nodes;
        if (const Json* of = fields.find("of"); of && fields.choice("of", *of, {"nodes", "internodes"}) == 1)
            op.of = RadiusOp::Of::internodes;
    } else if (fields.find("of")) {
        fields.refuse("key of is given without group; expected both, or neither for what is selected");
    }
    // Without a size of its own an internode tapers from node to node.
    if (op.of != RadiusOp::Of::internodes || !fields.need("radius").is_null()) {
        fields.need("radius");
        op.radius_voxels = fields.radius("radius");
    }
    return op;
}

PaintOp read_paint(const Fields& fields)
{
    fields.allow({"brush", "region", "group", "threshold", "radius", "connectivity", "path"});
    PaintOp op = read_brush(fields);
    op.group = uint8_t(fields.whole("group", fields.need("group"), 0, 255));
    return op;
}

PaintOp read_density(const Fields& fields)
{
    fields.allow({"brush", "region", "group", "threshold", "radius", "connectivity", "path", "offset", "falloff"});
    PaintOp op = read_brush(fields);
    const Json* group = fields.find("group");
    op.paints_group = group != nullptr;
    if (group) op.group = uint8_t(fields.whole("group", *group, 0, 255));
    op.density.emplace();
    if (const Json* falloff = fields.find("falloff"))
        op.density->falloff = Falloff(fields.choice("falloff", *falloff, {"flat", "distance"}));
    if (const Json* offset = fields.find("offset"); offset && *offset != "automatic") {
        if (!offset->is_number())
            fields.refuse("key offset is ", shown(*offset), "; expected a number or \"automatic\"");
        op.density->offset = fields.number("offset", *offset);
    }
    return op;
}

int read_count(const Fields& fields)
{
    fields.allow({"count"});
    const Json* count = fields.find("count");
    return count ? int(fields.whole("count", *count, 1, 1000000000)) : 1;
}

/// The group that a key such as "3" names; nothing where it names none.
std::optional<uint8_t> group_of(const std::string& key)
{
    const bool is_number = !key.empty() && key.size() <= 3 &&
                           key.find_first_not_of("0123456789") == std::string::npos &&
                           (key.size() == 1 || key[0] != '0');
    if (!is_number || std::stoi(key) > 255) return {};
    return uint8_t(std::stoi(key));
}

ExpectOp read_expect(const Fields& fields)
{
    constexpr int64_t MOST = int64_t{1} << 62;
    fields.allow({"voxels_in_group", "voxels_with_offset", "nodes", "internodes"});
    ExpectOp op;
    if (const Json* groups = fields.find("voxels_in_group")) {
        if (!groups->is_object())
            fields.refuse("key voxels_in_group is ", shown(*groups), "; expected an object such as {\"3\": 1234}");
        for (const auto& [key, voxels] : groups->items()) {
            const std::optional<uint8_t> group = group_of(key);
            if (!group) fields.refuse("key voxels_in_group.", shown_key(key), " is no group; expected 0 ... 255");
            op.voxels_in_group[*group] = fields.whole("voxels_in_group." + key, voxels, 0, MOST);
        }
    }
    if (const Json* voxels = fields.find("voxels_with_offset"))
        op.voxels_with_offset = fields.whole("voxels_with_offset", *voxels, 0, MOST);
    if (const Json* nodes = fields.find("nodes")) op.nodes = fields.whole("nodes", *nodes, 0, MOST);
    if (const Json* links = fields.find("internodes")) op.internodes = fields.whole("internodes", *links, 0, MOST);
    return op;
}

ScriptOp read_op(const Fields& fields)
{
    const Json& name = fields.need("op");
    if (name == "paint") return read_paint(fields);
    if (name == "node") return read_node(fields);
    if (name == "select") return read_select(fields);
    if (name == "link") return read_link(fields);
    if (name == "radius") return read_radius(fields);
    if (name == "move") {
        fields.allow({"to"});
        return MoveOp{fields.point("to")};
    }
    if (name == "group") {
        fields.allow({"group"});
        fields.need("group");
        return GroupOp{*fields.group("group")};
    }
    if (name == "select_segment" || name == "deselect" || name == "delete") {
        fields.allow({});
        if (name == "select_segment") return SelectSegmentOp{};
        if (name == "deselect") return DeselectOp{};
        return DeleteOp{};
    }
    if (name == "density") return read_density(fields);
    if (name == "undo") return UndoOp{read_count(fields)};
    if (name == "redo") return RedoOp{read_count(fields)};
    if (name == "expect") return read_expect(fields);
    if (name == "save") {
        fields.allow({});
        return SaveOp{};
    }
    fields.refuse("op ", shown(name), " is unknown",
                  "; known: paint, density, node, select, select_segment, deselect, link, move, delete, group, radius, "
                  "undo, redo, "
                  "save, expect");
}

/// Refuses what the parser itself lets pass: a key given twice, of which it would silently keep the last.
class Strictness {
public:
    explicit Strictness(const std::string& where) : where_(&where) {}

    bool operator()(int depth, Json::parse_event_t event, const Json& parsed)
    {
        constexpr int DEEPEST_NESTING = 8;
        if (depth > DEEPEST_NESTING)
            fail(*where_, ": nests deeper than ", DEEPEST_NESTING, " levels; expected at most 3");
        if (event == Json::parse_event_t::object_start) keys_.emplace_back();
        if (event == Json::parse_event_t::object_end) keys_.pop_back();
        if (event == Json::parse_event_t::key && !keys_.back().insert(parsed.get<std::string>()).second)
            fail(*where_, ": key ", shown_key(parsed.get<std::string>()), " appears twice; expected once");
        return true;
    }

private:
    const std::string* where_;
    std::vector<std::set<std::string>> keys_;
};

Json parse_line(const std::string& line, const std::string& where)
{
    const auto refuse_from = [&](size_t character) {
        fail(where, ": is not JSON from character ", character, " on; expected one object on the line");
    };
    // The parser would take a zero byte for the end of the line.
    if (const size_t zero = line.find('\0'); zero != std::string::npos) refuse_from(zero + 1);
    Json object;
    try {
        object = Json::parse(line, Strictness(where));
    } catch (const Json::parse_error& error) {
        refuse_from(error.byte);
    } catch (const Json::out_of_range&) {
        fail(where, ": holds a number too large to represent; expected numbers up to 1.8e308");
    }
    if (!object.is_object()) fail(where, ": is ", shown(object), "; expected an object such as {\"op\":\"save\"}");
    return object;
}

}  // namespace

std::vector<ScriptLine> read_script(const std::filesystem::path& path)
{
    std::istringstream text(read_text(path, MOST_SCRIPT_BYTES));
    std::vector<ScriptLine> script;
    std::string line;
    for (int number = 1; std::getline(text, line); ++number) {
        const size_t start = line.find_first_not_of(" \t\r");
        if (start == std::string::npos || line.compare(start, 2, "//") == 0) continue;
        const std::string where = sentence(path.string(), ":", number);
        const Json object = parse_line(line, where);
        script.push_back({number, read_op(Fields(object, where))});
    }
    return script;
}

}  // namespace shvr
