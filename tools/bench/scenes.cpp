#include "tools/bench/scenes.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numeric>
#include <random>

#include <nlohmann/json.hpp>

#include "engine/base/file.h"
#include "engine/base/json.h"
#include "engine/base/text.h"
#include "engine/session/quality.h"

namespace shvr::bench {

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* FAMILIES[] = {"quality", "step",      "pre-integrated", "opacity limit", "sampling", "resolution",
                                    "coarse",  "skipping",  "occlusion rays", "budget",        "detail",   "mixed",
                                    "VTK",     "VTK OpenGL"};
constexpr int64_t MAX_SESSION_BYTES = 1 << 20;
/// Shading as other programs define it: without highlights, and without fading where there is no surface.
Json matt()
{
    return {{"light", {{"specular", 0}, {"gradient_fade", 0}}}};
}

struct Point {
    double intensity, opacity;
};

Json points_of(std::initializer_list<Point> points, const char* color = "#f0d8b8")
{
    Json list = Json::array();
    for (const Point& point : points)
        list.push_back({{"intensity", point.intensity}, {"color", color}, {"opacity", point.opacity}});
    return {{"points", list}};
}

/// The session of several scenes: tubes, surrounded by air with noise (mean 40, standard deviation 5.4).
Json session_of(int64_t side, const glm::uvec2& pixels, const Json& function)
{
    return {{"shvr_session", 1},
            {"volume", {{"procedural", "tubes"}, {"size", {side, side, side}}, {"seed", 3}}},
            {"camera", {{"side", "front"}, {"zoom", 1.4}, {"turn_degrees", 30}, {"tilt_degrees", 20}}},
            {"transfer_function", function},
            {"render", {{"size", {pixels.x, pixels.y}}, {"background", "#000000"}}}};
}

Scene scene_of(const std::string& name, const std::string& what, const Json& session)
{
    return {.name = name,
            .what = what,
            .drawn = {.name = name,
                      .folder = ".",
                      .why = what,
                      .loosened = {},
                      .session_path = {},
                      .session_text = session.dump(),
                      .settings = {},
                      .script = {}}};
}

ScriptOp line_of_script(const std::string& text)
{
    const JsonDocument document(text, "bench");
    return read_script_op(document.root());
}

struct Example {
    const char *name, *what;
};
constexpr Example EXAMPLES[] = {{"stent", "a scan: CT of a stent in an aorta"},
                                {"cranium", "a scan: CT of a head, opaque bone in translucent skin"}};

std::string scene_names(const std::vector<Scene>& own)
{
    std::string names;
    for (const Scene& scene : own) names += scene.name + ", ";
    for (const Example& example : EXAMPLES) names += sentence(example.name, ", ", example.name, "-matt, ");
    return names.substr(0, names.size() - 2);
}

/// Returns a scene of the example that tools/fetch_example downloaded, without paint. `is_matt`: also without
/// highlights and fading. Fails if the example is missing.
Scene example_scene(const Example& example, bool is_matt, const SceneChoice& choice)
{
    const std::filesystem::path folder = choice.examples / example.name / "shvr";
    if (!is_file(folder / "session.json"))
        fail("scene ", example.name, ": ", (folder / "session.json").string(),
             " is missing; expected the scan, which tools/fetch_example ", example.name, " gets");
    Json session = Json::parse(read_text(folder / "session.json", MAX_SESSION_BYTES));
    session.erase("annotation");
    session["render"]["size"] = {choice.pixels.x, choice.pixels.y};
    for (const std::string_view key : keys_of_quality()) session["render"].erase(std::string(key));
    if (is_matt) session.merge_patch(matt());
    Scene scene = scene_of(example.name + std::string(is_matt ? "-matt" : ""),
                           example.what + std::string(is_matt ? ", matt: as VTK can draw it, too" : ""), session);
    scene.drawn.folder = folder;
    return scene;
}

Scene painted_scene(const Json& session, int64_t side)
{
    Scene scene = scene_of("painted", "painted groups in translucent tissue", session);
    constexpr double MOST = 127.0;  // voxels that a brush reaches
    const double middle = 0.5 * double(side), radius = std::min(0.3 * double(side), MOST);
    const auto stroke = [&](int group, double x) {
        return line_of_script(Json{{"op", "paint"},
                                   {"brush", "fill"},
                                   {"region", "ball"},
                                   {"group", group},
                                   {"threshold", 60},
                                   {"radius", radius},
                                   {"path", Json::array({{x, middle, middle}})}}
                                  .dump());
    };
    scene.drawn.script = {{1, stroke(1, 0.35 * double(side))}, {2, stroke(2, 0.7 * double(side))}};
    return scene;
}

}  // namespace

