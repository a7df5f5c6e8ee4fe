#pragma once
// The scenes of the bench: typical uses, generated from seeds without any file, or the user's own sessions. Also the
// runs, that is, the settings with which scenes are drawn: one setting varied at a time, and the qualities that window
// and command line offer. Plain data.

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "tools/golden/golden.h"

namespace shvr::bench {

struct Scene {
    std::string name;
    std::string what;            ///< why it is included
    golden::Golden drawn;        ///< its session and paint
    uint64_t budget_device = 0;  ///< bytes; 0: unlimited
};

/// Returns the built-in scenes: volumes with `side` voxels along each axis, drawn as pictures of `pixels`.
std::vector<Scene> own_scenes(int64_t side, const glm::uvec2& pixels);

struct SceneChoice {
    std::vector<std::string> names;  ///< empty: all built-in scenes, and the examples that are available
    int64_t side = 64;               ///< voxels
    glm::uvec2 pixels{120, 90};
    std::filesystem::path examples;  ///< folder where tools/fetch_example stored the scans
};
struct ChosenScenes {
    std::vector<Scene> scenes;
    std::vector<std::string> left_out;  ///< a sentence for each scene that is omitted for lack of its data
};
/// Returns the scenes with these names. A name that is not a built-in scene's is the path of a session, project or
/// volume. Fails if there is no such file, or if the data of a named example is missing.
ChosenScenes chosen_scenes(const SceneChoice& choice);

/// A way to draw a scene.
struct Run {
    std::string name;                   ///< "step 0.5"
    std::string family;                 ///< "step"
    std::vector<std::string> settings;  ///< "render.step_voxels=0.5"
    double scale = 1.0;                 ///< factor on the sides of the picture, which is enlarged again bilinearly
    uint64_t budget_device = 0;         ///< bytes; 0: the scene's
};

/// Returns the runs of a scene, omitting those that vary only a setting that has no effect on it.
std::vector<Run> runs_of(const Scene& scene, bool quick);
/// Returns runs that vary step, resolution, opacity limit, pre-integration and sampling at once, spread evenly over the
/// ranges of all five settings (a Latin hypercube). Equal counts give equal runs.
std::vector<Run> mixed_runs(int count);
/// Returns the names of all families of runs, the qualities first.
std::span<const char* const> families();

}  // namespace shvr::bench
