#include "engine/session/words/setting_labels.h"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "engine/base/error.h"
#include "engine/session/session_keys.h"
#include "engine/session/words/number_words.h"

namespace shvr {

namespace {

using nlohmann::json;

constexpr const char *VOXELS = "voxels", *LENGTHS = "reference lengths";

constexpr SettingLabel LABELS[] = {
    {"transfer_function.points", "points of the transfer function"},
    {"transfer_function.points.N.intensity", "intensity of a transfer function's point"},
    {"transfer_function.points.N.color", "colour of a transfer function's point"},
    {"transfer_function.points.N.opacity", "opacity of a transfer function's point"},
    {"transfer_function.preset", "preset of the transfer function"},
    {"groups.N.visible", "visibility of a group"},
    {"groups.N.locked", "lock of a group"},
    {"groups.N.name", "name of a group"},
    {"groups.N.parent", "parent of a group"},
    {"groups.N.color", "colour of a group"},
    {"groups.N.opacity", "opacity of a group"},
    {"unpainted.visible", "unpainted voxels"},
    {"unpainted.opacity", "opacity of unpainted voxels", {}, "Volume"},
    {"light.shaded", "shading"},
    {"light.ambient", "ambient light"},
    {"light.diffuse", "diffuse light"},
    {"light.specular", "highlight"},
    {"light.shininess", "shininess"},
    {"light.direction", "direction of the light", {}, "Light from"},
    {"light.gradient_fade", "gradient at which shading fades"},
    {"light.occlusion.strength", "strength of ambient occlusion"},
    {"light.occlusion.radius", "radius of ambient occlusion", LENGTHS},
    {"light.occlusion.rays", "rays of ambient occlusion"},
    {"light.occlusion.full_sphere", "ambient occlusion from behind surfaces"},
    {"light.occlusion.curve", "exponent of ambient occlusion"},
    {"light.occlusion.mapping", "curve of ambient occlusion"},
    {"light.occlusion.mapping.N.arrives", "arriving light at a point of the occlusion curve"},
    {"light.occlusion.mapping.N.seen", "shown light at a point of the occlusion curve"},
    {"light.occlusion.automatic", "automatic update of ambient occlusion"},
    {"blend.size", "size of distance blending"},
    {"blend.rate", "rate of distance blending"},
    {"blend.color", "colour of distance blending"},
    {"render.size", "size of the picture", "pixels"},
    {"render.quality", "render quality"},
    {"render.step_voxels", "step between samples", LENGTHS},
    {"render.opacity_limit", "opacity at which rays end", {}, "Opaque from"},
    {"render.background", "background"},
    {"render.sampling", "sampling", {}, "as suits the device, exact, by the texture unit"},
    {"render.paging", "paging", {}, "if needed, always, never"},
    {"render.detail", "detail of large volumes", "voxels per pixel"},
    {"render.skip_empty_space", "skipping of empty space"},
    {"render.preintegration", "pre-integration of narrow peaks"},
    {"render.exact_integral", "exact integral"},
    {"render.gradient", "gradient of shading", {}, "over one voxel, inside a voxel"},
    {"render.smooth_borders", "smooth borders of groups"},
    {"render.saturation", "saturation of the picture"},
    {"view.arrangement", "arrangement of the panes", {}, "Window: single view, two eyes, overview, slices"},
    {"view.stereo.output", "output of stereo", {}, "Shown: side by side, one above the other, red and cyan glasses"},
    {"view.stereo.eye_distance", "distance between the eyes", {}, "Eyes apart"},
    {"view.stereo.toe_in", "toe-in of the eyes"},
    {"view.slices.paint_share", "strength of paint in slices"},
    {"view.slices.zoom", "zoom of the slices", {}, "Enlarged"},
    {"view.slices.center", "centre of the slices", VOXELS},
    {"view.slices.cross", "point that the slices go through", VOXELS},
    {"view.slices.black", "black level of the slices"},
    {"view.slices.white", "white level of the slices"},
    {"view.overview_zoom", "scale of the maps", {}, "Map scale"},
    {"view.volume", "volume"},
    {"view.meshes", "nodes, internodes and probe"},
    {"view.cut_box", "edges of the cutting planes", {}, "Clip box with handles"},
    {"view.plane_handles", "handles of the oblique cutting plane"},
    {"view.solo", "only visible group"},
    {"interaction.resolution", "resolution in motion", {}, "In motion"},
    {"interaction.frames_per_second", "frame rate", "frames per second", "Frames"},
    {"interaction.screenshot_scale", "scale of large screenshots"},
    {"interaction.screenshot_marks", "scale bar, axes and groups in screenshots"},
    {"interaction.pivot", "pivot of turning"},
    {"interaction.scale_bar", "scale bar"},
    {"interaction.axes", "axes"},
    {"interaction.probe_label", "depth and filling at the probe"},
    {"interaction.group_legend", "names of the groups"},
    {"interaction.workspace_scale", "workspace scale"},
    {"cut.lower", "near cutting planes", VOXELS},
    {"cut.upper", "far cutting planes", VOXELS},
    {"cut.plane_normal", "direction of the oblique cutting plane"},
    {"cut.plane_point", "point on the oblique cutting plane", VOXELS, "Offset"},
    {"measurements", "measurements"},
    {"measurements.N.name", "name of a measurement"},
    {"measurements.N.kind", "kind of a measurement"},
    {"measurements.N.points", "points of a measurement", VOXELS},
    {"measurements.N.from", "first end of a distance", VOXELS},
    {"measurements.N.to", "second end of a distance", VOXELS},
    {"meshes", "meshes"},
    {"meshes.N.file", "file of a mesh"},
    {"meshes.N.color", "colour of a mesh"},
    {"meshes.N.shown", "whether a mesh is shown"},
    {"probe.radius_voxels", "radius of brush and probe", VOXELS},
    {"probe.group", "active group"},
    {"probe.brush", "brush"},
    {"probe.region", "shape of the brush"},
    {"probe.connectivity", "neighbours of a voxel", {}, "Neighbours: faces, all around"},
    {"probe.only_unpainted", "protection of painted voxels", {}, "Paints only unpainted voxels"},
    {"probe.voxel", "position of the probe", VOXELS},
    {"probe.paint_threshold", "paint threshold"},
    {"probe.haptic_threshold", "haptic threshold"},
    {"probe.shown", "probe in rendered pictures"},
    {"probe.shell", "iso-surface around the probe"},
    {"probe.shell_opacity", "opacity of the iso-surface"},
    {"probe.preview", "preview of the brush", {}, "Preview: show changes"},
    {"probe.tool", "tool of the mouse"},
    {"probe.measure", "kind of measurement"},
    {"probe.guided", "guidance of the probe"},
    {"probe.guidance", "law of guidance", {}, "Pull: smooth, mean, points"},
    {"probe.touch.mode", "mode of touch", {}, "Touches: near, surface, object"},
    {"probe.touch.strength", "strength of touch"},
    {"probe.touch.surface_share", "share of the probe's ball that holds it on a surface", {}, "Holds from"},
    {"probe.touch.stiffness", "stiffness of touch", "N/m"},
    {"probe.touch.damping", "damping of touch", "N s/m"},
    {"probe.touch.groups", "groups that are felt", {}, "Feels"},
    {"probe.touch.at_proxy", "tools at the middle of the touched part", {}, "Act at the middle"},
    {"probe.touch.overlap_radius", "radius of new nodes from what is felt", {}, "Width from touch"},
    {"probe.touch.to_nodes", "attraction of tools to nodes"},
    {"probe.touch.to_lines", "attraction of tools to centre lines"},
    {"probe.touch.clicks", "clicks where contact begins", {}, "Click at contact"},
    {"probe.touch.plane", "plane that holds the probe", {}, "Plane: free"},
    {"probe.touch.feels_hidden", "touch of hidden parts", {}, "Feel hidden parts"},
    {"probe.node_radius", "radius of new nodes", VOXELS},
    {"probe.measured_radius", "radius of new nodes from the structure", {}, "New nodes: measured"},
    {"probe.centered_nodes", "centring of clicked nodes", {}, "centred when clicked"},
    {"probe.color", "colour of the probe"},
    {"probe.opacity", "opacity of the probe"},
    {"probe.silhouette", "silhouette of the probe"},
    {"probe.arrow", "arrow towards the probe"},
    {"probe.density", "density painting", {}, "raises intensities"},
    {"probe.density.offset", "offset of density painting", {}, "Raise by"},
    {"probe.density.falloff", "falloff of density painting", {}, "Falls off: not at all, to the edge"},
    {"probe.paints_group", "painting of groups", {}, "and paints the group"},
};

/// Values that their spelling does not explain.
struct ValueWords {
    std::string_view key, value;
    const char* words;
};
constexpr ValueWords VALUES[] = {
    {"interaction.pivot", "target", "the centre of the view"},
    {"interaction.pivot", "probe", "the probe"},
    {"interaction.pivot", "picked", "the picked point"},
};

std::string in_words(const json& value)
{
    if (value.is_number()) return number_in_words(value.get<double>());
    if (value.is_boolean()) return value.get<bool>() ? "on" : "off";
    if (value.is_string()) {
        std::string text = value.get<std::string>();
        std::ranges::replace(text, '_', ' ');
        return text;
    }
    if (!value.is_array()) return {};
    if (value.empty()) return "none";
    if (value.front().is_object()) return sentence(value.size(), value.size() == 1 ? " point" : " points");
    std::string text;
    for (const json& one : value) text += (text.empty() ? "" : ", ") + in_words(one);
    return text;
}

}  // namespace

std::span<const SettingLabel> setting_labels()
{
    return LABELS;
}

const SettingLabel* label_of_setting(std::string_view key)
{
    const auto found = std::ranges::find_if(
        LABELS, [&](const SettingLabel& each) { return SessionKey{.name = std::string(each.key)}.covers(key); });
    return found == std::end(LABELS) ? nullptr : &*found;
}

std::string value_in_words(std::string_view key, const std::string& text)
{
    const json value = text.empty() ? json() : json::parse(text);
    if (value.is_null()) return {};
    for (const ValueWords& each : VALUES)
        if (each.key == key && value.is_string() && value.get_ref<const std::string&>() == each.value)
            return each.words;
    const SettingLabel* const label = label_of_setting(key);
    const bool has_unit = label && !label->unit.empty() && (value.is_number() || value.is_array());
    return in_words(value) + (has_unit ? sentence(' ', label->unit) : "");
}

}  // namespace shvr
