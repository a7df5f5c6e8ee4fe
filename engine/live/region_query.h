#pragma once
// Asks the device which voxels of given regions a brush selects. The caller collects the answer later, or waits for it.
//
//   positions -> frame_of_regions (CPU) -> RegionQuery::ask -> passes of the brush (device) -> RegionQuery::answer
//
// The exact value of each voxel is compared with the threshold. In volumes where several values share a code, the host
// compares (Scene::threshold_bricks); the device then only connects voxels, and a filling brush needs no device.
//
// Each instance has at most one query in flight. Used only by the renderer's thread.

#include <optional>
#include <span>
#include <vector>

#include "engine/annotation/brush.h"
#include "engine/picture/renderer.h"

namespace shvr {

/// A region of the volume, and the position of the stroke at the region's centre.
struct RegionAt {
    BrushRegion region;
    glm::dvec3 centre_voxel{0.0};
};

/// The regions that fit in one frame, in the order of their positions.
struct FrameOfRegions {
    std::vector<RegionAt> regions;  ///< only regions that contain a voxel of the volume
    size_t end = 0;                 ///< index of the first position not covered yet
};
/// Returns the regions of `op` around `positions`, from index `first` on, as far as they fit in one frame.
FrameOfRegions frame_of_regions(const PaintOp& op, std::span<const glm::dvec3> positions, size_t first,
                                const VolumeInfo& volume);

/// The device's answer for one region.
struct RegionAnswer {
    BrushRegion region;
    glm::dvec3 centre_voxel{0.0};
    std::vector<uint32_t> words;  ///< bits of the selected voxels, in rows of BrushRegion::words_per_row
};

class RegionQuery {
public:
    enum class Wait { no, for_bricks };
    /// `name`: the name of the read-backs in profiles.
    explicit RegionQuery(Renderer& renderer, const char* name = "") : renderer_(renderer), name_(name) {}

    /// Asks which voxels of `regions` (at least one) are selected by the brush, threshold and connectivity of `op`.
    /// Drops an earlier query. If bricks of the regions are not loaded yet: depending on `wait`, reads them, or submits
    /// nothing and returns false.
    bool ask(const PaintOp& op, std::vector<RegionAt> regions, Wait wait);
    bool is_asking() const { return frame_ || !known_.empty(); }
    /// Whether `answer` would return without waiting.
    bool is_answered() const { return !known_.empty() || (frame_ && frame_.done()); }
    /// Waits if necessary. Returns one answer per region, in order. Afterwards no query is in flight.
    std::vector<RegionAnswer> answer();
    /// Drops the query in flight, if any.
    void drop()
    {
        frame_ = {};
        known_.clear();
    }
    /// Device time of the last answer; 0 if the device has no timestamps.
    double gpu_ms() const { return gpu_ms_; }

private:
    bool ask_host(ThresholdBricks& bricks, const PaintOp& op, std::vector<RegionAt>&& regions, Wait wait);

    Renderer& renderer_;
    const char* name_;
    std::vector<RegionAt> regions_;
    gpu::Submission frame_;
    std::vector<RegionAnswer> known_;  ///< answers that were found without the device
    double gpu_ms_ = 0.0;
};

}  // namespace shvr
