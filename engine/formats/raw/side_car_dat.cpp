// Reads side-cars of scanners and viewers: "Resolution: x y z" text (NSI, Inviwo) and XML (Dragonfly).

#include <cmath>
#include <utility>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/formats/header_fields.h"
#include "engine/formats/orientation.h"
#include "engine/formats/raw/side_cars.h"

namespace shvr {
namespace {

namespace fs = std::filesystem;

/// Returns the value of `name="..."` in the tag <tag ...>.
std::optional<std::string> attribute(std::string_view xml, const std::string& tag, std::string_view name)
{
    for (size_t at = xml.find("<" + tag); at != std::string_view::npos; at = xml.find("<" + tag, at + 1)) {
        std::string_view rest = xml.substr(at + 1 + tag.size());
        rest = rest.substr(0, rest.find('>'));
        if (rest.empty() || std::string_view(" \t\r\n").find(rest[0]) == std::string_view::npos) continue;
        for (size_t equals = rest.find('='); equals != std::string_view::npos; equals = rest.find('=')) {
            const std::string_view key = trimmed(rest.substr(0, equals));
            const std::string_view value = trimmed(rest.substr(equals + 1));
            if (value.empty() || (value[0] != '"' && value[0] != '\'')) break;
            const size_t close = value.find(value[0], 1);
            if (close == std::string_view::npos) break;
            if (key == name) return std::string(value.substr(1, close - 1));
            rest = value.substr(close + 1);
        }
    }
    return {};
}

/// Returns "x y z" from <Tag X="x" Y="y" Z="z">; null if the tag has none of these attributes.
std::optional<std::string> attributes(std::string_view xml, const std::string& tag,
                                      std::initializer_list<const char*> names)
{
    std::string values;
    bool any = false;
    for (const char* name : names) {
        const std::optional<std::string> value = attribute(xml, tag, name);
        any |= value.has_value();
        values += value.value_or("missing") + " ";
    }
    return any ? std::optional(values) : std::nullopt;
}

std::optional<std::string> element(std::string_view xml, const std::string& tag)
{
    const size_t open = xml.find("<" + tag + ">");
    if (open == std::string_view::npos) return {};
    const std::string_view rest = xml.substr(open + tag.size() + 2);
    const size_t close = rest.find("</" + tag);
    if (close == std::string_view::npos) return {};
    std::string text(trimmed(rest.substr(0, close)));
    constexpr std::pair<const char*, const char*> ENTITIES[] = {
        {"&lt;", "<"}, {"&gt;", ">"}, {"&quot;", "\""}, {"&apos;", "'"}, {"&amp;", "&"}};
    for (const auto& [entity, character] : ENTITIES) {
        for (size_t at = text.find(entity); at != std::string::npos; at = text.find(entity, at + 1)) {
            text.replace(at, std::string_view(entity).size(), character);
        }
    }
    return text;
}

/// Reads Dragonfly's XML into fields that have the names of the text format's fields.
HeaderFields dragonfly_fields(const fs::path& path, std::string_view xml)
{
    HeaderFields fields(path);
    for (const char* tag : {"ObjectFileName", "Format", "DataSlope", "DataOffset"}) {
        if (const auto text = element(xml, tag)) fields.add(tag, *text);
    }
    if (const auto size = attributes(xml, "Resolution", {"X", "Y", "Z"})) fields.add("Resolution", *size);
    if (const auto times = attribute(xml, "Resolution", "T")) fields.add("Resolution T", *times);
    if (const auto spacing = attributes(xml, "Spacing", {"X", "Y", "Z"})) fields.add("Spacing", *spacing);
    if (const auto axes = attributes(xml, "Orientation", {"X0", "X1", "X2", "Y0", "Y1", "Y2", "Z0", "Z1", "Z2"})) {
        fields.add("Orientation", *axes);
    }
    return fields;
}

HeaderFields text_fields(const fs::path& path, std::string_view text)
{
    HeaderFields fields(path);
    while (!text.empty()) {
        const std::string_view line = take_line(text);
        const size_t colon = line.find(':');
        if (trimmed(line).empty() || line.starts_with('#')) continue;
        if (colon == std::string_view::npos)
            fail(path.string(), ": holds ", in_quotes(line), "; expected \"field: value\"");
        const std::string name = lower_case(trimmed(line.substr(0, colon)));
        fields.add(name == "rawfile" ? "ObjectFileName" : name, line.substr(colon + 1));
    }
    return fields;
}

void describe_spacing(const HeaderFields& fields, VolumeInfo& info)
{
    if (fields.has("Spacing")) {
        constexpr double UM_PER_M = 1e6;
        apply_spacing(info, fields.spacing("Spacing") * UM_PER_M, "um", "um");
    } else if (fields.has("SliceThickness")) {
        apply_spacing(info, fields.spacing("SliceThickness"), {}, "mm");
    } else {
        apply_spacing(info, {}, {}, "mm");
    }
}

void warn_of_what_is_left_out(const HeaderFields& fields, VolumeInfo& info)
{
    for (const auto& [name, neutral] : {std::pair("DataSlope", 1.0), std::pair("DataOffset", 0.0)}) {
        if (fields.has(name) && fields.numbers(name, 1)[0] != neutral) {
            info.warnings.push_back(
                sentence(name, " is ", in_quotes(*fields.find(name)), "; voxels are shown as stored"));
        }
    }
}

/// Sets the directions of x, y and z, the columns of a matrix. The file format names no coordinate frame.
void read_orientation(const HeaderFields& fields, VolumeInfo& info)
{
    if (!fields.has("Orientation")) return;
    const std::vector<double> m = fields.numbers("Orientation", 9);
    const glm::dmat3 steps(m[0], m[1], m[2], m[3], m[4], m[5], m[6], m[7], m[8]);
    for (int axis = 0; axis < 3; ++axis) {
        const double length = glm::length(steps[axis]);
        if (!(length > 0.0) || !std::isfinite(length)) {
            fields.refuse("Orientation", "three vectors of finite length greater than 0");
        }
    }
    static_cast<void>(place(info, steps, glm::dvec3(0.0), ""));
}

}  // namespace

std::optional<SideCar> read_dat_side_car(const fs::path& path, fs::path raw)
{
    const std::string text = read_head(path);
    const std::string_view start = trimmed(text);
    std::optional<HeaderFields> fields;
    if (start.starts_with("<?xml") || start.starts_with("<RAWFileData")) {
        if (text.find("<RAWFileData") == std::string::npos) return {};
        fields = dragonfly_fields(path, text);
    } else if (const std::string lower = lower_case(start.substr(0, 16)); lower.starts_with("objectfilename:") ||
                                                                          lower.starts_with("rawfile:") ||
                                                                          lower.starts_with("resolution:")) {
        fields = text_fields(path, text);
    } else {
        return {};
    }

    SideCar found{.voxels = {.big_endian = {}}};
    found.info.size = fields->size("Resolution");
    fields->whole("Resolution T", 1, 1, 1);
    found.info.type = fields->type("Format");
    describe_spacing(*fields, found.info);
    warn_of_what_is_left_out(*fields, found.info);
    read_orientation(*fields, found.info);
    if (const std::string* order = fields->find("ByteOrder")) {
        const std::string lower = lower_case(*order);
        if (lower != "littleendian" && lower != "bigendian") fields->refuse("ByteOrder", "LittleEndian or BigEndian");
        found.voxels.big_endian = lower == "bigendian";
    }
    if (raw.empty()) {
        raw = fields->data_file("ObjectFileName");
        const fs::path renamed = fs::path(path).replace_extension(".raw");
        if (!is_file(raw) && is_file(renamed)) {
            found.info.warnings.push_back(sentence(raw.filename().string(), " does not exist; ",
                                                   renamed.filename().string(), " was read instead"));
            raw = renamed;
        } else if (!is_file(raw)) {
            fields->refuse("ObjectFileName",
                           "the name of a file in the same folder, or " + renamed.filename().string());
        }
    }
    found.voxels.file = raw;
    return found;
}

}  // namespace shvr
