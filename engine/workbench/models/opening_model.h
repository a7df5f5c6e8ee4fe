#pragma once
// View of opening and other long work.

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/annotation/mask_preview.h"
#include "engine/annotation/work/saved_files.h"
#include "engine/jobs/jobs.h"
#include "engine/session/choices.h"
#include "engine/tasks/unfinished_import.h"
#include "engine/volume/volume.h"

namespace shvr::ui {

/// Data about a file that the user considers opening, for the open dialog (LookAtFile).
struct Candidate {
    std::filesystem::path path;
    std::string settings;  ///< settings used to inspect it
    bool is_being_read = true;
    std::string failure;            ///< why the file cannot be opened; empty: it can, as far as is known
    std::vector<Choice> choices{};  ///< if the user must choose how to read the file: the alternatives
    std::string kind;               ///< "Volume", "Session", "Project", "Picture of a session"
    bool is_project = false;        ///< the file needs no import
    VolumeInfo volume{};            ///< this and all members below are valid only if `failure` is empty
    int levels = 1;
    std::string memory{};  ///< required host and device memory
    std::vector<std::string> warnings{};
};

/// A file that may be either a scan or annotation of the open scan, so that the user must decide (TakeFile).
struct UnclearFile {
    std::filesystem::path path;
    std::string beside{};     ///< as in TakeFile
    bool may_be_scan = true;  ///< otherwise only annotation was asked for
    std::string why = "has the size of the open scan, and does not state what it is";
    bool may_be_offsets = true;
};

/// Annotation or a transfer function that was read but not loaded, and the changes it would make (PreviewLoad).
struct LoadPreview {
    std::filesystem::path path;
    std::optional<Part> part{};  ///< null: a transfer function or a mesh
    bool is_mesh = false;
    std::string changes;  ///< a sentence: "1200 voxels would change their group"
    bool changes_anything = true;
    bool is_being_read = false;  ///< what follows is not known yet
    std::string failure{};       ///< why the file cannot be loaded; empty: it can
    bool is_unclear = false;     ///< it fails because its contents do not say what it is: it can if that is stated
    std::vector<MaskPreview::Group> groups{};  ///< those that gain or lose voxels, if it is a mask
    std::vector<std::string> notes{};          ///< how the file was read, and what of it is left out
};

/// Made by the opener.
struct OpeningModel {
    std::span<const std::string> recovered{};  ///< notes about recovered or set-aside work, until they are dismissed
    std::string_view opening{};                ///< name of the file being opened; empty: none
    /// Reason why the last attempt to open a file failed, and the file's path; empty: it did not fail.
    std::string_view open_failure{};
    const std::filesystem::path* failed_path = nullptr;
    /// Why the open file is probably a label image, not a scan; empty: it is not, or the user dismissed the notice.
    std::string_view looks_like_labels{};
};

/// Made by the taker of files.
struct CandidateModel {
    const Candidate* candidate = nullptr;       ///< null: none
    const UnclearFile* unclear_file = nullptr;  ///< null: none
    const LoadPreview* load_preview = nullptr;  ///< null: none
};

/// Made by the runner of tasks.
struct JobModel {
    std::vector<Jobs::State> jobs{};               ///< jobs, the running one first
    const UnfinishedImport* unfinished = nullptr;  ///< what an import has left that ended early; null: nothing known
};

}  // namespace shvr::ui
