#pragma once
// The session inside a picture: text chunks of a .png file from which the picture can be rendered again.
//
//   "SHVR session"   the session as in its file (README.md), with the picture's size and camera; paths are relative to
//                    the picture's folder
//   "SHVR project"   the session file from which the picture was made, relative to the picture's folder; none for a
//                    bare volume. The journal next to the session file contains the annotation
//   "SHVR outline"   "none" if the probe has no outline
//
// Annotation is not stored in the picture: if it has changed since the picture was made, a new picture shows its
// current state. Programs that re-encode pictures drop the text chunks. Any thread may call these.

#include <optional>

#include "engine/base/image_file.h"
#include "engine/session/session.h"

namespace shvr {

/// How the picture shows the probe.
enum class PictureProbe {
    none,
    plain,        ///< shown as in the window: always, without an outline over objects that hide it
    as_rendered,  ///< shown as by `shvr render`: only if the session shows it, with its outline
};
/// `picture`: the picture's file. `project`: the "SHVR project" described above; may be empty.
PictureTexts texts_of_picture(Session session, const Camera& camera, const std::filesystem::path& picture,
                              const std::filesystem::path& project, PictureProbe probe);
/// Whether a picture rendered from that file outlines the probe; false for pictures taken in the window.
bool outlines_probe(const std::filesystem::path& picture);

struct PictureSession {
    std::string text;
    std::filesystem::path project;  ///< absolute; empty: none
};
/// Returns null if the file is not a PNG file. Fails if it is a PNG file without a session.
std::optional<PictureSession> session_in_picture(const std::filesystem::path& picture);

}  // namespace shvr
