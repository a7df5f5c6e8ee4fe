#include "engine/formats/headers/nrrd_axes.h"

#include <cmath>

#include "engine/base/error.h"
#include "engine/formats/orientation.h"
#include "engine/volume/unit.h"

namespace shvr {
namespace {

constexpr const char* DIRECTIONS = "space directions";
constexpr const char* DIRECTIONS_EXPECTED = "three vectors of three numbers, (a,b,c) (d,e,f) (g,h,i)";

/// "mm" "mm" "mm", with or without quotes.
std::vector<std::string> texts_of(std::string_view value)
{
    std::vector<std::string> texts;
    for (size_t open = value.find('"'); open != std::string_view::npos; open = value.find('"')) {
        const size_t close = value.find('"', open + 1);
        if (close == std::string_view::npos) break;
        texts.emplace_back(value.substr(open + 1, close - open - 1));
        value.remove_prefix(close + 1);
    }
    if (texts.empty()) {
        for (const std::string_view word : words_of(value)) texts.emplace_back(word);
    }
    return texts;
}

/// Parses and removes "(a,b,c)" at the start of `rest`.
std::optional<glm::dvec3> take_vector(std::string_view& rest)
{
    rest = trimmed(rest);
    const size_t close = rest.find(')');
    if (!rest.starts_with('(') || close == std::string_view::npos) return {};
    std::string numbers(rest.substr(1, close - 1));
    rest.remove_prefix(close + 1);
    for (char& character : numbers) {
        if (character == ',') character = ' ';
    }
    const std::vector<std::string_view> words = words_of(numbers);
    if (words.size() != 3) return {};
    glm::dvec3 vector(0.0);
    for (int component = 0; component < 3; ++component) {
        const std::optional<double> number = number_of(words[size_t(component)]);
        if (!number) return {};
        vector[component] = *number;
    }
    return vector;
}

/// One entry per axis of the file; null for an axis that is not spatial ("none", or NaNs).
std::vector<std::optional<glm::dvec3>> axis_directions(const HeaderFields& fields, size_t dimension)
{
    std::string_view rest = fields.required(DIRECTIONS, DIRECTIONS_EXPECTED);
    std::vector<std::optional<glm::dvec3>> directions;
    while (!trimmed(rest).empty()) {
        rest = trimmed(rest);
        if (rest.starts_with("none")) {
            rest.remove_prefix(4);
            directions.emplace_back();
            continue;
        }
        const std::optional<glm::dvec3> vector = take_vector(rest);
        if (!vector) fields.refuse(DIRECTIONS, DIRECTIONS_EXPECTED);
        const bool is_none = std::isnan(vector->x) && std::isnan(vector->y) && std::isnan(vector->z);
        directions.push_back(is_none ? std::nullopt : vector);
    }
    if (directions.size() != dimension) fields.refuse(DIRECTIONS, DIRECTIONS_EXPECTED);
    return directions;
}

/// Whether the first of four axes is the non-spatial one; otherwise it is the last.
bool first_is_not_space(const HeaderFields& fields)
{
    constexpr const char* EXPECTED = "3, or 4 with kinds or space directions that say which axis is none of space";
    if (fields.has(DIRECTIONS)) {
        const auto directions = axis_directions(fields, 4);
        const bool middle_is_space = directions[1] && directions[2];
        if (middle_is_space && directions[0].has_value() != directions[3].has_value()) return !directions[0];
    }
    if (const std::string* kinds = fields.find("kinds")) {
        const std::vector<std::string_view> words = words_of(*kinds);
        const auto is_space = [&](size_t i) {
            const std::string kind = lower_case(words[i]);
            return kind == "domain" || kind == "space" || kind == "???" || kind == "none";
        };
        if (words.size() == 4 && is_space(0) != is_space(3)) return !is_space(0);
    }
    fields.refuse("dimension", EXPECTED);
}

std::optional<std::string> unit_of(const HeaderFields& fields, const NrrdAxes& axes)
{
    const bool of_space = fields.has("space units");
    const char* const name = of_space ? "space units" : "units";
    const std::string* value = fields.find(name);
    if (value == nullptr) return {};
    std::vector<std::string> texts = texts_of(*value);
    if (!of_space && axes.dimension == 4 && texts.size() == 4) texts.erase(texts.begin() + (axes.first == 1 ? 0 : 3));
    if (texts.empty()) return {};
    for (const std::string& text : texts) {
        if (plain_unit(text) != plain_unit(texts[0])) fields.refuse(name, "one unit for all axes");
    }
    return texts[0];
}

/// Columns are the steps from voxel to voxel along x, y and z.
glm::dmat3 space_directions(const HeaderFields& fields, const NrrdAxes& axes)
{
    const auto directions = axis_directions(fields, axes.dimension);
    glm::dmat3 steps(0.0);
    for (int axis = 0; axis < 3; ++axis) {
        const std::optional<glm::dvec3>& direction = directions[axes.first + size_t(axis)];
        if (!direction) fields.refuse(DIRECTIONS, DIRECTIONS_EXPECTED);
        steps[axis] = *direction;
        if (!(glm::length(steps[axis]) > 0.0) || !std::isfinite(glm::length(steps[axis]))) {
            fields.refuse(DIRECTIONS, "vectors of finite length greater than 0");
        }
    }
    return steps;
}

glm::dvec3 space_origin(const HeaderFields& fields)
{
    constexpr const char* NAME = "space origin";
    if (!fields.has(NAME)) return glm::dvec3(0.0);
    std::string_view rest = *fields.find(NAME);
    const std::optional<glm::dvec3> origin = take_vector(rest);
    if (!origin || !trimmed(rest).empty()) fields.refuse(NAME, "one vector of three numbers, (a,b,c)");
    const bool is_known = std::isfinite(origin->x) && std::isfinite(origin->y) && std::isfinite(origin->z);
    return is_known ? *origin : glm::dvec3(0.0);
}

/// A known frame, and whether the file's x axis is opposite to the frame's.
struct Space {
    std::string frame;
    bool is_left_handed = false;
};

Space space_of(const HeaderFields& fields, VolumeInfo& info)
{
    const std::string* value = fields.find("space");
    if (value == nullptr) return {};
    const std::string space = lower_case(*value);
    if (space == "right-anterior-superior" || space == "ras") return {"RAS"};
    if (space == "left-posterior-superior" || space == "lps") return {"LPS"};
    if (space == "left-anterior-superior" || space == "las") return {"RAS", true};
    if (space == "3d-left-handed") {
        info.warnings.emplace_back("space is left-handed; positions are given with x reversed");
        return {"", true};
    }
    if (space != "3d-right-handed" && space != "scanner-xyz") {
        info.warnings.push_back(
            sentence("space is ", in_quotes(*value), ", which is unknown; a right-handed space is assumed"));
    }
    return {};
}

/// In files without a space, a negative spacing means that the axis runs backwards.
std::optional<glm::dmat3> steps_of_spacings(const HeaderFields& fields, const NrrdAxes& axes)
{
    constexpr const char* NAME = "spacings";
    std::vector<double> numbers = fields.numbers(NAME, axes.dimension);
    glm::dmat3 steps(0.0);
    int unknown = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const double number = numbers[axes.first + size_t(axis)];
        unknown += std::isnan(number) ? 1 : 0;  // NRRD's value for "unknown"
        steps[axis][axis] = number;
    }
    if (unknown == 3) return {};
    for (int axis = 0; axis < 3; ++axis) {
        // The square of anything below 1e-162 is 0.
        if (!std::isfinite(glm::length(steps[axis])) || glm::length(steps[axis]) == 0.0) {
            fields.refuse(NAME, sentence(axes.dimension, " finite numbers other than 0"));
        }
    }
    return steps;
}

}  // namespace

