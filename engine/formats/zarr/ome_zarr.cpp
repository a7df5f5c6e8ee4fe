#include "engine/formats/zarr/ome_zarr.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/formats/zarr/store/zarr_json.h"
#include "engine/volume/unit.h"

namespace shvr {
namespace {

using Path = std::filesystem::path;

/// A unit: its name in this program, its name in the specification, and its length in metres.
struct Unit {
    const char* plain;
    const char* name;
    double metres;
};
constexpr Unit UNITS[] = {{"nm", "nanometer", 1e-9},  {"um", "micrometer", 1e-6}, {"mm", "millimeter", 1e-3},
                          {"cm", "centimeter", 1e-2}, {"m", "meter", 1.0},        {"angstrom", "angstrom", 1e-10},
                          {"inch", "inch", 0.0254}};

constexpr size_t MAX_DATASETS = 64;
constexpr size_t MAX_CHANNELS = 4096;

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

Axis read_axis(const JsonNode& node)
{
    constexpr const char* EXPECTED = "a name such as \"z\", or an object with one";
    const std::array<std::string_view, 3> kinds{"space", "channel", "time"};
    Axis axis;
    if (!node.is_object() && !node.is_text()) node.refuse(EXPECTED);
    const JsonNode name = node.is_object() ? node["name"] : node;  // version 0.3 states only the names of axes
    axis.name = lower_case(name.any_text(EXPECTED));
    axis.kind = kind_of(axis.name);
    if (const JsonNode kind = node["type"]; kind.exists()) axis.kind = kinds[kind.choice(kinds)];
    if (const JsonNode unit = node["unit"]; unit.is_text()) axis.unit = plain_unit(unit.any_text());
    return axis;
}

std::vector<Axis> read_axes(const JsonNode& node, int zarr_version)
{
    if (!node.exists() && zarr_version == 2)  // versions 0.1 and 0.2
        return {{"t", "time", {}}, {"c", "channel", {}}, {"z", "space", {}}, {"y", "space", {}}, {"x", "space", {}}};
    constexpr const char* EXPECTED = "a list of z, y, x and perhaps t and c";
    if (!node.is_array() || node.count() > 5) node.refuse(EXPECTED);
    std::vector<Axis> axes;
    for (const JsonNode& element : node.elements()) {
        Axis axis = read_axis(element);
        if (std::ranges::find(axes, axis.name, &Axis::name) != axes.end()) node.refuse(EXPECTED);
        axes.push_back(std::move(axis));
    }
    return axes;
}

void place_axes(const JsonNode& node, const std::vector<Axis>& axes, OmeImage& image)
{
    image.axes = axes.size();
    for (const Axis& axis : axes) image.names.push_back(axis.name);
    std::array<bool, 3> is_there{};
    for (size_t axis = 0; axis < axes.size(); ++axis) {
        std::optional<size_t>* const other = axes[axis].kind == "channel" ? &image.channel
                                             : axes[axis].kind == "time"  ? &image.time
                                                                          : nullptr;
        if (other != nullptr) {
            if (other->has_value()) node.refuse("at most one axis of channels and one of time");
            *other = axis;
            continue;
        }
        const size_t along = std::string("xyz").find(axes[axis].name);
        if (axes[axis].name.size() != 1 || along > 2) node.refuse("axes of space called x, y and z");
        image.xyz[along] = axis;
        is_there[along] = true;
    }
    if (is_there[0] && is_there[1] && !is_there[2]) node.refuse("a z axis too: two-dimensional images are not volumes");
    if (!is_there[0] || !is_there[1] || !is_there[2]) node.refuse("axes of space called x, y and z");
}

/// Reads one finite number per axis. For scales, the numbers must be above 0.
std::vector<double> read_numbers(const JsonNode& node, size_t axes, bool is_scale)
{
    const std::string expected =
        sentence("a finite number", is_scale ? " above 0" : "", " for each of the ", axes, " axes");
    if (node.count() != axes) node.refuse(expected);
    NumberRange range = any_number();
    if (is_scale) range = {std::numeric_limits<double>::denorm_min(), range.upper, "a finite number above 0"};
    std::vector<double> numbers;
    for (const JsonNode& number : node.elements()) numbers.push_back(number.number(range));
    return numbers;
}

/// Scales and translations, combined.
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

/// Applies the transformations of `owner`, which is a dataset, or the multiscale (these apply to all datasets).
void apply_transformations(const JsonNode& owner, size_t axes, Transformation& transformation)
{
    constexpr const char* EXPECTED = "a list of at most 8 objects of type scale, translation or identity";
    const JsonNode steps = owner["coordinateTransformations"];
    if (!steps.exists()) return;
    if (!steps.is_array() || steps.count() > 8) steps.refuse(EXPECTED);
    for (const JsonNode& step : steps.elements()) {
        const JsonNode type = step["type"], scale = step["scale"], translation = step["translation"];
        if (type.is("scale") && scale.exists())
            transformation.scale_by(read_numbers(scale, axes, true));
        else if (type.is("translation") && translation.exists())
            transformation.move_by(read_numbers(translation, axes, false));
        else if (!type.is("identity"))
            step.refuse(EXPECTED);
    }
}

/// Returns the factors that convert each axis to the unit of x; 1 for axes in that unit.
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
            factors[int(along)] = metres / metres_of_image;
        }
    }
    return factors;
}

