// The keys of a session file that say what a picture looks like.

#include "engine/session/session_read.h"

#include <limits>

#include <nlohmann/json.hpp>

namespace shvr {

namespace {

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

glm::uvec2 read_picture_size(const JsonNode& node, const glm::uvec2& fallback)
{
    if (!node.exists()) return fallback;
    const std::vector<JsonNode> sides = node.elements();
    if (sides.size() != 2) node.refuse("two whole numbers, [width, height]");
    return {sides[0].whole(0, 1, 65536), sides[1].whole(0, 1, 65536)};
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

}  // namespace

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

}  // namespace shvr