NrrdAxes read_nrrd_axes(const HeaderFields& fields)
{
    fields.required("dimension", "3");
    NrrdAxes axes{.dimension = size_t(fields.whole("dimension", 3, 3, 4))};
    const std::vector<int64_t> sides = fields.sizes("sizes", axes.dimension);
    if (axes.dimension == 4) {
        axes.first = first_is_not_space(fields) ? 1 : 0;
        (axes.first == 1 ? axes.channels : axes.frames) = sides[axes.first == 1 ? 0 : 3];
        const std::string* kinds = fields.find("kinds");
        axes.channels_are_colors = kinds != nullptr && lower_case(*kinds).starts_with("rgb");
    }
    axes.size = {sides[axes.first], sides[axes.first + 1], sides[axes.first + 2]};
    return axes;
}

void read_nrrd_space(const HeaderFields& fields, const NrrdAxes& axes, VolumeInfo& info)
{
    std::optional<glm::dvec3> spacing;
    if (fields.has(DIRECTIONS)) {
        glm::dmat3 steps = space_directions(fields, axes);
        glm::dvec3 origin = space_origin(fields);
        const Space space = space_of(fields, info);
        if (space.is_left_handed) {
            const glm::dvec3 mirrored(-1.0, 1.0, 1.0);
            for (int axis = 0; axis < 3; ++axis) steps[axis] *= mirrored;
            origin *= mirrored;
        }
        spacing = place(info, steps, origin, space.frame);
    } else if (fields.has("spacings")) {
        if (const auto steps = steps_of_spacings(fields, axes)) spacing = place(info, *steps, glm::dvec3(0.0), "");
    }
    apply_spacing(info, spacing, unit_of(fields, axes), "mm");
}

}  // namespace shvr
