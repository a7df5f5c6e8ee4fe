#pragma once
// The session inside a picture: texts in a .png or .tif file from which the picture can be rendered again.
//
//   "SHVR session"   the session as in its file (README.md), with the picture's size and camera; paths are relative to
//                    the picture's folder
//   "SHVR project"   the session file from which the picture was made, relative to the picture's folder; absent for a
//                    bare volume. The journal next to the session file contains the annotation
//   "SHVR outline"   "none" if the probe has no outline; "point" if it is a point without one
//   "SHVR figure"    what is drawn over it (engine/workbench/actions/figure_text.h)
//
// A picture does not contain annotation. If annotation has changed since the picture was made, a new picture shows its
// current state. Programs that re-encode pictures drop the text chunks. Any thread may call these.

#include <optional>

#include "engine/base/image_file.h"
#include "engine/session/session.h"

namespace shvr {

/// How the picture shows the probe.
enum class PictureProbe {
    none,
    plain,        ///< the probe is drawn as in the window: always, and without its outline
    point,        ///< likewise, as the point that the window draws inside the outline
    as_rendered,  ///< the probe is drawn as by `shvr render`: if the session shows it, with its outline
};
/// `picture`: path of the picture's file. `project`: the value of "SHVR project" above; may be empty.
PictureTexts texts_of_picture(Session session, const Camera& camera, const std::filesystem::path& picture,
                              const std::filesystem::path& project, PictureProbe probe);
/// Returns how pictures rendered from this file show the probe; `as_rendered` unless it was taken in the window.
PictureProbe probe_of_picture(const std::filesystem::path& picture);

/// Returns the text with this keyword in a picture's file; null if there is none, or the file is no picture.
std::optional<std::string> text_in_picture(const std::filesystem::path& picture, const char* keyword);

struct PictureSession {
    std::string text;
    std::filesystem::path project;  ///< absolute; empty: none
};
/// Returns null if the file is neither a PNG file nor a TIFF with a session. Fails if it is a PNG file without one.
std::optional<PictureSession> session_in_picture(const std::filesystem::path& picture);

}  // namespace shvr
