#pragma once
// The files in which a session keeps its annotation: their names, the names (OME-Zarr, sparse) of new sessions, and
// files outside the session's folder. A session file states where annotation is saved, so a session from a stranger
// could name any file of the user: directly, through ".." or through a symbolic link. Therefore nothing is written
// outside the session's folder before the user agrees. Any thread.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "engine/session/session.h"

namespace shvr {

/// Lists the files outside the folder of the session file (for a project: outside the project) that annotating and
/// saving would write, as in "annotation.mask, which is /home/me/notes.mask". Leaves out files that `settings`
/// ("key=value") name, since the user has chosen them. Empty if there are none.
std::string files_outside(const Session& session, const std::filesystem::path& session_file,
                          const std::vector<std::string>& settings);

/// Returns the mask of a new session NAME.json: NAME.labels.zarr, or NAME.mask if only NAME.mask exists.
std::filesystem::path mask_beside(const std::filesystem::path& session_file);
/// Returns the default file of density offsets for a mask: its name with `.offsets.zarr`, or with `.offset` if that
/// file exists or the mask is no label image. For IMAGE/labels/NAME, the file is in IMAGE/shvr.
std::filesystem::path offsets_beside(const std::filesystem::path& mask);
/// Like offsets_beside, for the trace, with `.graphml`.
std::filesystem::path trace_beside(const std::filesystem::path& mask);

/// Sets a session's annotation paths to the default names for a session file NAME.json. The files need not exist.
void name_annotation(Session& session, const std::filesystem::path& session_file);
/// The extensions of all files of a session NAME.json: those of `name_annotation`, and those of older sessions. A name
/// is free only if no file with any of these extensions exists.
inline constexpr const char* SESSION_EXTENSIONS[] = {".json",   ".labels.zarr", ".offsets.zarr", ".mask",
                                                     ".offset", ".graphml",     ".journal"};

struct AnnotationNames {
    std::filesystem::path mask, trace, density;
};
/// Returns names in sparse formats for a project (PROJECT/shvr/session.json) that has a `.mask` or `.offset` inside the
/// project. The mask becomes PROJECT/labels/NAME if the project is an OME-Zarr, else NAME.zarr next to the old mask;
/// offsets become NAME.offsets.zarr. If a name is taken, NAME-2 and so on. Null if nothing is to be renamed.
std::optional<AnnotationNames> sparse_names(const Session& session, const std::filesystem::path& session_file);
/// Returns the text of a session file with these names under `annotation`. Apart from them, only the layout changes.
std::string with_names(const std::string& text, const AnnotationNames& names,
                       const std::filesystem::path& session_file);

}  // namespace shvr
