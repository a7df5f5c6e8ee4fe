#pragma once
// State of one opening. Include this header only in the opener's own source files.

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

    Jobs::Number number = 0;                       ///< number of the reading job, which the opening keeps afterwards
    std::shared_ptr<Document::Read> read{};        ///< null: still being read
    std::shared_ptr<std::exception_ptr> thrown{};  ///< exception from the job
    uint64_t journal_bytes = 0;                    ///< size of the open document's journal when reading began
    std::optional<Session> pictured{};             ///< the look to apply, if the opened file is a picture
    std::string looks_like_labels{};               ///< as in OpeningModel
    std::unique_ptr<Scene> scene{};                ///< scene being loaded
};

}  // namespace shvr::ui
