#pragma once
// Read-only view of the open document or, while no document is open, of an empty session.

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
    bool has_session_file = false;  ///< false: no session file exists; the document is a scan that was never saved
    std::string_view holder{};      ///< another process that writes the project, so that this window is read-only
    std::string_view outside{};     ///< files that the session may not write, since they are outside its folder; if
                                    ///< there are any, the window is read-only
    std::string_view remote{};      ///< address of the volume if that was opened, not a session that names it; unless
                                    ///< it is empty, the window is read-only
    const MessageLog& messages;
};

}  // namespace shvr::ui
