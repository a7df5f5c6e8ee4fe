#pragma once
// The dialog Export: where to, and which of mask, trace, measures and surfaces, each in a format. Pure; any thread.

#include <span>
#include <string>
#include <vector>

#include "engine/tasks/export_task.h"
#include "engine/workbench/forms/disk_space.h"
#include "engine/workbench/models/model.h"

namespace shvr::ui {

struct ExportForm {
    struct Part {
        bool is_written = false;
        std::string ending;  ///< ".nrrd"
    };
    std::string base;  ///< folder and beginning of all names, as typed: "/scans/leaf"
    Part mask{false, ".nrrd"}, trace{false, ".graphml"}, measures{false, ".csv"}, surfaces{false, ".ply"};
    Part measurements{false, ".csv"};               ///< distances, paths and angles; without a row where there are none
    ExportTask more{.names = OptionNames::titles};  ///< options under More
};

/// One row of the dialog.
struct ExportRow {
    const char* title = "";
    ExportForm::Part* part = nullptr;
    std::span<const char* const> endings{};
    std::string file;     ///< name of the file that it writes
    std::string size;     ///< "at most 17 MB"
    std::string why_not;  ///< why it cannot be written; empty: it can
};
/// Returns the rows, with references into `form`.
std::vector<ExportRow> rows_of(ExportForm& form, const Model& model);

/// Returns a form that exports all existing annotation, next to the scan, but no surfaces, which take longest. `last`:
/// formats to use again.
ExportForm suggested_export(const Model& model, const ExportForm& last);
/// `folder`: where relative names lie.
ExportTask task_of(const ExportForm& form, const std::filesystem::path& folder);
/// The number of files that surfaces are written to: one, or one for each group.
int64_t files_of_surfaces(const ExportForm& form, const Model& model);
/// What the files of the rows take together.
BytesNeeded bytes_written(const ExportForm& form, const Model& model);
/// Options of the task that the rows cover, so that More leaves them out.
inline constexpr std::string_view EXPORT_ROWS_COVER[]{"mask", "trace", "metrics", "surface", "measurements"};

}  // namespace shvr::ui
