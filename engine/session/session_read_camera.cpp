// The cameras of a session file.

#include "engine/session/session_read.h"

#include <cmath>

#include <nlohmann/json.hpp>

namespace shvr {

namespace {

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

}  // namespace

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

}  // namespace shvr
