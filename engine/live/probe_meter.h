#pragma once
// Measures the relevant share of the probe's ball: the fraction of its voxels at or above a threshold, after offsets
// are added. The device counts the voxels, as it does for a filling brush. One query is in flight at a time and no call
// waits. Nothing is submitted while the ball and the densities stay the same. The annotator's thread only.

#include <optional>

#include "engine/live/annotator.h"

namespace shvr {

class ProbeMeter {
public:
    explicit ProbeMeter(Annotator& annotator) : annotator_(annotator), query_(annotator.renderer()) {}

    /// The ball to measure: its centre in voxels, and its radius in voxels along x. Null: no measurement.
    struct Ball {
        glm::dvec3 voxel{0.0};
        double radius_voxels = 1.0;
        double threshold = 0.0;
        bool operator==(const Ball&) const = default;
    };
    /// Sets the ball. Call it in every frame: without a change, the call only compares.
    void want(const std::optional<Ball>& ball) { wanted_ = ball; }
    /// Collects a finished answer and submits the next query. Fails if the ball is larger than a brush may be.
    void advance();
    /// Drops a query in flight; `advance` then submits it again.
    void drop()
    {
        query_.drop();
        asked_.reset();
    }
    /// The relevant share, 0 to 1, of the ball's voxels inside the volume; null if there are no such voxels, or before
    /// the first answer. Lags behind a moving ball.
    std::optional<double> share() const { return wanted_ ? share_ : std::nullopt; }
    bool is_current() const;
    /// Whether a query is in flight. No query is in flight while its bricks are loaded; it is then submitted again.
    bool is_asking() const { return query_.is_asking(); }

private:
    struct Asked {
        Ball ball;
        uint64_t revision = 0;  ///< revision of the offsets
        bool operator==(const Asked&) const = default;
    };
    Annotator& annotator_;
    std::optional<Ball> wanted_;
    std::optional<Asked> asked_, answered_;
    std::optional<double> share_;
    RegionQuery query_;
};

}  // namespace shvr
