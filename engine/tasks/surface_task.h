#pragma once
// Exports surfaces of painted groups for other programs, for `shvr export --surface`. The file's extension determines
// the format. The annotation as in export_task.h.

#include <optional>

#include "engine/tasks/export_task.h"

namespace shvr {

inline constexpr int MAX_SURFACE_STEPS = 1000;
inline constexpr double MIN_SURFACE_SHARE = 0.001;

struct SurfaceTask {
    static constexpr const char* TITLE = "Export surfaces";

    std::filesystem::path surface;
    std::string groups;     ///< numbers joined by "+"; empty: all painted groups
    int smooth = 20;        ///< steps
    double decimate = 1.0;  ///< share of the triangles to keep; 1: all
    Positions space = Positions::physical;
    int64_t budget_host_mib = 0;  ///< memory that it may take; 0: three quarters of the machine's memory

    OptionNames names = OptionNames::keys;  ///< as in ExportTask
};
void fields(Fields& f, SurfaceTask& task);
/// Returns the existing files that the task would replace, whatever groups are painted. Asks the disk.
std::vector<std::filesystem::path> replaced_files(const SurfaceTask& task);

/// The fields of how surfaces are made, of SurfaceTask or ExportTask.
template <class Task>
void surface_form_fields(Fields& f, Task& task)
{
    f.whole("smooth", task.smooth, 0, MAX_SURFACE_STEPS,
            {"steps that smooth surfaces, within half a voxel, with the volumes of groups kept; 0: faces of voxels"});
    f.number("decimate", task.decimate, {MIN_SURFACE_SHARE, 1.0},
             {"share of the triangles of surfaces to keep; vertices of the full surface stay within a voxel of it, and "
              "groups that touch keep equal borders"});
}

struct SurfaceResult {
    std::vector<std::string> written;  ///< paths of the written files, in order
    std::map<int, int64_t> triangles_by_group;
    /// Every vertex before decimation is within this distance of the written surface, and every point of this one of
    /// that before, in the volume's unit. Null without decimation.
    std::optional<double> decimation_error{};
};

/// Checks the groups' numbers, the file's name and its folder.
void check(const SurfaceTask& task);
/// Checks that the groups are painted, too, and all files of `surface_files`.
void check(const SurfaceTask& task, const AnnotationView& annotation);
/// Returns the files to write: one for all groups; or one for each, NAME-GROUP.stl, where a format holds one surface
/// and the task does not state one group. Fails if a stated group is not painted, or none is.
std::vector<std::filesystem::path> surface_files(const SurfaceTask& task, const Mask& mask);

/// Computes the surfaces of all groups, since they share borders; then writes each file atomically, and calls `wrote`
/// after each. Files written before a failure stay.
SurfaceResult run(const SurfaceTask& task, const AnnotationView& annotation, ProgressReporter& reporter,
                  const std::function<void(const SurfaceResult& so_far)>& wrote = {});

}  // namespace shvr
