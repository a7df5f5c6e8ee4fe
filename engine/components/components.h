#pragma once
// Connected components of the voxels at or above a threshold, in a volume that need not fit into memory.
//
// Slices are read slab by slab and converted to bits and runs. A run takes the label of a run that it touches in the
// preceding rows, or else a new label. If a run touches several labels, they are joined (label_forest.h). Threads label
// ranges of slices in parallel; then the ranges are joined. Memory holds a slab and two slices of runs per range and 8
// bytes per provisional label (in a noisy volume up to one label per run). The labelled runs themselves go to a
// temporary file, and only if the labels are wanted. If a source lists its stored blocks (VolumeSource::stored_blocks),
// only those are traversed, unless the fill value is at or above the threshold.

#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

#include "engine/volume/source.h"

namespace shvr {

enum class Connectivity { faces = 6, corners = 26 };  ///< voxels are connected if they share a face, or any corner

struct ComponentOptions {
    double threshold = 0.0;  ///< inclusive, in intensity units; not NaN
    Connectivity connectivity = Connectivity::faces;
    int64_t fewest_voxels = 1;   ///< smaller components are dropped
    int64_t max_components = 0;  ///< keeps this many of the largest components; of equal ones, the first; 0: all
    int threads = 0;             ///< 0: one per core
    /// Folder for a temporary file. If unset, no labels are kept, and `labels` must not be called.
    std::optional<std::filesystem::path> run_folder{};
    Progress progress{};  ///< called a few times per second
};

class Components {
public:
    struct Component {
        uint32_t label;  ///< 1 ... kept
        int64_t voxels;
    };
    struct Counts {
        int64_t found = 0, kept = 0;
        int64_t foreground_voxels = 0;  ///< total of all components
        int64_t kept_voxels = 0;
        int64_t largest_voxels = 0;      ///< 0 if there is none
        std::vector<Component> largest;  ///< the largest of the kept components, sorted by size, then by order; at most
                                         ///< MAX_LARGEST_LISTED
        int64_t provisional = 0;         ///< number of provisional labels
        int64_t peak_bytes = 0;          ///< peak memory while labelling
        int64_t forest_bytes = 0;        ///< the part of `peak_bytes` for provisional labels
        int64_t run_file_bytes = 0;
    };
    static constexpr size_t MAX_LARGEST_LISTED = 100;

    virtual ~Components() = default;
    const Counts& counts() const { return counts_; }

    /// Returns the volume of labels: 0 for dropped and background voxels, otherwise 1 to `kept`, in the order of the
    /// components' first voxels (by z, then y, then x). The type is the smallest of uint8, uint16 and uint32 that holds
    /// all labels. The volume may outlive this object and `source`.
    virtual std::unique_ptr<VolumeSource> labels() const = 0;

protected:
    Counts counts_;
};

/// Fails if a slice is too large to be kept as bits, if reading fails, if there are more than 2^32 provisional labels,
/// or if the temporary file cannot be written. Call this from one thread at a time.
std::unique_ptr<Components> find_components(const VolumeSource& source, const ComponentOptions& options);

}  // namespace shvr