std::span<const char* const> families()
{
    return FAMILIES;
}

std::vector<Scene> own_scenes(int64_t side, const glm::uvec2& pixels)
{
    const auto made = [&](const Json& function, const Json& more = Json::object()) {
        Json session = session_of(side, pixels, function);
        session.merge_patch(more);
        return session;
    };
    const Json opaque = points_of({{120, 0.0}, {160, 1.0}, {255, 1.0}});
    const int64_t several = std::max<int64_t>(side, 64);  // bricks have 32 voxels a side
    const Json tissue = points_of({{38, 0.0}, {120, 0.06}, {255, 0.2}});
    std::vector<Scene> scenes;
    scenes.push_back(scene_of("tubes", "clean opaque tubes: most of the volume is empty and leapt over", made(opaque)));
    scenes.push_back(scene_of("noisy-surface",
                              "an opaque surface whose threshold lies in the noise: hardly a cell is empty, and most "
                              "samples show nothing",
                              made(points_of({{50, 0.0}, {58, 1.0}, {255, 1.0}}))));
    scenes.push_back(scene_of("tissue", "dense half-transparent tissue, shaded: nothing to leap over", made(tissue)));
    scenes.push_back(scene_of("fog", "smooth fog without shading: every sample counts a little",
                              made(points_of({{60, 0.0}, {160, 0.08}}),
                                   {{"volume", {{"procedural", "fog"}}}, {"light", {{"shaded", false}}}})));
    scenes.push_back(scene_of("peaks", "narrow peaks in a function of high frequency: steps miss them",
                              made(points_of({{90, 0.0}, {94, 0.6}, {98, 0.0}, {150, 0.0}, {153, 0.8}, {156, 0.0}}),
                                   {{"volume", {{"procedural", "marschner_lobb"}}}})));
    scenes.push_back(scene_of("uint16", "voxels of 16 bits, a soft surface",
                              made(points_of({{90, 0.0}, {200, 0.8}}), {{"volume", {{"type", "uint16"}}}})));
    scenes.push_back(scene_of("anisotropic", "voxels 2.5 times as long along z",
                              made(tissue, {{"volume",
                                             {{"size", {side, side, std::max<int64_t>(side * 2 / 5, 8)}},
                                              {"spacing", {1, 1, 2.5}},
                                              {"unit", "um"}}}})));
    scenes.push_back(scene_of("paged", "bricks that are paged at a small budget",
                              made(tissue, {{"volume", {{"size", {several, several, several}}}},
                                            {"render", {{"paging", "always"}, {"detail", 0}}}})));
    scenes.back().budget_device = uint64_t{24} << 20;
    scenes.push_back(painted_scene(
        made(tissue, {{"groups", {{"1", {{"color", "#e03030"}}}, {"2", {{"color", "#3080ff"}, {"opacity", 0.15}}}}}}),
        side));
    scenes.push_back(scene_of("occluded", "local ambient occlusion of opaque tubes",
                              made(opaque, {{"light", {{"occlusion", {{"strength", 0.8}, {"radius", 6}}}}}})));
    const double unit = double(side) / 64.0;
    Json balls = Json::array();
    for (int i = 0; i < 5; ++i)
        balls.push_back({{"from", {(14 + 9 * i) * unit, (30 + 3 * i) * unit, (20 + 6 * i) * unit}},
                         {"radius", (4 + i) * unit},
                         {"color", i % 2 ? "#ff6020" : "#40c0ff"}});
    scenes.push_back(scene_of("surfaces", "opaque balls in translucent tissue", made(tissue, {{"surfaces", balls}})));
    // Three of the scenes above, shaded as other programs do.
    const Json noisy = points_of({{50, 0.0}, {58, 1.0}, {255, 1.0}});
    scenes.push_back(
        scene_of("tubes-matt", "the clean opaque tubes, matt: as VTK can draw them, too", made(opaque, matt())));
    scenes.push_back(scene_of("noisy-surface-matt", "the opaque surface in the noise, matt: as VTK can draw it, too",
                              made(noisy, matt())));
    scenes.push_back(
        scene_of("tissue-matt", "the half-transparent tissue, matt: as VTK can draw it, too", made(tissue, matt())));
    return scenes;
}

