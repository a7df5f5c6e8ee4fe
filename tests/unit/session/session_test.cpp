#include "engine/session/session.h"

#include <unistd.h>

#include <cmath>
#include <ctime>
#include <fstream>

#include <doctest/doctest.h>

#include "engine/base/error.h"
#include "engine/base/image.h"
#include "engine/look/session_color.h"

using namespace shvr;
namespace fs = std::filesystem;

namespace {

const std::string SMALLEST = R"("shvr_session": 1, "volume": {"path": "a.nhdr"})";

/// The smallest session, with extra keys.
std::string with(const std::string& keys)
{
    return "{" + SMALLEST + (keys.empty() ? "" : ", " + keys) + "}";
}

Session parse(const std::string& text, const std::vector<std::string>& settings = {})
{
    return parse_session(text, "/data/scans", "s.json", settings);
}

/// The message that refuses a text.
std::string refusal(const std::string& text, const std::vector<std::string>& settings = {})
{
    try {
        parse(text, settings);
    } catch (const Error& error) {
        return error.what();
    }
    return "(accepted)";
}

std::string volume_refusal(const std::string& volume)
{
    return refusal("{\"shvr_session\": 1, \"volume\": " + volume + "}");
}

glm::dvec3 color(const char* text)
{
    return glm::dvec3(color_of(text).value());
}

VolumeInfo cube()
{
    VolumeInfo volume;
    volume.size = Size3(100);
    return volume;
}

const std::string EVERYTHING = R"({
  "shvr_session": 1,
  "volume": {"path": "raw/x.raw", "raw": "256x255x108:int16:big:12", "spacing": [0.5, 0.75, 1.25], "unit": "mm"},
  "camera": "tele",
  "cameras": {
    "tele": {"projection": "perspective", "eye": [1.5, -400, 0.1], "target": [1, 2, 3], "up": [0, 0.1, 1],
             "fov_y_degrees": 12.5, "near": 3, "far": 900},
    "plan": {"projection": "orthographic", "eye": [0, 0, 50], "target": [0, 0, 0], "up": [0, 1, 0], "height": 80,
             "shift_right": -0.25},
    "tilted": {"side": "left", "zoom": 1.5, "turn_degrees": 30, "tilt_degrees": -20}
  },
  "transfer_function": {"points": [{"intensity": 900.25, "color": "#ffffff", "opacity": 1},
                                   {"intensity": -200, "color": "#d03020", "opacity": 0.125}]},
  "groups": {"1": {"name": "aorta", "color": "#c02020", "opacity": 0.9, "visible": false}, "255": {"parent": 1, "opacity": 0.5}},
  "unpainted": {"visible": false, "opacity": 0.75},
  "light": {"shaded": false, "ambient": 0.1, "diffuse": 0.2, "specular": 0.3, "shininess": 4, "direction": [1, 2, 3],
            "gradient_fade": 0.5,
            "occlusion": {"strength": 0.75, "radius": 9.5, "rays": 48, "full_sphere": true, "curve": 1.5,
                          "automatic": false}},
  "blend": {"size": 0.75, "rate": 2, "color": "#204060"},
  "render": {"size": [640, 480], "step_voxels": 0.25, "opacity_limit": 0.9, "background": "#10203040",
             "sampling": "exact", "paging": "never", "detail": 0.5, "skip_empty_space": false,
             "preintegration": true, "exact_integral": true, "gradient": "analytic", "smooth_borders": true, "saturation": 0.375},
  "view": {"arrangement": "slices", "stereo": {"output": "top_bottom", "eye_distance": 0.0625, "toe_in": true},
           "slices": {"black": -20, "white": 300.5, "paint_share": 0.25, "zoom": 3, "cross": [4, 5.5, 6]}, "overview_zoom": 1.5,
           "volume": false, "meshes": false, "cut_box": true, "solo": 7, "plane_handles": false},
  "interaction": {"resolution": 0.5, "frames_per_second": 25, "screenshot_scale": 3, "workspace_scale": 2.5},
  "cut": {"lower": [1, 2, 3], "upper": [40, 50, 60.5], "plane_normal": [0, 1, -2], "plane_point": [3, 4.5, 5]},
  "probe": {"voxel": [10, 20, 30.5], "radius_voxels": 2.5, "group": 7, "brush": "speckle", "region": "box",
            "connectivity": 26, "paint_threshold": 120.5, "haptic_threshold": -3, "shown": true, "shell": true, "shell_opacity": 0.25,
            "preview": true, "density": {"offset": 12.5, "falloff": "distance"}, "paints_group": false,
            "color": "#40c0a0", "opacity": 0.5, "silhouette": false, "arrow": false},
  "surfaces": [{"from": [1, 2, -3.5], "radius": 0.25, "color": "#d03020"},
               {"from": [0, 0, 0], "to": [10, 20, 30], "radii": [2, 1.5]},
               {"from": [5, 5, 5], "to": [6, 5, 5], "radius": 3}],
  "annotation": {"mask": "shvr/labels.mask"}
})";

/// A temporary folder, removed at the end.
struct TemporaryFolder {
    fs::path path = fs::temp_directory_path() / sentence("shvr_session_test_", getpid());
    TemporaryFolder() { fs::create_directories(path); }
    ~TemporaryFolder() { fs::remove_all(path); }
    fs::path write(const fs::path& name, const std::string& text) const
    {
        fs::create_directories((path / name).parent_path());
        std::ofstream(path / name) << text;
        return path / name;
    }
};

}  // namespace

