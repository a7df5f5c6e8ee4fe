#include "engine/session/picture_session.h"

#include <utility>

#include "engine/base/error.h"
#include "engine/base/image_tiff.h"

namespace shvr {

namespace fs = std::filesystem;

namespace {

const char *const SESSION_TEXT = "SHVR session", *const PROJECT_TEXT = "SHVR project",
                  *const OUTLINE_TEXT = "SHVR outline";
const char *const NO_OUTLINE = "none", *const POINT = "point";
const char* const CAMERA_OF_PICTURE = "picture";

bool is_picture(const fs::path& path)
{
    std::error_code ignored;
    return (path.extension() == ".png" || is_tiff_name(path)) && fs::is_regular_file(path, ignored);
}

std::optional<std::string> text_in(const fs::path& picture, const char* keyword)
{
    return is_tiff_name(picture) ? read_tiff_text(picture, keyword) : read_png_text(picture, keyword);
}

fs::path folder_of(const fs::path& picture)
{
    return fs::absolute(picture).lexically_normal().parent_path();
}

}  // namespace

PictureTexts texts_of_picture(Session session, const Camera& camera, const fs::path& picture, const fs::path& project,
                              PictureProbe probe)
{
    session.cameras[CAMERA_OF_PICTURE] = camera;
    session.camera_name = CAMERA_OF_PICTURE;
    if (probe == PictureProbe::none) {
        session.probe.shown = session.probe.shell = false;
        session.probe.preview = false;
    }
    const bool is_of_window = probe == PictureProbe::plain || probe == PictureProbe::point;
    if (is_of_window) session.probe.shown = true;
    PictureTexts texts{{SESSION_TEXT, to_text(session, folder_of(picture))}};
    if (is_of_window) texts.emplace_back(OUTLINE_TEXT, probe == PictureProbe::point ? POINT : NO_OUTLINE);
    if (!project.empty())
        texts.emplace_back(PROJECT_TEXT,
                           fs::absolute(project).lexically_normal().lexically_proximate(folder_of(picture)).string());
    return texts;
}

PictureProbe probe_of_picture(const fs::path& picture)
{
    const std::optional<std::string> text = text_in_picture(picture, OUTLINE_TEXT);
    return text == NO_OUTLINE ? PictureProbe::plain : text == POINT ? PictureProbe::point : PictureProbe::as_rendered;
}

std::optional<std::string> text_in_picture(const fs::path& picture, const char* keyword)
{
    return is_picture(picture) ? text_in(picture, keyword) : std::nullopt;
}

std::optional<PictureSession> session_in_picture(const fs::path& picture)
{
    if (!is_picture(picture)) return std::nullopt;
    const std::optional<std::string> text = text_in(picture, SESSION_TEXT);
    if (!text && is_tiff_name(picture)) return std::nullopt;  // a volume
    if (!text)
        fail(picture.string(),
             ": is a picture without a session in it; expected one that shvr made with --with-session, or a "
             "session, a project folder or a volume");
    PictureSession found{*text, {}};
    if (const std::optional<std::string> project = text_in(picture, PROJECT_TEXT))
        found.project = (folder_of(picture) / *project).lexically_normal();
    return found;
}

}  // namespace shvr
