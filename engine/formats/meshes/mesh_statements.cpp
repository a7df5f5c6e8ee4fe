#include "engine/formats/meshes/mesh_statements.h"

#include <algorithm>
#include <cmath>

#include <glm/gtc/type_ptr.hpp>

#include "engine/base/text.h"
#include "engine/volume/unit.h"

namespace shvr {
namespace {

constexpr size_t MAX_COMMENT_BYTES = 4096;  // of a comment that is looked at

std::optional<uint8_t> group_of(std::string_view word)
{
    const std::optional<int64_t> number = whole_of(word);
    if (!number || *number < 0 || *number > 255) return std::nullopt;
    return uint8_t(*number);
}

/// Removes `prefix` from the text; false if it begins otherwise.
bool take_prefix(std::string_view& text, std::string_view prefix)
{
    if (!text.starts_with(prefix)) return false;
    text.remove_prefix(prefix.size());
    return true;
}

/// Null unless the text is `count` finite numbers.
template <size_t count>
std::optional<std::array<double, count>> finite_numbers(std::string_view text)
{
    std::array<double, count> numbers{};
    for (double& number : numbers) {
        text = trimmed(text);
        const size_t end = std::min(text.find(' '), text.size());
        const std::optional<double> found = number_of(text.substr(0, end));
        if (!found || !std::isfinite(*found)) return std::nullopt;
        number = *found;
        text.remove_prefix(end);
    }
    return trimmed(text).empty() ? std::optional(numbers) : std::nullopt;
}

std::optional<glm::dvec3> origin_of(std::string_view text)
{
    const auto found = finite_numbers<3>(text);
    return found ? std::optional(glm::make_vec3(found->data())) : std::nullopt;
}

std::optional<glm::dmat3> directions_of(std::string_view text)
{
    const auto found = finite_numbers<9>(text);
    return found ? std::optional(glm::make_mat3(found->data())) : std::nullopt;
}

/// The axes that a text such as "3D Slicer output. SPACE=LPS" names; empty if none.
std::string frame_in(std::string_view text)
{
    const size_t at = text.find("SPACE=");
    const std::string_view name = at == std::string_view::npos ? std::string_view() : text.substr(at + 6, 3);
    return name == "LPS" || name == "RAS" ? std::string(name) : std::string();
}

}  // namespace

void MeshStatements::take(std::string_view comment)
{
    std::string_view text = trimmed(comment.substr(0, MAX_COMMENT_BYTES));
    if (text.starts_with("SHVR trace as tubes, unit ")) text.remove_prefix(text.find("unit "));
    if (take_prefix(text, "unit ")) {
        unit_ = plain_unit(text);
    } else if (text == "space physical" || text.starts_with("positions are physical")) {
        positions_ = "physical";
    } else if (text == "space volume" || text.starts_with("positions are voxels times spacing")) {
        positions_ = "volume";
    } else if (text == "frame LPS" || text == "frame RAS") {
        frame_ = text.substr(6);
    } else if (take_prefix(text, "origin ")) {
        origin_ = origin_of(text);
    } else if (take_prefix(text, "directions ")) {
        directions_ = directions_of(text);
    } else if (const std::string frame = frame_in(text); !frame.empty()) {
        frame_ = frame;
    } else if (take_prefix(text, "group ")) {
        const std::optional<uint8_t> group = group_of(text.substr(0, text.find(' ')));
        text.remove_prefix(std::min(text.find(' '), text.size()));
        if (group && take_prefix(text, " is ")) groups_[*group] = trimmed(text);
    }
}

void MeshStatements::take_stl_header(std::string_view header)
{
    if (!take_prefix(header, "SHVR surface, ")) {
        frame_ = frame_in(header);
        return;
    }
    const bool may_be_cut = !header.ends_with(' ');
    while (!header.empty()) {
        const size_t comma = header.find(", ");
        const std::string_view piece = header.substr(0, comma);
        const bool is_last = comma == std::string_view::npos;
        header.remove_prefix(is_last ? header.size() : comma + 2);
        if (is_last && may_be_cut && piece.starts_with("unit ")) return;
        if (piece.starts_with("group ")) stl_group_ = group_of(trimmed(piece.substr(6)));
        take(piece);
    }
}

std::optional<double> MeshStatements::metres() const
{
    const std::optional<double> micrometres = micrometres_in(unit_);
    return micrometres ? std::optional(1e-6 * *micrometres) : std::nullopt;
}

std::string MeshStatements::name_of_group(uint8_t group) const
{
    return groups_[group].empty() ? "group " + std::to_string(group) : groups_[group];
}

std::string MeshStatements::name_of_obj_group(std::string_view name) const
{
    std::string_view number = name;
    if (!take_prefix(number, "group_")) return std::string(name);
    const std::optional<uint8_t> group = group_of(number);
    return group && !groups_[*group].empty() ? groups_[*group] : std::string(name);
}

}  // namespace shvr
