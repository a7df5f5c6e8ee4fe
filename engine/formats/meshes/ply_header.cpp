#include "engine/formats/meshes/ply_header.h"

#include <algorithm>
#include <utility>

#include "engine/base/error.h"
#include "engine/base/text.h"

namespace shvr {
namespace {

constexpr size_t MAX_PROPERTIES = 1000;  // of all elements together

constexpr std::pair<std::string_view, PlyType> TYPES[] = {
    {"char", PlyType::int8},       {"int8", PlyType::int8},       {"uchar", PlyType::uint8},
    {"uint8", PlyType::uint8},     {"short", PlyType::int16},     {"int16", PlyType::int16},
    {"ushort", PlyType::uint16},   {"uint16", PlyType::uint16},   {"int", PlyType::int32},
    {"int32", PlyType::int32},     {"uint", PlyType::uint32},     {"uint32", PlyType::uint32},
    {"float", PlyType::float32},   {"float32", PlyType::float32}, {"double", PlyType::float64},
    {"float64", PlyType::float64},
};

PlyType type_in(const MeshInput& input, std::string_view word)
{
    for (const auto& [name, type] : TYPES)
        if (word == name) return type;
    fail(input.place(), ": has the type ", in_quotes(word), "; expected one such as uchar, int or float");
}

void read_format(const MeshInput& input, const std::vector<std::string_view>& words, PlyHeader& header)
{
    const std::string_view coding = words.size() == 3 && words[2] == "1.0" ? words[1] : "";
    if (coding == "binary_little_endian") {
        header.order = std::endian::little;
    } else if (coding == "binary_big_endian") {
        header.order = std::endian::big;
    } else if (coding != "ascii") {
        fail(input.place(), ": has a format that is not known; expected format ascii 1.0, binary_little_endian 1.0 or ",
             "binary_big_endian 1.0");
    }
}

PlyElement element_in(const MeshInput& input, const std::vector<std::string_view>& words)
{
    const std::optional<int64_t> count = words.size() == 3 ? whole_of(words[2]) : std::nullopt;
    if (!count || *count < 0)
        fail(input.place(), ": states an element of ", words.size() == 3 ? in_quotes(words[2]) : "no number",
             "; expected a name and a number, such as element vertex 8");
    return {std::string(words[1]), uint64_t(*count)};
}

PlyProperty property_in(const MeshInput& input, const std::vector<std::string_view>& words)
{
    if (words.size() == 3) return {std::string(words[2]), type_in(input, words[1])};
    if (words.size() != 5 || words[1] != "list")
        fail(input.place(), ": states a property of ", words.size(), " words; expected one such as property float x");
    const PlyType count_type = type_in(input, words[2]);
    if (is_float(count_type))
        fail(input.place(), ": counts a list by ", in_quotes(words[2]), "; expected a type of whole numbers");
    return {std::string(words[4]), type_in(input, words[3]), count_type};
}

/// The fewest bytes of one element. A face has three corners; other lists may be empty.
uint64_t least_bytes_of(const PlyElement& element, bool is_text)
{
    const PlyProperty* corners = element.name == "face" ? corners_of(element) : nullptr;
    uint64_t bytes = 0;
    for (const PlyProperty& property : element.properties) {
        const auto words = [&](PlyType type) { return is_text ? 2 : bytes_of(type); };
        bytes += words(property.count_type.value_or(property.type));
        if (&property == corners) bytes += 3 * words(property.type);
    }
    return bytes;
}

void check_sizes(const MeshInput& input, const PlyHeader& header)
{
    uint64_t rest = input.rest() + (header.order ? 0 : 1);  // a text may end without a space
    for (const PlyElement& element : header.elements) {
        const uint64_t bytes = least_bytes_of(element, !header.order);
        if (bytes == 0) continue;
        if (element.count > rest / bytes)
            fail(input.name(), ": states ", element.count, " of element ", in_quotes(element.name),
                 ", each of at least ", bytes, " bytes; expected at most ", rest / bytes,
                 ", which the rest of the file can hold");
        rest -= element.count * bytes;
    }
}

void check_elements(const MeshInput& input, const PlyHeader& header)
{
    const PlyElement* const vertex = header.find("vertex");
    const PlyElement* const face = header.find("face");
    if (vertex == nullptr || face == nullptr)
        fail(input.name(), ": has no element ", vertex == nullptr ? "vertex" : "face",
             "; expected vertices and faces of a mesh of triangles or polygons");
    for (const char* const axis : {"x", "y", "z"})
        if (const PlyProperty* const found = vertex->find(axis); found == nullptr || found->count_type)
            fail(input.name(), ": has no property ", axis, " of each vertex; expected x, y and z");
    const PlyProperty* const corners = corners_of(*face);
    if (corners == nullptr || !corners->count_type || is_float(corners->type))
        fail(input.name(), ": has no list of corners of each face; expected property list uchar int vertex_indices");
}

}  // namespace

uint64_t bytes_of(PlyType type)
{
    switch (type) {
        case PlyType::int8:
        case PlyType::uint8: return 1;
        case PlyType::int16:
        case PlyType::uint16: return 2;
        case PlyType::int32:
        case PlyType::uint32:
        case PlyType::float32: return 4;
        case PlyType::float64: return 8;
    }
    SHVR_CHECK(false, int(type));
    return 0;
}

bool is_float(PlyType type)
{
    return type == PlyType::float32 || type == PlyType::float64;
}

const PlyProperty* PlyElement::find(std::string_view property) const
{
    const auto found = std::ranges::find(properties, property, &PlyProperty::name);
    return found == properties.end() ? nullptr : &*found;
}

const PlyElement* PlyHeader::find(std::string_view element) const
{
    const auto found = std::ranges::find(elements, element, &PlyElement::name);
    return found == elements.end() ? nullptr : &*found;
}

const PlyProperty* corners_of(const PlyElement& face)
{
    const PlyProperty* const corners = face.find("vertex_indices");
    return corners != nullptr ? corners : face.find("vertex_index");
}

PlyHeader read_ply_header(MeshInput& input)
{
    PlyHeader header;
    bool has_format = false;
    size_t properties = 0;
    input.line();  // "ply"
    for (;;) {
        const std::optional<std::string_view> line = input.line();
        if (!line) fail(input.name(), ": ends in its header; expected the line end_header");
        const std::string_view text = trimmed(*line);
        if (text == "end_header") break;
        if (text.starts_with("comment ")) {
            header.statements.take(text.substr(8));
            continue;
        }
        if (text.empty() || text.starts_with("comment") || text.starts_with("obj_info")) continue;
        if (text.size() > 1000) fail(input.place(), ": has ", text.size(), " bytes; expected a line of the PLY header");
        const std::vector<std::string_view> words = words_of(text);
        if (words[0] == "format") {
            read_format(input, words, header);
            has_format = true;
        } else if (words[0] == "element" && properties < MAX_PROPERTIES) {
            header.elements.push_back(element_in(input, words));
            ++properties;
        } else if (words[0] == "property" && !header.elements.empty() && properties < MAX_PROPERTIES) {
            header.elements.back().properties.push_back(property_in(input, words));
            ++properties;
        } else {
            fail(input.place(), ": has ", in_quotes(text), "; expected a line of the PLY header such as ",
                 "element vertex 8, of at most ", MAX_PROPERTIES);
        }
    }
    if (!has_format) fail(input.name(), ": states no format in its header; expected a line such as format ascii 1.0");
    check_elements(input, header);
    check_sizes(input, header);
    return header;
}

}  // namespace shvr
