#include "engine/formats/meshes/mesh_statements.h"

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
    } else if (take_prefix(text, "group ")) {
        const std::optional<uint8_t> group = group_of(text.substr(0, text.find(' ')));
        text.remove_prefix(std::min(text.find(' '), text.size()));
        if (group && take_prefix(text, " is ")) groups_[*group] = trimmed(text);
    }
}

void MeshStatements::take_stl_header(std::string_view header)
{
    if (!take_prefix(header, "SHVR surface, ")) return;
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
