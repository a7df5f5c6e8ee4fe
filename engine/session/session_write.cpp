#include <nlohmann/json.hpp>

#include "engine/look/session_color.h"
#include "engine/session/session_json.h"

namespace shvr {
namespace {

// Keeps the order in which keys are added, which is the order of README.md.
using OrderedJson = nlohmann::ordered_json;

OrderedJson array_of(const glm::dvec3& v)
{
    return {v.x, v.y, v.z};
}

std::string color_text(const glm::dvec3& linear)
{
    return text_of_color({linear, 1.0});
}

std::string path_text(const std::filesystem::path& path, const std::filesystem::path& folder)
{
    const std::filesystem::path whole = std::filesystem::absolute(folder / ".").lexically_normal();
    const std::filesystem::path relative = path.lexically_relative(whole);
    // What belongs to a project lies beside or around its folder shvr, and moves with it.
    const bool is_project = whole.parent_path().filename() == "shvr";
    auto step = relative.begin();
    if (is_project && step != relative.end() && *step == "..") ++step;
    const bool is_inside = !relative.empty() && (step == relative.end() || *step != "..");
    return (is_inside ? relative : path).generic_string();
}

std::string raw_text(const RawLayout& layout)
{
    const char* const order = !layout.big_endian ? "" : *layout.big_endian ? ":big" : ":little";
    return sentence(layout.size.x, "x", layout.size.y, "x", layout.size.z, ":", name_of(layout.type), order, ":",
                    layout.offset_bytes);
}

OrderedJson write_volume(const Session& session, const std::filesystem::path& folder)
{
    if (const auto& spec = session.procedural) {
        return {{"procedural", spec->kind},
                {"size", {spec->size.x, spec->size.y, spec->size.z}},
                {"seed", spec->seed},
                {"type", name_of(spec->type)},
                {"spacing", array_of(spec->spacing)},
                {"unit", spec->unit}};
    }
    OrderedJson volume = {{"path", path_text(session.volume_path, folder)}};
    if (const auto& layout = session.raw_layout) {
        volume["raw"] = raw_text(*layout);
        volume["spacing"] = array_of(layout->spacing);
        volume["unit"] = layout->unit;
    }
    if (!session.open_options.channel.empty()) volume["channel"] = session.open_options.channel;
    if (!session.open_options.frame.empty()) volume["frame"] = session.open_options.frame;
    return volume;
}

OrderedJson write_camera(const CameraSpec& spec)
{
    if (const auto* view = std::get_if<SideView>(&spec)) {
        return {{"side", view->side},
                {"zoom", view->zoom},
                {"turn_degrees", view->turn_degrees},
                {"tilt_degrees", view->tilt_degrees}};
    }
    const Camera& camera = std::get<Camera>(spec);
    const bool is_perspective = camera.projection == Camera::Projection::perspective;
    OrderedJson written = {{"projection", is_perspective ? "perspective" : "orthographic"},
                           {"eye", array_of(camera.eye)},
                           {"target", array_of(camera.target)},
                           {"up", array_of(camera.up)}};
    if (is_perspective)
        written["fov_y_degrees"] = camera.fov_y_degrees;
    else
        written["height"] = camera.height;
    written["near"] = camera.near_distance;
    written["far"] = camera.far_distance;
    if (camera.shift_right != 0.0) written["shift_right"] = camera.shift_right;
    return written;
}

OrderedJson write_cameras(const Session& session)
{
    OrderedJson cameras = OrderedJson::object();
    for (const auto& [name, camera] : session.cameras) cameras[name] = write_camera(camera);
    return cameras;
}

OrderedJson write_points(const TransferFunction& function)
{
    OrderedJson points = OrderedJson::array();
    for (const ControlPoint& point : function.points())
        points.push_back(
            {{"intensity", point.intensity}, {"color", color_text(point.color)}, {"opacity", point.opacity}});
    return points;
}

OrderedJson write_groups(const Session& session)
{
    OrderedJson groups = OrderedJson::object();
    for (const auto& [number, group] : session.groups) {
        OrderedJson& entry = groups[std::to_string(number)];
        entry["visible"] = group.visible;
        if (!group.name.empty()) entry["name"] = group.name;
        if (group.parent != 0) entry["parent"] = group.parent;
        if (group.color) entry["color"] = color_text(*group.color);
        if (group.opacity) entry["opacity"] = *group.opacity;
    }
    return groups;
}

OrderedJson write_light(const Light& light)
{
    return {{"shaded", light.shaded},
            {"ambient", light.ambient},
            {"diffuse", light.diffuse},
            {"specular", light.specular},
            {"shininess", light.shininess},
            {"direction", array_of(light.direction)},
            {"gradient_fade", light.gradient_fade},
            {"occlusion",
             {{"strength", light.occlusion.strength},
              {"radius", light.occlusion.radius},
              {"rays", light.occlusion.rays},
              {"full_sphere", light.occlusion.full_sphere},
              {"curve", light.occlusion.curve},
              {"automatic", light.occlusion.automatic}}}};
}

OrderedJson write_blend(const DistanceBlend& blend)
{
    OrderedJson node{{"size", blend.size}, {"rate", blend.rate}};
    if (blend.color) node["color"] = color_text(*blend.color);
    return node;
}

const char* name_of(Paging paging)
{
    switch (paging) {
        case Paging::automatic: return "automatic";
        case Paging::always: return "always";
        case Paging::never: return "never";
    }
    SHVR_CHECK(false, "paging ", int(paging));
    return "";
}

const char* name_of(Sampling sampling)
{
    switch (sampling) {
        case Sampling::automatic: return "automatic";
        case Sampling::exact: return "exact";
        case Sampling::hardware: return "hardware";
    }
    return "automatic";
}

OrderedJson write_render(const RenderSettings& render)
{
    return {{"size", {render.size.x, render.size.y}},
            {"step_voxels", render.step_voxels},
            {"opacity_limit", render.opacity_limit},
            {"background", text_of_color(render.background)},
            {"sampling", name_of(render.sampling)},
            {"paging", name_of(render.paging)},
            {"detail", render.detail},
            {"skip_empty_space", render.skip_empty_space},
            {"preintegration", render.preintegration}};
}

const char* name_of(Arrangement arrangement)
{
    switch (arrangement) {
        case Arrangement::single: return "single";
        case Arrangement::stereo: return "stereo";
        case Arrangement::overview: return "overview";
        case Arrangement::slices: return "slices";
    }
    return "single";
}

const char* name_of(StereoOutput output)
{
    switch (output) {
        case StereoOutput::side_by_side: return "side_by_side";
        case StereoOutput::top_bottom: return "top_bottom";
        case StereoOutput::anaglyph: return "anaglyph";
    }
    return "side_by_side";
}

OrderedJson write_view(const ViewSettings& view)
{
    OrderedJson slices{{"paint_share", view.slices.paint_share}, {"zoom", view.slices.zoom}};
    if (view.slices.black) slices["black"] = *view.slices.black;
    if (view.slices.white) slices["white"] = *view.slices.white;
    return {{"arrangement", name_of(view.arrangement)},
            {"stereo",
             {{"output", name_of(view.stereo.output)},
              {"eye_distance", view.stereo.eye_distance},
              {"toe_in", view.stereo.toe_in}}},
            {"slices", slices},
            {"overview_zoom", view.overview_zoom}};
}

OrderedJson write_probe(const ProbeSettings& probe)
{
    OrderedJson document = {{"radius_voxels", probe.radius_voxels},
                            {"group", probe.group},
                            {"brush", row_of(probe.brush).key},
                            {"region", probe.region == RegionShape::ball ? "ball" : "box"},
                            {"connectivity", probe.connectivity}};
    if (probe.voxel) document["voxel"] = array_of(*probe.voxel);
    if (probe.paint_threshold) document["paint_threshold"] = *probe.paint_threshold;
    if (probe.haptic_threshold) document["haptic_threshold"] = *probe.haptic_threshold;
    document["shown"] = probe.shown;
    document["shell"] = probe.shell;
    document["shell_opacity"] = probe.shell_opacity;
    document["preview"] = probe.preview;
    if (probe.density)
        document["density"] = {
            {"offset", probe.density->offset ? OrderedJson(*probe.density->offset) : OrderedJson("automatic")},
            {"falloff", probe.density->falloff == Falloff::flat ? "flat" : "distance"}};
    document["paints_group"] = probe.paints_group;
    return document;
}

OrderedJson write_surfaces(const std::vector<SurfaceLook>& surfaces)
{
    OrderedJson array = OrderedJson::array();
    for (const SurfaceLook& surface : surfaces) {
        OrderedJson entry{{"from", array_of(surface.from)}};
        if (surface.to != surface.from) entry["to"] = array_of(surface.to);
        if (surface.radius_to == surface.radius_from)
            entry["radius"] = surface.radius_from;
        else
            entry["radii"] = {surface.radius_from, surface.radius_to};
        entry["color"] = color_text(surface.color);
        array.push_back(std::move(entry));
    }
    return array;
}

bool is_row(const OrderedJson& value)
{
    return std::ranges::none_of(value, [](const OrderedJson& member) { return member.is_structured(); });
}

/// Indented by two spaces, with arrays of plain values and the control points on one line each.
std::string laid_out(const OrderedJson& value, const std::string& indent, bool may_be_row)
{
    if (!value.is_structured() || value.empty() || (is_row(value) && (value.is_array() || may_be_row)))
        return value.dump();
    const std::string inner = indent + "  ";
    std::string text;
    for (const auto& item : value.items()) {
        text += (text.empty() ? "\n" : ",\n") + inner;
        if (value.is_object()) text += OrderedJson(item.key()).dump() + ": ";
        text += laid_out(item.value(), inner, value.is_array());
    }
    text += "\n" + indent;
    return value.is_array() ? "[" + text + "]" : "{" + text + "}";
}

}  // namespace

std::string to_text(const Session& session, const std::filesystem::path& folder)
{
    OrderedJson document = {{"shvr_session", 1}, {"volume", write_volume(session, folder)}};
    if (!session.camera_name.empty()) {
        const std::string& name = session.camera_name;
        document["camera"] = is_camera_object(name) ? OrderedJson::parse(name) : OrderedJson(name);
    }
    document["cameras"] = write_cameras(session);
    if (session.transfer_preset.empty())
        document["transfer_function"] = {{"points", write_points(session.transfer_function)}};
    else
        document["transfer_function"] = {{"preset", session.transfer_preset}};
    document["groups"] = write_groups(session);
    document["light"] = write_light(session.light);
    document["blend"] = write_blend(session.blend);
    document["render"] = write_render(session.render);
    document["view"] = write_view(session.view);
    document["interaction"] = {{"resolution", session.interaction.resolution},
                               {"frames_per_second", session.interaction.frames_per_second},
                               {"screenshot_scale", session.interaction.screenshot_scale}};
    document["cut"] = {{"lower", array_of(session.cut.lower)}, {"upper", array_of(session.cut.upper)}};
    document["probe"] = write_probe(session.probe);
    if (!session.surfaces.empty()) document["surfaces"] = write_surfaces(session.surfaces);
    if (!session.mask_path.empty()) document["annotation"]["mask"] = path_text(session.mask_path, folder);
    if (!session.trace_path.empty()) document["annotation"]["trace"] = path_text(session.trace_path, folder);
    if (!session.density_path.empty()) document["annotation"]["density"] = path_text(session.density_path, folder);
    try {
        return laid_out(document, "", false) + "\n";
    } catch (const OrderedJson::type_error&) {
        fail("session of ", session.volume_path.string(), ": a name or path is not UTF-8, which JSON cannot hold; ",
             "expected UTF-8");
    }
}

}  // namespace shvr
