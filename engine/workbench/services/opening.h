#pragma once
// State of an opening under way; only for the opener's own source files.

#include "engine/workbench/services/opener.h"

namespace shvr::ui {

struct Opener::Opening {
    std::filesystem::path path;
    std::string name{};
    std::vector<std::string> settings{};
    double begun_s = 0.0;
    Work::Opening how{.program = {}};
    bool saves_before = true;
    bool asks = false;                                   ///< as in begin_open
    bool comes_back = false;                             ///< restores the unloaded document
    std::vector<std::filesystem::path> taken_into_it{};  ///< annotation dropped together with it

    Jobs::Number number = 0;                       ///< the reading job's; the opening keeps it after the job ends
    std::shared_ptr<Document::Read> read{};        ///< null: still being read
    std::shared_ptr<std::exception_ptr> thrown{};  ///< exception from the job
    uint64_t journal_bytes = 0;  ///< size of the open document's journal when reading began; used if `read` has it
    std::optional<Session> pictured{};  ///< look of a picture, if the opened file is one
    std::string looks_like_labels{};    ///< as in OpeningModel
    std::unique_ptr<Scene> scene{};     ///< scene being loaded
};

}  // namespace shvr::ui
