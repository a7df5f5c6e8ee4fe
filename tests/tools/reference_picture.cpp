// Draws a random part of the pixels of a picture with the double-precision reference renderer, against which pictures
// of large scenes are measured (README.md).

#include <charconv>
#include <cstdio>
#include <random>
#include <unordered_set>

#include <nlohmann/json.hpp>

#include "engine/annotation/files/mask_file.h"
#include "engine/annotation/mask.h"
#include "engine/base/atomic_file.h"
#include "engine/base/error.h"
#include "engine/session/session.h"
#include "tools/bench/reference_scene.h"

namespace shvr {

namespace {

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

/// Reads the session's mask file; null if it has none.
std::optional<Mask> mask_of(const Session& session, const Size3& size)
{
    if (session.mask_path.empty() || !std::filesystem::exists(session.mask_path)) return std::nullopt;
    Mask mask(size);
    for (const MaskBrickChange& change : load_mask(session.mask_path, size)) mask.apply(change, Direction::forwards);
    return mask;
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
    const std::optional<Mask> mask = mask_of(session, opened.source->info().size);
    const bench::ReferenceScene scene =
        bench::reference_scene_of(session, *opened.source, measure(*opened.source), camera, mask ? &*mask : nullptr);
    const glm::uvec2 size = session.render.size;
    const std::vector<glm::uvec2> pixels = some_pixels(size, options.pixels, options.seed);
    const std::vector<reference::Ray> rays =
        bench::rays_through(pixels, ray_planes(camera, size, opened.source->info()));
    const std::vector<glm::dvec4> lights =
        bench::draw(scene, rays, mode_of(options, session, scene.scene), session.render.background, 2);

    nlohmann::ordered_json written{
        {"size", {size.x, size.y}}, {"mode", options.mode}, {"pixels", nlohmann::json::array()}};
    for (size_t i = 0; i < pixels.size(); ++i) {
        const glm::dvec4& pixel = lights[i];
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
