// The keys of a session file for the look of a picture.

#include <algorithm>
#include <limits>

#include "engine/session/quality.h"
#include "engine/session/session_keys.h"

namespace shvr {
namespace {

constexpr const char* INTENSITIES = "the file's intensities";

}  // namespace

void fields(Fields& f, ControlPoint& point)
{
    constexpr double LARGEST = std::numeric_limits<float>::max();
    f.number("intensity", point.intensity, {-LARGEST, LARGEST},
             {.meaning = "where the point lies", .allowed = INTENSITIES, .is_required = true});
    f.color("color", point.color, {"colour"});
    f.number("opacity", point.opacity, SHARE,
             {.meaning = "opacity", .unit = "per reference length", .is_required = true});
}

void fields(Fields& f, OcclusionPoint& point)
{
    f.number("arrives", point.arrives, SHARE, {.meaning = "share of the light that arrives", .is_required = true});
    f.number("seen", point.seen, SHARE, {.meaning = "share that is seen of it", .is_required = true});
}

void fields(Fields& f, OcclusionSettings& occlusion)
{
    f.number("strength", occlusion.strength, SHARE,
             {"local ambient occlusion: how far the ambient light goes where less of it arrives; 0: off"});
    f.number("radius", occlusion.radius, above_zero(1e-3, MAX_OCCLUSION_RADIUS),
             {"how far away things keep ambient light off", "reference lengths"});
    f.whole("rays", occlusion.rays, 1, 1024, {"directions that light is looked for in, for each voxel"});
    f.flag("full_sphere", occlusion.full_sphere,
           {"look behind surfaces, too; otherwise only before them, where there is one"});
    f.number("curve", occlusion.curve, above_zero(0.1, 10.0),
             {"the share of light that arrives is raised to this power: above 1 darker"});
    static_assert(MAX_OCCLUSION_POINTS == 16);
    const About mapping{.meaning =
                            "instead of `curve`: points of the light that is seen over the light that arrives, by "
                            "the latter; linear in between, level before the first and after the last",
                        .allowed = "array of at most 16",
                        .standard = "none"};
    if (f.has("mapping", !occlusion.mapping.empty())) {
        f.list("mapping", occlusion.mapping, MAX_OCCLUSION_POINTS, mapping);
        f.check("mapping", std::ranges::is_sorted(occlusion.mapping, {}, &OcclusionPoint::arrives),
                "points in the order of `arrives`");
    } else {
        f.mention("mapping", mapping);
    }
    f.flag("automatic", occlusion.automatic, {"the window renews it at once; false: when it is asked to (F8)"});
}

void fields(Fields& f, Light& light)
{
    f.flag("shaded", light.shaded,
           {"false: the volume's colours as they are, no gradient is taken; surfaces and probe are always shaded"});
    f.number("ambient", light.ambient, {0.0, 10.0}, {"share of the colour that is always seen"});
    f.number("diffuse", light.diffuse, {0.0, 10.0}, {"share that depends on the surface's direction"});
    f.number("specular", light.specular, {0.0, 10.0}, {"strength of the highlight"});
    f.number("shininess", light.shininess, {0.0, 1000.0}, {"exponent of the highlight"});
    f.vector("direction", light.direction, {-1e6, 1e6},
             {.meaning = "towards the light, along the camera's right, up and back; 0, 0, 0 means 0.3, 0.5, 1",
              .allowed = "any length from 1e-6"});
    f.check("direction", light.direction == glm::dvec3(0.0) || glm::length(light.direction) >= 1e-6,
            "a direction of length 1e-06 or more, or 0, 0, 0 for the default");
    f.number("gradient_fade", light.gradient_fade, SHARE,
             {"gradients well below this are no surface", "share of the intensity range per voxel"});
    f.section("occlusion", light.occlusion);
}

void fields(Fields& f, DistanceBlend& blend)
{
    f.number("size", blend.size, {0.0, 1000.0},
             {"distance blending: how much of another colour there is at the far end of what is drawn; 0: none"});
    f.number("rate", blend.rate, {0.0, 1000.0}, {"how it gets there: depth^rate; 0: the same everywhere"});
    f.color("color", blend.color, {.meaning = "that colour", .standard = "the background's"});
}

void fields(Fields& f, Unpainted& unpainted)
{
    f.flag("visible", unpainted.visible, {"false: voxels that no group holds are not drawn"});
    f.number("opacity", unpainted.opacity, SHARE,
             {"of voxels that no group holds: the transfer function's opacities are multiplied by it"});
}

namespace {

/// Sets the keys that a preset covers; explicit keys in the same file are read afterwards and override it.
void quality_fields(Fields& f, RenderSettings& render)
{
    const About about{.meaning =
                          "sets `step_voxels`, `opacity_limit`, `sampling`, `detail`, `skip_empty_space`, "
                          "`preintegration` and `adaptive_tolerance` at once, where they are not given (quality.h)",
                      .allowed = "`\"draft\"`, `\"interactive\"`, `\"good\"`, `\"reference\"`",
                      .standard = "none"};
    if (!f.has("quality", false)) return f.mention("quality", about);
    std::vector<std::string_view> names;
    for (const Quality& each : qualities()) names.push_back(each.name);
    std::string name;
    f.choice("quality", name, names, about);
    for (const Quality& each : qualities())
        if (name == each.name) take(render, each);
}

// Keys for how a picture is computed are in two places of a file, before the background and after it.

void sample_fields(Fields& f, RenderSettings& render)
{
    std::vector<int64_t> size{render.size.x, render.size.y};
    f.wholes("size", size, 1, 65536, {"width and height of the picture", "pixels"});
    render.size = {size[0], size[1]};
    quality_fields(f, render);
    f.number("step_voxels", render.step_voxels, above_zero(1e-4, 1024.0),
             {"distance between samples", "reference lengths"});
    f.number("opacity_limit", render.opacity_limit, above_zero(1e-6, 1.0),
             {"a ray stops once its opacity reaches this"});
}

void way_fields(Fields& f, RenderSettings& render)
{
    f.choice("sampling", render.sampling,
             {"how voxels are interpolated: in the kernel (exact), by the texture unit (hardware), or whichever the "
              "device does well"});
    f.choice("paging", render.paging,
             {"whether bricks are paged on the device; never: a volume that does not fit is refused; automatic: where "
              "the file has levels or does not fit"});
    f.number("detail", render.detail, {0.0, 16.0},
             {"how fine paged bricks of several levels are; 0: all voxels, as a resident volume always shows. "
              "Pictures of different levels differ, and each is complete",
              "voxels per pixel at least"});
    f.flag("skip_empty_space", render.skip_empty_space,
           {"leap over bricks and cells in which nothing is visible; the picture is the same"});
    f.flag(
        "preintegration", render.preintegration,
        {"look at both ends of a step and at all densities between them, for transfer functions with narrow peaks or "
         "steep edges; steps of at most 1"});
    f.number(
        "adaptive_tolerance", render.adaptive_tolerance, SHARE,
        {"above 0: rays go through every second pixel of every second row, and through all pixels only where colours "
         "around differ by more; pixels in between are interpolated, and what is thinner than two pixels may be "
         "missed. "
         "Not in slices, and not where bricks have to take turns on the device",
         "square roots of linear light"});
    f.check("preintegration", !render.preintegration || render.step_voxels <= 1.0,
            sentence("false, because render.step_voxels is ", render.step_voxels, ", above 1"));
}

void background_field(Fields& f, RenderSettings& render)
{
    std::optional<glm::dvec4> background = render.background;
    f.color("background", background, true, {"colour behind the volume, with straight alpha"});
    render.background = background.value_or(render.background);
}

void border_and_color_fields(Fields& f, RenderSettings& render)
{
    f.flag(
        "smooth_borders", render.smooth_borders,
        {"painted groups end between voxels, where their labels, interpolated, weigh less than their neighbours'; at "
         "the middle of a voxel its own label holds, and no third one appears between two. Slices show voxels. "
         "A picture takes about half as long again where much is painted"});
    f.number(
        "saturation", render.saturation, SHARE,
        {"of the picture's colours, background included; 0: greys of the same luminance, for print, or for anaglyphs "
         "of things that one eye alone would see; lines over the picture keep theirs"});
}

}  // namespace

void rendering_fields(Fields& f, RenderSettings& render)
{
    sample_fields(f, render);
    way_fields(f, render);
}

void picture_fields(Fields& f, RenderSettings& render)
{
    background_field(f, render);
    border_and_color_fields(f, render);
}

void fields(Fields& f, RenderSettings& render)
{
    sample_fields(f, render);
    background_field(f, render);
    way_fields(f, render);
    border_and_color_fields(f, render);
}

void fields(Fields& f, StereoSettings& stereo)
{
    f.choice("output", stereo.output, {"where the eyes' pictures go; an anaglyph is for red and cyan glasses"});
    f.number("eye_distance", stereo.eye_distance, SHARE,
             {"between the eyes; both see the same at the target's distance", "distances from eye to target"});
    f.flag("toe_in", stereo.toe_in,
           {"the eyes turn towards the target, which leaves points higher for one eye than for the other; false: "
            "off-axis"});
}

void fields(Fields& f, SliceSettings& slices)
{
    f.number("paint_share", slices.paint_share, SHARE, {"how much of a painted voxel's colour is its group's"});
    f.number("zoom", slices.zoom, above_zero(1e-3, 1e3), {"of the slices; 1: the whole volume fits"});
    f.vector("center", slices.center, {-double(MAX_SIDE), 2.0 * double(MAX_SIDE)},
             {.meaning = "what the slices have in their middle",
              .unit = "voxels",
              .standard = "the volume's, or of slices that are enlarged the probe"});
    const char* const standard = "the end of the volume's range";
    f.number(
        "black", slices.black, INTENSITY,
        {.meaning = "intensity that slices draw black; below `white`", .allowed = INTENSITIES, .standard = standard});
    f.number("white", slices.white, INTENSITY,
             {.meaning = "intensity that slices draw white", .allowed = INTENSITIES, .standard = standard});
    f.check("black", !slices.black || !slices.white || *slices.black < *slices.white,
            "an intensity below view.slices.white");
}

void fields(Fields& f, ViewSettings& view)
{
    f.choice("arrangement", view.arrangement,
             {"the panes of a picture: a pane for each eye (stereo), the camera and three maps with its frustum "
              "(overview), or the camera and the planes through the probe across z, y and x (slices)"});
    f.section("stereo", view.stereo);
    f.section("slices", view.slices);
    f.number("overview_zoom", view.overview_zoom, above_zero(1e-3, 1e3), {"of the three maps"});
    f.flag("volume", view.volume, {"false: no voxels are drawn, except in slices"});
    f.flag("meshes", view.meshes, {"false: no nodes, internodes and surfaces are drawn, and no ball of the probe"});
    f.flag("cut_box", view.cut_box, {"lines along the edges of the box that the cutting planes leave"});
    std::optional<int64_t> solo = view.solo;
    f.any_whole("solo", solo, 0, 255,
                {.meaning = "the one group that is drawn, with those below it; 0: only what no group holds",
                 .standard = "none: all that are visible"});
    view.solo = solo ? std::optional(uint8_t(*solo)) : std::nullopt;
}

void fields(Fields& f, InteractionSettings& interaction)
{
    f.number("resolution", interaction.resolution, {0.1, 1.0},
             {"while something moves the window draws at most so many pixels for one of the screen, along each axis, "
              "and fewer where that takes too long"});
    f.number("frames_per_second", interaction.frames_per_second, {1.0, 1000.0}, {"at most"});
    f.whole("screenshot_scale", interaction.screenshot_scale, 1, 32,
            {"of large screenshots: pixels for one of the window, along each axis"});
    f.flag("screenshot_marks", interaction.screenshot_marks,
           {"the window's screenshots have the scale bar, axes, names of groups and distances that the window draws"});
    f.choice("pivot", interaction.pivot, {"what turning the view goes about"});
    f.flag("scale_bar", interaction.scale_bar, {"the window draws a length over each pane"});
    f.flag("axes", interaction.axes, {"the window draws the directions of x, y and z over each pane"});
    f.flag("probe_label", interaction.probe_label,
           {"the window writes beside the probe how deep it is, and how much of it is at or above the threshold"});
    f.flag(
        "group_legend", interaction.group_legend,
        {"the window writes names and colours of the groups that are painted or traced, and drawn, over the picture"});
    f.number("workspace_scale", interaction.workspace_scale, above_zero(MIN_WORKSPACE_SCALE, MAX_WORKSPACE_SCALE),
             {"how far the probe goes for a move of a haptic device; 1: its whole reach is the height of the view"});
}

void fields(Fields& f, CutBox& cut)
{
    const NumberRange voxel{0.0, double(MAX_SIDE)};
    f.vector("lower", cut.lower, voxel, {"lower corner of the part of the volume that is drawn", "voxels"});
    f.vector("upper", cut.upper, voxel, {"its upper corner", "voxels"});
    f.check("", !glm::any(glm::greaterThan(cut.lower, cut.upper)), "a lower corner that is not above the upper one");
}

}  // namespace shvr
