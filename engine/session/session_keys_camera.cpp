// The keys of cameras, and of the looks kept with them, in a session file.

#include <algorithm>
#include <cmath>
#include <set>

#include <nlohmann/json.hpp>

#include "engine/session/session_keys.h"

namespace shvr {
namespace {

std::vector<std::string_view> views_of(const std::vector<std::string>& texts)
{
    return {texts.begin(), texts.end()};
}

}  // namespace

bool is_camera_object(const std::string& name_or_json)
{
    const size_t begin = name_or_json.find_first_not_of(" \t\r\n");
    return begin != std::string::npos && name_or_json[begin] == '{';
}

void fields(Fields& f, SideView& view)
{
    const std::vector<std::string> sides = camera_sides();
    f.choice("side", view.side, views_of(sides),
             {.meaning =
                  "side from which the volume is seen: -y (front), +y (back), -x (left), +x (right) with z up; +z "
                  "(top), -z (bottom) with y up. The volume's bounding sphere fits a square picture with 5 % to spare",
              .standard = "instead of the keys above"});
    f.number("zoom", view.zoom, above_zero(1e-3, 1e3), {"with `side`: divisor of the eye's distance"});
    f.number("turn_degrees", view.turn_degrees, {-360.0, 360.0},
             {"with `side`: rotation of the eye around the volume, to the viewer's right", "degrees"});
    f.number("tilt_degrees", view.tilt_degrees, {-90.0, 90.0},
             {"with `side`: elevation of the eye after that; 90 looks straight down", "degrees"});
}

void fields(Fields& f, Camera& camera)
{
    constexpr const char* UNITS = "physical units";
    f.choice("projection", camera.projection, {"projection of the camera"});
    f.vector("eye", camera.eye, COORDINATE, {.meaning = "position of the eye", .allowed = UNITS, .is_required = true});
    f.vector("target", camera.target, COORDINATE,
             {.meaning = "point that the eye looks at", .allowed = UNITS, .is_required = true});
    f.vector("up", camera.up, COORDINATE,
             {.meaning = "up direction of the picture; not parallel to the view", .allowed = "any length but 0"});
    if (camera.projection == Camera::Projection::perspective)
        f.number("fov_y_degrees", camera.fov_y_degrees,
                 {1e-12, std::nextafter(180.0, 0.0), "a number of degrees above 0 and below 180"},
                 {.meaning = "perspective: full vertical angle", .allowed = "degrees, above 0, below 180"});
    else
        f.number(
            "height", camera.height, above_zero(1e-12, 1e15),
            {.meaning = "orthographic: height of the view", .allowed = "physical units, above 0", .is_required = true});
    f.number(
        "near", camera.near_distance, {0.0, 1e15},
        {.meaning = "distance of the near clip plane from the eye, along the view; nothing behind the eye is visible",
         .allowed = "physical units, 0 or more"});
    f.number("far", camera.far_distance, {0.0, 1e15},
             {.meaning = "distance of the far clip plane; 0: none", .allowed = "physical units, 0 or more"});
    const About about{.meaning = "off-axis shift of the picture's centre to the right of the line from eye to target",
                      .unit = "heights of the view",
                      .standard = "0"};
    std::optional<double> shift = camera.shift_right == 0.0 ? std::nullopt : std::optional(camera.shift_right);
    f.number("shift_right", shift, {-1e3, 1e3}, about);
    camera.shift_right = shift.value_or(0.0);
    f.checked([&] { check_camera(camera); });
}

void fields(Fields& f, CameraSpec& camera)
{
    const bool is_side = f.has("side", std::holds_alternative<SideView>(camera));
    if (is_side != std::holds_alternative<SideView>(camera)) {
        if (is_side)
            camera = SideView{};
        else
            camera = Camera{};
    }
    if (!is_side) f.mention("side", {});
    std::visit([&](auto& form) { fields(f, form); }, camera);
}

void camera_fields(Fields& f, Session& session)
{
    bool is_given = false, is_object = false;
    const auto read = [&](const JsonNode& node) {
        is_given = true;
        is_object = node.is_object();
        if (is_object) read_camera(node);
        session.camera_name = is_object ? node.dump() : node.is_text() ? node.any_text() : "";
    };
    const auto written = [&]() -> std::optional<std::string> {
        const std::string& name = session.camera_name;
        if (name.empty()) return {};
        return is_camera_object(name) ? name : nlohmann::json(name).dump();
    };
    f.other("camera", read, written,
            {.meaning = "camera in use: the name of one of `cameras`, a side, or a camera object",
             .allowed = "name or object",
             .standard = "`\"front\"`, or for a stack of few slices `\"top\"` or `\"right\"`"});

    std::vector<std::string> names;
    for (const auto& [name, camera] : session.cameras) names.push_back(name);
    const auto visit = [&](Fields& entry, const std::string& name) {
        entry.check("", !name.empty() && !is_camera_object(name),
                    "a camera whose name is not empty and does not begin with {");
        fields(entry, session.cameras[name]);
    };
    f.entries("cameras", names, "NAME", visit,
              {.meaning = "named camera in one of the three forms below; the name of a side redefines that side",
               .allowed = "object",
               .standard = "none"});

    if (!is_given || is_object) return;
    const std::vector<std::string> sides = camera_sides();
    std::set<std::string> known(sides.begin(), sides.end());
    for (const auto& [name, camera] : session.cameras) known.insert(name);
    std::string list;
    for (const std::string& name : known) list += (list.empty() ? "one of \"" : ", \"") + name + "\"";
    f.check("camera", known.contains(session.camera_name), list);
}

void fields(Fields& f, KeyLook& look)
{
    const Fields::Visit points = [&](Fields& function) {
        points_field(function, look.transfer_function, {.meaning = "control points", .is_required = true});
    };
    f.section("transfer_function", points, {.is_required = true});
    fields(f, look.groups);
    f.section("unpainted", look.unpainted);
    f.section("light", look.light);
    f.section("blend", look.blend);
    f.section("cut", look.cut);
}

void key_look_fields(Fields& f, Session& session, bool writes_none)
{
    const auto read = [&](const JsonNode& node) {
        session.key_looks.clear();
        for (const std::string& view : node.names())
            read_fields(node[view], {}, [&](Fields& look) { fields(look, session.key_looks[view]); });
    };
    const auto written = [&]() -> std::optional<std::string> {
        if (session.key_looks.empty() && !writes_none) return {};
        std::string text;
        for (auto& [view, kept] : session.key_looks) {
            KeyLook& look = kept;
            text += (text.empty() ? "{" : ",") + nlohmann::json(view).dump() + ":" +
                    write_fields({}, [&look](Fields& each) { fields(each, look); });
        }
        return text.empty() ? "{}" : text + "}";
    };
    f.other("key_looks", read, written,
            {.meaning =
                 "looks kept with views, by the view's name: what movies show from its camera, and mix on the way to "
                 "other views. Each has `transfer_function` (with `points`), and `groups`, `unpainted`, `light`, "
                 "`blend` and `cut`, with the keys and defaults that they have here",
             .allowed = "object of objects",
             .standard = "none"});
}

}  // namespace shvr
