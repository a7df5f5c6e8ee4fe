#pragma once
// The session inside a picture: what a .png file keeps in texts of its own, so that the picture can be made again.
//
//   "SHVR session"   the session as in its file (README.md), with the picture's size and camera; paths are relative to
//                    the picture's folder
//   "SHVR project"   the session's file that the picture was made of, relative to the same folder; none for a bare
//                    volume. The journal beside it holds the annotation
//   "SHVR outline"   "none" where the probe has no outline
//
// Annotation is not in the picture: where it has changed since, the picture made again shows it as it is now. Programs
// that write pictures anew drop the texts. Any thread may call these.

#include <optional>

#include "engine/base/image_file.h"
#include "engine/session/session.h"

namespace shvr {

/// How the picture shows the probe.
enum class PictureProbe {
    none,
    plain,        ///< as the window does: always, and without an outline over what hides it
    as_rendered,  ///< as `shvr render` does: where the session says so, with its outline
};
/// `picture`: its file. `project`: as above; may be empty.
PictureTexts texts_of_picture(Session session, const Camera& camera, const std::filesystem::path& picture,
                              const std::filesystem::path& project, PictureProbe probe);
/// Whether a picture made again from that file has the probe's outline: not where it is one of the window.
bool outlines_probe(const std::filesystem::path& picture);

struct PictureSession {
    std::string text;
    std::filesystem::path project;  ///< absolute; empty: none
};
/// Nothing where the file is no PNG file. Fails where it is one and holds no session.
std::optional<PictureSession> session_in_picture(const std::filesystem::path& picture);

}  // namespace shvr
