#pragma once
// Draws a scene with the settings of each of `runs`, measures each picture against the reference renderer, and times
// the runs in interleaved rounds. One thread, apart from the threads of the reference renderer.

#include <functional>

#include "engine/base/image.h"
#include "tools/bench/peer.h"
#include "tools/bench/results.h"
#include "tools/bench/scenes.h"
#include "tools/golden/studio.h"

namespace shvr::bench {

struct MeasureOptions {
    std::string device;
    bool quick = false;
    int mixed = 0;  ///< number of runs that vary all settings at once (mixed_runs)
    int rounds = 7;
    int threads = 2;  ///< threads of the reference
    PeerOptions peer = {};
    std::filesystem::path kept;  ///< an existing folder that keeps references between runs
    std::function<void(const std::string& what, double share)> tell = {};  ///< may throw, which ends the work
};

/// A scene and its pictures for readers: the reference, one for each quality, and another program's picture, drawn with
/// the step of `interactive`.
struct Pictures {
    ImageF reference;
    std::vector<std::pair<std::string, ImageF>> of_qualities, of_peers = {};
};
struct MeasuredScene {
    SceneResult result;
    Pictures pictures;
};

MeasuredScene measure_scene(const Scene& scene, const MeasureOptions& options);
/// Describes the machine and program that measure when SHVR draws on `device`.
Results who_measures(const std::string& device);

Error error_of(const ImageF& picture, const ImageF& reference);
/// Resizes bilinearly between pixel centres, with the border repeated.
ImageF resized(const ImageF& image, int width, int height);
/// Needs at least one measurement. The 95th percentile is not interpolated: it is a measured value.
Time time_of(std::vector<double> milliseconds);

}  // namespace shvr::bench
