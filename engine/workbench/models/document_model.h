#pragma once
// Read-only view of the open document, or of an empty session if no document is open.

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
    bool has_session_file = false;  ///< false: the document is a bare scan that was never saved
    std::string_view holder{};      ///< another process that writes the project: this window is then read-only
    std::string_view outside{};     ///< files that the session would write outside its folder, if the user has not
                                    ///< agreed: this window is then read-only
    const MessageLog& messages;
};

}  // namespace shvr::ui
