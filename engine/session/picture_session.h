#pragma once
// The session inside a picture: what a .png file keeps in texts of its own, so that the picture can be made again.
//
//   "SHVR session"   the session as in its file (README.md), with the picture's size and camera; paths are relative to
//                    the picture's folder
//   "SHVR project"   the session's file that the picture was made of, relative to the same folder; none for a bare
//                    volume. The journal beside it holds the annotation
//
// Annotation is not in the picture: where it has changed since, the picture made again shows it as it is now. Programs
// that write pictures anew drop the texts. Any thread may call these.

#include <optional>

#include "engine/base/image_file.h"
#include "engine/session/session.h"

namespace shvr {

/// `picture`: its file. `project`: as above; may be empty. `shows_probe`: as the session says, or not at all.
PictureTexts texts_of_picture(Session session, const Camera& camera, const std::filesystem::path& picture,
                              const std::filesystem::path& project, bool shows_probe);

struct PictureSession {
    std::string text;
    std::filesystem::path project;  ///< absolute; empty: none
};
/// Nothing where the file is no PNG file. Fails where it is one and holds no session.
std::optional<PictureSession> session_in_picture(const std::filesystem::path& picture);

}  // namespace shvr
