#include "engine/formats/zarr/ome_zarr.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <nlohmann/json.hpp>

#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/formats/zarr/zarr_json.h"
#include "engine/volume/unit.h"

namespace shvr {
namespace {

using Json = nlohmann::json;
using Path = std::filesystem::path;

/// Units as we write them, as the specification names them, and in metres.
struct Unit {
    const char* plain;
    const char* name;
    double metres;
};
constexpr Unit UNITS[] = {{"nm", "nanometer", 1e-9},  {"um", "micrometer", 1e-6}, {"mm", "millimeter", 1e-3},
                          {"cm", "centimeter", 1e-2}, {"m", "meter", 1.0},        {"angstrom", "angstrom", 1e-10},
                          {"inch", "inch", 0.0254}};

constexpr size_t MOST_DATASETS = 64;
constexpr size_t MOST_CHANNELS = 4096;

struct Axis {
    std::string name;
    std::string kind;  ///< "space", "channel" or "time"
    std::optional<std::string> unit;
};

std::string kind_of(const std::string& name)
{
    if (name == "t") return "time";
    return name == "c" ? "channel" : "space";
}

Axis read_axis(const Path& path, const Json& value)
{
    constexpr const char* EXPECTED = "a name such as \"z\", or an object with one";
    Axis axis;
    const Json* name = &value;  // version 0.3 gives names alone
    if (value.is_object()) name = &required(path, value, "name", EXPECTED);
    if (!name->is_string()) refuse_json(path, "multiscales.axes", value, EXPECTED);
    axis.name = lower_case(name->get<std::string>());
    axis.kind = kind_of(axis.name);
    if (!value.is_object()) return axis;
    if (const auto kind = value.find("type"); kind != value.end()) {
        if (*kind != "space" && *kind != "channel" && *kind != "time") {
            refuse_json(path, "multiscales.axes.type", *kind, "\"space\", \"channel\" or \"time\"");
        }
        axis.kind = kind->get<std::string>();
    }
    if (const auto unit = value.find("unit"); unit != value.end() && unit->is_string()) {
        axis.unit = plain_unit(unit->get<std::string>());
    }
    return axis;
}

std::vector<Axis> read_axes(const Path& path, const Json& multiscale)
{
    const auto found = multiscale.find("axes");
    if (found == multiscale.end()) {  // versions 0.1 and 0.2
        return {{"t", "time", {}}, {"c", "channel", {}}, {"z", "space", {}}, {"y", "space", {}}, {"x", "space", {}}};
    }
    constexpr const char* EXPECTED = "a list of z, y, x and perhaps t and c";
    if (!found->is_array() || found->size() > 5) refuse_json(path, "multiscales.axes", *found, EXPECTED);
    std::vector<Axis> axes;
    for (const Json& value : *found) {
        axes.push_back(read_axis(path, value));
        for (size_t other = 0; other + 1 < axes.size(); ++other) {
            if (axes[other].name == axes.back().name) refuse_json(path, "multiscales.axes", *found, EXPECTED);
        }
    }
    return axes;
}

void place_axes(const Path& path, const Json& multiscale, const std::vector<Axis>& axes, OmeImage& image)
{
    image.axes = axes.size();
    const auto refuse = [&](const std::string& expected) {
        refuse_json(path, "multiscales.axes", multiscale.value("axes", Json()), expected);
    };
    std::array<bool, 3> is_there{};
    for (size_t axis = 0; axis < axes.size(); ++axis) {
        std::optional<size_t>* const other = axes[axis].kind == "channel" ? &image.channel
                                             : axes[axis].kind == "time"  ? &image.time
                                                                          : nullptr;
        if (other != nullptr) {
            if (other->has_value()) refuse("at most one axis of channels and one of time");
            *other = axis;
            continue;
        }
        const size_t along = std::string("xyz").find(axes[axis].name);
        if (axes[axis].name.size() != 1 || along > 2) refuse("axes of space called x, y and z");
        image.xyz[along] = axis;
        is_there[along] = true;
    }
    if (is_there[0] && is_there[1] && !is_there[2]) refuse("a z axis too: pictures of two dimensions are no volumes");
    if (!is_there[0] || !is_there[1] || !is_there[2]) refuse("axes of space called x, y and z");
}

/// One number for every axis, all finite; where they scale, above 0.
std::vector<double> read_numbers(const Path& path, const std::string& key, const Json& value, size_t axes,
                                 bool is_scale)
{
    const std::string expected =
        sentence("a finite number", is_scale ? " above 0" : "", " for each of the ", axes, " axes");
    if (!value.is_array() || value.size() != axes) refuse_json(path, key, value, expected);
    std::vector<double> numbers;
    for (const Json& number : value) {
        if (!number.is_number()) refuse_json(path, key, value, expected);
        numbers.push_back(number.get<double>());
        if (!std::isfinite(numbers.back()) || (is_scale && !(numbers.back() > 0.0)))
            refuse_json(path, key, value, expected);
    }
    return numbers;
}

/// Scales and translations, one after the other.
struct Transformation {
    std::vector<double> scale;  ///< empty: none stated
    std::vector<double> translation;

