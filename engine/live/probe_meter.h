#pragma once
// How much of the probe's ball is relevant: the share of its voxels that are at or above a threshold, offsets included.
// The device counts, as it does for a brush that fills. One question is in flight at a time and nothing waits; nothing
// is submitted while the ball and the densities stay as they are. One thread, the annotator's.

#include <optional>

#include "engine/live/annotator.h"

namespace shvr {

class ProbeMeter {
public:
    explicit ProbeMeter(Annotator& annotator) : annotator_(annotator), query_(annotator.renderer()) {}

    /// Where the ball is: one position in voxels; its radius in voxels along x. Null: nobody wants to know.
    struct Ball {
        glm::dvec3 voxel{0.0};
        double radius_voxels = 1.0;
        double threshold = 0.0;
        bool operator==(const Ball&) const = default;
    };
    /// Call it in every turn: it costs a comparison where nothing has changed.
    void want(const std::optional<Ball>& ball) { wanted_ = ball; }
    /// Collects a finished answer and submits the next question. Fails where the ball is larger than a brush may be.
    void advance();
    /// Forgets a question that is in flight; it is asked again.
    void drop()
    {
        query_.drop();
        asked_.reset();
    }
    /// 0 ... 1, of the voxels inside the volume; null where none is, or nothing is known yet. It lags behind a ball
    /// that moves.
    std::optional<double> share() const { return wanted_ ? share_ : std::nullopt; }
    bool is_current() const;
    /// A question is in flight. One whose bricks are missing is not: it is asked again as they come.
    bool is_asking() const { return query_.is_asking(); }

private:
    struct Asked {
        Ball ball;
        uint64_t revision = 0;  ///< of the offsets
        bool operator==(const Asked&) const = default;
    };
    Annotator& annotator_;
    std::optional<Ball> wanted_;
    std::optional<Asked> asked_, answered_;
    std::optional<double> share_;
    RegionQuery query_;
};

}  // namespace shvr
