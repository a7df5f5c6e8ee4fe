#pragma once
// A session says where its annotation is saved. A session from a stranger could name any file of the user's, directly,
// through ".." or through a symbolic link; outside its own folder nothing is written before the user agrees. Any
// thread.

#include <filesystem>
#include <string>
#include <vector>

#include "engine/session/session.h"

namespace shvr {

/// The files that annotating and saving would write outside the folder of the session file (for a project: outside the
/// project), in words: "annotation.mask, which is /home/me/notes.mask". Files that `settings` ("key=value") name are
/// the user's own choice. Empty: none.
std::string files_outside(const Session& session, const std::filesystem::path& session_file,
                          const std::vector<std::string>& settings);

}  // namespace shvr