    void scale_by(const std::vector<double>& factors)
    {
        if (scale.empty()) scale.assign(factors.size(), 1.0);
        for (size_t axis = 0; axis < factors.size(); ++axis) {
            scale[axis] *= factors[axis];
            if (!translation.empty()) translation[axis] *= factors[axis];
        }
    }
    void move_by(const std::vector<double>& offsets)
    {
        if (translation.empty()) translation.assign(offsets.size(), 0.0);
        for (size_t axis = 0; axis < offsets.size(); ++axis) translation[axis] += offsets[axis];
    }
};

void apply_transformations(const Path& path, const std::string& owner, const Json& object, size_t axes,
                           Transformation& transformation)
{
    const auto found = object.find("coordinateTransformations");
    if (found == object.end()) return;
    const std::string key = owner + ".coordinateTransformations";
    constexpr const char* EXPECTED = "a list of at most 8 objects of type scale, translation or identity";
    if (!found->is_array() || found->size() > 8) refuse_json(path, key, *found, EXPECTED);
    for (const Json& step : *found) {
        const std::string type = step.is_object() ? step.value("type", Json()).dump() : "";
        if (type == "\"scale\"" && step.contains("scale")) {
            transformation.scale_by(read_numbers(path, key + ".scale", step["scale"], axes, true));
        } else if (type == "\"translation\"" && step.contains("translation")) {
            transformation.move_by(read_numbers(path, key + ".translation", step["translation"], axes, false));
        } else if (type != "\"identity\"") {
            refuse_json(path, key, step, EXPECTED);
        }
    }
}

/// Names of folders below the image, nothing else: a path that climbs out of it is an attack or a mistake.
std::string read_level_path(const Path& path, const Json& dataset)
{
    constexpr const char* KEY = "multiscales.datasets.path";
    constexpr const char* EXPECTED = "the relative path of an array inside the image's folder";
    const Json& value = required(path, dataset, "path", EXPECTED);
    if (!value.is_string()) refuse_json(path, KEY, value, EXPECTED);
    const auto text = value.get<std::string>();
    const Path relative(text);
    const bool climbs = std::ranges::find(relative, Path("..")) != relative.end();
    if (text.empty() || relative.is_absolute() || climbs || text.find('\0') != std::string::npos) {
        refuse_json(path, KEY, value, EXPECTED);
    }
    return text;
}

/// Where units differ, everything is brought to that of x.
glm::dvec3 unit_factors(const Path& path, const std::vector<Axis>& axes, OmeImage& image)
{
    std::array<std::optional<std::string>, 3> units;
    for (size_t along = 0; along < 3; ++along) {
        units[along] = axes[image.xyz[along]].unit;
        if (units[along] && !image.unit) image.unit = units[along];
    }
    glm::dvec3 factors(1.0);
    if (!image.unit) return factors;
    const auto metres_of = [](const std::string& unit) {
        const auto* found = std::ranges::find_if(UNITS, [&](const Unit& known) { return unit == known.plain; });
        return found == std::end(UNITS) ? 0.0 : found->metres;
    };
    for (size_t along = 0; along < 3; ++along) {
        if (!units[along]) {
            image.warnings.push_back(sentence("axis ", "xyz"[along], " has no unit; ", *image.unit, " assumed"));
        } else if (*units[along] != *image.unit) {
            const double metres = metres_of(*units[along]);
            const double metres_of_image = metres_of(*image.unit);
            if (!(metres > 0.0) || !(metres_of_image > 0.0)) {
                fail(path.string(), ": axes are in ", in_quotes(*image.unit), " and in ", in_quotes(*units[along]),
                     "; expected one unit for x, y and z, or units of length");
            }
            factors[static_cast<int>(along)] = metres / metres_of_image;
        }
    }
    return factors;
}

void read_levels(const Path& path, const Json& multiscale, const std::vector<Axis>& axes, OmeImage& image)
{
    const glm::dvec3 factors = unit_factors(path, axes, image);
    const std::string expected = sentence("a list of 1 to ", MOST_DATASETS, " objects with a path");
    const Json& datasets = required(path, multiscale, "datasets", expected);
    if (!datasets.is_array() || datasets.empty() || datasets.size() > MOST_DATASETS) {
        refuse_json(path, "multiscales.datasets", datasets, expected);
    }
    for (const Json& dataset : datasets) {
        if (!dataset.is_object()) refuse_json(path, "multiscales.datasets", dataset, expected);
        OmeImage::Level level{.path = read_level_path(path, dataset)};
        Transformation transformation;
        apply_transformations(path, "multiscales.datasets", dataset, image.axes, transformation);
        apply_transformations(path, "multiscales", multiscale, image.axes, transformation);
        const auto xyz_of = [&](const std::vector<double>& numbers) {
            return factors * glm::dvec3(numbers[image.xyz[0]], numbers[image.xyz[1]], numbers[image.xyz[2]]);
        };
        if (!transformation.scale.empty()) level.scale = xyz_of(transformation.scale);
        if (!transformation.translation.empty()) level.translation = xyz_of(transformation.translation);
        image.levels.push_back(std::move(level));
    }
}

void read_channels(const Json& attributes, OmeImage& image)
{
    const auto omero = attributes.find("omero");
    if (omero == attributes.end() || !omero->is_object()) return;
    const auto channels = omero->find("channels");
    if (channels == omero->end() || !channels->is_array() || channels->size() > MOST_CHANNELS) return;
    for (const Json& channel : *channels) {
        const auto label = channel.is_object() ? channel.find("label") : channel.end();
        const bool has_label = channel.is_object() && label != channel.end() && label->is_string();
        image.channels.push_back(has_label ? label->get<std::string>() : std::string());
    }
}

}  // namespace

OmeImage read_ome_image(const Path& path, const Json& attributes)
{
    constexpr const char* EXPECTED = "a list of objects with datasets";
    const Json& multiscales = required(path, attributes, "multiscales", EXPECTED);
    if (!multiscales.is_array() || multiscales.empty() || !multiscales[0].is_object()) {
        refuse_json(path, "multiscales", multiscales, EXPECTED);
    }
    const Json& multiscale = multiscales[0];
    const auto version = multiscale.find("version");
    const bool is_known =
        version == multiscale.end() || *version == "0.1" || *version == "0.2" || *version == "0.3" || *version == "0.4";
    if (!is_known) refuse_json(path, "multiscales.version", *version, "\"0.1\" to \"0.4\"");

    OmeImage image;
    if (multiscales.size() > 1) {
        image.warnings.push_back(sentence("the image is there in ", multiscales.size(), " forms; the first is taken"));
    }
    const std::vector<Axis> axes = read_axes(path, multiscale);
    place_axes(path, multiscale, axes, image);
    read_levels(path, multiscale, axes, image);
    read_channels(attributes, image);
    return image;
}

std::string ome_unit(const std::string& unit)
{
    const auto* found = std::ranges::find_if(UNITS, [&](const Unit& known) { return unit == known.plain; });
    return found == std::end(UNITS) ? unit : found->name;
}

}  // namespace shvr
