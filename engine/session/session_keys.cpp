// The keys of a session file, except keys of the look (session_keys_look.cpp) and of cameras
// (session_keys_camera.cpp).

#include "engine/session/session_keys.h"
#include "engine/session/annotation_files.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include "engine/annotation/trace/trace_file.h"
#include "engine/base/text.h"
#include "engine/remote/address.h"
#include "engine/volume/grid.h"
#include "engine/volume/unit.h"

namespace shvr {

// ---- Shared helpers for values --------------------------------------------------------------------------------------

void Fields::flag(std::string_view name, bool& value, const About& about)
{
    std::optional<bool> flag = value;
    any_flag(name, flag, about);
    value = flag.value_or(value);
}

void Fields::number(std::string_view name, double& value, const NumberRange& range, const About& about)
{
    std::optional<double> number = value;
    this->number(name, number, range, about);
    value = number.value_or(value);
}

void Fields::vector(std::string_view name, glm::dvec3& value, const NumberRange& range, const About& about)
{
    std::optional<glm::dvec3> vector = value;
    this->vector(name, vector, range, about);
    value = vector.value_or(value);
}

void Fields::color(std::string_view name, std::optional<glm::dvec3>& value, const About& about)
{
    std::optional<glm::dvec4> color;
    if (value) color = glm::dvec4(*value, 1.0);
    this->color(name, color, false, about);
    if (color) value = glm::dvec3(*color);
}

void Fields::color(std::string_view name, glm::dvec3& value, const About& about)
{
    std::optional<glm::dvec3> color = value;
    this->color(name, color, about);
    value = color.value_or(value);
}

namespace {

// ---- volume ---------------------------------------------------------------------------------------------------------

const About PROCEDURAL{.meaning = "synthetic volume to compute, instead of `path`", .standard = "none"};
const About PATH{.meaning = "path of the volume's file or folder",
                 .allowed = "path",
                 .standard = "required for files",
                 .is_required = true};
const About VOLUME_PATH{.meaning =
                            "path of the volume's file or folder, or the address of an OME-Zarr, as "
                            "https://host/scan.zarr or s3://bucket/scan.zarr",
                        .allowed = PATH_OR_ADDRESS,
                        .standard = "required for files",
                        .is_required = true};
const About RAW{.meaning =
                    "layout of a file without a header, `\"256x256x108:int16:little:0\"`: size, type, byte order and "
                    "bytes to skip; the last two are optional. `volume.path` may then be the first of numbered files "
                    "with one slice each, or their folder",
                .allowed = "text",
                .standard = "none"};

const About SPACING{.meaning = "size of a voxel along x, y and z; overrides the file's",
                    .allowed = "physical units per voxel, above 0",
                    .standard = "the file's; `[1, 1, 1]` with `raw` or `procedural`"};
const About UNIT{.meaning = "unit of the spacing",
                 .allowed = "text",
                 .standard = "the file's; `\"voxel\"` with `raw` or `procedural`"};

void spacing_fields(Fields& f, glm::dvec3& spacing, std::string& unit)
{
    f.vector("spacing", spacing, above_zero(MIN_SPACING, MAX_SPACING), SPACING);
    f.text("unit", unit, UNIT);
    f.check("unit", !has_controls(unit), "the name of a unit");
}

/// Fields for the spacing and the unit of a volume, which override those stated in its file.
void spacing_fields(Fields& f, OpenOptions& options)
{
    f.vector("spacing", options.spacing, above_zero(MIN_SPACING, MAX_SPACING), SPACING);
    f.text("unit", options.unit, UNIT);
    f.check("unit", !has_controls(options.unit), "the name of a unit");
}

constexpr std::string_view NO_NODATA = "none";

/// Infinity represents the text "none" (OpenOptions).
void nodata_field(Fields& f, std::optional<double>& nodata)
{
    const auto read = [&](const JsonNode& node) {
        if (!node.is_text())
            nodata = node.number(any_number());
        else if (node.text() == NO_NODATA)
            nodata = std::numeric_limits<double>::infinity();
        else
            node.refuse("a number, or \"none\"");
    };
    const auto written = [&]() -> std::optional<std::string> {
        if (!nodata) return std::nullopt;
        return std::isinf(*nodata) ? '"' + std::string(NO_NODATA) + '"' : digits_of(*nodata);
    };
    f.other(
        "nodata", read, written,
        {.meaning = "value of voxels without data (fill value). It counts neither for the histogram's range nor for "
                    "automatic settings; painting decides by values alone. `\"none\"`: no value is one",
         .allowed = "number or `\"none\"`",
         .standard = "values at an end of the range, behind a gap that is wide for all others"});
}

void procedural_fields(Fields& f, ProceduralSpec& spec)
{
    const std::vector<std::string> kinds = procedural_kinds();
    f.choice("procedural", spec.kind, {kinds.begin(), kinds.end()}, PROCEDURAL);
    std::vector<int64_t> size{spec.size.x, spec.size.y, spec.size.z};
    f.wholes("size", size, 1, MAX_SIDE, {"size of the `procedural` volume", "voxels"});
    spec.size = {size[0], size[1], size[2]};
    f.whole("seed", spec.seed, 0, std::numeric_limits<uint32_t>::max(),
            {"seed of the `procedural` volume's random numbers"});
    std::vector<std::string_view> types;
    for (const VoxelType type : VOXEL_TYPES) types.push_back(name_of(type));
    std::string type = name_of(spec.type);
    f.choice("type", type, types, {"voxel type of the `procedural` volume"});
    spec.type = voxel_type_of(type).value_or(spec.type);
    spacing_fields(f, spec.spacing, spec.unit);
}

std::string text_of(const RawLayout& layout)
{
    const char* const order = !layout.big_endian ? "" : *layout.big_endian ? ":big" : ":little";
    return sentence(layout.size.x, "x", layout.size.y, "x", layout.size.z, ":", name_of(layout.type), order, ":",
                    layout.offset_bytes);
}

void raw_fields(Fields& f, std::filesystem::path& path, std::optional<RawLayout>& layout)
{
    f.path("path", path, PATH);
    const auto read = [&](const JsonNode& node) {
        layout = node.checked([text = node.text()] { return parse_raw_layout(text); });
    };
    f.other(
        "raw", read, [&] { return layout ? std::optional('"' + text_of(*layout) + '"') : std::nullopt; }, RAW);
    if (!layout) layout.emplace();
    spacing_fields(f, layout->spacing, layout->unit);
}

constexpr int MAX_LEVEL = 23;

/// Visits the volume, which has one of three forms: a procedural function, raw voxels, or a file in a known format.
void volume_fields(Fields& f, Session& session)
{
    if (f.has("procedural", session.procedural.has_value())) {
        if (!session.procedural) session.procedural.emplace();
        return procedural_fields(f, *session.procedural);
    }
    if (f.has("raw", session.raw_layout.has_value())) {
        raw_fields(f, session.volume_path, session.raw_layout);
        return nodata_field(f, session.open_options.nodata);
    }
    f.path("path", session.volume_path, VOLUME_PATH);
    f.mention("raw", RAW);
    f.mention("procedural", PROCEDURAL);
    f.text("channel", session.open_options.channel,
           {.meaning = "channel to read from a file with several: `\"red\"`, `\"green\"`, `\"blue\"`, `\"alpha\"`, a "
                       "name in the file, or a number from 1",
            .allowed = "text",
            .standard = "none: such a file is refused"});
    f.text(
        "frame", session.open_options.frame,
        {.meaning = "time point to read from a file with several: a number from 1. Of DICOM slices also what a refusal "
                    "lists, as `\"stack A\"`, `\"first\"` or `\"last\"` of repeated ones; `\"z\"` stacks those of one "
                    "position",
         .allowed = "text",
         .standard = "none: such a file is refused"});
    std::optional<int64_t> level = session.open_options.level;
    if (level == 0) level.reset();
    f.any_whole(
        "level", level, 0, MAX_LEVEL,
        {.meaning =
             "resolution level to read from a file with several, as OME-Zarr has: 0 is the finest, each further level "
             "twice as coarse. It is opened as a volume of its own; its paint and trace fit no other level",
         .standard = "0"});
    session.open_options.level = int(level.value_or(0));
    spacing_fields(f, session.open_options);
    nodata_field(f, session.open_options.nodata);
}

// ---- transfer_function, groups, probe, surfaces, annotation ---------------------------------------------------------

}  // namespace

void points_field(Fields& f, TransferFunction& function, const About& about)
{
    const std::span<const ControlPoint> before = function.points();
    std::vector<ControlPoint> points(before.begin(), before.end());
    f.list("points", points, SIZE_MAX, about);
    if (!std::ranges::equal(points, before)) function = TransferFunction(std::move(points));
}

namespace {

void transfer_fields(Fields& f, Session& session)
{
    const About points_about{.meaning =
                                 "control points; opacity and colour are linear between them and 0 outside; two points "
                                 "at one intensity make a step",
                             .allowed = "array",
                             .standard = "without `transfer_function` one is made from the histogram, with a warning",
                             .is_required = true};
    const About preset_about{
        .meaning = "preset from `assets/transfer_functions`, fitted to the volume's intensities, instead of `points`",
        .allowed =
            "`\"bone\"`, `\"bundles\"`, `\"cividis\"`, `\"fire\"`, `\"grey\"`, `\"haze\"`, `\"heat\"`, "
            "`\"layers\"`, `\"magma\"`, `\"surface\"`, `\"viridis\"`",
        .standard = "none"};
    if (f.has("preset", !session.transfer_preset.empty())) {
        f.mention("points", points_about);
        f.check("preset", !f.has("points", false), "either points or a preset");
        return f.text("preset", session.transfer_preset, preset_about);
    }
    points_field(f, session.transfer_function, points_about);
    f.mention("preset", preset_about);
}

void group_fields(Fields& f, GroupSettings& group)
{
    f.flag("visible", group.visible, {"whether its voxels are drawn; false hides the groups below it, too"});
    f.flag("locked", group.locked,
           {"true: no brush adds voxels to it or to groups below it, or removes any; undo and redo still do"});
    f.text("name", group.name, {.meaning = "name of the group", .allowed = "text", .standard = "`\"group N\"`"});
    std::optional<int64_t> parent = group.parent == 0 ? std::nullopt : std::optional<int64_t>(group.parent);
    f.any_whole("parent", parent, 0, 255,
                {.meaning = "number of the parent group, from which N inherits all that it does not set; 0: none",
                 .allowed = "0 ... 255, no cycle",
                 .standard = "0"});
    group.parent = uint8_t(parent.value_or(0));
    f.color("color", group.color, {.meaning = "colour", .standard = "the parent's, or one of ten"});
    f.number("opacity", group.opacity, SHARE,
             {.meaning = "opacity of its voxels", .unit = "per reference length", .standard = "the parent's, or 1"});
}

std::optional<uint8_t> group_number(const std::string& name)
{
    uint8_t group = 0;
    const auto result = std::from_chars(name.data(), name.data() + name.size(), group);
    const bool is_whole = result.ec == std::errc() && result.ptr == name.data() + name.size();
    if (!is_whole || group == 0 || name[0] == '0') return {};
    return group;
}

void density_fields(Fields& f, DensityBrush& density)
{
    const auto read = [&](const JsonNode& node) {
        density.offset.reset();
        if (node.is("automatic")) return;
        if (!node.is_number()) node.refuse("a number or \"automatic\"");
        density.offset = node.number(INTENSITY);
    };
    const auto written = [&] { return density.offset ? digits_of(*density.offset) : std::string("\"automatic\""); };
    f.other("offset", read, written,
            {.meaning = "offset added to intensities at the centre of the brush; `\"automatic\"`: lifts the paint "
                        "threshold to the lowest visible intensity",
             .allowed = "the file's intensities, or `\"automatic\"`",
             .standard = "`\"automatic\"`"});
    f.choice(
        "falloff", density.falloff,
        {"profile of the offset over the brush: the same everywhere (flat), or falling to 0 at its edge (distance)"});
}

void annotation_fields(Fields& f, Session& session)
{
    f.path("mask", session.mask_path,
           {.meaning =
                "label image of the mask, created when first saved: OME-Zarr (`NAME.zarr`, or `labels/NAME` in "
                "a project), which holds only what is painted, and also names and colours groups that `groups` "
                "does not list; or a file of every voxel: `.nrrd`, `.tif`, or raw bytes (`.mask`). A mask in a format "
                "that is only read, as `m.nii.gz`, is kept in `m.labels.zarr` next to it, and read from there",
            .allowed = "path",
            .standard = "none"});
    f.path("trace", session.trace_path,
           {.meaning = "file of the trace, created when first saved: `.graphml`, which keeps everything, `.txt`, "
                       "`.swc` or `.rsml`",
            .allowed = "path",
            .standard = "next to the mask, with its name and `.graphml`; in `shvr` for `labels/NAME`"});
    if (session.trace_path.empty() && !session.mask_path.empty()) session.trace_path = trace_beside(session.mask_path);
    f.check("trace", session.trace_path.empty() || is_trace_file(session.trace_path),
            "a path that ends in .graphml, .txt, .swc or .rsml");
    f.path(
        "density", session.density_path,
        {.meaning = "density offsets, created when first saved: an OME-Zarr image (`.zarr`), which holds only what is "
                    "painted, or a file of every voxel: `.nrrd`, `.tif`, or raw numbers (`.offset`)",
         .allowed = "path",
         .standard = "the same with `.offsets.zarr`; with `.offset` where that exists, and for masks of every voxel"});
    if (session.density_path.empty() && !session.mask_path.empty())
        session.density_path = offsets_beside(session.mask_path);
}

/// Visits a list of group numbers, without repetitions. Empty: everything can be felt.
void felt_groups_field(Fields& f, std::vector<uint8_t>& groups)
{
    const auto read = [&](const JsonNode& node) {
        groups.clear();
        for (const JsonNode& each : node.elements()) groups.push_back(uint8_t(each.whole(0, 255)));
        std::ranges::sort(groups);
        groups.erase(std::unique(groups.begin(), groups.end()), groups.end());
    };
    const auto written = [&]() -> std::optional<std::string> {
        if (groups.empty()) return std::nullopt;
        std::string text;
        for (const uint8_t group : groups) text += sentence(text.empty() ? "[" : ",", int(group));
        return text + "]";
    };
    f.other("groups", read, written,
            {.meaning = "groups that can be felt; 0 stands for unpainted voxels",
             .allowed = "numbers from 0 to 255",
             .standard = "none: everything"});
}

void density_section(Fields& f, BrushSettings& brush)
{
    const About density{
        .meaning = "density painting, in which the brush also raises intensities; an object with the two keys below",
        .allowed = "object",
        .standard = "none"};
    if (f.has("density", brush.density.has_value())) {
        if (!brush.density) brush.density.emplace();
        f.section(
            "density", [&](Fields& inner) { density_fields(inner, *brush.density); }, density);
    } else {
        f.mention("density", density);
    }
}

}  // namespace

void fields(Fields& f, Groups& groups)
{
    std::vector<std::string> names;
    for (const auto& [number, group] : groups) names.push_back(std::to_string(number));
    const auto visit = [&](Fields& entry, const std::string& name) {
        const std::optional<uint8_t> number = group_number(name);
        entry.check("", number.has_value(), "a group number from 1 to 255 as its name");
        GroupSettings unnumbered;
        group_fields(entry, number ? groups[*number] : unnumbered);
    };
    f.entries(
        "groups", names, "N", visit,
        {.meaning = "colour group N, 1 ... 255, whose colour and opacity replace the transfer function in its voxels",
         .allowed = "object",
         .standard = "one of ten colours in turn"});
    if (const std::optional<uint8_t> group = group_in_cycle(groups))
        f.check(sentence("groups.", int{*group}, ".parent"), false, "a group other than itself and those below it");
}

void fields(Fields& f, FeelSettings& touch)
{
    f.choice("mode", touch.mode,
             {"target of the pull on the probe: everything felt in its ball (proximity), a surface that holds it "
              "(surface), or the object touched first (object)"});
    f.number("strength", touch.strength, SHARE, {"factor of the force"});
    f.number("surface_share", touch.surface_share, above_zero(0.01, 1.0),
             {"fraction of the probe's ball that must be felt for a surface to hold it"});
    f.number("stiffness", touch.stiffness, {0.0, MAX_STIFFNESS},
             {.meaning = "stiffness of the pull for a 2.5 mm probe in the hand; the device's own limit also applies",
              .allowed = "N/m, 0 ... 1000"});
    f.number("damping", touch.damping, {0.0, MAX_FELT_DAMPING},
             {.meaning = "damping of the hand in contact", .allowed = "N s/m, 0 ... 1.2"});
    felt_groups_field(f, touch.groups);
    f.flag("at_proxy", touch.at_proxy,
           {"tools paint and trace at the centre of the touched structure while the probe is guided"});
    f.flag(
        "overlap_radius", touch.overlap_radius,
        {"new nodes get the radius of a tube that would fill the same share of the probe's ball as the felt voxels"});
    f.flag("to_nodes", touch.to_nodes, {"tools act at the nearest node inside the probe's ball"});
    f.flag("to_lines", touch.to_lines,
           {"tools act at the nearest point of a centre line inside the probe's ball, where a new node divides it"});
    f.flag("clicks", touch.clicks, {"a haptic device gives a short pulse when the probe begins to touch something"});
    f.choice("plane", touch.plane, {"axis across which the probe stays in its plane of voxels"});
    f.flag("feels_hidden", touch.feels_hidden,
           {"true: what the picture does not show is felt, too, and tools act at nodes that are not drawn: what is cut "
            "away or transparent, and hidden groups; false: what is seen is what is felt"});
}

void fields(Fields& f, ProbeSettings& probe)
{
    BrushSettings& brush = probe.brush;
    constexpr const char* INTENSITIES = "the file's intensities";
    f.number("radius_voxels", brush.radius_voxels, above_zero(1e-3, 127.0),
             {.meaning = "radius of the probe and its brush, along x", .allowed = "voxels, above 0 ... 127"});
    f.whole("group", brush.group, 0, 255, {"group that the brush paints; 0 erases"});
    f.choice("brush", brush.brush,
             {"voxels of the region that the brush paints: all at or above the threshold (fill), those connected with "
              "the centre (flood), or whole components (speckle)"});
    f.choice("region", brush.region, {"shape of the brush's region"});
    f.whole("connectivity", brush.connectivity, 6, 26,
            {.meaning = "number of neighbours of a voxel, for flood and speckle", .allowed = "6 or 26"});
    f.check("connectivity", brush.connectivity == 6 || brush.connectivity == 26, "6 or 26");
    f.flag("only_unpainted", brush.only_unpainted,
           {"true: the brush paints only unpainted voxels and takes none from other groups; density offsets change "
            "everywhere"});
    f.vector("voxel", probe.voxel, {-double(MAX_SIDE), 2.0 * double(MAX_SIDE)},
             {.meaning = "position of the probe", .unit = "voxels", .standard = "the volume's middle"});
    f.number("paint_threshold", brush.threshold, INTENSITY,
             {.meaning = "lowest intensity that brushes paint",
              .allowed = INTENSITIES,
              .standard = "the middle of what the transfer function shows"});
    f.number("haptic_threshold", probe.haptic_threshold, INTENSITY,
             {.meaning = "lowest intensity that is felt", .allowed = INTENSITIES, .standard = "the paint threshold"});
    f.flag("shown", probe.shown,
           {"true: `shvr render` draws the probe as a ball in its group's colour; the window always does"});
    f.flag("shell", probe.shell,
           {"true: shows an iso-surface at the paint threshold in the probe's region, the boundary of what painting "
            "reaches"});
    f.number("shell_opacity", probe.shell_opacity, SHARE, {"opacity of one crossing of the iso-surface"});
    f.any_flag("preview", probe.preview,
               {.meaning = "true: highlights the voxels that painting would change now, in pictures and slices; "
                           "striped where it would erase",
                .standard = "true in the window while a tool that paints is in hand, false in pictures"});
    f.choice("tool", probe.tool, {"function of the left mouse button in the window"});
    f.choice("measure", probe.measure, {"what the window's tool for measuring begins"});
    f.flag("guided", probe.guided, {"true: the window pulls the probe to voxels at or above the haptic threshold"});
    f.choice("guidance", probe.guidance, {"force law of the pull"});
    f.section("touch", probe.touch);
    f.number("node_radius", probe.node_radius_voxels, above_zero(1e-3, 127.0),
             {.meaning = "radius of new nodes of the trace, along x",
              .allowed = "voxels, above 0 ... 127",
              .standard = "in the window 1/500 of the volume's diagonal, at least 1; in scripts the probe's radius"});
    f.flag("measured_radius", probe.measured_radius,
           {"true: the window gives new nodes the radius of the structure around them, above the paint threshold"});
    f.flag("centered_nodes", probe.centered_nodes,
           {"true: nodes clicked in the window go to the centre of the structure seen there, above the paint "
            "threshold; false: onto its wall"});
    f.color("color", probe.color,
            {.meaning = "colour of the probe's ball, silhouette and arrow", .standard = "its group's"});
    f.number("opacity", probe.opacity, SHARE, {"opacity of the probe's ball; 0: not drawn"});
    f.flag("silhouette", probe.silhouette, {"true: draws the probe's outline over whatever hides it"});
    f.flag("arrow", probe.arrow, {"true: an arrow points towards the probe when it is out of sight"});
    density_section(f, brush);
    f.flag("paints_group", brush.paints_group, {"false, with `probe.density`: the brush changes offsets only"});
    f.check("paints_group", brush.paints_group || brush.density, "true where probe.density is not given");
}

void fields(Fields& f, SurfaceLook& surface)
{
    static const NumberRange SIZE = above_zero(1e-12, 1e15);
    const bool is_ball = surface.to == surface.from, is_even = surface.radius_to == surface.radius_from;
    std::optional<glm::dvec3> to = is_ball ? std::nullopt : std::optional(surface.to);
    std::optional<double> radius = is_even ? std::optional(surface.radius_from) : std::nullopt;
    std::optional<glm::dvec2> radii =
        is_even ? std::nullopt : std::optional(glm::dvec2(surface.radius_from, surface.radius_to));
    f.vector("from", surface.from, COORDINATE,
             {.meaning = "first end of a rod, or centre of a ball", .allowed = "physical units", .is_required = true});
    f.vector("to", to, COORDINATE,
             {.meaning = "other end of the rod", .allowed = "physical units", .standard = "`from`: a ball"});
    surface.to = to.value_or(surface.from);
    const bool has_radii = f.has("radii", !is_even);
    f.check("radius", !has_radii || !f.has("radius", false), "either radius or radii");
    const About one{.meaning = "radius of both ends",
                    .allowed = "physical units, above 0",
                    .standard = "required, or `radii`",
                    .is_required = true};
    const About two{.meaning = "radii of the two ends, `[from, to]`",
                    .allowed = "physical units, above 0",
                    .standard = "required, or `radius`"};
    if (has_radii) {
        f.mention("radius", one);
        f.numbers("radii", radii, SIZE, two);
        if (radii) std::tie(surface.radius_from, surface.radius_to) = std::tie(radii->x, radii->y);
    } else {
        f.number("radius", radius, SIZE, one);
        f.mention("radii", two);
        if (radius) surface.radius_from = surface.radius_to = *radius;
    }
    f.color("color", surface.color, {"colour"});
}

namespace {

/// The fields of the look, except for cuts: in a file, other sections lie between the look and the cuts.
void look_fields(Fields& f, Session& session)
{
    f.section("transfer_function", [&](Fields& transfer) { transfer_fields(transfer, session); });
    fields(f, session.groups);
    f.section("unpainted", session.unpainted);
    f.section("light", session.light);
    f.section("blend", session.blend);
}

}  // namespace

void fields(Fields& f, Measurement& measurement)
{
    f.text("name", measurement.name, {.meaning = "name", .standard = "its kind and its number"});
    f.choice("kind", measurement.kind,
             {"distance of two points, length of a path along two or more, or angle at the second of three points"});
    const auto read = [&](const JsonNode& node) {
        measurement.points.clear();
        for (const JsonNode& point : node.elements(2, MAX_MEASURED_POINTS))
            measurement.points.push_back(point.vector(COORDINATE));
    };
    const auto written = [&]() -> std::optional<std::string> {
        if (measurement.points.empty() || measurement.kind == MeasureKind::distance) return std::nullopt;
        std::string text;
        for (const glm::dvec3& point : measurement.points)
            text += sentence(text.empty() ? "[[" : ",[", digits_of(point.x), ',', digits_of(point.y), ',',
                             digits_of(point.z), ']');
        return text + ']';
    };
    f.other("points", read, written,
            {.meaning = "points of a path or an angle",
             .allowed = "array of 2 ... 200 `[x, y, z]`, in voxels; 0.5 is the middle of the first",
             .standard = "required; a distance has `from` and `to`"});
    static_assert(MAX_MEASURED_POINTS == 200);
    std::optional<glm::dvec3> from, to;
    if (measurement.kind == MeasureKind::distance && measurement.points.size() == 2) {
        from = measurement.points[0];
        to = measurement.points[1];
    }
    const char* const ALLOWED = "`[x, y, z]`, in voxels; 0.5 is the middle of the first";
    f.vector("from", from, COORDINATE, {.meaning = "one end of a distance", .allowed = ALLOWED, .standard = "none"});
    f.vector("to", to, COORDINATE, {.meaning = "its other end", .allowed = ALLOWED, .standard = "none"});
    if (from && to && measurement.points.empty()) measurement.points = {*from, *to};
    f.check("points", is_count_of(measurement.kind, measurement.points.size()),
            "2 points for a distance, 2 or more for a path and 3 for an angle");
}

void fields(Fields& f, MeshLook& mesh)
{
    f.text("file", mesh.file,
           {.meaning = "file of the mesh: `.stl`, `.ply`, `.obj` or `.glb`, in the volume's physical space and unit "
                       "unless the file states others; LPS and RAS are converted",
            .allowed = "path, relative to the session's folder",
            .standard = "required",
            .is_required = true});
    f.check("file", !mesh.file.empty() && mesh.file.size() < PATH_MAX && !has_controls(mesh.file),
            "a path of less than 4096 bytes");
    f.color("color", mesh.color, {.meaning = "colour", .standard = "the file's, or `\"#c8b48c\"`"});
    f.flag("shown", mesh.shown, {"false: the mesh is kept, and not drawn"});
}

namespace {

const About MESHES{.meaning =
                       "surfaces of files, such as those that other programs or `shvr export --surface` wrote; "
                       "slices do not show them, and cutting planes do not affect them",
                   .allowed = "array of at most 64",
                   .standard = "none"};
static_assert(MAX_SESSION_MESHES == 64);

const About MEASUREMENTS{.meaning = "distances, paths and angles measured in the window",
                         .allowed = "array of at most 1000",
                         .standard = "none"};
static_assert(MAX_MEASUREMENTS == 1000);

void work_fields(Fields& f, Session& session)
{
    look_fields(f, session);
    f.section("cut", session.cut);
    f.list("measurements", session.measurements, MAX_MEASUREMENTS, MEASUREMENTS);
    f.list("meshes", session.meshes, MAX_SESSION_MESHES, MESHES);
}

/// Fields of settings that are neither cameras nor part of the work.
void passing_fields(Fields& f, Session& session)
{
    f.section("view", session.view);
    f.section("interaction", session.interaction);
    f.section("probe", session.probe);
}

}  // namespace

void lasting_fields(Fields& f, Session& session)
{
    work_fields(f, session);
    f.section("picture", [&](Fields& picture) { picture_fields(picture, session.render); });
}

void kept_fields(Fields& f, Session& session)
{
    f.section("cameras", [&](Fields& cameras) { camera_fields(cameras, session); });
    key_look_fields(f, session, true);  // journals must state that the last look was removed
    f.section("render", [&](Fields& render) {
        rendering_fields(render, session.render);
        for (const std::string_view key : PICTURE_KEYS) render.mention(key, {});  // older journals have these keys here
    });
    passing_fields(f, session);
}

void setting_fields(Fields& f, Session& session)
{
    work_fields(f, session);
    f.section("render", session.render);
    passing_fields(f, session);
}

void fields(Fields& f, Session& session)
{
    int64_t version = 1;
    f.whole("shvr_session", version, 1, 1, {.meaning = "version of this format", .allowed = "1", .is_required = true});
    f.section("volume", [&](Fields& volume) { volume_fields(volume, session); },
              {.meaning = "one of the three forms below", .allowed = "object", .is_required = true});
    camera_fields(f, session);
    key_look_fields(f, session, false);
    look_fields(f, session);
    f.section("render", session.render);
    f.section("view", session.view);
    f.section("interaction", session.interaction);
    f.section("cut", session.cut);
    if (f.has("measurements", !session.measurements.empty()))
        f.list("measurements", session.measurements, MAX_MEASUREMENTS, MEASUREMENTS);
    else
        f.mention("measurements", MEASUREMENTS);
    f.section("probe", session.probe);
    const About surfaces{.meaning = "opaque balls and rods, which cutting planes do not affect",
                         .allowed = "array of at most 100000",
                         .standard = "none"};
    if (f.has("surfaces", !session.surfaces.empty()))
        f.list("surfaces", session.surfaces, MAX_SESSION_SURFACES, surfaces);
    else
        f.mention("surfaces", surfaces);
    if (f.has("meshes", !session.meshes.empty()))
        f.list("meshes", session.meshes, MAX_SESSION_MESHES, MESHES);
    else
        f.mention("meshes", MESHES);
    const bool has_files = !session.mask_path.empty() || !session.trace_path.empty() || !session.density_path.empty();
    if (f.has("annotation", has_files))
        f.section("annotation", [&](Fields& annotation) { annotation_fields(annotation, session); });
    else
        f.mention("annotation", {});
}

}  // namespace shvr
