#pragma once
// What the open document shows; without one, an empty session.

#include <filesystem>
#include <span>
#include <string_view>

#include "engine/annotation/work/work.h"
#include "engine/session/session.h"
#include "engine/workbench/models/messages.h"

namespace shvr::ui {

/// Made by the desk.
struct DocumentModel {
    bool is_open = false;  ///< false: what follows is of an empty session
    const Session& session;
    const VolumeInfo& volume;
    const VolumeStatistics& statistics;
    const Camera& camera;
    const std::filesystem::path& session_path;
    bool has_session_file = false;  ///< false: a bare scan that was never saved
    std::string_view holder{};      ///< who writes the project, if that is another process: then this window only looks
    const MessageLog& messages;
};

}  // namespace shvr::ui
