#pragma once
// Draws a scene in every way of `runs`, measures each against the reference renderer, and times them in interleaved
// rounds. One thread, apart from the reference's.

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

/// A scene with pictures to look at: the reference's, those of the qualities, and another program's, drawn with the
/// step of `interactive`.
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
/// Needs at least one value; the 95th percentile is one of the values.
Time time_of(std::vector<double> milliseconds);

}  // namespace shvr::bench
