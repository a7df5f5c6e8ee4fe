// The keys of a session file, version 1, one function a section. README.md lists them.

#include <charconv>
#include <limits>

#include <nlohmann/json.hpp>

#include "engine/annotation/trace/trace_file.h"
#include "engine/base/text.h"
#include "engine/session/session_read.h"
#include "engine/volume/grid.h"

namespace shvr {
namespace {

constexpr int64_t VERSION = 1;

glm::dvec3 read_spacing(const JsonNode& node, const glm::dvec3& fallback)
{
    return node.vector(fallback, above_zero(1e-12, 1e12));
}

std::filesystem::path read_path(const JsonNode& node, const std::filesystem::path& folder)
{
    if (!node.exists()) return {};
    const std::string text = node.text("");
    if (has_controls(text)) node.refuse("a path");
    if (is_address(text)) node.refuse(NO_ADDRESS);
    return std::filesystem::absolute(folder / text).lexically_normal();
}

std::string read_unit(const JsonNode& node, const std::string& fallback)
{
    const std::string unit = node.text(fallback);
    if (has_controls(unit)) node.refuse("the name of a unit");
    return unit;
}

ProceduralSpec read_procedural(const JsonNode& node)
{
    node.expect_object({"procedural", "size", "seed", "type", "spacing", "unit"});
    ProceduralSpec spec;
    std::map<std::string, std::string> kinds;
    for (const std::string& kind : procedural_kinds()) kinds[kind] = kind;
    spec.kind = node["procedural"].choice(spec.kind, kinds);
    spec.size = node["size"].size(spec.size);
    spec.seed = static_cast<uint32_t>(node["seed"].whole(spec.seed, 0, std::numeric_limits<uint32_t>::max()));
    std::map<std::string, VoxelType> types;
    for (const VoxelType type : VOXEL_TYPES) types[name_of(type)] = type;
    spec.type = node["type"].choice(spec.type, types);
    spec.spacing = read_spacing(node["spacing"], spec.spacing);
    spec.unit = read_unit(node["unit"], spec.unit);
    return spec;
}

RawLayout read_raw_layout(const JsonNode& node)
{
    const JsonNode raw = node["raw"];
    RawLayout layout = raw.checked([text = raw.text("")] { return parse_raw_layout(text); });
    layout.spacing = read_spacing(node["spacing"], layout.spacing);
    layout.unit = read_unit(node["unit"], layout.unit);
    return layout;
}

void read_volume(const JsonNode& node, const std::filesystem::path& folder, Session& session)
{
    if (node["procedural"].exists()) {
        session.procedural = read_procedural(node);
        return;
    }
    if (node["raw"].exists()) {
        node.expect_object({"path", "raw", "spacing", "unit"});
        session.raw_layout = read_raw_layout(node);
    } else {
        node.expect_object({"path", "raw", "procedural", "channel", "frame"});
        session.open_options = {.channel = node["channel"].text(""), .frame = node["frame"].text("")};
    }
    session.volume_path = read_path(node.required("path", "the path of a volume file"), folder);
}

uint8_t group_number(const JsonNode& groups, const std::string& name)
{
    uint8_t group = 0;
    const auto result = std::from_chars(name.data(), name.data() + name.size(), group);
    if (result.ec != std::errc() || result.ptr != name.data() + name.size() || group == 0 || name[0] == '0')
        groups[name].refuse("a group number from 1 to 255 as its name");
    return group;
}

Groups read_groups(const JsonNode& node)
{
    Groups groups;
    if (!node.exists()) return groups;
    for (const std::string& name : node.names()) {
        const uint8_t number = group_number(node, name);
        const JsonNode entry = node[name];
        entry.expect_object({"name", "parent", "color", "opacity", "visible"});
        GroupSettings& group = groups[number];
        group.name = entry["name"].text("");
        group.parent = uint8_t(entry["parent"].whole(0, 0, 255));
        if (entry["color"].exists()) group.color = entry["color"].color(glm::dvec3(0.0));
        if (entry["opacity"].exists()) group.opacity = entry["opacity"].number(0.0, SHARE);
        group.visible = entry["visible"].flag(true);
    }
    if (const std::optional<uint8_t> group = group_in_cycle(groups))
        node[std::to_string(*group)]["parent"].refuse("a group that is not the group itself or below it");
    return groups;
}

CutBox read_cut(const JsonNode& node)
{
    CutBox cut;
    if (!node.exists()) return cut;
    node.expect_object({"lower", "upper"});
    const NumberRange voxel = range(0.0, double(LARGEST_SIDE));
    cut.lower = node["lower"].vector(cut.lower, voxel);
    cut.upper = node["upper"].vector(cut.upper, voxel);
    if (glm::any(glm::greaterThan(cut.lower, cut.upper))) node.refuse("a lower corner that is not above the upper one");
    return cut;
}

DensityBrush read_density(const JsonNode& node)
{
    node.expect_object({"offset", "falloff"});
    DensityBrush density;
    const JsonNode offset = node["offset"];
    if (offset.is_text()) {
        if (offset.text("") != "automatic") offset.refuse("a number or \"automatic\"");
    } else {
        density.offset = read_intensity(offset);
    }
    density.falloff =
        node["falloff"].choice(density.falloff, {{"flat", Falloff::flat}, {"distance", Falloff::distance}});
    return density;
}

ProbeSettings read_probe(const JsonNode& node)
{
    ProbeSettings probe;
    if (!node.exists()) return probe;
    node.expect_object({"voxel", "radius_voxels", "group", "brush", "region", "connectivity", "paint_threshold",
                        "haptic_threshold", "shown", "shell", "shell_opacity", "preview", "density", "paints_group"});
    if (node["voxel"].exists())
        probe.voxel = node["voxel"].vector(glm::dvec3(0.0), range(-double(LARGEST_SIDE), 2.0 * double(LARGEST_SIDE)));
    probe.radius_voxels = node["radius_voxels"].number(probe.radius_voxels, above_zero(1e-3, 127.0));
    probe.group = uint8_t(node["group"].whole(probe.group, 0, 255));
    std::map<std::string, Brush> brushes;
    for (const BrushRow& row : BRUSHES) brushes[row.key] = row.brush;
    probe.brush = node["brush"].choice(probe.brush, brushes);
    probe.region = node["region"].choice(probe.region, {{"ball", RegionShape::ball}, {"box", RegionShape::box}});
    const auto connectivity = int(node["connectivity"].whole(probe.connectivity, 6, 26));
    if (connectivity != 6 && connectivity != 26) node["connectivity"].refuse("6 or 26");
    probe.connectivity = connectivity;
    probe.paint_threshold = read_intensity(node["paint_threshold"]);
    probe.haptic_threshold = read_intensity(node["haptic_threshold"]);
    probe.shown = node["shown"].flag(probe.shown);
    probe.shell = node["shell"].flag(probe.shell);
    probe.shell_opacity = node["shell_opacity"].number(probe.shell_opacity, SHARE);
    probe.preview = node["preview"].flag(probe.preview);
    if (node["density"].exists()) probe.density = read_density(node["density"]);
    probe.paints_group = node["paints_group"].flag(probe.paints_group);
    if (!probe.paints_group && !probe.density) node["paints_group"].refuse("true, where there is no probe.density");
    return probe;
}

SurfaceLook read_surface(const JsonNode& node)
{
    node.expect_object({"from", "to", "radius", "radii", "color"});
    const NumberRange radius = above_zero(1e-12, 1e15);
    SurfaceLook surface;
    surface.from = node.required("from", "three numbers, [x, y, z]").vector(surface.from, COORDINATE);
    surface.to = node["to"].vector(surface.from, COORDINATE);
    if (node["radii"].exists()) {
        if (node["radius"].exists()) node["radius"].refuse("either radius or radii");
        const std::vector<JsonNode> radii = node["radii"].elements();
        if (radii.size() != 2) node["radii"].refuse("two numbers above 0, [from, to]");
        surface.radius_from = radii[0].number(0.0, radius);
        surface.radius_to = radii[1].number(0.0, radius);
    } else {
        surface.radius_from = surface.radius_to = node.required("radius", "a number above 0").number(0.0, radius);
    }
    surface.color = node["color"].color(surface.color);
    return surface;
}

std::vector<SurfaceLook> read_surfaces(const JsonNode& node)
{
    if (!node.exists()) return {};
    const std::vector<JsonNode> elements = node.elements();
    if (elements.size() > MOST_SESSION_SURFACES)
        node.checked([&] { fail(elements.size(), " surfaces; expected at most ", MOST_SESSION_SURFACES); });
    std::vector<SurfaceLook> surfaces;
    surfaces.reserve(elements.size());
    for (const JsonNode& element : elements) surfaces.push_back(read_surface(element));
    return surfaces;
}

void read_annotation(const JsonNode& node, const std::filesystem::path& folder, Session& session)
{
    if (!node.exists()) return;
    node.expect_object({"mask", "trace", "density"});
    session.mask_path = read_path(node["mask"], folder);
    session.trace_path = read_path(node["trace"], folder);
    if (session.trace_path.empty() && !session.mask_path.empty()) {
        session.trace_path = session.mask_path;
        session.trace_path.replace_extension(".graphml");
    }
    if (!session.trace_path.empty() && !is_trace_file(session.trace_path))
        node["trace"].refuse("a path that ends in .graphml, .txt, .swc or .rsml");
    session.density_path = read_path(node["density"], folder);
}

}  // namespace

Session read_session(const nlohmann::json& json, const std::filesystem::path& folder, const std::string& origin)
{
    const JsonNode document(json, origin);
    document.expect_object({"shvr_session", "volume", "camera", "cameras", "transfer_function", "groups", "light",
                            "blend", "render", "view", "interaction", "cut", "probe", "surfaces", "annotation"});
    document.required("shvr_session", "the version of the session, 1").whole(VERSION, VERSION, VERSION);
    Session session;
    read_volume(document.required("volume", "an object with path or procedural"), folder, session);
    session.cameras = read_cameras(document["cameras"]);
    session.camera_name = read_camera_choice(document, json, session);
    session.transfer_function = read_transfer_function(document["transfer_function"]);
    if (document["transfer_function"].exists())
        session.transfer_preset = document["transfer_function"]["preset"].text("");
    session.groups = read_groups(document["groups"]);
    session.light = read_light(document["light"]);
    session.blend = read_blend(document["blend"]);
    session.render = read_render(document["render"]);
    session.view = read_view(document["view"]);
    session.interaction = read_interaction(document["interaction"]);
    session.cut = read_cut(document["cut"]);
    session.probe = read_probe(document["probe"]);
    session.surfaces = read_surfaces(document["surfaces"]);
    read_annotation(document["annotation"], folder, session);
    return session;
}

Session parse_session(const std::string& text, const std::filesystem::path& folder, const std::string& origin,
                      const std::vector<std::string>& settings)
{
    nlohmann::json document = json_of(text, origin);
    apply_settings(document, settings);
    return read_session(document, folder, origin);
}

}  // namespace shvr
