#pragma once
// What the bench draws: what people look at, made by code from seeds, so that no file is needed; or a person's own
// sessions. And the settings it is drawn with: one knob turned at a time, and the qualities that window and command
// line offer. Plain data.

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "tools/golden/golden.h"

namespace shvr::bench {

struct Scene {
    std::string name;
    std::string what;            ///< why it is among them
    golden::Golden drawn;        ///< its session and paint
    uint64_t budget_device = 0;  ///< bytes; 0: as much as there is
};

/// Of `side` voxels and this many pixels.
std::vector<Scene> own_scenes(int64_t side, const glm::uvec2& pixels);

struct SceneChoice {
    std::vector<std::string> names;  ///< empty: all of our own, and the examples that are there
    int64_t side = 64;               ///< voxels
    glm::uvec2 pixels{120, 90};
    std::filesystem::path examples;  ///< folder in which tools/fetch_example left the scans
};
struct ChosenScenes {
    std::vector<Scene> scenes;
    std::vector<std::string> left_out;  ///< a sentence for each whose data is not there
};
/// Those of the names; a name that is none of ours is the path of a session, project or volume. Fails where it is
/// neither, or names an example that is not there.
ChosenScenes chosen_scenes(const SceneChoice& choice);

/// A way to draw a scene.
struct Run {
    std::string name;                   ///< "step 0.5"
    std::string family;                 ///< "step"
    std::vector<std::string> settings;  ///< "render.step_voxels=0.5"
    double scale = 1.0;                 ///< of the picture's sides; what is smaller is drawn large again, bilinearly
    uint64_t budget_device = 0;         ///< bytes; 0: the scene's
};

/// The runs of a scene: those whose knob has something to turn.
std::vector<Run> runs_of(const Scene& scene, bool quick);
/// Settings that turn step, resolution, opacity limit, pre-integration and sampling at once, spread evenly over all of
/// them (a Latin hypercube); equal counts give equal settings.
std::vector<Run> mixed_runs(int count);
/// The names of all families, the qualities first.
std::span<const char* const> families();

}  // namespace shvr::bench
