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
             {.meaning = "intensity of the control point", .allowed = INTENSITIES, .is_required = true});
    f.color("color", point.color, {"colour"});
    f.number("opacity", point.opacity, SHARE,
             {.meaning = "opacity", .unit = "per reference length", .is_required = true});
}

void fields(Fields& f, OcclusionPoint& point)
{
    f.number("arrives", point.arrives, SHARE, {.meaning = "share of ambient light that arrives", .is_required = true});
    f.number("seen", point.seen, SHARE, {.meaning = "share shown instead of it", .is_required = true});
}

void fields(Fields& f, OcclusionSettings& occlusion)
{
    f.number("strength", occlusion.strength, SHARE,
             {"strength of local ambient occlusion, the factor of the darkening of ambient light; 0: off"});
    f.number("radius", occlusion.radius, above_zero(1e-3, MAX_OCCLUSION_RADIUS),
             {"maximum distance at which voxels block ambient light", "reference lengths"});
    f.whole("rays", occlusion.rays, 1, 1024, {"number of directions sampled per voxel"});
    f.flag("full_sphere", occlusion.full_sphere,
           {"true: samples directions behind a surface, too; false: only in front of it, where there is one"});
    f.number("curve", occlusion.curve, above_zero(0.1, 10.0),
             {"exponent applied to the share of light that arrives; above 1 darkens"});
    static_assert(MAX_OCCLUSION_POINTS == 16);
    const About mapping{.meaning =
                            "instead of `curve`: control points that map the light that arrives to the light shown, "
                            "sorted by the former; linear between them, constant outside",
                        .allowed = "array of at most 16",
                        .standard = "none"};
    if (f.has("mapping", !occlusion.mapping.empty())) {
        f.list("mapping", occlusion.mapping, MAX_OCCLUSION_POINTS, mapping);
        f.check("mapping", std::ranges::is_sorted(occlusion.mapping, {}, &OcclusionPoint::arrives),
                "points in the order of `arrives`");
    } else {
        f.mention("mapping", mapping);
    }
    f.flag("automatic", occlusion.automatic, {"true: the window updates occlusion at once; false: on request (F8)"});
}

void fields(Fields& f, Light& light)
{
    f.flag(
        "shaded", light.shaded,
        {"false: draws the volume in its plain colours, without gradients; surfaces and the probe are always shaded"});
    f.number("ambient", light.ambient, {0.0, 10.0}, {"ambient share of the colour"});
    f.number("diffuse", light.diffuse, {0.0, 10.0},
             {"diffuse share of the colour, which depends on the surface's orientation"});
    f.number("specular", light.specular, {0.0, 10.0}, {"strength of the highlight"});
    f.number("shininess", light.shininess, {0.0, 1000.0}, {"exponent of the highlight"});
    f.vector(
        "direction", light.direction, {-1e6, 1e6},
        {.meaning = "direction towards the light, along the camera's right, up and back; 0, 0, 0 means 0.3, 0.5, 1",
         .allowed = "any length from 1e-6"});
    f.check("direction", light.direction == glm::dvec3(0.0) || glm::length(light.direction) >= 1e-6,
            "a direction of length 1e-06 or more, or 0, 0, 0 for the default");
    f.number("gradient_fade", light.gradient_fade, SHARE,
             {"gradient magnitude well below which shading fades out", "share of the intensity range per voxel"});
    f.section("occlusion", light.occlusion);
}

void fields(Fields& f, DistanceBlend& blend)
{
    f.number("size", blend.size, {0.0, 1000.0},
             {"share of the colour of distance blending at the far end of the scene; 0: off"});
    f.number("rate", blend.rate, {0.0, 1000.0},
             {"exponent of depth in distance blending; 0: the same share everywhere"});
    f.color("color", blend.color, {.meaning = "colour of distance blending", .standard = "the background's"});
}

void fields(Fields& f, Unpainted& unpainted)
{
    f.flag("visible", unpainted.visible, {"false: unpainted voxels are not drawn"});
    f.number("opacity", unpainted.opacity, SHARE, {"factor of the transfer function's opacity in unpainted voxels"});
}

