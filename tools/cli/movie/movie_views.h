#pragma once
// The views that `shvr render --movie --keys` names.

#include <optional>
#include <string>
#include <vector>

#include "engine/movie/movie.h"
#include "tools/cli/cli.h"

namespace shvr::cli {

/// A view as stated, read as far as possible without the volume.
struct StatedView {
    std::string name;                   ///< as stated
    std::string camera;                 ///< for `camera_named`; empty: that of the movie
    std::string patch;                  ///< JSON merge patch of session settings; empty: none
    std::optional<Session> session;     ///< the session of a file or picture, with its looks and its camera
    bool has_transfer_function = true;  ///< whether `session` states one
};

/// Reads views separated by commas, which do not count within braces, brackets and quotes:
///
///   NAME         a camera of the session, with the look that was kept with it, or a side
///   {...}        a camera, or settings of the session with or without "camera"
///   FILE.json    either of these, or a session
///   FILE.png     a picture that holds its session
///
/// Fails if a file cannot be read, or holds anything else.
std::vector<StatedView> stated_views(const std::string& keys);

/// Fails if the view names a camera that does not exist, as `check_camera` does.
void check_view(const StatedView& view, const Session& session, const VolumeInfo& volume);
/// Returns the view of an opened session. `camera`: the movie's, as named on the command line. Fails if the view is of
/// another volume.
MovieView view_of(const StatedView& view, const Opened& opened, const std::string& camera);

}  // namespace shvr::cli
