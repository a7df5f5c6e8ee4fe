#pragma once
// The files in which a session keeps its annotation: their names, the sparse names (OME-Zarr) of new sessions, and the
// files outside the session's folder. A session states where its annotation is saved, so a session from a stranger
// could name any file of the user: directly, through ".." or through a symbolic link. Nothing is written outside the
// session's folder before the user agrees. Any thread.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "engine/session/session.h"

namespace shvr {

/// Describes the files that annotating and saving would write outside the folder of the session file (for a project:
/// outside the project): "annotation.mask, which is /home/me/notes.mask". Leaves out files that `settings`
/// ("key=value") name, because they are the user's own choice. Empty: none.
std::string files_outside(const Session& session, const std::filesystem::path& session_file,
                          const std::vector<std::string>& settings);

/// The mask of a new session file NAME.json: NAME.labels.zarr, or NAME.mask if only NAME.mask exists.
std::filesystem::path mask_beside(const std::filesystem::path& session_file);
/// The default file of density offsets for a session with that mask: the mask's name with `.offsets.zarr`, or `.offset`
/// if that file exists or the mask is no label image. For IMAGE/labels/NAME, the file is in IMAGE/shvr.
std::filesystem::path offsets_beside(const std::filesystem::path& mask);
/// Like offsets_beside, for the trace, with `.graphml`.
std::filesystem::path trace_beside(const std::filesystem::path& mask);

/// Names all annotation files of a session saved as NAME.json. The files need not exist.
void name_annotation(Session& session, const std::filesystem::path& session_file);
/// The extensions of the files of a session NAME.json: those that `name_annotation` uses, and those of older sessions.
/// A name is free only if no file with any of these extensions exists.
inline constexpr const char* SESSION_EXTENSIONS[] = {".json",   ".labels.zarr", ".offsets.zarr", ".mask",
                                                     ".offset", ".graphml",     ".journal"};

struct AnnotationNames {
    std::filesystem::path mask, trace, density;
};
/// The sparse names for a project (PROJECT/shvr/session.json) whose session names a `.mask` or an `.offset` inside the
/// project. The mask becomes PROJECT/labels/NAME if the project is an OME-Zarr, else NAME.zarr next to the old mask;
/// offsets become NAME.offsets.zarr. NAME-2 and so on replace taken names. Null if nothing is to be renamed.
std::optional<AnnotationNames> sparse_names(const Session& session, const std::filesystem::path& session_file);
/// Returns the text of a session file with these names under `annotation`; otherwise, only its layout changes.
std::string with_names(const std::string& text, const AnnotationNames& names,
                       const std::filesystem::path& session_file);

}  // namespace shvr
