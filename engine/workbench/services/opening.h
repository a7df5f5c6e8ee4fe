#pragma once
// State of an opening under way: for the opener's own sources.

#include "engine/workbench/services/opener.h"

namespace shvr::ui {

struct Opener::Opening {
    std::filesystem::path path;
    std::string name{};
    std::vector<std::string> settings{};
    double begun_s = 0.0;
    Work::Opening how{.program = {}};
    bool saves_before = true;
    bool comes_back = false;                             ///< restores the document that was put away
    std::vector<std::filesystem::path> taken_into_it{};  ///< annotation dropped together with it

    Jobs::Number number = 0;                       ///< number of the reading job, afterwards of the opening
    std::shared_ptr<Document::Read> read{};        ///< null: still being read
    std::shared_ptr<std::exception_ptr> thrown{};  ///< exception from the job
    uint64_t journal_bytes = 0;  ///< size of the open document's journal when reading began; used if `read` has it, too
    std::optional<Session> pictured{};  ///< look of a picture, if a picture is opened
    std::unique_ptr<Scene> scene{};     ///< scene being loaded
};

}  // namespace shvr::ui
