#pragma once
// An opening under way: for the opener's own sources.

#include "engine/workbench/services/opener.h"

namespace shvr::ui {

struct Opener::Opening {
    std::filesystem::path path;
    std::string name{};
    std::vector<std::string> settings{};
    double begun_s = 0.0;
    Work::Opening how{.program = {}};
    bool saves_before = true;
    bool comes_back = false;                             ///< what was put away
    std::vector<std::filesystem::path> taken_into_it{};  ///< annotation that was dropped with it

    Jobs::Number number = 0;                       ///< number of the job that reads, afterwards of the opening
    std::shared_ptr<Document::Read> read{};        ///< null: it is being read
    std::shared_ptr<std::exception_ptr> thrown{};  ///< by the job
    uint64_t journal_bytes = 0;         ///< size of the open document's journal when reading began, if it is the same
    std::optional<Session> pictured{};  ///< the look of a picture, where that is opened
    std::unique_ptr<Scene> scene{};     ///< being loaded
};

}  // namespace shvr::ui
