#include "engine/annotation/script.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <sstream>

#include <nlohmann/json.hpp>

#include "engine/base/error.h"
#include "engine/base/file.h"

namespace shvr {

namespace {

using Json = nlohmann::json;

constexpr int64_t MOST_SCRIPT_BYTES = int64_t(256) << 20;

/// Reads the keys of one line, each exactly once, and refuses what is left over.
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
            std::string known;
            for (const char* name : names) known += (known.empty() ? "" : ", ") + std::string(name);
            refuse("unknown key ", key, "; expected one of: ", known.empty() ? "none but op" : known);
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
            refuse("key ", key, " is ", value.dump(), "; expected a number");
        return value.get<double>();
    }
    int64_t whole(const char* key, const Json& value, int64_t least, int64_t most) const
    {
        const bool fits = value.is_number_integer() &&
                          (value.is_number_unsigned() ? value.get<uint64_t>() <= uint64_t(most)
                                                      : value.get<int64_t>() <= most) &&
                          (value.is_number_unsigned() || value.get<int64_t>() >= least);
        if (!fits || value.get<int64_t>() < least)
            refuse("key ", key, " is ", value.dump(), "; expected a whole number from ", least, " to ", most);
        return value.get<int64_t>();
    }
    /// The index of the value among `names`.
    size_t choice(const char* key, const Json& value, std::initializer_list<const char*> names) const
    {
        std::string known;
        size_t index = 0;
        for (const char* name : names) {
            if (value.is_string() && value.get<std::string>() == name) return index;
            known += (index++ == 0 ? "" : ", ") + std::string(name);
        }
        refuse("key ", key, " is ", value.dump(), "; expected one of: ", known);
    }
    std::vector<glm::dvec3> path(const char* key, const Json& value) const
    {
        const auto is_point = [](const Json& p) {
            return p.is_array() && p.size() == 3 && std::all_of(p.begin(), p.end(), [](const Json& c) {
                       return c.is_number() && std::isfinite(c.get<double>());
                   });
        };
        if (!value.is_array() || value.empty() || !std::all_of(value.begin(), value.end(), is_point))
            refuse("key ", key, " is ", value.dump().substr(0, 60), "; expected [[x,y,z], ...] with at least one point");
        std::vector<glm::dvec3> points;
        for (const Json& p : value) points.emplace_back(p[0].get<double>(), p[1].get<double>(), p[2].get<double>());
        return points;
    }

private:
    const Json& object_;
    std::string where_;
};

PaintOp read_paint(const Fields& fields)
{
    fields.allow({"brush", "region", "group", "threshold", "radius", "connectivity", "path"});
    PaintOp op;
    op.brush = Brush(fields.choice("brush", fields.need("brush"), {"fill", "flood", "speckle"}));
    if (const Json* region = fields.find("region"))
        op.region = RegionShape(fields.choice("region", *region, {"ball", "box"}));
    op.group = uint8_t(fields.whole("group", fields.need("group"), 0, 255));
    op.threshold = fields.number("threshold", fields.need("threshold"));
    op.radius_voxels = fields.number("radius", fields.need("radius"));
    if (op.radius_voxels <= 0.0 || op.radius_voxels > 128.0)
        fields.refuse("key radius is ", op.radius_voxels, "; expected a number above 0, at most 128");
    if (const Json* connectivity = fields.find("connectivity")) {
        op.connectivity = int(fields.whole("connectivity", *connectivity, 6, 26));
        if (op.connectivity != 6 && op.connectivity != 26)
            fields.refuse("key connectivity is ", op.connectivity, "; expected 6 or 26");
    }
    op.path = fields.path("path", fields.need("path"));
    return op;
}

int read_count(const Fields& fields)
{
    fields.allow({"count"});
    const Json* count = fields.find("count");
    return count ? int(fields.whole("count", *count, 1, 1000000000)) : 1;
}

ExpectOp read_expect(const Fields& fields)
{
    constexpr int64_t MOST = int64_t(1) << 62;
    fields.allow({"voxels_in_group", "nodes", "internodes"});
    ExpectOp op;
    if (const Json* groups = fields.find("voxels_in_group")) {
        if (!groups->is_object())
            fields.refuse("key voxels_in_group is ", groups->dump(), "; expected an object such as {\"3\": 1234}");
        for (const auto& [name, voxels] : groups->items()) {
            const bool is_number = !name.empty() && name.size() <= 3 &&
                                   name.find_first_not_of("0123456789") == std::string::npos && std::stoi(name) <= 255;
            if (!is_number) fields.refuse("key voxels_in_group.", name, " is no group; expected 0 ... 255");
            op.voxels_in_group[uint8_t(std::stoi(name))] =
                fields.whole(("voxels_in_group." + name).c_str(), voxels, 0, MOST);
        }
    }
    if (const Json* nodes = fields.find("nodes")) op.nodes = fields.whole("nodes", *nodes, 0, MOST);
    if (const Json* links = fields.find("internodes")) op.internodes = fields.whole("internodes", *links, 0, MOST);
    return op;
}

ScriptOp read_op(const Fields& fields)
{
    const Json& name = fields.need("op");
    if (name == "paint") return read_paint(fields);
    if (name == "undo") return UndoOp{read_count(fields)};
    if (name == "redo") return RedoOp{read_count(fields)};
    if (name == "expect") return read_expect(fields);
    if (name == "save") {
        fields.allow({});
        return SaveOp{};
    }
    const char* const later[] = {"density", "node", "select", "deselect", "link", "move", "delete", "group",
                                 "select_segment"};
    const bool is_later = std::any_of(std::begin(later), std::end(later), [&](const char* op) { return name == op; });
    fields.refuse("op ", name.dump(), is_later ? " is not supported by this version" : " is unknown",
                  "; known: paint, undo, redo, save, expect");
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
        Json object = Json::parse(line, nullptr, false);
        if (object.is_discarded()) fail(where, ": is not JSON; expected one object on the line");
        if (!object.is_object()) fail(where, ": is ", object.type_name(), "; expected an object such as {\"op\":\"save\"}");
        script.push_back({number, read_op(Fields(object, where))});
    }
    return script;
}

}  // namespace shvr
