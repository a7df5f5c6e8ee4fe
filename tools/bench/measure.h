#pragma once
// Draws a scene once with the settings of each of `runs`, compares each picture with the reference renderer's, and
// times the runs in rounds. One thread, apart from the threads of the reference renderer.

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
    std::filesystem::path kept;  ///< an existing folder that stores references for later calls
    std::function<void(const std::string& what, double share)> tell = {};  ///< may throw, which ends the work
};

/// A scene and its pictures for the report: the reference, one for each quality, and the comparison program's picture,
/// drawn with the step of `interactive`.
struct Pictures {
    ImageF reference;
    std::vector<std::pair<std::string, ImageF>> of_qualities, of_peers = {};
};
struct MeasuredScene {
    SceneResult result;
    Pictures pictures;
};

MeasuredScene measure_scene(const Scene& scene, const MeasureOptions& options);
/// Describes the machine, the program and the device that the results are measured with.
Results who_measures(const std::string& device);

Error error_of(const ImageF& picture, const ImageF& reference);
/// Resizes bilinearly between pixel centres; outside, the picture's border is repeated.
ImageF resized(const ImageF& image, int width, int height);
/// Needs at least one value. The 95th percentile is one of the values, not interpolated.
Time time_of(std::vector<double> milliseconds);

}  // namespace shvr::bench
