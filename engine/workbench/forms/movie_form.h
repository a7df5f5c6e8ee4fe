#pragma once
// The dialog Movie: degrees or views, seconds, frames per second, size, what is drawn over its frames, and the file.
// Pure, except for check and replaced_files, which read the disk; any thread.

#include <string>
#include <vector>

#include "engine/workbench/actions/picture_actions.h"
#include "engine/workbench/forms/figure_form.h"
#include "engine/workbench/models/model.h"

namespace shvr::ui {

enum class MovieKind : uint8_t { webm, mp4, frames };

struct MovieForm {
    std::string path;       ///< as typed
    std::string suggested;  ///< the path that was suggested; one that was typed is kept
    MovieKind kind = MovieKind::webm;
    bool goes_through_views = false;  ///< otherwise it turns
    double degrees = 360.0;
    std::vector<std::string> views;    ///< in their order
    std::vector<std::string> offered;  ///< those kept with their looks that have been in `views`, also if removed since
    bool keeps_shown = false;          ///< what the window shows is to be kept as the next view
    double seconds = 4.0;
    MovieTask more{.pixels = {1280, 720}};
    ElementsForm elements;
};

/// Returns a form for the present view, with a name next to the scan. `last`: choices to use again, except numbers that
/// no movie can have.
MovieForm suggested_movie(const Model& model, const MovieForm& last);
/// Adds the views that were kept with their looks since the last call, so that the movie goes through them.
void offer_kept_looks(MovieForm& form, const Session& session);
/// Moves a view to the place of the one before it.
void move_up(MovieForm& form, size_t view);
/// Returns what a movie mixes on the way between two views besides the camera: "changes cut, light"; empty: nothing.
std::string change_between(const Session& session, const std::string& from, const std::string& to);
/// Chooses what is written, and suggests a name for it, unless another name was typed.
void choose_kind(MovieForm& form, MovieKind kind);
std::string why_not(const MovieForm& form);
/// `folder`: where relative names lie.
MovieTask task_of(const MovieForm& form, const std::filesystem::path& folder);
/// Fails if the movie cannot be written there.
void check(const MovieTask& task);
std::vector<std::filesystem::path> replaced_files(const MovieTask& task);

}  // namespace shvr::ui
