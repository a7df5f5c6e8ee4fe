#pragma once
// What is annotated in a study: a phantom of the thesis's section, read into memory once, with its truth. Immutable
// once made, so any number of annotators on any threads may share it.

#include <cstdint>
#include <vector>

#include "engine/annotation/brush.h"
#include "engine/annotation/mask.h"
#include "engine/annotation/trace/trace_segments.h"
#include "engine/touch/region_wish.h"
#include "engine/volume/source.h"
#include "haptics/relevance.h"

namespace shvr {

/// The intensity from which on voxels are visible, felt and painted: half-way between ground tissue (60) and veins
/// (200), so that veins keep their width.
inline constexpr double STUDY_THRESHOLD = 130.0;
/// A threshold that lets receptacle tissue (90) be painted, which a mistaken annotator chooses.
inline constexpr double MISTAKEN_THRESHOLD = 80.0;

struct Phantom;
/// The phantom's true trace, in physical units, for voxels of this size; names are the indices of its nodes and links.
TraceGraph trace_of(const Phantom& phantom, const glm::dvec3& spacing);

struct SceneSpec {
    int64_t side = 256;  ///< voxels
    uint32_t seed = 1;
    double noise = 10.0;  ///< PhantomFlaws::noise
    bool operator==(const SceneSpec&) const = default;
};

/// Bundles that are joined to no others, and so not part of the task.
struct SeparateBundle {
    std::vector<glm::dvec3> course;  ///< voxels; along its axis
};

class StudyScene {
public:
    explicit StudyScene(const SceneSpec& spec);

    const SceneSpec& spec() const { return spec_; }
    /// One level, spacing 1: physical units are voxels.
    const VolumeSource& volume() const { return *volume_; }
    Size3 size() const { return volume_->info().size; }
    const Mask& full_mask() const { return full_; }
    const Mask& partial_mask() const { return partial_; }
    const TraceGraph& trace() const { return trace_; }
    const std::vector<TraceSegment>& segments() const { return segments_; }
    const std::vector<SeparateBundle>& separate_bundles() const { return separate_; }
    /// Mean radius of the true trace's nodes, voxels: the veins' within 5 %.
    double vein_radius() const { return vein_radius_; }
    /// Metres in the hand to voxels.
    double voxels_per_metre() const;

    double intensity(const Size3& voxel) const { return voxels_[size_t(index_of(voxel, size()))]; }
    /// Computes the relevance around a probe, with the bits of `relevance_on_host` (engine/live/relevance_host.h).
    void put_relevance(const RegionWish& wish, RelevancePatch& patch) const;
    /// Whether a picture shows a surface in this voxel of half the resolution: at least half of its eight voxels are
    /// visible. A picture averages, so single voxels of noise hide nothing.
    bool shows_surface(const glm::ivec3& half_voxel) const;
    /// Returns the voxels that a brush selects along a path, as the device's kernels do; `fill` and `flood` only.
    VoxelSelection select(const PaintOp& stroke) const;

private:
    void note_bits();
    void note_separate_bundles();

    SceneSpec spec_;
    std::vector<uint8_t> voxels_;
    std::unique_ptr<VolumeSource> volume_;
    Mask full_, partial_;
    TraceGraph trace_;
    std::vector<TraceSegment> segments_;
    std::vector<SeparateBundle> separate_;
    double vein_radius_ = 0.0;
    int64_t words_per_row_ = 0;
    std::vector<uint32_t> bits_;  ///< voxels at or above STUDY_THRESHOLD: bit b of word w is voxel x = 32 w + b
    std::vector<bool> surface_;   ///< of half-resolution voxels
    glm::ivec3 half_size_{0};
};

}  // namespace shvr
