#include "engine/workbench/forms/voxel_size.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/volume/unit.h"

namespace shvr::ui {

namespace {

/// Replaces commas between two digits, as in "0,8 x 0,8 x 1,2", by points.
std::string with_decimal_points(std::string text)
{
    for (size_t i = 1; i + 1 < text.size(); ++i)
        if (text[i] == ',' && is_digit(text[i - 1]) && is_digit(text[i + 1])) text[i] = '.';
    return text;
}

/// Parts "0.8x0.8x1.2um" into words, and replaces the signs between numbers by spaces.
std::string spaced_out(const std::string& text)
{
    std::string signs = text, spaced;
    for (const std::string_view sign : {"\u00d7", "*", ","})
        for (size_t at = signs.find(sign); at != std::string::npos; at = signs.find(sign))
            signs.replace(at, sign.size(), " ");
    for (size_t i = 0; i < signs.size(); ++i) {
        const char before = i > 0 ? signs[i - 1] : ' ', here = signs[i],
                   after = i + 1 < signs.size() ? signs[i + 1] : ' ';
        const bool is_exponent = (here == 'e' || here == 'E') && (is_digit(after) || after == '-' || after == '+');
        const bool ends_number = is_digit(before) && !is_digit(here) && here != '.' && here != ' ' && !is_exponent;
        if (ends_number) spaced += ' ';
        const bool begins_number = (before == 'x' || before == 'X') && (is_digit(here) || here == '.');
        if (begins_number) spaced += ' ';
        spaced += here;
    }
    return spaced;
}

/// Reads a size in which commas stand between numbers, as signs or spaces do.
std::optional<VoxelSize> read_size(const std::string& text)
{
    const std::string spaced = spaced_out(text);
    std::vector<double> sides;
    VoxelSize size;
    for (const std::string_view word : words_of(spaced)) {
        if (word == "x" || word == "X") continue;
        const std::optional<double> side = size.unit.empty() ? number_of(word) : std::nullopt;
        if (side && std::isfinite(*side) && *side > 0.0)
            sides.push_back(*side);
        else if (size.unit.empty() && !sides.empty() && !is_digit(word[0]) && word[0] != '-')
            size.unit = word;
        else
            return std::nullopt;
    }
    if (sides.size() != 1 && sides.size() != 3) return std::nullopt;
    size.spacing = sides.size() == 1 ? glm::dvec3(sides[0]) : glm::dvec3(sides[0], sides[1], sides[2]);
    size.unit = plain_unit(size.unit);
    return size;
}

}  // namespace

std::optional<VoxelSize> voxel_size_of(const std::string& text)
{
    const std::optional<VoxelSize> size = read_size(with_decimal_points(text));
    // One comma, as in "1 2,5", may be either, so that it is refused.
    return size || std::ranges::count(text, ',') != 2 ? size : read_size(text);
}

std::string why_no_voxel_size(const std::string& text, const std::string& unit)
{
    const std::optional<VoxelSize> size = voxel_size_of(text);
    if (!size) return EXPECTED_VOXEL_SIZE;
    for (int axis = 0; axis < 3; ++axis)
        if (const double side = size->spacing[axis]; !(side >= MIN_SPACING && side <= MAX_SPACING))
            return sentence("the size ", digits_of(side), " is out of range; expected ", MIN_SPACING, " to ",
                            MAX_SPACING);
    const bool is_known =
        size->unit.empty() || size->unit == unit || size->unit == "voxel" || micrometres_in(size->unit).has_value();
    if (is_known) return {};
    return sentence("the unit ", in_quotes(size->unit), " is not known here; expected um, mm, nm, pm, cm, m or inch");
}

std::string text_of(const VoxelSize& size)
{
    const glm::dvec3& side = size.spacing;
    return sentence(digits_of(side.x), " x ", digits_of(side.y), " x ", digits_of(side.z),
                    size.unit.empty() ? "" : " " + size.unit);
}

}  // namespace shvr::ui
