// Draws a random part of the pixels of a picture with the double-precision reference renderer: what pictures of large
// scenes are measured against (README.md).

#include <charconv>
#include <cstdio>
#include <random>
#include <unordered_set>

#include <nlohmann/json.hpp>

#include "engine/annotation/files/mask_file.h"
#include "engine/annotation/mask.h"
#include "engine/base/atomic_file.h"
#include "engine/base/error.h"
#include "engine/bricks/code_rows.h"
#include "engine/session/session.h"
#include "shaders/raycast.h"
#include "tests/reference/render.h"

namespace shvr {

namespace {

constexpr double LARGEST_CODE = 65535.0;

constexpr const char* USAGE =
    "usage: shvr_reference_picture SESSION -o OUT.json [--camera NAME|JSON] [--pixels 2000] [--seed 1]\n"
    "                              [--mode exact|discrete] [--step REFERENCE-LENGTHS] [--set KEY=VALUE]...\n";

struct Options {
    std::string session, output, camera, mode = "exact";
    uint64_t pixels = 2000;
    uint64_t seed = 1;
    double step = 0.0;  ///< 0: the session's
    std::vector<std::string> settings;
};

template <class Number>
Number number_of(const std::string& name, const std::string& text)
{
    Number number{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc() || end != text.data() + text.size() || !(number > Number{0}))
        throw UsageError(sentence(name, " is '", text, "'; expected a number above 0"));
    return number;
}

Options parse(std::span<char*> arguments)
{
    Options options;
    for (size_t i = 0; i < arguments.size(); ++i) {
        const std::string name = arguments[i];
        if (!name.starts_with('-')) {
            options.session = name;
            continue;
        }
        if (i + 1 == arguments.size()) throw UsageError(sentence(name, " lacks its value"));
        const std::string value = arguments[++i];
        if (name == "-o")
            options.output = value;
        else if (name == "--camera")
            options.camera = value;
        else if (name == "--pixels")
            options.pixels = number_of<uint64_t>(name, value);
        else if (name == "--seed")
            options.seed = number_of<uint64_t>(name, value);
        else if (name == "--mode")
            options.mode = value;
        else if (name == "--step")
            options.step = number_of<double>(name, value);
        else if (name == "--set")
            options.settings.push_back(value);
        else
            throw UsageError(sentence(name, " is no option"));
    }
    if (options.session.empty() || options.output.empty()) throw UsageError("SESSION or -o is missing");
    if (options.mode != "exact" && options.mode != "discrete")
        throw UsageError(sentence("--mode is '", options.mode, "'; expected exact or discrete"));
    return options;
}

/// The codes that the device holds, from 0 to 1.
std::vector<double> densities(const VolumeSource& source, const IntensityWindow& window)
{
    const VolumeInfo& info = source.info();
    const CodeRows rows(info.type, window);
    const auto slice_voxels = size_t(info.size.x * info.size.y);
    std::vector<std::byte> voxels(slice_voxels * bytes_of(info.type));
    std::vector<uint16_t> codes(slice_voxels);
    std::vector<double> density;
    density.reserve(size_t(voxel_count(info)));
    for (int64_t z = 0; z < info.size.z; ++z) {
        source.read({{0, 0, z}, {info.size.x, info.size.y, z + 1}}, voxels);
        rows.convert(voxels, codes);
        for (const uint16_t code : codes) density.push_back(code / LARGEST_CODE);
    }
    return density;
}

std::vector<uint8_t> labels(const std::filesystem::path& path, const Size3& size)
{
    Mask mask(size);
    for (const MaskBrickChange& change : load_mask(path, size)) mask.apply(change, Direction::forwards);
    std::vector<uint8_t> labels;
    labels.reserve(size_t(size.x * size.y * size.z));
    for (int64_t z = 0; z < size.z; ++z)
        for (int64_t y = 0; y < size.y; ++y)
            for (int64_t x = 0; x < size.x; ++x) labels.push_back(mask.at({x, y, z}));
    return labels;
}

/// Lights move with the camera; 0, 0, 0 is over the viewer's shoulder.
glm::dvec3 to_light(const glm::dvec3& stated, const Camera& camera)
{
    const glm::dvec3 along = stated == glm::dvec3(0.0) ? glm::dvec3(0.3, 0.5, 1.0) : stated;
    const glm::dvec3 back = glm::normalize(camera.eye - camera.target);
    const glm::dvec3 right = glm::normalize(glm::cross(camera.up, back));
    return glm::dmat3(right, glm::cross(back, right), back) * along;
}

reference::Scene scene_of(const Session& session, const VolumeSource& source, const Camera& camera)
{
    const VolumeInfo& info = source.info();
    const VolumeStatistics statistics = measure(source);
    const IntensityWindow window = window_for(info.type, statistics.range().lower, statistics.range().upper);
    reference::Scene scene{.size = glm::ivec3(info.size),
                           .density = densities(source, window),
                           .spacing = info.spacing,
                           .cut_min = session.cut.lower,
                           .cut_max = session.cut.upper};
    for (const ControlPoint& point : session.transfer_function.points())
        scene.points.push_back({window.code_of(point.intensity) / LARGEST_CODE, point.color, point.opacity});
    if (!session.mask_path.empty() && std::filesystem::exists(session.mask_path)) {
        scene.labels = labels(session.mask_path, info.size);
        for (size_t i = 1; i < scene.groups.size(); ++i) {
            const ColorGroup group = group_of(session.groups, uint8_t(i));
            scene.groups[i] = {group.color, group.opacity, group.visible};
        }
    }
    if (session.light.shaded) {
        const double range = window.code_of(statistics.range().upper) - window.code_of(statistics.range().lower);
        scene.shading = {.ambient = session.light.ambient,
                         .diffuse = session.light.diffuse,
                         .specular = session.light.specular,
                         .shininess = session.light.shininess,
                         .fade = session.light.gradient_fade * range / LARGEST_CODE,
                         .to_light = to_light(session.light.direction, camera)};
    }
    return scene;
}

/// Different pixels, equal for equal seeds; all of them where that many are asked for.
std::vector<glm::uvec2> some_pixels(const glm::uvec2& size, uint64_t count, uint64_t seed)
{
    const uint64_t all = uint64_t(size.x) * size.y;
    std::vector<glm::uvec2> pixels;
    std::unordered_set<uint64_t> taken;
    std::mt19937_64 random(seed);
    while (pixels.size() < std::min(count, all)) {
        // Distributions of the standard library differ between libraries; the bias of % is of no account here.
        const uint64_t pixel = count >= all ? pixels.size() : random() % all;
        if (taken.insert(pixel).second) pixels.emplace_back(pixel % size.x, pixel / size.x);
    }
    return pixels;
}

std::vector<reference::Ray> rays_through(std::span<const glm::uvec2> pixels, const RayPlanes& planes)
{
    std::vector<reference::Ray> rays;
    for (const glm::uvec2& pixel : pixels) {
        const glm::dvec2 centre = glm::dvec2(pixel) + 0.5;
        const glm::dvec3 near = planes.near_corner + centre.x * planes.near_dx + centre.y * planes.near_dy;
        const glm::dvec3 far = planes.far_corner + centre.x * planes.far_dx + centre.y * planes.far_dy;
        const glm::dvec3 direction = planes.empty ? glm::dvec3(0.0) : far - near;
        rays.push_back({.origin = near, .direction = direction, .t_min = 0.0, .t_max = 1.0});
    }
    return rays;
}

/// At most one code between two entries, and 4096 at least.
uint32_t table_entries_of(const reference::Scene& scene)
{
    double first = 1.0, last = 0.0;
    for (const reference::ControlPoint& point : scene.points)
        first = std::min(first, point.x), last = std::max(last, point.x);
    const double codes = std::ceil(65535.0 * (std::min(last, 1.0) - std::max(first, 0.0)));
    return std::max(uint32_t(std::max(codes, 0.0)) + 1, 4096u);
}

reference::Mode mode_of(const Options& options, const Session& session, const reference::Scene& scene)
{
    if (options.mode == "exact") return reference::ExactOptions{};
    return reference::DiscreteOptions{.step = options.step > 0.0 ? options.step : session.render.step_voxels,
                                      .stop_opacity = session.render.opacity_limit,
                                      .table_entries = table_entries_of(scene)};
}

void run(const Options& options)
{
    const OpenedSession opened = open_session(options.session, options.settings);
    const Session& session = opened.session;
    const std::string& camera_name = options.camera.empty() ? session.camera_name : options.camera;
    const Camera camera = camera_named(session, camera_name, opened.source->info());
    const reference::Scene scene = scene_of(session, *opened.source, camera);
    const glm::uvec2 size = session.render.size;
    const std::vector<glm::uvec2> pixels = some_pixels(size, options.pixels, options.seed);
    const std::vector<reference::Ray> rays = rays_through(pixels, ray_planes(camera, size, opened.source->info()));
    const std::vector<glm::dvec4> lights = reference::render(scene, rays, mode_of(options, session, scene), 2);

    nlohmann::ordered_json written{
        {"size", {size.x, size.y}}, {"mode", options.mode}, {"pixels", nlohmann::json::array()}};
    for (size_t i = 0; i < pixels.size(); ++i) {
        // The reference's own backgrounds are opaque.
        const double through = (1.0 - lights[i].a) * session.render.background.a;
        const glm::dvec4 pixel = lights[i] + through * glm::dvec4(glm::dvec3(session.render.background), 1.0);
        written["pixels"].push_back({pixels[i].x, pixels[i].y, pixel.r, pixel.g, pixel.b, pixel.a});
    }
    const std::string text = written.dump() + "\n";
    write_file_atomically(options.output, std::as_bytes(std::span(text)));
}

}  // namespace

}  // namespace shvr

int main(int argc, char** argv)
{
    try {
        shvr::run(shvr::parse(std::span(argv, size_t(argc)).subspan(1)));
        return 0;
    } catch (const shvr::UsageError& error) {
        std::fprintf(stderr, "shvr_reference_picture: %s\n%s", error.what(), shvr::USAGE);
        return 2;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "shvr_reference_picture: %s\n", error.what());
        return 1;
    }
}
