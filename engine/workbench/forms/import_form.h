#pragma once
// The dialog Import as project: the scan, the project, the size of a voxel and of the result. Pure; any thread.

#include <string>

#include "engine/tasks/import_estimate.h"
#include "engine/tasks/import_task.h"
#include "engine/workbench/forms/disk_space.h"
#include "engine/workbench/models/model.h"

namespace shvr::ui {

struct ImportForm {
    std::string volume, project;                    ///< as typed
    std::string suggested;                          ///< the project that was suggested; one that was typed is kept
    std::string voxel_size;                         ///< as typed (voxel_size.h); empty: the file's
    std::string suggested_size;                     ///< the size that a person gave the open scan; empty: none
    ImportTask more{.names = OptionNames::titles};  ///< all other options; those of the rows too
};

/// Returns a form for that scan, or for the open scan if the path is empty. Spacing and unit that a person gave the
/// open scan, and that its file does not have, are among the form's values.
ImportForm suggested_import(const Model& model, const std::filesystem::path& volume);
/// Suggests a project for the typed scan, unless a project was typed. The size suggested for another scan is dropped.
void follow_volume(ImportForm& form);
/// Returns the folder that is suggested for a project: "/scans/leaf-project" for "/scans/leaf.tif".
std::filesystem::path project_for(const std::filesystem::path& volume);
/// Returns why the form cannot be carried out; empty: it can.
std::string why_not(const ImportForm& form);
/// Returns what happens to the project that an import replaces: "leaf exists and will be deleted ..."; empty: none is.
std::string words_of_replacement(const ImportTask& task, const ImportPlace& place);
/// Returns that a project of the open scan begins without the scan's annotation, and how that is loaded; empty: another
/// scan is imported, or there is no annotation.
std::string words_of_annotation(const ImportForm& form, const Model& model);
/// What an import writes of a scan, at least: a project of nothing but background. At most: without compression.
BytesNeeded bytes_written(const ImportEstimate& estimate);
/// `folder`: where relative names lie.
ImportTask task_of(const ImportForm& form, const std::filesystem::path& folder);
inline constexpr std::string_view IMPORT_ROWS_COVER[]{"volume", "project", "spacing", "unit", "downscale"};

}  // namespace shvr::ui
