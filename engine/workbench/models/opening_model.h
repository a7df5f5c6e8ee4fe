#pragma once
// What opening and other long work show.

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
    std::string settings;  ///< with which it was looked at
    bool is_being_read = true;
    std::string failure;            ///< why it cannot be opened so; empty: it can, as far as that is known
    std::vector<Choice> choices{};  ///< where the reason is that one of several has to be chosen
    std::string kind;               ///< "Volume", "Session", "Project", "Picture of a session"
    bool is_project = false;        ///< nothing is to be imported
    VolumeInfo volume{};            ///< what follows is known only without a failure
    int levels = 1;
    std::string memory{};  ///< what it will take of host and device
    std::vector<std::string> warnings{};
};

/// Made by the opener.
struct OpeningModel {
    std::span<const std::string> recovered{};  ///< what was recovered or set aside at opening, until it is dismissed
    std::string_view opening{};                ///< what is being opened; empty: nothing
    /// Why the last Open failed, and what it was to open; empty: it did not.
    std::string_view open_failure{};
    const std::filesystem::path* failed_path = nullptr;
};

/// Made by the taker of files.
struct CandidateModel {
    const Candidate* candidate = nullptr;  ///< null: none
};

/// Made by the runner of tasks.
struct JobModel {
    std::vector<Jobs::State> jobs{};  ///< the one that runs first
};

}  // namespace shvr::ui