namespace {

/// Sets the keys that the quality preset covers. Keys that the file states are visited later, and override the preset.
void quality_fields(Fields& f, RenderSettings& render)
{
    const About about{.meaning =
                          "preset of `step_voxels`, `opacity_limit`, `sampling`, `detail`, `skip_empty_space`, "
                          "`preintegration` and `exact_integral`, for those not given (quality.h)",
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

// The keys for how a picture is computed need two functions: in a file, the background lies between these keys.

void sample_fields(Fields& f, RenderSettings& render)
{
    std::vector<int64_t> size{render.size.x, render.size.y};
    f.wholes("size", size, 1, 65536, {"width and height of the picture", "pixels"});
    render.size = {size[0], size[1]};
    quality_fields(f, render);
    f.number("step_voxels", render.step_voxels, above_zero(1e-4, 1024.0),
             {"distance between samples", "reference lengths"});
    f.number("opacity_limit", render.opacity_limit, above_zero(1e-6, 1.0), {"opacity at which a ray ends"});
}

void way_fields(Fields& f, RenderSettings& render)
{
    f.choice("sampling", render.sampling,
             {"interpolation of voxels: in the kernel (exact), by the texture unit (hardware), or the better one on "
              "this device (automatic)"});
    f.choice("paging", render.paging,
             {"whether bricks are paged on the device; never: a volume that does not fit is refused; automatic: if the "
              "file has levels or does not fit"});
    f.number("detail", render.detail, {0.0, 16.0},
             {"resolution of paged volumes with several levels; 0: all voxels, as resident volumes always show. Each "
              "resolution gives a complete picture of its own",
              "voxels per pixel at least"});
    f.flag("skip_empty_space", render.skip_empty_space,
           {"true: skips bricks and cells in which nothing is visible; the picture is the same"});
    f.flag("preintegration", render.preintegration,
           {"true: integrates the transfer function over all densities between the ends of a step, for narrow peaks "
            "and steep edges; needs steps of at most 1"});
    f.flag("exact_integral", render.exact_integral,
           {"true: integrates light between borders of voxels and points of the transfer function, to about 1e-5, "
            "instead of sampling steps; takes the place of `preintegration`; needs exact sampling, and steps of at "
            "most 1"});
    f.choice("gradient", render.gradient,
             {"differences that shading takes its normals from: over one voxel (central), or the derivative of the "
              "interpolation inside the voxel (analytic), which reads half of the voxels at a larger error; "
              "`exact_integral` and occlusion always use central ones"});
    f.retired("adaptive_tolerance");
    f.check("preintegration", !render.preintegration || render.step_voxels <= 1.0,
            sentence("false, because render.step_voxels is ", render.step_voxels, ", above 1"));
    f.check("exact_integral", !render.exact_integral || render.step_voxels <= 1.0,
            sentence("false, because render.step_voxels is ", render.step_voxels, ", above 1"));
    f.check("exact_integral", !render.exact_integral || render.sampling == Sampling::exact,
            "false, because render.sampling is not exact");
}

void background_field(Fields& f, RenderSettings& render)
{
    std::optional<glm::dvec4> background = render.background;
    f.color("background", background, true, {"colour behind the volume, with straight alpha"});
    render.background = background.value_or(render.background);
}

void border_and_color_fields(Fields& f, RenderSettings& render)
{
    f.flag("smooth_borders", render.smooth_borders,
           {"true: draws smooth borders of painted groups by interpolated labels, which keep each voxel's label at its "
            "centre. Slices show voxels. Pictures with much paint take about 50 % longer"});
    f.number("saturation", render.saturation, SHARE,
             {"saturation of the picture, background included; 0: greys of the same luminance, for print or anaglyphs. "
              "Lines over the picture keep their colours"});
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
    f.choice("output", stereo.output, {"layout of the two eyes' pictures; an anaglyph is for red and cyan glasses"});
    f.number(
        "eye_distance", stereo.eye_distance, SHARE,
        {"distance between the eyes, whose views coincide at the target's distance", "distances from eye to target"});
    f.flag("toe_in", stereo.toe_in,
           {"true: turns the eyes towards the target, which causes vertical parallax; false: off-axis"});
}

void fields(Fields& f, SliceSettings& slices)
{
    f.number("paint_share", slices.paint_share, SHARE, {"share of the group's colour in a painted voxel"});
    f.number("zoom", slices.zoom, above_zero(1e-3, 1e3), {"zoom of the slices; 1: the whole volume fits"});
    f.vector("center", slices.center, {-double(MAX_SIDE), 2.0 * double(MAX_SIDE)},
             {.meaning = "point at the centre of the slices",
              .unit = "voxels",
              .standard = "the volume's centre; for enlarged slices the probe"});
    f.vector("cross", slices.cross, {-double(MAX_SIDE), 2.0 * double(MAX_SIDE)},
             {.meaning = "point that the slices go through", .unit = "voxels", .standard = "the probe"});
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
    f.number("overview_zoom", view.overview_zoom, above_zero(1e-3, 1e3), {"zoom of the three maps"});
    f.flag("volume", view.volume, {"false: draws no voxels, except in slices"});
    f.flag("meshes", view.meshes, {"false: draws no nodes, internodes, surfaces or meshes, and no ball of the probe"});
    f.flag("cut_box", view.cut_box, {"true: draws the edges of the box that the cutting planes leave"});
    std::optional<int64_t> solo = view.solo;
    f.any_whole(
        "solo", solo, 0, 255,
        {.meaning = "number of the only group that is drawn, with the groups below it; 0: unpainted voxels only",
         .standard = "none: all that are visible"});
    f.flag("plane_handles", view.plane_handles,
           {"false: the window draws no handles of the oblique cutting plane, which still cuts"});
    view.solo = solo ? std::optional(uint8_t(*solo)) : std::nullopt;
}

void fields(Fields& f, InteractionSettings& interaction)
{
    f.number("resolution", interaction.resolution, {0.1, 1.0},
             {"maximum resolution while something moves, as pixels drawn per pixel of the screen along each axis; "
              "lowered further if drawing takes too long"});
    f.number("frames_per_second", interaction.frames_per_second, {1.0, 1000.0}, {"maximum frame rate of the window"});
    f.whole("screenshot_scale", interaction.screenshot_scale, 1, 32,
            {"scale of large screenshots: pixels per pixel of the window, along each axis"});
    f.flag("screenshot_marks", interaction.screenshot_marks,
           {"true: screenshots include the scale bar, axes, names of groups and distances drawn by the window"});
    f.choice("pivot", interaction.pivot, {"pivot of turning the view"});
    f.flag("scale_bar", interaction.scale_bar, {"true: draws a scale bar over each pane"});
    f.flag("axes", interaction.axes, {"true: draws the directions of x, y and z over each pane"});
    f.flag("probe_label", interaction.probe_label,
           {"true: shows next to the probe its depth and the share of it at or above the threshold"});
    f.flag("group_legend", interaction.group_legend,
           {"true: lists names and colours of all visible groups with paint or nodes over the picture"});
    f.number("workspace_scale", interaction.workspace_scale, above_zero(MIN_WORKSPACE_SCALE, MAX_WORKSPACE_SCALE),
             {"scale of a haptic device's motion; 1: its whole reach is the height of the view"});
}

void fields(Fields& f, CutBox& cut)
{
    const NumberRange voxel{0.0, double(MAX_SIDE)};
    f.vector("lower", cut.lower, voxel, {"lower corner of the part of the volume that is drawn", "voxels"});
    f.vector("upper", cut.upper, voxel, {"upper corner of the part of the volume that is drawn", "voxels"});
    f.check("", !glm::any(glm::greaterThan(cut.lower, cut.upper)), "a lower corner that is not above the upper one");
    f.vector("plane_normal", cut.plane_normal, {-1e6, 1e6},
             {.meaning = "direction in which the oblique cutting plane, of any orientation, removes the volume",
              .allowed = "any length from 1e-6",
              .standard = "no such plane"});
    f.check("plane_normal", !cut.plane_normal || glm::length(*cut.plane_normal) >= 1e-6,
            "a direction of length 1e-06 or more");
    f.vector("plane_point", cut.plane_point, {-double(MAX_SIDE), 2.0 * double(MAX_SIDE)},
             {.meaning = "point on that plane", .unit = "voxels", .standard = "the volume's centre"});
}

}  // namespace shvr
