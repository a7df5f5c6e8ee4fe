// The keys of a session file, version 1, one function a section. README.md lists them.

#include <charconv>
#include <cmath>
#include <limits>

#include <nlohmann/json.hpp>

#include "engine/annotation/trace_file.h"
#include "engine/scene/session_json.h"
#include "engine/volume/header_text.h"

namespace shvr {
namespace {

constexpr int64_t VERSION = 1;

NumberRange range(double lower, double upper)
{
    return {lower, upper, ""};
}
/// Above 0, within what single precision and finite work allow.
NumberRange above_zero(double lower, double upper)
{
    return {lower, upper, sentence("a number above 0 (", lower, " ... ", upper, ")")};
}
const NumberRange SHARE = range(0.0, 1.0);
/// Far beyond any volume in any unit, and far below where squares overflow.
const NumberRange COORDINATE = range(-1e15, 1e15);

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

SideView read_side_view(const JsonNode& node)
{
    node.expect_object({"side", "zoom", "turn_degrees", "tilt_degrees"});
    SideView view;
    std::map<std::string, std::string> sides;
    for (const std::string& side : camera_sides()) sides[side] = side;
    view.side = node["side"].choice(view.side, sides);
    view.zoom = node["zoom"].number(view.zoom, above_zero(1e-3, 1e3));
    view.turn_degrees = node["turn_degrees"].number(view.turn_degrees, range(-360.0, 360.0));
    view.tilt_degrees = node["tilt_degrees"].number(view.tilt_degrees, range(-90.0, 90.0));
    return view;
}

TransferFunction read_transfer_function(const JsonNode& node)
{
    if (!node.exists()) return {};
    node.expect_object({"points", "preset"});
    if (node["preset"].exists()) {
        if (node["points"].exists()) node["preset"].refuse("either points or a preset");
        return {};
    }
    constexpr double LARGEST = std::numeric_limits<float>::max();
    std::vector<ControlPoint> points;
    for (const JsonNode& element : node.required("points", "an array").elements()) {
        element.expect_object({"intensity", "color", "opacity"});
        ControlPoint point;
        point.intensity = element.required("intensity", "a number").number(0.0, range(-LARGEST, LARGEST));
        point.color = element["color"].color(point.color);
        point.opacity = element.required("opacity", "a number from 0 to 1").number(0.0, SHARE);
        points.push_back(point);
    }
    return TransferFunction(std::move(points));
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

OcclusionSettings read_occlusion(const JsonNode& node)
{
    OcclusionSettings occlusion;
    if (!node.exists()) return occlusion;
    node.expect_object({"strength", "radius", "rays", "full_sphere", "curve", "automatic"});
    occlusion.strength = node["strength"].number(occlusion.strength, SHARE);
    occlusion.radius = node["radius"].number(occlusion.radius, above_zero(1e-3, 60.0));
    occlusion.rays = uint32_t(node["rays"].whole(occlusion.rays, 1, 1024));
    occlusion.full_sphere = node["full_sphere"].flag(occlusion.full_sphere);
    occlusion.curve = node["curve"].number(occlusion.curve, above_zero(0.1, 10.0));
    occlusion.automatic = node["automatic"].flag(occlusion.automatic);
    return occlusion;
}

Light read_light(const JsonNode& node)
{
    Light light;
    if (!node.exists()) return light;
    node.expect_object(
        {"shaded", "ambient", "diffuse", "specular", "shininess", "direction", "gradient_fade", "occlusion"});
    light.shaded = node["shaded"].flag(light.shaded);
    light.ambient = node["ambient"].number(light.ambient, range(0.0, 10.0));
    light.diffuse = node["diffuse"].number(light.diffuse, range(0.0, 10.0));
    light.specular = node["specular"].number(light.specular, range(0.0, 10.0));
    light.shininess = node["shininess"].number(light.shininess, range(0.0, 1000.0));
    light.direction = node["direction"].vector(light.direction, range(-1e6, 1e6));
    if (light.direction != glm::dvec3(0.0) && glm::length(light.direction) < 1e-6)
        node["direction"].refuse("a direction at least 1e-06 long, or 0, 0, 0 for the usual one");
    light.gradient_fade = node["gradient_fade"].number(light.gradient_fade, SHARE);
    light.occlusion = read_occlusion(node["occlusion"]);
    return light;
}

DistanceBlend read_blend(const JsonNode& node)
{
    DistanceBlend blend;
    if (!node.exists()) return blend;
    node.expect_object({"size", "rate", "color"});
    blend.size = node["size"].number(blend.size, range(0.0, 1000.0));
    blend.rate = node["rate"].number(blend.rate, range(0.0, 1000.0));
    if (node["color"].exists()) blend.color = node["color"].color(glm::dvec3(0.0));
    return blend;
}

glm::uvec2 read_picture_size(const JsonNode& node, const glm::uvec2& fallback)
{
    if (!node.exists()) return fallback;
    const std::vector<JsonNode> sides = node.elements();
    if (sides.size() != 2) node.refuse("two whole numbers, [width, height]");
    return {sides[0].whole(0, 1, 65536), sides[1].whole(0, 1, 65536)};
}

RenderSettings read_render(const JsonNode& node)
{
    RenderSettings render;
    if (!node.exists()) return render;
    node.expect_object({"size", "step_voxels", "opacity_limit", "background", "sampling", "paging", "detail",
                        "skip_empty_space", "preintegration"});
    render.size = read_picture_size(node["size"], render.size);
    render.step_voxels = node["step_voxels"].number(render.step_voxels, above_zero(1e-4, 1024.0));
    render.opacity_limit = node["opacity_limit"].number(render.opacity_limit, above_zero(1e-6, 1.0));
    render.background = node["background"].color_and_alpha(render.background);
    render.sampling = node["sampling"].choice(
        render.sampling,
        {{"automatic", Sampling::automatic}, {"exact", Sampling::exact}, {"hardware", Sampling::hardware}});
    render.paging = node["paging"].choice(
        render.paging, {{"automatic", Paging::automatic}, {"always", Paging::always}, {"never", Paging::never}});
    render.detail = node["detail"].number(render.detail, range(0.0, 16.0));
    render.skip_empty_space = node["skip_empty_space"].flag(render.skip_empty_space);
    render.preintegration = node["preintegration"].flag(render.preintegration);
    if (render.preintegration && render.step_voxels > 1.0)
        node["preintegration"].refuse(sentence("false, as render.step_voxels is ", render.step_voxels, ", above 1"));
    return render;
}

std::optional<double> read_intensity(const JsonNode& node)
{
    if (!node.exists()) return std::nullopt;
    return node.number(0.0, range(-3.4e38, 3.4e38));
}

StereoSettings read_stereo(const JsonNode& node)
{
    StereoSettings stereo;
    if (!node.exists()) return stereo;
    node.expect_object({"output", "eye_distance", "toe_in"});
    stereo.output = node["output"].choice(stereo.output, {{"side_by_side", StereoOutput::side_by_side},
                                                          {"top_bottom", StereoOutput::top_bottom},
                                                          {"anaglyph", StereoOutput::anaglyph}});
    stereo.eye_distance = node["eye_distance"].number(stereo.eye_distance, SHARE);
    stereo.toe_in = node["toe_in"].flag(stereo.toe_in);
    return stereo;
}

SliceSettings read_slices(const JsonNode& node)
{
    SliceSettings slices;
    if (!node.exists()) return slices;
    node.expect_object({"black", "white", "paint_share", "zoom"});
    slices.black = read_intensity(node["black"]);
    slices.white = read_intensity(node["white"]);
    if (slices.black && slices.white && !(*slices.black < *slices.white))
        node["black"].refuse("an intensity below view.slices.white");
    slices.paint_share = node["paint_share"].number(slices.paint_share, SHARE);
    slices.zoom = node["zoom"].number(slices.zoom, above_zero(1e-3, 1e3));
    return slices;
}

ViewSettings read_view(const JsonNode& node)
{
    ViewSettings view;
    if (!node.exists()) return view;
    node.expect_object({"arrangement", "stereo", "slices", "overview_zoom"});
    view.arrangement = node["arrangement"].choice(view.arrangement, {{"single", Arrangement::single},
                                                                     {"stereo", Arrangement::stereo},
                                                                     {"overview", Arrangement::overview},
                                                                     {"slices", Arrangement::slices}});
    view.stereo = read_stereo(node["stereo"]);
    view.slices = read_slices(node["slices"]);
    view.overview_zoom = node["overview_zoom"].number(view.overview_zoom, above_zero(1e-3, 1e3));
    return view;
}

InteractionSettings read_interaction(const JsonNode& node)
{
    InteractionSettings interaction;
    if (!node.exists()) return interaction;
    node.expect_object({"resolution", "frames_per_second", "screenshot_scale"});
    interaction.resolution = node["resolution"].number(interaction.resolution, range(0.1, 1.0));
    interaction.frames_per_second = node["frames_per_second"].number(interaction.frames_per_second, range(1.0, 1000.0));
    interaction.screenshot_scale = uint32_t(node["screenshot_scale"].whole(interaction.screenshot_scale, 1, 32));
    return interaction;
}

CutBox read_cut(const JsonNode& node)
{
    CutBox cut;
    if (!node.exists()) return cut;
    node.expect_object({"lower", "upper"});
    const NumberRange voxel = range(0.0, 1048576.0);
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
    if (node["voxel"].exists()) probe.voxel = node["voxel"].vector(glm::dvec3(0.0), range(-1048576.0, 2097152.0));
    probe.radius_voxels = node["radius_voxels"].number(probe.radius_voxels, above_zero(1e-3, 127.0));
    probe.group = uint8_t(node["group"].whole(probe.group, 0, 255));
    probe.brush = node["brush"].choice(probe.brush,
                                       {{"fill", Brush::fill}, {"flood", Brush::flood}, {"speckle", Brush::speckle}});
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

std::map<std::string, CameraSpec> read_cameras(const JsonNode& node)
{
    std::map<std::string, CameraSpec> cameras;
    if (!node.exists()) return cameras;
    for (const std::string& name : node.names()) {
        if (name.empty() || is_camera_object(name))
            node[name].refuse("a camera whose name is not empty and does not begin with {");
        cameras[name] = read_camera(node[name]);
    }
    return cameras;
}

/// A name, checked against what there is, or the text of a camera object.
std::string read_camera_choice(const JsonNode& document, const nlohmann::json& json, const Session& session)
{
    const JsonNode node = document["camera"];
    if (!node.exists()) return {};
    if (node.is_object()) {
        read_camera(node);
        return json.at("camera").dump();
    }
    std::map<std::string, std::string> names;
    for (const std::string& side : camera_sides()) names[side] = side;
    for (const auto& [name, camera] : session.cameras) names[name] = name;
    return node.choice<std::string>({}, names);
}

}  // namespace

bool is_camera_object(const std::string& name_or_json)
{
    const size_t begin = name_or_json.find_first_not_of(" \t\r\n");
    return begin != std::string::npos && name_or_json[begin] == '{';
}

CameraSpec read_camera(const JsonNode& node)
{
    if (node["side"].exists()) return read_side_view(node);
    Camera camera;
    camera.projection = node["projection"].choice(
        camera.projection,
        {{"perspective", Camera::Projection::perspective}, {"orthographic", Camera::Projection::orthographic}});
    const bool is_perspective = camera.projection == Camera::Projection::perspective;
    if (is_perspective) {
        node.expect_object(
            {"side", "projection", "eye", "target", "up", "fov_y_degrees", "near", "far", "shift_right"});
        camera.fov_y_degrees = node["fov_y_degrees"].number(
            camera.fov_y_degrees, {1e-12, std::nextafter(180.0, 0.0), "a number of degrees above 0 and below 180"});
    } else {
        node.expect_object({"projection", "eye", "target", "up", "height", "near", "far", "shift_right"});
        camera.height = node.required("height", "a number above 0").number(0.0, above_zero(1e-12, 1e15));
    }
    camera.eye = node.required("eye", "three numbers, [x, y, z]").vector(camera.eye, COORDINATE);
    camera.target = node.required("target", "three numbers, [x, y, z]").vector(camera.target, COORDINATE);
    camera.up = node["up"].vector(camera.up, COORDINATE);
    camera.near_distance = node["near"].number(camera.near_distance, range(0.0, 1e15));
    camera.far_distance = node["far"].number(camera.far_distance, range(0.0, 1e15));
    camera.shift_right = node["shift_right"].number(camera.shift_right, range(-1e3, 1e3));
    return node.checked([&] {
        check_camera(camera);
        return camera;
    });
}

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
