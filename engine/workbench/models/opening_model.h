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
#include "engine/volume/volume.h"

namespace shvr::ui {

/// A file that the open dialog describes (LookAtFile).
struct Candidate {
    std::filesystem::path path;
    std::string settings;  ///< settings used to inspect it
    bool is_being_read = true;
    std::string failure;            ///< reason why the file cannot be opened; empty: no reason is known
    std::vector<Choice> choices{};  ///< alternatives to choose from, if the file cannot be opened without a choice
    std::string kind;               ///< "Volume", "Session", "Project", "Picture of a session"
    bool is_project = false;        ///< the file needs no import
    VolumeInfo volume{};            ///< this and the members below are valid only if `failure` is empty
    int levels = 1;
    std::string memory{};  ///< required host and device memory
    std::vector<std::string> warnings{};
};

/// A file that could be a scan or annotation of the open scan; the user decides which (TakeFile).
struct UnclearFile {
    std::filesystem::path path;
    std::string beside{};     ///< as in TakeFile
    bool may_be_scan = true;  ///< otherwise only annotation was asked for
    std::string why = "has the size of the open scan, and does not state what it is";
    bool may_be_offsets = true;
};

/// Annotation or a transfer function to be loaded, and what that would change (PreviewLoad).
struct LoadPreview {
    std::filesystem::path path;
    std::optional<Part> part{};  ///< null: a transfer function
    std::string changes;         ///< a sentence: "1200 voxels would change their group"
    bool changes_anything = true;
    std::vector<MaskPreview::Group> groups{};  ///< those that gain or lose voxels, if it is a mask
    std::vector<std::string> notes{};          ///< how the file was read, and what of it is left out
};

/// Made by the opener.
struct OpeningModel {
    std::span<const std::string> recovered{};  ///< notes at opening on recovered or set-aside work, until dismissed
    std::string_view opening{};                ///< name of the file being opened; empty: none
    /// Why the last Open failed, and the path of its file; empty: it did not fail.
    std::string_view open_failure{};
    const std::filesystem::path* failed_path = nullptr;
    /// Why the open file looks like a label image instead of a scan; empty: it does not, or the notice was dismissed.
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
    std::vector<Jobs::State> jobs{};  ///< jobs, the running one first
};

}  // namespace shvr::ui
