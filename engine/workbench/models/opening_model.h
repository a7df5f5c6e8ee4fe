#pragma once
// View of opening and other long work.

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

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
};

/// Made by the opener.
struct OpeningModel {
    std::span<const std::string> recovered{};  ///< notes at opening on recovered or set-aside work, until dismissed
    std::string_view opening{};                ///< name of the file being opened; empty: none
    /// Why the last Open failed, and the path of its file; empty: it did not fail.
    std::string_view open_failure{};
    const std::filesystem::path* failed_path = nullptr;
};

/// Made by the taker of files.
struct CandidateModel {
    const Candidate* candidate = nullptr;       ///< null: none
    const UnclearFile* unclear_file = nullptr;  ///< null: none
};

/// Made by the runner of tasks.
struct JobModel {
    std::vector<Jobs::State> jobs{};  ///< jobs, the running one first
};

}  // namespace shvr::ui