ChosenScenes chosen_scenes(const SceneChoice& choice)
{
    const std::vector<Scene> own = own_scenes(choice.side, choice.pixels);
    ChosenScenes chosen;
    if (choice.names.empty()) {
        chosen.scenes = own;
        for (const Example& example : EXAMPLES)
            for (const bool is_matt : {false, true}) try {
                    chosen.scenes.push_back(example_scene(example, is_matt, choice));
                } catch (const shvr::Error& missing) {
                    if (!is_matt) chosen.left_out.push_back(missing.what());
                }
        return chosen;
    }
    for (const std::string& name : choice.names) {
        const auto found = std::ranges::find(own, name, &Scene::name);
        if (found != own.end()) {
            chosen.scenes.push_back(*found);
            continue;
        }
        const auto is_named = [&](const Example& example) {
            return name == example.name || name == std::string(example.name) + "-matt";
        };
        if (const auto* const example = std::ranges::find_if(EXAMPLES, is_named); example != std::end(EXAMPLES)) {
            chosen.scenes.push_back(example_scene(*example, name != example->name, choice));
            continue;
        }
        if (!std::filesystem::exists(name))
            fail("--scenes: ", in_quotes(name), " is neither a scene (", scene_names(own),
                 ") nor the path of a session");
        const std::string stem = std::filesystem::path(name).stem().string();
        chosen.scenes.push_back({.name = stem,
                                 .what = "session " + name,
                                 .drawn = {.name = stem,
                                           .folder = ".",
                                           .why = name,
                                           .loosened = {},
                                           .session_path = name,
                                           .session_text = {},
                                           .settings = {},
                                           .script = {}}});
        chosen.scenes.back().drawn.settings = {sentence("render.size=[", choice.pixels.x, ",", choice.pixels.y, "]")};
    }
    return chosen;
}

