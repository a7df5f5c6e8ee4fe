#pragma once
// Exports annotation for other programs, for `shvr export`. File extensions determine the formats.
//
// `run` gets the annotation by reference. To export in the background while the user paints on, take an
// `AnnotationSnapshot` on the main thread and export it on another. A snapshot shares the bricks of mask and offsets,
// which are immutable (sparse_bricks.h), and copies only the tables of bricks and the trace (MEASURED.md).

#include <functional>
#include <map>
#include <span>
#include <vector>

#include "engine/annotation/density.h"
#include "engine/annotation/mask.h"
#include "engine/annotation/measures/measurement.h"
#include "engine/annotation/trace/trace_file.h"
#include "engine/look/groups.h"
#include "engine/tasks/task_options.h"

namespace shvr {

inline constexpr Spelling<Positions> POSITIONS[] = {{Positions::physical, "physical"}, {Positions::volume, "volume"}};
constexpr std::span<const Spelling<Positions>> spellings_of(Positions)
{
    return POSITIONS;
}

struct ExportTask {
    static constexpr const char* TITLE = "Export annotation";

    // Files to write; empty: not written.
    std::filesystem::path mask, offset, trace, mesh, metrics, measurements;
    bool labels = false;       ///< also writes the mask as labels/mask in the project
    bool break_loops = false;  ///< removes loops of the trace, for formats that can only hold trees
    Positions space = Positions::physical;
    std::optional<OmeZarrVersion> version;
    std::string sections;  ///< for `metrics`: the groups of a flower head's parts, parsed by head_sections()
    std::string axis;      ///< for `metrics`: a flower head's axis, parsed by stated_axis()
    // Surfaces of painted groups, as in SurfaceTask (surface_task.h).
    std::filesystem::path surface;
    std::string surface_groups;
    int smooth = 20;
    double decimate = 1.0;
    int64_t budget_host_mib = 0;  ///< memory that surfaces may take; not an option itself

    OptionNames names = OptionNames::keys;  ///< how messages name options; not an option itself
};
void fields(Fields& f, ExportTask& task);
/// Returns the existing files that the task would replace. Asks the disk.
std::vector<std::filesystem::path> replaced_files(const ExportTask& task);

/// The exported data, which must not change until `run` returns.
struct AnnotationView {
    const VolumeInfo& volume;
    const Mask& mask;
    const DensityField& density;
    const TraceGraph& trace;
    const Groups& groups;
    std::string volume_hash{};            ///< as Session::volume_hash
    std::filesystem::path project{};      ///< path that the user opened; for `labels`
    std::filesystem::path volume_path{};  ///< see Session::volume_path; no output may replace it
    std::filesystem::path trace_path{};   ///< see Session::trace_path; used in messages if there is no trace
    std::filesystem::path mask_path{};    ///< mask file whose header an export keeps (mask_segments.h); may be missing
    std::span<const Measurement> measurements{};
};

/// An independent copy of the annotation. Any thread may read and destroy it.
class AnnotationSnapshot {
public:
    explicit AnnotationSnapshot(const AnnotationView& view);
    AnnotationSnapshot(const AnnotationSnapshot&) = delete;
    /// Returns a view of this object, which must outlive the view.
    AnnotationView view() const;

private:
    VolumeInfo volume_;
    Mask mask_;
    DensityField density_;
    TraceGraph trace_;
    Groups groups_;
    std::string volume_hash_;
    std::filesystem::path project_, volume_path_, trace_path_, mask_path_;
    std::vector<Measurement> measurements_;
};

struct ExportResult {
    std::vector<std::string> written;   ///< paths of the written files, in order
    std::vector<std::string> left_out;  ///< a sentence for each internode that a format could not represent
    std::map<int, int64_t> voxels_by_group;
    size_t nodes = 0, internodes = 0;
    std::map<int, double> length_by_group;  ///< in `unit`
    std::string unit;
};

/// Checks names and folders, and whether there is data to write.
void check(const ExportTask& task);
void check(const ExportTask& task, const AnnotationView& annotation);

/// Checks the task, then writes each file atomically, and calls `wrote` after each. Files written before a failure
/// stay.
ExportResult run(const ExportTask& task, const AnnotationView& annotation, ProgressReporter& reporter,
                 const std::function<void(const ExportResult& so_far)>& wrote = {});

}  // namespace shvr
