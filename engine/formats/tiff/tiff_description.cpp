#include "engine/formats/tiff/tiff_description.h"

#include <tiffio.h>

#include <algorithm>
#include <cmath>

#include "engine/base/error.h"
#include "engine/formats/header_fields.h"
#include "engine/volume/unit.h"

namespace shvr {
namespace {

constexpr double UM_PER_INCH = 25400.0;
constexpr double UM_PER_CM = 10000.0;

/// Returns the length of a unit in micrometres; null if the unit is unknown or no length.
std::optional<double> um_of(const std::string& unit)
{
    constexpr std::pair<const char*, double> LENGTHS[] = {
        {"nm", 1e-3}, {"um", 1.0}, {"mm", 1e3}, {"cm", UM_PER_CM}, {"m", 1e6}, {"inch", UM_PER_INCH},
    };
    for (const auto& [name, um] : LENGTHS) {
        if (unit == name) return um;
    }
    return {};
}

/// Returns the unit of length; null if `stated` is a word for voxels instead.
std::optional<std::string> length_unit(const std::string& stated)
{
    const std::string unit = plain_unit(stated);
    const std::string lower = lower_case(unit);
    for (const char* none : {"", "pixel", "pixels", "voxel", "voxels", "reference frame"}) {
        if (lower == none) return {};
    }
    for (const char* inch : {"inch", "inches", "in"}) {
        if (lower == inch) return "inch";
    }
    return unit;
}

/// Number of pixels per unit, from the resolution fields.
struct Resolution {
    std::optional<double> x, y;  ///< pixels per unit
    double um_per_unit = 0.0;    ///< 0: the fields name no unit
    bool is_for_printing = false;
};

Resolution resolution_of(const TiffFile& file, uint64_t directory, const TiffPage& page)
{
    Resolution resolution{rational_field(file, directory, TIFFTAG_XRESOLUTION),
                          rational_field(file, directory, TIFFTAG_YRESOLUTION)};
    if (!resolution.x) return resolution;
    if (!resolution.y) resolution.y = resolution.x;
    const uint16_t unit = page.number16(TIFFTAG_RESOLUTIONUNIT, RESUNIT_INCH);
    if (unit == RESUNIT_INCH) resolution.um_per_unit = UM_PER_INCH;
    if (unit == RESUNIT_CENTIMETER) resolution.um_per_unit = UM_PER_CM;
    // Detects resolutions meant for screens and printers, which say nothing about voxels; 1 stands for "unknown".
    const double dots_per_inch = *resolution.x * (resolution.um_per_unit == UM_PER_CM ? 2.54 : 1.0);
    for (const double usual : {72.0, 75.0, 90.0, 96.0, 100.0, 120.0, 144.0, 150.0, 200.0, 300.0, 600.0, 1200.0}) {
        if (std::abs(dots_per_inch - usual) < 0.02 * 2.54) resolution.is_for_printing = true;
    }
    if (*resolution.x == 1.0 && *resolution.y == 1.0) resolution.is_for_printing = true;
    return resolution;
}

/// Converts the spacings of y and z, which may be in other units than that of x, to the unit of x.
void use_one_unit(TiffDescription& description)
{
    for (int axis = 1; axis < 3; ++axis) {
        if (!description.spacing[axis]) continue;
        const std::optional<std::string> unit = length_unit(description.unit[axis]);
        const std::optional<std::string> x_unit = length_unit(description.unit[0]);
        if (unit == x_unit) continue;
        const std::optional<double> um = unit ? um_of(*unit) : std::nullopt;
        const std::optional<double> x_um = x_unit ? um_of(*x_unit) : std::nullopt;
        if (um && x_um) {
            *description.spacing[axis] *= *um / *x_um;
        } else {
            description.warnings.push_back(sentence("spacing along ", "xyz"[axis], " is stated in ",
                                                    in_quotes(description.unit[axis]), ", which does not convert to ",
                                                    in_quotes(description.unit[0]), ", and was ignored"));
            description.spacing[axis].reset();
        }
        description.unit[axis] = description.unit[0];
    }
}

/// Sets spacing and unit of x and y from the resolution fields.
void add_resolution(TiffDescription& description, const Resolution& resolution)
{
    const bool is_imagej = description.writer == TiffDescription::Writer::imagej;
    const bool has_unit = is_imagej && length_unit(description.unit[0]).has_value();
    if (!resolution.x) {
        if (has_unit) {
            description.warnings.push_back(sentence("no distance of pixels stated; 1 ",
                                                    *length_unit(description.unit[0]), " assumed, as ImageJ does"));
            description.spacing[0] = description.spacing[1] = 1.0;
        }
        return;
    }
    if (has_unit || (is_imagej && resolution.um_per_unit == 0.0)) {
        // ImageJ's resolution fields count pixels per unit; the unit is in its description.
        description.spacing[0] = 1.0 / *resolution.x;
        description.spacing[1] = 1.0 / *resolution.y;
        return;
    }
    if (resolution.is_for_printing) {
        if (resolution.um_per_unit != 0.0 && *resolution.x != 1.0) {
            description.warnings.push_back(sentence("its ", *resolution.x, " pixels for each ",
                                                    resolution.um_per_unit == UM_PER_CM ? "centimetre" : "inch",
                                                    " are those of a screen or printer, and were ignored"));
        }
        return;
    }
    if (resolution.um_per_unit == 0.0) {
        // Without a unit, the two values state only the aspect ratio of a pixel; equal values add nothing.
        if (*resolution.x == *resolution.y) return;
        description.spacing[0] = 1.0;
        description.spacing[1] = *resolution.x / *resolution.y;
        return;
    }
    description.spacing[0] = resolution.um_per_unit / *resolution.x;
    description.spacing[1] = resolution.um_per_unit / *resolution.y;
    if (description.spacing[2]) *description.spacing[2] *= resolution.um_per_unit;  // ImageJ states it in the same unit
    for (std::string& unit : description.unit) unit = "um";
}

/// Applies our own files' lines. The exact spacing there replaces the resolution fields' rounded one if both agree.
void take_place(VolumeInfo& info, const TiffDescription::Place& place, const std::string& unit)
{
    constexpr double TOLERANCE = 1e-5;
    if (place.spacing && glm::all(glm::greaterThan(*place.spacing, glm::dvec3(0.0))) &&
        glm::all(glm::lessThanEqual(glm::abs(info.spacing - *place.spacing), TOLERANCE * info.spacing)))
        info.spacing = *place.spacing;
    if (!place.directions || !place.origin || info.unit != length_unit(unit).value_or("voxel")) return;
    if (!are_axes(*place.directions)) {
        info.warnings.emplace_back("shvr_directions in its description are no right-handed axes; they are left out");
        return;
    }
    info.directions = *place.directions;
    info.origin = *place.origin;
    info.frame = place.frame;
}

}  // namespace

TiffDescription read_description(const TiffFile& file, std::string_view text, int samples, TiffRole role)
{
    const std::string_view start = trimmed(text);
    if (start.starts_with("ImageJ=")) return read_imagej_description(file.path().string(), start);
    const bool is_xml = start.starts_with("<") || start.starts_with("\xef\xbb\xbf<");
    const bool is_ome = is_xml && start.find("<OME") != std::string_view::npos;
    return is_ome ? read_ome_description(file, start, samples, role) : TiffDescription();
}

std::string content_of_tiff(const std::filesystem::path& path)
{
    if (!TiffFile::begins(read_head(path, 8))) return {};
    const TiffFile file(path);
    const std::string text =
        TiffPage(file, read_directories(file).pages.front().offset, 1).text(TIFFTAG_IMAGEDESCRIPTION);
    const std::string_view start = trimmed(text);
    return start.starts_with("ImageJ=") ? read_imagej_description(path.string(), start).content : std::string();
}

void apply_tiff_spacing(VolumeInfo& info, const TiffDescription& stated, const TiffFile& file, uint64_t directory,
                        const TiffPage& page)
{
    TiffDescription description = stated;
    if (!description.spacing[0] || !description.spacing[1]) {
        if (description.writer == TiffDescription::Writer::ome) description.spacing[2].reset();
        add_resolution(description, resolution_of(file, directory, page));
    }
    use_one_unit(description);
    info.warnings.insert(info.warnings.end(), description.warnings.begin(), description.warnings.end());

    std::optional<std::string> unit = length_unit(description.unit[0]);
    const bool is_imagej = description.writer == TiffDescription::Writer::imagej;
    if (!description.spacing[0] && !description.spacing[1] && !description.spacing[2]) {
        apply_spacing(info, std::nullopt, std::nullopt, "voxel");
        return take_place(info, stated.place, description.unit[0]);
    }
    glm::dvec3 spacing(description.spacing[0].value_or(1.0));
    spacing.y = description.spacing[1].value_or(spacing.x);
    // A missing distance between slices is 1 in ImageJ's files, since ImageJ omits that value.
    spacing.z = description.spacing[2].value_or(is_imagej ? 1.0 : spacing.x);
    const bool is_nothing = !unit && spacing == glm::dvec3(1.0);
    if (!description.spacing[2] && info.size.z > 1 && !is_nothing) {
        info.warnings.push_back(sentence("no distance of slices stated; ", spacing.z, " ", unit.value_or("voxel"),
                                         is_imagej ? " assumed, as ImageJ does" : " assumed, as between pixels"));
    }
    if (unit == "inch") {
        spacing *= 25.4;
        unit = "mm";
    }
    apply_spacing(info, is_nothing ? std::nullopt : std::optional(spacing), unit, "voxel");
    take_place(info, stated.place, description.unit[0]);
}

}  // namespace shvr
