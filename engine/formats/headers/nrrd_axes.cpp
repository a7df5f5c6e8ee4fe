#include "engine/formats/headers/nrrd_axes.h"

#include <cmath>
#include <limits>

#include "engine/base/error.h"
#include "engine/formats/orientation.h"
#include "engine/volume/unit.h"

namespace shvr {
namespace {

constexpr const char* DIRECTIONS = "space directions";
constexpr const char* DIRECTIONS_EXPECTED = "three vectors of three numbers, (a,b,c) (d,e,f) (g,h,i)";

/// Splits values such as "mm" "mm" "mm" at spaces, and removes quotes.
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

/// Parses a vector "(a,b,c)" at the start of `rest` and removes it from `rest`.
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

/// Returns one entry per axis of the file; null for a non-spatial axis, whose direction is "none" or a vector of NaNs.
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

/// Returns whether the non-spatial axis is the first of four axes (true) or the last (false). Fails if that is unclear.
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

/// Whether the first of three axes holds colours or components and the other two are spatial, as in a 2-D picture.
bool is_picture(std::string_view kinds)
{
    const std::vector<std::string_view> words = words_of(kinds);
    if (words.size() != 3) return false;
    const auto is_space = [&](size_t i) {
        const std::string kind = lower_case(words[i]);
        return kind == "domain" || kind == "space";
    };
    const std::string first = lower_case(words[0]);
    const bool is_of_components = first.ends_with("-color") || first.ends_with("vector") || first == "complex" ||
                                  first == "point" || first == "normal" || first == "list";
    return is_of_components && is_space(1) && is_space(2);
}

std::optional<std::string> unit_of(const HeaderFields& fields, const NrrdAxes& axes)
{
    const bool of_space = fields.has("space units");
    const char* const name = of_space ? "space units" : "units";
    const std::string* value = fields.find(name);
    if (value == nullptr) return {};
    std::vector<std::string> texts = texts_of(*value);
    if (!of_space && texts.size() == axes.dimension && axes.dimension > size_t(axes.spatial()))
        texts.erase(axes.first == 1 ? texts.begin() : texts.end() - 1);
    std::erase(texts, "");
    if (texts.empty()) return {};
    for (const std::string& text : texts) {
        if (plain_unit(text) != plain_unit(texts[0])) fields.refuse(name, "one unit for all axes");
    }
    return texts[0];
}

/// Returns the steps between voxels; column i is the step along axis i.
glm::dmat3 space_directions(const HeaderFields& fields, const NrrdAxes& axes)
{
    const auto directions = axis_directions(fields, axes.dimension);
    glm::dmat3 steps(0.0);
    for (int axis = 0; axis < axes.spatial(); ++axis) {
        const std::optional<glm::dvec3>& direction = directions[axes.first + size_t(axis)];
        if (!direction) fields.refuse(DIRECTIONS, DIRECTIONS_EXPECTED);
        steps[axis] = *direction;
        if (!(glm::length(steps[axis]) > 0.0) || !std::isfinite(glm::length(steps[axis]))) {
            fields.refuse(DIRECTIONS, "vectors of finite length greater than 0");
        }
    }
    // A 2-D picture becomes a slice that is as thick as a pixel is wide.
    if (axes.is_picture) steps[2] = glm::cross(steps[0], steps[1]) / glm::length(steps[1]);
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

/// A known coordinate frame; `is_left_handed`: the file's x axis is opposite to that of `frame`.
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

/// Whether the samples of an axis lie at the borders of its cells ("node") rather than in the cells' centres ("cell").
bool is_node_centered(const HeaderFields& fields, const NrrdAxes& axes, size_t axis, bool& is_stated)
{
    const char* const name = fields.has("centers") ? "centers" : "centerings";
    const std::vector<std::string_view> words = fields.has(name) ? words_of(*fields.find(name)) : words_of("");
    if (words.size() == axes.dimension) {
        const std::string word = lower_case(words[axis]);
        if (word == "node" || word == "cell") return word == "node";
        if (word != "???" && word != "none") fields.refuse(name, "node, cell, ??? or none for each axis");
    } else if (!words.empty()) {
        fields.refuse(name, sentence(axes.dimension, " words"));
    }
    is_stated = false;
    return false;
}

/// Returns the steps that "axis mins" and "axis maxs" state, with NaN for an axis without them. Null if the header has
/// neither field.
std::optional<std::vector<double>> steps_of_ends(const HeaderFields& fields, const NrrdAxes& axes, VolumeInfo& info)
{
    const char* const mins_name = fields.has("axismins") ? "axismins" : "axis mins";
    const char* const maxs_name = fields.has("axismaxs") ? "axismaxs" : "axis maxs";
    if (!fields.has(mins_name) || !fields.has(maxs_name)) return {};
    const std::vector<double> mins = fields.numbers(mins_name, axes.dimension);
    const std::vector<double> maxs = fields.numbers(maxs_name, axes.dimension);
    std::vector<double> steps(axes.dimension, std::numeric_limits<double>::quiet_NaN());
    bool is_stated = true, begins_elsewhere = false;
    for (int axis = 0; axis < axes.spatial(); ++axis) {
        const size_t at = axes.first + size_t(axis);
        const bool is_node = is_node_centered(fields, axes, at, is_stated);
        const int64_t cells = info.size[axis] - (is_node ? 1 : 0);
        if (cells > 0) steps[at] = (maxs[at] - mins[at]) / double(cells);
        begins_elsewhere |= std::isfinite(mins[at]) && mins[at] != 0.0;
    }
    if (!is_stated)
        info.warnings.emplace_back("axis mins and axis maxs are stated without centerings; cells are assumed");
    if (begins_elsewhere)
        info.warnings.push_back(sentence(mins_name, " is ", in_quotes(*fields.find(mins_name)),
                                         "; without a space only the spacing is taken from it"));
    return steps;
}

/// Returns the steps from "spacings" or "axis mins" and "axis maxs". A negative spacing means a reversed axis.
std::optional<glm::dmat3> steps_of_spacings(const HeaderFields& fields, const NrrdAxes& axes, VolumeInfo& info)
{
    const char* const NAME = fields.has("spacings") ? "spacings" : "axis maxs";
    std::vector<double> numbers(axes.dimension, std::numeric_limits<double>::quiet_NaN());
    if (fields.has("spacings")) numbers = fields.numbers("spacings", axes.dimension);
    if (const std::optional<std::vector<double>> ends = steps_of_ends(fields, axes, info)) {
        bool contradicts = false;
        for (size_t axis = 0; axis < axes.dimension; ++axis) {
            contradicts |= std::abs(numbers[axis] - (*ends)[axis]) > 1e-6 * std::abs((*ends)[axis]);
            if (std::isnan(numbers[axis])) numbers[axis] = (*ends)[axis];
        }
        if (contradicts)
            info.warnings.push_back(sentence("spacings is ", in_quotes(*fields.find("spacings")),
                                             ", which axis mins and axis maxs contradict; they are left out"));
    }
    glm::dmat3 steps(0.0);
    int unknown = 0;
    for (int axis = 0; axis < axes.spatial(); ++axis) {
        const double number = numbers[axes.first + size_t(axis)];
        unknown += std::isnan(number) ? 1 : 0;  // NRRD's value for "unknown"
        steps[axis][axis] = number;
    }
    if (unknown == axes.spatial()) return {};
    if (axes.is_picture) steps[2][2] = std::abs(steps[0][0]);
    // One slice has no step between nodes.
    for (int axis = 0; axis < 3; ++axis)
        if (std::isnan(steps[axis][axis]) && info.size[axis] == 1 && !fields.has("spacings"))
            steps[axis][axis] = std::abs(steps[axis == 0 ? 1 : 0][axis == 0 ? 1 : 0]);
    for (int axis = 0; axis < 3; ++axis) {
        // Also refuses lengths below 1e-162, whose square underflows to 0.
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
    const std::string* kinds = fields.find("kinds");
    if (axes.dimension == 3 && kinds != nullptr && is_picture(*kinds)) {
        axes.is_picture = true;
        axes.first = 1;
        axes.channels = sides[0];
        axes.channels_are_colors = lower_case(*kinds).starts_with("rgb");
        axes.size = {sides[1], sides[2], 1};
        return axes;
    }
    if (axes.dimension == 4) {
        axes.first = first_is_not_space(fields) ? 1 : 0;
        (axes.first == 1 ? axes.channels : axes.frames) = sides[axes.first == 1 ? 0 : 3];
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
    } else if (const auto steps = steps_of_spacings(fields, axes, info)) {
        spacing = place(info, *steps, glm::dvec3(0.0), "");
    }
    apply_spacing(info, spacing, unit_of(fields, axes), "mm");
}

}  // namespace shvr
