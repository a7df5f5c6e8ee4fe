#pragma once
// The scene that a study annotates: a phantom of the thesis's section in memory, with its ground truth. Immutable once
// made, so annotators on several threads may share it.

#include <cstdint>
#include <vector>

#include "engine/annotation/brush.h"
#include "engine/annotation/mask.h"
#include "engine/annotation/trace/trace_segments.h"
#include "engine/touch/region_wish.h"
#include "engine/volume/source.h"
#include "haptics/relevance.h"

namespace shvr {

/// The lowest intensity of voxels that are visible, felt and painted: half-way between ground tissue (60) and veins
/// (200), so that veins keep their width.
inline constexpr double STUDY_THRESHOLD = 130.0;
/// A threshold low enough to include receptacle tissue (90), chosen by an annotator who makes a mistake.
inline constexpr double MISTAKEN_THRESHOLD = 80.0;

struct Phantom;
/// The phantom's true trace, in physical units for this voxel spacing. Numbers are indices of phantom nodes and links.
TraceGraph trace_of(const Phantom& phantom, const glm::dvec3& spacing);

struct SceneSpec {
    int64_t side = 256;  ///< voxels
    uint32_t seed = 1;
    double noise = 10.0;  ///< PhantomFlaws::noise
    bool operator==(const SceneSpec&) const = default;
};

/// A bundle that is joined to no other bundle, and so is not part of the task.
struct SeparateBundle {
    std::vector<glm::dvec3> course;  ///< voxels; along its axis
};

class StudyScene {
public:
    explicit StudyScene(const SceneSpec& spec);

    const SceneSpec& spec() const { return spec_; }
    /// The volume, with one level and spacing 1, so that physical units equal voxels.
    const VolumeSource& volume() const { return *volume_; }
    Size3 size() const { return volume_->info().size; }
    const Mask& full_mask() const { return full_; }
    const Mask& partial_mask() const { return partial_; }
    const TraceGraph& trace() const { return trace_; }
    const std::vector<TraceSegment>& segments() const { return segments_; }
    const std::vector<SeparateBundle>& separate_bundles() const { return separate_; }
    /// Mean radius in voxels of the nodes of the true trace, which is within 5 % of the veins' radius.
    double vein_radius() const { return vein_radius_; }
    /// Metres in the hand to voxels.
    double voxels_per_metre() const;

    double intensity(const Size3& voxel) const { return voxels_[size_t(index_of(voxel, size()))]; }
    /// Computes the relevance around a probe, bit for bit like `relevance_on_host` (engine/live/relevance_host.h).
    void put_relevance(const RegionWish& wish, RelevancePatch& patch) const;
    /// Whether a picture shows a surface at this voxel of the half-resolution grid: at least four of its eight voxels
    /// reach STUDY_THRESHOLD. Pictures average voxels, so a single noisy voxel hides nothing behind it.
    bool shows_surface(const glm::ivec3& half_voxel) const;
    /// Returns the voxels that a brush selects along a path, like the GPU kernels do. Only for `fill` and `flood`.
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
    std::vector<uint32_t> bits_;  ///< voxels at or above STUDY_THRESHOLD: bit b of word w of a row is x = 32 w + b
    std::vector<bool> surface_;   ///< of half-resolution voxels
    glm::ivec3 half_size_{0};
};

}  // namespace shvr