TEST_CASE("every key of a session is read")
{
    const Session session = parse(EVERYTHING);
    CHECK(session.volume_path == "/data/scans/raw/x.raw");
    REQUIRE(session.raw_layout);
    CHECK(session.raw_layout->size == Size3(256, 255, 108));
    CHECK(session.raw_layout->type == VoxelType::int16);
    CHECK(session.raw_layout->big_endian);
    CHECK(session.raw_layout->offset_bytes == 12);
    CHECK(session.raw_layout->spacing == glm::dvec3(0.5, 0.75, 1.25));
    CHECK(session.raw_layout->unit == "mm");
    CHECK(session.camera_name == "tele");
    Camera tele;
    tele.eye = {1.5, -400, 0.1};
    tele.target = {1, 2, 3};
    tele.up = {0, 0.1, 1};
    tele.fov_y_degrees = 12.5;
    tele.near_distance = 3;
    tele.far_distance = 900;
    CHECK(session.cameras.at("tele") == CameraSpec(tele));
    const Camera plan = std::get<Camera>(session.cameras.at("plan"));
    CHECK(plan.projection == Camera::Projection::orthographic);
    CHECK(plan.height == 80.0);
    CHECK(plan.shift_right == -0.25);
    CHECK(session.cameras.at("tilted") == CameraSpec(SideView{"left", 1.5, 30, -20}));
    REQUIRE(session.transfer_function.points().size() == 2);
    CHECK(session.transfer_function.points()[0] == ControlPoint{-200, color("#d03020"), 0.125});
    CHECK(session.transfer_function.points()[1] == ControlPoint{900.25, glm::dvec3(1), 1});
    CHECK(session.groups.at(1) == GroupSettings{"aorta", 0, color("#c02020"), 0.9, false});
    CHECK(session.groups.at(255) == GroupSettings{.name = "", .parent = 1, .color = {}, .opacity = 0.5});
    CHECK(session.unpainted == Unpainted{false, 0.75});
    CHECK(session.light == Light{false, 0.1, 0.2, 0.3, 4, {1, 2, 3}, 0.5, {0.75, 9.5, 48, true, 1.5, false}});
    CHECK(session.blend == DistanceBlend{0.75, 2.0, color("#204060")});
    const glm::dvec4 background(color("#102030"), 64 / 255.0);
    CHECK(session.render == RenderSettings{{640, 480},
                                           0.25,
                                           0.9,
                                           background,
                                           Sampling::exact,
                                           Paging::never,
                                           0.5,
                                           false,
                                           true,
                                           true,
                                           Gradient::analytic,
                                           true,
                                           0.375});
    CHECK(session.view == ViewSettings{Arrangement::slices,
                                       {StereoOutput::top_bottom, 0.0625, true},
                                       {-20.0, 300.5, 0.25, 3.0, {}, glm::dvec3(4, 5.5, 6)},
                                       1.5,
                                       false,
                                       false,
                                       true,
                                       uint8_t{7},
                                       false});
    CHECK(session.interaction == InteractionSettings{0.5, 25.0, 3, 2.5});
    CHECK(session.cut == CutBox{{1, 2, 3}, {40, 50, 60.5}, glm::dvec3(0, 1, -2), glm::dvec3(3, 4.5, 5)});
    const BrushSettings brush{
        Brush::speckle, RegionShape::box, 7, 120.5, 2.5, 26, DensityBrush{12.5, Falloff::distance}, false};
    ProbeSettings probe{glm::dvec3(10, 20, 30.5), brush, -3, true, true, 0.25, true};
    probe.color = color("#40c0a0");
    probe.opacity = 0.5;
    probe.silhouette = probe.arrow = false;
    CHECK(session.probe == probe);
    CHECK((session.surfaces == std::vector<SurfaceLook>{{{1, 2, -3.5}, {1, 2, -3.5}, 0.25, 0.25, color("#d03020")},
                                                        {{0, 0, 0}, {10, 20, 30}, 2.0, 1.5, glm::dvec3(1)},
                                                        {{5, 5, 5}, {6, 5, 5}, 3.0, 3.0, glm::dvec3(1)}}));
    CHECK(session.mask_path == "/data/scans/shvr/labels.mask");
}

TEST_CASE("a session that says little has the defaults of the structures")
{
    const Session session = parse(with(""));
    CHECK(session.camera_name.empty());
    CHECK(session.cameras.empty());
    CHECK(session.transfer_function.points().empty());
    CHECK(session.groups.empty());
    CHECK(session.light == Light{});
    CHECK(session.blend == DistanceBlend{});
    CHECK(session.render == RenderSettings{});
    CHECK(session.view == ViewSettings{});
    CHECK(session.interaction == InteractionSettings{});
    CHECK(session.cut == CutBox{});
    CHECK(session.probe == ProbeSettings{});
    CHECK(session.surfaces.empty());
    CHECK(session.mask_path.empty());
    CHECK_FALSE(session.procedural);
    CHECK_FALSE(session.raw_layout);
}

TEST_CASE("what is written reads back the same")
{
    const std::string procedural = R"({"shvr_session": 1, "volume": {"procedural": "speckles", "size": [3, 4, 5],
        "seed": 4294967295, "type": "int16", "spacing": [1, 2, 0.1], "unit": "um"}, "camera": "top"})";
    const std::string channel = R"({"shvr_session": 1, "volume": {"path": "a.tif", "channel": "2", "frame": "red"}})";
    CHECK(parse(channel).open_options == OpenOptions{.channel = "2", .frame = "red"});
    const std::string nodata = R"({"shvr_session": 1, "volume": {"path": "a.tif", "nodata": -9999.5}})";
    const std::string none =
        R"({"shvr_session": 1, "volume": {"raw": "4x3x2:float32", "path": "a.raw", "nodata": "none"}})";
    CHECK(parse(nodata).open_options.nodata == -9999.5);
    CHECK(std::isinf(parse(none).open_options.nodata.value()));
    for (const std::string& text :
         {EVERYTHING, procedural, channel, nodata, none, with(""), with(R"("camera": {"side": "back", "zoom": 2})"),
          with(R"("transfer_function": {"points": []})")}) {
        const Session first = parse(text);
        const std::string written = to_text(first, "/data/scans");
        CAPTURE(written);
        const Session second = parse_session(written, "/data/scans", "written");
        CHECK(to_text(second, "/data/scans") == written);
        CHECK(second.volume_path == first.volume_path);
        CHECK(second.open_options == first.open_options);
        CHECK(second.cameras == first.cameras);
        CHECK(second.camera_name == first.camera_name);
        CHECK(std::ranges::equal(second.transfer_function.points(), first.transfer_function.points()));
        CHECK(second.groups == first.groups);
        CHECK(second.light == first.light);
        CHECK(second.render == first.render);
        CHECK(second.cut == first.cut);
        CHECK(second.probe == first.probe);
        CHECK((second.surfaces == first.surfaces));
        CHECK(second.mask_path == first.mask_path);
        CHECK(second.trace_path == first.trace_path);
        REQUIRE(second.procedural.has_value() == first.procedural.has_value());
        if (first.procedural) {
            CHECK(second.procedural->kind == "speckles");
            CHECK(second.procedural->size == Size3(3, 4, 5));
            CHECK(second.procedural->seed == 4294967295u);
            CHECK(second.procedural->type == VoxelType::int16);
            CHECK(second.procedural->spacing == glm::dvec3(1, 2, 0.1));
            CHECK(second.procedural->unit == "um");
        }
        REQUIRE(second.raw_layout.has_value() == first.raw_layout.has_value());
        if (first.raw_layout) {
            CHECK(second.raw_layout->size == first.raw_layout->size);
            CHECK(second.raw_layout->type == first.raw_layout->type);
            CHECK(second.raw_layout->big_endian == first.raw_layout->big_endian);
            CHECK(second.raw_layout->offset_bytes == first.raw_layout->offset_bytes);
            CHECK(second.raw_layout->spacing == first.raw_layout->spacing);
            CHECK(second.raw_layout->unit == first.raw_layout->unit);
        }
    }
}

