#pragma once
// View of the open document; without one, of an empty session.

#include <filesystem>
#include <span>
#include <string_view>

#include "engine/annotation/work/work.h"
#include "engine/session/session.h"
#include "engine/workbench/models/messages.h"

namespace shvr::ui {

/// Made by the desk.
struct DocumentModel {
    bool is_open = false;  ///< false: the members below describe an empty session
    const Session& session;
    const VolumeInfo& volume;
    const VolumeStatistics& statistics;
    const Camera& camera;
    const std::filesystem::path& session_path;
    bool has_session_file = false;  ///< false: a bare scan that was never saved
    std::string_view holder{};      ///< another process that writes the project: this window then only looks
    std::string_view outside{};     ///< files that the session would write outside its folder, without the user's
                                    ///< agreement: this window then only looks
    const MessageLog& messages;
};

}  // namespace shvr::ui
