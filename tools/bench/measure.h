#pragma once
// Draws a scene in every way of `runs`, measures each against the reference renderer, and times them in turns. One
// thread, apart from the reference's.

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
    int mixed = 0;  ///< settings that turn all knobs at once (mixed_runs)
    int rounds = 7;
    int threads = 2;  ///< of the reference
    PeerOptions peer = {};
    std::filesystem::path kept;  ///< folder in which references are kept from run to run; it exists
    std::function<void(const std::string& what, double share)> tell = {};  ///< may throw, which ends the work
};

/// A scene with pictures to look at: the reference's, those of the qualities, and another program's at the step that
/// `interactive` has.
struct Pictures {
    ImageF reference;
    std::vector<std::pair<std::string, ImageF>> of_qualities, of_peers = {};
};
struct MeasuredScene {
    SceneResult result;
    Pictures pictures;
};

MeasuredScene measure_scene(const Scene& scene, const MeasureOptions& options);
/// Who measures, when `device` is what SHVR draws on.
Results who_measures(const std::string& device);

Error error_of(const ImageF& picture, const ImageF& reference);
/// Bilinear between pixel centres, the border repeated.
ImageF resized(const ImageF& image, int width, int height);
/// Of at least one value; the 95th percentile is one of them.
Time time_of(std::vector<double> milliseconds);

}  // namespace shvr::bench