TEST_CASE("numbers are written with all their digits")
{
    Session session = parse(with(""));
    session.render.step_voxels = 0.1 + 0.2;
    session.light.ambient = 1.0 / 3.0;
    session.transfer_function = TransferFunction({{-1.0 / 7.0, glm::dvec3(0), 1e-30}, {3e38, glm::dvec3(0), 1}});
    const Session again = parse_session(to_text(session, "/"), "/", "written");
    CHECK(again.render == session.render);
    CHECK(again.light == session.light);
    CHECK(std::ranges::equal(again.transfer_function.points(), session.transfer_function.points()));
}

TEST_CASE("all colours of 8 bits survive")
{
    for (int value = 0; value < 256; ++value) {
        const double share = value / 255.0;
        const glm::dvec4 grey(srgb_decode(share), srgb_decode(share), srgb_decode(share), share);
        CHECK(color_of(text_of_color(grey)) == grey);
    }
    CHECK(text_of_color({1, 0, 0, 1}) == "#ff0000");
    CHECK(text_of_color({-0.5, 2, 0, 0}) == "#00ff0000");
    CHECK(color_of("#ABCDEF") == color_of("#abcdef"));
    for (const char* bad : {"", "#", "red", "#12345", "#1234567", "#12345g", "#+12345", "123456#", "#123456789"})
        CHECK_FALSE(color_of(bad));
}

TEST_CASE("relative paths are relative to the file, and paths inside its folder are written so")
{
    const Session session = parse(R"({"shvr_session": 1, "volume": {"path": "../other/./v.nhdr"},
                                      "annotation": {"mask": "labels.mask", "density": "raised.offset"}})");
    CHECK(session.volume_path == "/data/other/v.nhdr");
    CHECK(session.mask_path == "/data/scans/labels.mask");
    CHECK(session.trace_path == "/data/scans/labels.graphml");
    const Session traced =
        parse(R"({"shvr_session": 1, "volume": {"path": "v.nhdr"}, "annotation": {"trace": "t.swc"}})");
    CHECK(traced.mask_path.empty());
    CHECK(traced.trace_path == "/data/scans/t.swc");
    CHECK(to_text(traced, "/data/scans").find("\"trace\": \"t.swc\"") != std::string::npos);
    CHECK(session.density_path == "/data/scans/raised.offset");
    CHECK(parse(R"({"shvr_session": 1, "volume": {"path": "/abs/v.nhdr"}})").volume_path == "/abs/v.nhdr");
    const std::string text = to_text(session, "/data/scans/");
    CHECK(text.find("\"/data/other/v.nhdr\"") != std::string::npos);
    CHECK(text.find("\"labels.mask\"") != std::string::npos);
    CHECK(to_text(session, "/data").find("\"other/v.nhdr\"") != std::string::npos);
    const Session moved = parse_session(to_text(session, "/data"), "/data", "written");
    CHECK(moved.volume_path == session.volume_path);
    CHECK(moved.mask_path == session.mask_path);
    CHECK(moved.density_path == session.density_path);
    CHECK(parse_session(with(""), "", "s.json").volume_path == fs::current_path() / "a.nhdr");
}

TEST_CASE("what lies in a project is written relative to its folder shvr, so that it can be moved")
{
    const auto written = [](const char* volume) {
        const std::string text = sentence(R"({"shvr_session": 1, "volume": {"path": ")", volume, R"("}})");
        return to_text(parse_session(text, "/data/project/shvr", "s.json"), "/data/project/shvr");
    };
    CHECK(written("../scan.nhdr").find("\"../scan.nhdr\"") != std::string::npos);
    CHECK(written("below/scan.nhdr").find("\"below/scan.nhdr\"") != std::string::npos);
    CHECK(written("../../scan.nhdr").find("\"/data/scan.nhdr\"") != std::string::npos);
    CHECK(written("/other/scan.nhdr").find("\"/other/scan.nhdr\"") != std::string::npos);
    const std::string image = written("..");
    CHECK(image.find("/data") == std::string::npos);
    CHECK(parse_session(image, "/elsewhere/shvr", "s.json").volume_path.parent_path() == "/elsewhere");
}