std::vector<Run> runs_of(const Scene& scene, bool quick)
{
    std::vector<Run> runs;
    for (const Quality& quality : qualities())
        runs.push_back({quality.name, "quality", {sentence("render.quality=", quality.name)}});
    const auto sweep = [&](const char* family, const char* key, std::initializer_list<double> all,
                           std::initializer_list<double> few, const std::vector<std::string>& more = {}) {
        for (const double value : quick ? few : all) {
            runs.push_back({sentence(family, " ", digits_of(value)), family, more});
            runs.back().settings.push_back(sentence(key, "=", digits_of(value)));
        }
    };
    sweep("step", "render.step_voxels", {8, 5.6, 4, 2.8, 2, 1.4, 1, 0.85, 0.7, 0.6, 0.5, 0.35, 0.25, 0.125, 0.0625},
          {2, 1, 0.5, 0.25, 0.125, 0.0625});
    sweep("pre-integrated", "render.step_voxels", {1, 0.5, 0.25, 0.125, 0.0625}, {1, 0.25, 0.0625},
          {"render.preintegration=true"});
    sweep("opacity limit", "render.opacity_limit", {0.9, 0.95, 0.99, 0.999755859375, 1}, {0.9});
    for (const char* sampling : {"exact", "hardware"})
        runs.push_back({sentence("sampling ", sampling), "sampling", {sentence("render.sampling=", sampling)}});
    for (const double scale : quick ? std::vector{0.5} : std::vector{0.7, 0.5, 0.35})
        runs.push_back({sentence("resolution ", digits_of(scale)), "resolution", {}, scale});
    // Settings coarser than in practice, to find the cost of errors as large as the comparison program's.
    const auto coarse = [&](double scale, double step, bool preintegration) {
        runs.push_back(
            {sentence("coarse ", digits_of(scale), preintegration ? ", pre-integrated " : ", step ", digits_of(step)),
             "coarse",
             {sentence("render.step_voxels=", digits_of(step))},
             scale});
        if (preintegration) runs.back().settings.emplace_back("render.preintegration=true");
    };
    coarse(0.7, 1.0, false);
    coarse(0.5, 2.0, false);
    if (!quick)
        for (const double scale : {0.7, 0.5, 0.35}) {
            coarse(scale, 4.0, false);
            coarse(scale, 3.0, false);
            coarse(scale, 1.0, true);
            if (scale != 0.5) coarse(scale, 2.0, false);
            if (scale != 0.7) coarse(scale, 1.0, false);
        }
    runs.push_back({"skipping off", "skipping", {"render.skip_empty_space=false"}});
    const std::string& text = scene.drawn.session_text;
    sweep("gradient inside voxels, step", "render.step_voxels", {2, 1, 0.5, 0.25, 0.125}, {1, 0.5, 0.25},
          {"render.gradient=analytic"});
    if (text.find("\"occlusion\"") != std::string::npos)
        sweep("occlusion rays", "light.occlusion.rays", {8, 16, 32, 64, 128, 256}, {8, 64});
    if (scene.budget_device > 0)
        for (const uint64_t mib : {16, 48})
            runs.push_back({sentence("budget ", mib, " MiB"), "budget", {}, 1.0, mib << 20});
    if (text.find("\"paging\"") != std::string::npos) sweep("detail", "render.detail", {0.25, 0.5, 1, 2, 4}, {0.5, 2});
    return runs;
}

std::vector<Run> mixed_runs(int count)
{
    // Draws a Latin hypercube: divides the range of each setting into `count` equal parts, and uses each part once.
    std::mt19937 random(1);
    const auto places = [&] {
        std::vector<int> order(size_t(std::max(count, 0)));
        std::iota(order.begin(), order.end(), 0);
        for (size_t i = order.size(); i-- > 1;) std::swap(order[i], order[random() % (i + 1)]);
        return order;
    };
    const std::vector<int> steps = places(), scales = places(), limits = places(), tables = places(), taps = places();
    std::vector<Run> runs;
    for (size_t i = 0; i < steps.size(); ++i) {
        const auto share = [&](const std::vector<int>& order) { return (order[i] + 0.5) / count; };
        const auto rounded = [](double value, double to) { return std::round(value * to) / to; };
        const double step = rounded(std::exp2(std::lerp(2.0, -4.0, share(steps))), 1000.0);
        const double limit = 1.0 - std::pow(10.0, std::lerp(-1.0, -4.0, share(limits)));
        runs.push_back({sentence("mixed ", i + 1),
                        "mixed",
                        {sentence("render.step_voxels=", digits_of(step)),
                         sentence("render.opacity_limit=", digits_of(rounded(limit, 1e5))),
                         sentence("render.preintegration=", share(tables) < 0.5 ? "false" : "true"),
                         sentence("render.sampling=", share(taps) < 0.5 ? "exact" : "hardware")},
                        rounded(std::lerp(0.35, 1.0, share(scales)), 100.0)});
    }
    return runs;
}

}  // namespace shvr::bench
