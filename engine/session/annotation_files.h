#pragma once
// The files in which a session keeps its annotation: their names, sparse ones (OME-Zarr) for new sessions, and which of
// them lie outside its folder. A session says where its annotation is saved; one from a stranger could name any file of
// the user's, directly, through ".." or through a symbolic link. Outside its own folder nothing is written before the
// user agrees. Any thread.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "engine/session/session.h"

namespace shvr {

/// The files that annotating and saving would write outside the folder of the session file (for a project: outside the
/// project), in words: "annotation.mask, which is /home/me/notes.mask". Files that `settings` ("key=value") name are
/// the user's own choice. Empty: none.
std::string files_outside(const Session& session, const std::filesystem::path& session_file,
                          const std::vector<std::string>& settings);

/// The mask of a new session file NAME.json: NAME.labels.zarr; NAME.mask if that exists and the other does not.
std::filesystem::path mask_beside(const std::filesystem::path& session_file);
/// The default for density offsets of a session with that mask: the mask's name with `.offsets.zarr`, or `.offset` for
/// masks that are no label images and wherever that exists. Those of IMAGE/labels/NAME are in IMAGE/shvr.
std::filesystem::path offsets_beside(const std::filesystem::path& mask);
/// The same for the trace, with `.graphml`.
std::filesystem::path trace_beside(const std::filesystem::path& mask);

/// Names all annotation files of a session saved as NAME.json, none of which need exist.
void name_annotation(Session& session, const std::filesystem::path& session_file);
/// The extensions of the files of a session NAME.json that `name_annotation` names, and those of older ones: a name is
/// free only if none of them exists.
inline constexpr const char* SESSION_EXTENSIONS[] = {".json",   ".labels.zarr", ".offsets.zarr", ".mask",
                                                     ".offset", ".graphml",     ".journal"};

struct AnnotationNames {
    std::filesystem::path mask, trace, density;
};
/// The sparse names for a project (PROJECT/shvr/session.json) whose session names a `.mask` or an `.offset` inside the
/// project: PROJECT/labels/NAME if the project is an OME-Zarr, else NAME.zarr next to the mask; NAME.offsets.zarr; or
/// NAME-2 and so on where a name is taken. Null if nothing is to be renamed.
std::optional<AnnotationNames> sparse_names(const Session& session, const std::filesystem::path& session_file);
/// The text of a session file with these names under `annotation`; nothing else differs but its layout.
std::string with_names(const std::string& text, const AnnotationNames& names,
                       const std::filesystem::path& session_file);

}  // namespace shvr