TEST_CASE("keys that are not known are refused by their full name, with those that are")
{
    CHECK(refusal(with(R"("render": {"step": 1})")) ==
          "s.json: unknown key render.step; expected one of: size, quality, step_voxels, opacity_limit, background, "
          "sampling, "
          "paging, detail, skip_empty_space, preintegration, exact_integral, gradient, smooth_borders, saturation");
    struct Case {
        std::string keys, name;
    };
    for (const Case& wrong :
         {Case{R"("lights": {})", "lights"}, Case{R"("light": {"Ambient": 1})", "light.Ambient"},
          Case{R"("groups": {"3": {"colour": "#ffffff"}})", "groups.3.colour"},
          Case{R"("cut": {"left": 0})", "cut.left"}, Case{R"("annotation": {"masks": "a"})", "annotation.masks"},
          Case{R"("transfer_function": {"presets": 1, "points": []})", "transfer_function.presets"},
          Case{R"("transfer_function": {"points": [{"x": 1}]})", "transfer_function.points.0.x"},
          Case{R"("cameras": {"a": {"side": "top", "eye": [0, 0, 0]}})", "cameras.a.eye"},
          Case{R"("cameras": {"a": {"eye": [0, 0, 0], "target": [1, 0, 0], "height": 3}})", "cameras.a.height"},
          Case{R"("cameras": {"a": {"projection": "orthographic", "fov_y_degrees": 3}})", "cameras.a.fov_y_degrees"},
          Case{R"("camera": {"side": "top", "roll": 3})", "camera.roll"}, Case{R"("a\nb": 3)", "a\\nb"}}) {
        CAPTURE(wrong.keys);
        CHECK(refusal(with(wrong.keys)).starts_with("s.json: unknown key " + wrong.name + "; expected one of: "));
    }
    CHECK(volume_refusal(R"({"path": "a", "size": [1, 1, 1]})") ==
          "s.json: unknown key volume.size; expected one of: path, raw, procedural, channel, frame, level, spacing, "
          "unit, nodata");
    CHECK(volume_refusal(R"({"path": "a", "procedural": "tubes"})").starts_with("s.json: unknown key volume.path;"));
}

TEST_CASE("values of the wrong type or range are refused with what was found and what was expected")
{
    CHECK(refusal(with(R"("render": {"step_voxels": -1})")) ==
          "s.json: key render.step_voxels is -1; expected a number above 0 (0.0001 ... 1024)");
    struct Case {
        std::string keys, sentence;
    };
    for (
        const Case& wrong : {
            Case{R"("render": 3)", "render is 3; expected an object with keys out of: size, "},
            Case{R"("render": {"size": [512]})", "render.size is [512]; expected two whole numbers"},
            Case{R"("render": {"size": [512, 0]})", "render.size.1 is 0; expected a whole number from 1 to 65536"},
            Case{R"("render": {"size": [1.5, 1]})", "render.size.0 is 1.5; expected a whole number"},
            Case{R"("render": {"size": "512x512"})", "render.size is \"512x512\"; expected two whole numbers"},
            Case{R"("render": {"step_voxels": "x"})", "render.step_voxels is \"x\"; expected a number above 0"},
            Case{R"("render": {"step_voxels": 0})", "render.step_voxels is 0; expected a number above 0"},
            Case{R"("render": {"step_voxels": true})", "render.step_voxels is true; expected a number above 0"},
            Case{R"("render": {"opacity_limit": 1.1})", "render.opacity_limit is 1.1; expected a number above 0"},
            Case{R"("render": {"background": "white"})", "render.background is \"white\"; expected a colour"},
            Case{R"("render": {"background": 0})", "render.background is 0; expected a colour"},
            Case{R"("render": {"sampling": "best"})",
                 "render.sampling is \"best\"; expected one of \"automatic\", \"exact\", \"hardware\""},
            Case{R"("render": {"sampling": 1})", "render.sampling is 1; expected one of"},
            Case{R"("render": {"skip_empty_space": 1})", "render.skip_empty_space is 1; expected true or false"},
            Case{R"("render": {"step_voxels": 1.5, "preintegration": true})",
                 "render.preintegration is true; expected false, because render.step_voxels is 1.5, above 1"},
            Case{R"("render": {"step_voxels": 1.5, "exact_integral": true, "sampling": "exact"})",
                 "render.exact_integral is true; expected false, because render.step_voxels is 1.5, above 1"},
            Case{R"("render": {"exact_integral": true})",
                 "render.exact_integral is true; expected false, because render.sampling is not exact"},
            Case{R"("light": {"ambient": -0.1})", "light.ambient is -0.1; expected a number from 0 to 10"},
            Case{R"("light": {"shininess": 1e9})", "light.shininess is 1000000000.0; expected a number from 0 to"},
            Case{R"("light": {"direction": [1, 2]})", "light.direction is [1,2]; expected three numbers"},
            Case{R"("light": {"direction": [1, 2, "z"]})", "light.direction.2 is \"z\"; expected a number"},
            Case{R"("light": {"direction": [0, 1e-9, 0]})", "light.direction is [0,1e-09,0]; expected a direction"},
            Case{R"("light": {"occlusion": {"strength": 2}})",
                 "light.occlusion.strength is 2; expected a number from 0 to 1"},
            Case{R"("light": {"occlusion": {"radius": 61}})", "light.occlusion.radius is 61; expected"},
            Case{R"("light": {"occlusion": {"rays": 0}})", "light.occlusion.rays is 0; expected"},
            Case{R"("light": {"occlusion": {"curve": 0}})", "light.occlusion.curve is 0; expected"},
            Case{R"("light": {"occlusion": {"mapping": [{"arrives": 0.5}]}})",
                 "light.occlusion.mapping.0.seen is missing"},
            Case{R"("light": {"occlusion": {"mapping": [{"arrives": 0.5, "seen": 1.5}]}})",
                 "light.occlusion.mapping.0.seen is 1.5; expected a number from 0 to 1"},
            Case{
                R"("light": {"occlusion": {"mapping": [{"arrives": 0.5, "seen": 1}, {"arrives": 0.4, "seen": 1}]}})",
                R"(light.occlusion.mapping is [{"arrives":0.5,"seen":1},{"arrives":0.4,"seen":1}]; expected points in the)"},
            Case{R"("light": {"gradient_fade": null})", "light.gradient_fade is null; expected a number"},
            Case{R"("groups": {"0": {}})", "groups.0 is {}; expected a group number from 1 to 255 as its name"},
            Case{R"("groups": {"256": {}})", "groups.256 is {}; expected a group number"},
            Case{R"("groups": {"01": {}})", "groups.01 is {}; expected a group number"},
            Case{R"("groups": {"a": {}})", "groups.a is {}; expected a group number"},
            Case{R"("groups": {"1": {"opacity": 2}})", "groups.1.opacity is 2; expected a number from 0 to 1"},
            Case{R"("groups": {"1": {"color": "#ffffff80"}})", "groups.1.color is \"#ffffff80\"; expected a colour"},
            Case{R"("groups": {"1": {"name": 7}})", "groups.1.name is 7; expected a text that is not empty"},
            Case{R"("groups": {"3": {"parent": 3}})", "groups.3.parent is 3; expected a group other than itself"},
            Case{R"("groups": {"3": {"parent": 4}, "4": {"parent": 5}, "5": {"parent": 3}})", "groups.3.parent is 4;"},
            Case{R"("blend": {"rate": -1})", "blend.rate is -1; expected a number from 0 to 1000"},
            Case{R"("blend": {"size": "a"})", "blend.size is \"a\"; expected a number"},
            Case{R"("groups": [])", "groups is []; expected an object"},
            Case{R"("cut": {"lower": [5, 0, 0], "upper": [4, 9, 9]})", "cut is {"},
            Case{R"("probe": {"connectivity": 18})", "probe.connectivity is 18; expected 6 or 26"},
            Case{R"("probe": {"radius_voxels": 127.5})", "probe.radius_voxels is 127.5; expected"},
            Case{R"("probe": {"brush": "pen"})", "probe.brush is"},
            Case{R"("probe": {"shown": 1})", "probe.shown is 1; expected true or false"},
            Case{R"("measurements": [{}])", "measurements.0.points is missing; expected 2 points for a distance"},
            Case{R"("measurements": [{"kind": "angle", "points": [[0, 0, 0], [1, 0, 0]]}])",
                 "measurements.0.points is [[0,0,0],[1,0,0]]; expected 2 points for a distance"},
            Case{R"("measurements": [{"from": [0, 0, 0]}])", "measurements.0.points is missing"},
            Case{R"("surfaces": {})", "surfaces is {}; expected an array"},
            Case{R"("surfaces": [3])", "surfaces.0 is 3; expected an object"},
            Case{R"("surfaces": [{"radius": 1}])", "surfaces.0.from is missing; expected three numbers, [x, y, z]"},
            Case{R"("surfaces": [{"from": [1, 2]}])", "surfaces.0.from is [1,2]; expected three numbers"},
            Case{R"("surfaces": [{"from": [1, 2, 3]}])", "surfaces.0.radius is missing; expected a number above 0"},
            Case{R"("surfaces": [{"from": [1, 2, 3], "radius": 0}])", "surfaces.0.radius is 0; expected a number"},
            Case{R"("surfaces": [{"from": [1, 2, 3], "radii": [1]}])", "surfaces.0.radii is [1]; expected two numbers"},
            Case{R"("surfaces": [{"from": [1, 2, 3], "radii": [1, -1]}])", "surfaces.0.radii.1 is -1; expected a"},
            Case{R"("surfaces": [{"from": [1, 2, 3], "radii": [1, 1], "radius": 1}])",
                 "surfaces.0.radius is 1; expected either radius or radii"},
            Case{R"("surfaces": [{"from": [0, 0, 0], "radius": 1}, {"from": [0, 0, 1e16], "radius": 1}])",
                 "surfaces.1.from.2 is 1e+16; expected a number from"},
            Case{R"("cut": {"plane_normal": [0, 0, 0]})", "cut.plane_normal is [0"},
            Case{R"("cut": {"lower": [-1, 0, 0]})", "cut.lower.0 is -1; expected a number from 0 to"},
            Case{R"("annotation": {"mask": ""})", "annotation.mask is \"\"; expected a path"},
            Case{R"("annotation": {"density": 3})", "annotation.density is 3; expected"},
            Case{R"("annotation": {"mask": "a\u0000b"})", "annotation.mask is \"a\\u0000b\"; expected a path"},
            Case{R"("annotation": {"trace": "a.obj"})", "annotation.trace is \"a.obj\"; expected a path that ends in"},
            Case{R"("transfer_function": {})", "transfer_function.points is missing; expected an array"},
            Case{R"("transfer_function": [])", "transfer_function is []; expected an object"},
            Case{R"("transfer_function": {"points": 3})", "transfer_function.points is 3; expected an array"},
            Case{R"("transfer_function": {"points": [{"intensity": 1}]})",
                 "transfer_function.points.0.opacity is missing; expected a number from 0 to 1"},
            Case{R"("transfer_function": {"points": [{"intensity": 1, "opacity": 1.01}]})",
                 "transfer_function.points.0.opacity is 1.01; expected a number from 0 to 1"},
            Case{R"("transfer_function": {"points": [{"intensity": 1e200, "opacity": 1}]})",
                 "transfer_function.points.0.intensity is 1e+200; expected a number from -3.4"},
            Case{R"("camera": "frnt")", "camera is \"frnt\"; expected one of \"back\", \"bottom\""},
            Case{R"("camera": 3)", "camera is 3; expected one of"},
            Case{R"("camera": {"side": "up"})", "camera.side is \"up\"; expected one of \"front\""},
            Case{R"("camera": {"side": "top", "zoom": 0})", "camera.zoom is 0; expected a number above 0"},
            Case{R"("camera": {"side": "top", "tilt_degrees": 91})", "camera.tilt_degrees is 91; expected a number"},
            Case{R"("camera": {})", "camera.eye is missing; expected three numbers, [x, y, z]"},
            Case{R"("cameras": {"a": 3})", "cameras.a is 3; expected an object"},
            Case{R"("cameras": {"": {"side": "top"}})", "cameras. is {\"side\":\"top\"}; expected a camera whose name"},
            Case{R"("cameras": {"a": {"projection": "fisheye"}})", "cameras.a.projection is \"fisheye\"; expected"},
            Case{R"("cameras": {"a": {"eye": [0, 0, 0], "target": [1, 1, 1], "fov_y_degrees": 180}})",
                 "cameras.a.fov_y_degrees is 180; expected a number of degrees above 0 and below 180"},
            Case{R"("cameras": {"a": {"eye": [0, 0, 0], "target": [0, 0, 0]}})",
                 "cameras.a: camera: eye and target are both (0, 0, 0); expected two different points"},
            Case{R"("cameras": {"a": {"projection": "orthographic", "eye": [0, 0, 0], "target": [0, 1, 0]}})",
                 "cameras.a.height is missing; expected a number above 0"},
        }) {
        CAPTURE(wrong.keys);
        const std::string found = refusal(with(wrong.keys));
        CAPTURE(found);
        CHECK(found.starts_with("s.json: key " + wrong.sentence));
    }
}

TEST_CASE("volumes that cannot be are refused")
{
    CHECK(refusal(R"({"shvr_session": 1})") ==
          "s.json: key volume is missing; expected an object with keys out of: path, raw, procedural, channel, frame, "
          "level, spacing, unit, nodata");
    for (const auto& [volume, sentence] : std::map<std::string, std::string>{
             {"3", "volume is 3; expected an object"},
             {"{}", "volume.path is missing; expected a path"},
             {R"({"path": 3})", "volume.path is 3; expected a path"},
             {R"({"path": "a", "raw": "what"})", "volume.raw: "},
             {R"({"path": "a", "raw": 3})", "volume.raw is 3; expected a text"},
             {R"({"raw": "4x4x4:uint8"})", "volume.path is missing"},
             {R"({"path": "a", "raw": "4x4x4:uint8", "spacing": [1, 1, 0]})",
              "volume.spacing.2 is 0; expected a number above 0"},
             {R"({"procedural": "tube"})", "volume.procedural is \"tube\"; expected one of \"constant\""},
             {R"({"procedural": "tubes", "size": [64, 64, 1048577]})",
              "volume.size.2 is 1048577; expected a whole number from 1 to 1048576"},
             {R"({"procedural": "tubes", "seed": -1})",
              "volume.seed is -1; expected a whole number from 0 to 4294967295"},
             {R"({"procedural": "tubes", "type": "uint64"})", "volume.type is \"uint64\"; expected one of \"uint8\""},
             {R"({"procedural": "tubes", "unit": ""})", "volume.unit is \"\"; expected a text"}}) {
        CAPTURE(volume);
        CHECK(volume_refusal(volume).starts_with("s.json: key " + sentence));
    }
}

TEST_CASE("texts that are no session are refused")
{
    CHECK(refusal("").starts_with("s.json: is not JSON: "));
    CHECK(refusal("{\"shvr_session\": 1,}").starts_with("s.json: is not JSON: parse error at line 1"));
    CHECK(refusal("{\"shvr_session\": 1e999}").starts_with("s.json: is not JSON: "));
    CHECK(refusal("{\"\xff\": 1}").starts_with("s.json: is not JSON: "));
    CHECK(refusal("[]").starts_with("s.json: the document is []; expected an object with keys out of: shvr_session"));
    CHECK(refusal("[]", {"a=1"}).starts_with("s.json: the document is []"));
    CHECK(refusal("{}") == "s.json: key shvr_session is missing; expected 1");
    CHECK(refusal(R"({"shvr_session": 2})").starts_with("s.json: key shvr_session is 2; expected "));
    CHECK(refusal(with(R"("cut": {}, "cut": {})")) == "s.json: key cut appears twice in one object; expected once");
    CHECK(refusal(std::string(1000000, '[')).starts_with("s.json: JSON nests deeper than"));
    for (size_t length = 0; length < EVERYTHING.size(); ++length)
        REQUIRE(refusal(EVERYTHING.substr(0, length)) != "(accepted)");
}

TEST_CASE("settings reach every key and make what is missing")
{
    CHECK(parse(with(""), {"render.step_voxels=0.25"}).render.step_voxels == 0.25);
    CHECK(parse(with(""), {"render.sampling=exact"}).render.sampling == Sampling::exact);
    CHECK(parse(with(""), {"render.sampling=\"exact\""}).render.sampling == Sampling::exact);
    CHECK(parse(with(""), {"render.size.0=100"}).render.size == glm::uvec2(100, 512));
    CHECK(parse(with(""), {"render.size=[7, 9]"}).render.size == glm::uvec2(7, 9));
    CHECK(parse(with(""), {"cut.upper.2=8", "cut.lower.0=3"}).cut == CutBox{{3, 0, 0}, {1048576, 1048576, 8}});
    CHECK(parse(with(""), {"groups.7.color=#ff0000"}).groups.at(7).color == glm::dvec3(1, 0, 0));
    CHECK(parse(with(""), {"volume.path=b=c.nhdr"}).volume_path == "/data/scans/b=c.nhdr");
    CHECK(parse(with(""), {"camera={\"side\": \"top\"}"}).camera_name == "{\"side\":\"top\"}");
    CHECK(parse(with(""), {"render.step_voxels=2", "render.step_voxels=3"}).render.step_voxels == 3.0);
    const Session session = parse(EVERYTHING, {"transfer_function.points.1.opacity=0.75", "light={}"});
    CHECK(session.transfer_function.points()[0].opacity == 0.75);
    CHECK(session.light == Light{});
    const std::string tubes = R"({"procedural": "tubes"})";
    CHECK(parse("{\"shvr_session\": 1}", {"volume=" + tubes}).procedural->kind == "tubes");
}

TEST_CASE("settings that lead nowhere are refused by name")
{
    CHECK(refusal(with(""), {"render.step_voxels=-1"}) ==
          "s.json: key render.step_voxels is -1; expected a number above 0 (0.0001 ... 1024)");
    CHECK(refusal(with(""), {"render.stop=1"}).starts_with("s.json: unknown key render.stop; expected one of: size"));
    for (const auto& [setting, sentence] : std::map<std::string, std::string>{
             {"render.step_voxels", "has no key and value; expected key=value, such as render.step_voxels=0.25"},
             {"=3", "has no key and value"},
             {"render..size=3", "the key has an empty part"},
             {".render=3", "the key has an empty part"},
             {"render.=3", "the key has an empty part"},
             {"shvr_session.a=3", "shvr_session is a number; expected an object or an array"},
             {"volume.path.a=3", "volume.path is a string; expected an object or an array"},
             {"render.size.2=3", "render.size has no element 2; expected a number below 2"},
             {"render.size.-1=3", "render.size has no element -1"},
             {"render.size.x=3", "render.size has no element x"},
             {"a.b.c.d.e.f.g.h.i=3", "the key has more than 8 parts"}}) {
        CAPTURE(setting);
        CHECK_THROWS_AS(parse(with(""), {setting}), UsageError);
        CHECK(refusal(with(""), {setting}).starts_with("--set " + setting + ": " + sentence));
    }
    CHECK_THROWS_AS(parse(with(""), {"camera=\xff"}), UsageError);
    CHECK_THROWS_AS(parse(with(""), {"\xff=1"}), UsageError);
    CHECK(refusal(with(""), {"render.step_voxels=1e999"}).find("is \"1e999\"; expected") != std::string::npos);
    CHECK(refusal(with(""), {"render={\"size\": [1, 2], \"size\": 3}"}).find("appears twice") != std::string::npos);
    CHECK_THROWS_AS(parse(with(""), {"render=" + std::string(100000, '[')}), Error);
}

TEST_CASE("cameras are found by name, by side and as JSON")
{
    Session session = parse(EVERYTHING);
    const VolumeInfo volume = cube();
    CHECK(camera_named(session, "tele", volume).fov_y_degrees == 12.5);
    CHECK(camera_named(session, "top", volume) == camera_looking("top", volume));
    CHECK(camera_named(session, "", volume) == camera_looking("front", volume));
    CHECK(camera_named(session, "tilted", volume) == camera_of(SideView{"left", 1.5, 30, -20}, volume));
    CHECK(camera_named(session, R"( {"side": "back", "zoom": 2})", volume) ==
          camera_of(SideView{.side = "back", .zoom = 2}, volume));
    session.cameras["front"] = SideView{.side = "bottom"};
    CHECK(camera_named(session, "", volume) == camera_looking("bottom", volume));
    CHECK_THROWS_WITH(
        camera_named(session, "frnt", volume),
        "camera is \"frnt\"; expected one of front, plan, tele, tilted, back, left, right, top, bottom, or "
        "a JSON object");
    CHECK_THROWS_WITH(camera_named(session, R"({"side": "back", "zoom": "x"})", volume),
                      "camera: key zoom is \"x\"; expected a number above 0 (0.001 ... 1000)");
    CHECK_THROWS_AS(camera_named(session, "{", volume), Error);
    // Without a choice: the side with the largest face, unless the session defines "front".
    VolumeInfo slices = volume;
    slices.spacing = {1, 1, 0.1};
    CHECK(camera_named(session, "", slices) == camera_looking("bottom", slices));
    session.cameras.erase("front");
    CHECK(camera_named(session, "", slices) == camera_looking("top", slices));
    CHECK(camera_named(session, "front", slices) == camera_looking("front", slices));
    for (const std::string& side : camera_sides())
        CHECK(parse(with("\"camera\": \"" + side + "\"")).camera_name == side);
}

TEST_CASE("cost of writing cameras is linear in their number")
{
    // CPU time of many cameras over that of few, on the same machine; the square would be 64.
    const auto seconds_for = [](int count) {
        Session session = parse(with(""));
        for (int i = 0; i < count; ++i) session.cameras[sentence("camera ", 100'000 + i)] = SideView{.side = "left"};
        double least = INFINITY;
        for (int i = 0; i < 3; ++i) {
            const std::clock_t begun = std::clock();
            CHECK(to_text(session, "/").size() > 20u * size_t(count));
            least = std::min(least, double(std::clock() - begun));
        }
        return least;
    };
    const double growth = seconds_for(24'000) / seconds_for(3'000);
    MESSAGE("8 times the cameras: " << growth << " times the CPU time");
    CHECK(growth < 16.0);
}

TEST_CASE("groups without an entry have ten colours in turn")
{
    CHECK(default_group(1).color != default_group(2).color);
    CHECK(default_group(1).color == default_group(11).color);
    CHECK(default_group(12).name == "group 12");
    CHECK(default_group(0).opacity == 0.0);
    const Session session = parse(EVERYTHING);
    CHECK(group_of(session.groups, 1).name == "aorta");
    CHECK(group_of(session.groups, 2) == default_group(2));
}

TEST_CASE("what is not set for a group comes from its parent, and a hidden parent hides all below it")
{
    const glm::dvec3 red(1.0, 0.0, 0.0), blue(0.0, 0.0, 1.0);
    Groups groups;
    groups[1] = {.name = "stem", .color = red, .opacity = 0.5};
    groups[2] = {.name = "leaf", .parent = 1, .color = blue};
    groups[3] = {.parent = 2, .opacity = 0.25};
    groups[4] = {.parent = 9};
    CHECK(group_of(groups, 2) == ColorGroup{"leaf", blue, 0.5, true});
    CHECK(group_of(groups, 3) == ColorGroup{"group 3", blue, 0.25, true});
    // A parent without its own entry has the default look.
    CHECK(group_of(groups, 4) == ColorGroup{"group 4", default_group(9).color, 1.0, true});
    groups[1].visible = false;
    for (const int group : {1, 2, 3}) CHECK_FALSE(group_of(groups, uint8_t(group)).visible);
    CHECK(group_of(groups, 4).visible);
    groups[1] = {.visible = true};
    CHECK(group_of(groups, 3) == ColorGroup{"group 3", blue, 0.25, true});
    groups.erase(2);
    CHECK(group_of(groups, 3) == ColorGroup{"group 3", default_group(2).color, 0.25, true});
    CHECK(is_within(groups, 3, 2));
    CHECK(is_within(groups, 3, 3));
    CHECK_FALSE(is_within(groups, 2, 3));
    CHECK_FALSE(group_in_cycle(groups));
    groups[2].parent = 3;
    CHECK(group_in_cycle(groups) == uint8_t{2});
}

TEST_CASE("the automatic transfer function shows the brighter class and hides the background")
{
    VolumeStatistics statistics;
    statistics.minimum = -1000.0;
    statistics.maximum = 1560.0;
    statistics.histogram.assign(256, 0);
    for (size_t bin = 0; bin < 20; ++bin) statistics.histogram[bin] = 50000;    // air
    for (size_t bin = 100; bin < 120; ++bin) statistics.histogram[bin] = 8000;  // tissue
    statistics.histogram[255] = 10;                                             // metal
    const TransferFunction function = automatic_transfer_function(statistics);
    CHECK_FALSE(function.draws_nothing());
    CHECK(function.at(-801.0).a == 0.0);
    CHECK(function.at(-1000.0 + 10.0 * 110).a > 0.1);
    CHECK(function.at(1560.0).a > 0.1);
    const TransferFunction again = automatic_transfer_function(statistics);
    CHECK(std::ranges::equal(function.points(), again.points()));
}

TEST_CASE("the automatic transfer function draws something whatever the histogram")
{
    VolumeStatistics constant;
    constant.minimum = constant.maximum = 128.0;
    constant.histogram.assign(256, 0);
    constant.histogram[0] = 1000;
    CHECK(automatic_transfer_function(constant).at(128.0).a > 0.0);
    CHECK(automatic_transfer_function({}).at(0.0).a > 0.0);
    for (size_t spike = 0; spike < 256; ++spike) {
        VolumeStatistics statistics;
        statistics.minimum = 0.0;
        statistics.maximum = 256.0;
        statistics.histogram.assign(256, 0);
        statistics.histogram[0] = statistics.histogram[255] = 1;
        statistics.histogram[spike] += 100000;
        const TransferFunction function = automatic_transfer_function(statistics);
        CAPTURE(spike);
        CHECK_FALSE(function.draws_nothing());
        CHECK(function.lower() > 0.0);
        CHECK(function.upper() == 256.0);
        CHECK(function.at(255.9).a > 0.0);
    }
}

TEST_CASE("a session file is opened with its volume, and gets a transfer function where it has none")
{
    const TemporaryFolder folder;
    const std::string volume = R"("shvr_session": 1, "volume": {"procedural": "sphere", "size": [16, 12, 8]})";
    const OpenedSession bare = open_session(folder.write("bare.json", "{" + volume + "}"));
    CHECK(bare.source->info().size == Size3(16, 12, 8));
    CHECK_FALSE(bare.session.transfer_function.draws_nothing());
    REQUIRE(bare.warnings.size() == 1);
    CHECK(bare.warnings[0].starts_with("no transfer function given; "));

    const std::string points = R"("transfer_function": {"points": []})";
    const OpenedSession empty = open_session(folder.write("empty.JSON", "{" + volume + ", " + points + "}"));
    CHECK(empty.warnings.empty());
    CHECK(empty.session.transfer_function.draws_nothing());

    const OpenedSession set =
        open_session(folder.path / "bare.json", {"volume.size.1=20", points.substr(1, 17) + "={\"points\": []}"});
    CHECK(set.source->info().size == Size3(16, 20, 8));
    CHECK(set.warnings.empty());
}

TEST_CASE("a project folder opens its session, and bare voxels open with their layout set")
{
    const TemporaryFolder folder;
    folder.write("project/shvr/session.json",
                 R"({"shvr_session": 1, "volume": {"path": "../v.raw", "raw": "2x3x4:uint8"}})");
    folder.write("project/v.raw", std::string(24, 'x'));
    const OpenedSession project = open_session(folder.path / "project");
    CHECK(project.source->info().size == Size3(2, 3, 4));
    CHECK(project.session.volume_path == fs::absolute(folder.path / "project/v.raw").lexically_normal());

    const OpenedSession raw = open_session(folder.path / "project/v.raw",
                                           {"volume.raw=4x3x2:uint8", "volume.spacing=[1,2,3]", "render.size.0=100"});
    CHECK(raw.source->info().size == Size3(4, 3, 2));
    CHECK(raw.source->info().spacing == glm::dvec3(1, 2, 3));
    CHECK(raw.session.render.size.x == 100);
    CHECK(raw.warnings.size() == 1);
}

TEST_CASE("paths that open nothing are refused with what was expected")
{
    const TemporaryFolder folder;
    const auto refused = [&](const fs::path& path, const std::string& sentence) {
        CHECK_THROWS_WITH_AS(open_session(path), doctest::Contains(sentence.c_str()), Error);
    };
    refused(folder.path / "absent.json", "absent.json: does not exist; expected a session file (.json)");
    refused(folder.path, ": is a folder without shvr/session.json and without a volume; expected a project");
    refused(folder.write("broken.json", "{"), "broken.json: is not JSON");
    refused(folder.write("large.json", std::string((16 << 20) + 1, ' ')), "large.json");
    refused(folder.write("wrong.json", with(R"("render": {"size": 3})")), "wrong.json: key render.size is 3");
}

// Kind (Sessions): a session with adaptive pictures, which lost thin features and were removed
TEST_CASE("a session with an option that was removed opens as without it, and says so")
{
    const TemporaryFolder folder;
    const std::string volume = R"("shvr_session": 1, "volume": {"procedural": "tubes", "size": [8, 8, 8]})";
    const fs::path old = folder.write("old.json", "{" + volume + R"(, "render": {"adaptive_tolerance": 0.05}})");
    const fs::path now = folder.write("now.json", "{" + volume + "}");
    const std::string said =
        ": render.adaptive_tolerance is ignored, as the option was removed and every pixel has a ray of its own; "
        "leave it out";
    const OpenedSession opened = open_session(old), plain = open_session(now);
    CHECK(opened.session.render == plain.session.render);
    CHECK(opened.removed == std::vector{old.string() + said});
    CHECK(plain.removed.empty());
    CHECK(to_text(opened.session, folder.path).find("adaptive") == std::string::npos);
    CHECK(open_session(now, {"render.adaptive_tolerance=0.05"}).removed == std::vector{"--set" + said});
    CHECK(open_session(now, {R"(render={"adaptive_tolerance": 2})"}).removed == std::vector{"--set" + said});
    CHECK(open_unmeasured_session(old).removed == opened.removed);
}

TEST_CASE("measurements are read as written, and distances of earlier versions become such")
{
    const auto session_of = [](const std::string& measurements) {
        return parse_session(
            R"({"shvr_session": 1, "volume": {"procedural": "sphere"}, "measurements": )" + measurements + "}", "/",
            "s.json");
    };
    const Session old = session_of(R"([{"from": [1, 2, 3.5], "to": [4, 5, 6]}])");
    REQUIRE(old.measurements.size() == 1);
    CHECK(old.measurements[0] == Measurement{{{1, 2, 3.5}, {4, 5, 6}}});
    const Session now =
        session_of(R"([{"name": "a \"b\"", "kind": "angle", "points": [[1, 2, 3.25], [4, 5, 6], [7, 8, 1e-7]]}])");
    const Session again = parse_session(to_text(now, "/"), "/", "written");
    CHECK(again.measurements == now.measurements);
    CHECK(again.measurements[0].name == "a \"b\"");
    CHECK(parse_session(to_text(old, "/"), "/", "written").measurements == old.measurements);
    CHECK(to_text(old, "/").find("\"from\": [1.0,2.0,3.5]") != std::string::npos);  // earlier versions read it, too
}