void read_levels(const Path& path, const JsonNode& multiscale, const std::vector<Axis>& axes, OmeImage& image)
{
    const glm::dvec3 factors = unit_factors(path, axes, image);
    for (const JsonNode& dataset : multiscale["datasets"].elements(1, MAX_DATASETS)) {
        OmeImage::Level level{.path = read_zarr_path(dataset["path"])};
        Transformation transformation;
        apply_transformations(dataset, image.axes, transformation);
        apply_transformations(multiscale, image.axes, transformation);
        const auto xyz_of = [&](const std::vector<double>& numbers) {
            return factors * glm::dvec3(numbers[image.xyz[0]], numbers[image.xyz[1]], numbers[image.xyz[2]]);
        };
        if (!transformation.scale.empty()) level.scale = xyz_of(transformation.scale);
        if (!transformation.translation.empty()) level.translation = xyz_of(transformation.translation);
        image.levels.push_back(std::move(level));
    }
}

void read_channels(const JsonNode& channels, OmeImage& image)
{
    if (!channels.is_array() || channels.count() > MAX_CHANNELS) return;
    for (const JsonNode& channel : channels.elements()) {
        const JsonNode label = channel["label"];
        image.channels.push_back(label.is_text() ? label.any_text() : std::string());
    }
}

}  // namespace

void check_ome_version(const ZarrNode& node)
{
    if (node.version == 2) return;
    const JsonNode ome = node.ome();
    if (!ome.exists()) {
        if (node.attributes()["multiscales"].exists()) {
            node.attributes().required("ome", "the attributes of OME-Zarr 0.5, which Zarr version 3 keeps in it");
        }
        return;
    }
    const JsonNode version = ome.required("version", "the version of OME-Zarr, 0.5");
    if (!version.is("0.5"))
        version.refuse("\"0.5\": earlier versions have Zarr version 2, and later ones are not supported yet");
}

OmeImage read_ome_image(const ZarrNode& node)
{
    check_ome_version(node);
    const std::string path = node.document.origin();
    const JsonNode attributes = node.ome();
    const JsonNode multiscales = attributes["multiscales"];
    if (multiscales.count() == 0 || !multiscales.elements()[0].is_object())
        multiscales.refuse("a list of objects with datasets");
    const JsonNode multiscale = multiscales.elements()[0];
    const std::array<std::string_view, 4> versions{"0.1", "0.2", "0.3", "0.4"};
    const std::array<std::string_view, 1> versions_of_3{"0.5"};
    if (const JsonNode version = multiscale["version"]; version.exists()) {
        if (node.version == 2)
            version.choice(versions);
        else
            version.choice(versions_of_3);
    }

    OmeImage image;
    if (multiscales.count() > 1)
        image.warnings.push_back(sentence("the image has ", multiscales.count(), " multiscales; the first is used"));
    const JsonNode axes_node = multiscale["axes"];
    const std::vector<Axis> axes = read_axes(axes_node, node.version);
    place_axes(axes_node, axes, image);
    read_levels(path, multiscale, axes, image);
    read_channels(attributes["omero"]["channels"], image);
    return image;
}

std::string read_zarr_path(const JsonNode& node)
{
    constexpr const char* EXPECTED = "a relative path that stays inside the image's folder";
    const std::string text = node.text(EXPECTED);
    const Path relative(text);
    const bool climbs = std::ranges::find(relative, Path("..")) != relative.end();
    if (relative.is_absolute() || climbs || has_controls(text)) node.refuse(EXPECTED);
    return text;
}

std::string ome_unit(const std::string& unit)
{
    const auto* found = std::ranges::find_if(UNITS, [&](const Unit& known) { return unit == known.plain; });
    return found == std::end(UNITS) ? unit : found->name;
}

}  // namespace shvr
