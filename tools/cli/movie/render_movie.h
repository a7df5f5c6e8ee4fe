#pragma once
// shvr render --movie: draws the frames of a movie, as PNG files or into a movie file.

#include <optional>
#include <string>

#include "tools/cli/cli.h"
#include "tools/cli/figure/figure_options.h"

namespace shvr::cli {

struct MovieOptions {
    std::string path;  ///< a movie file, or a folder for PNG files; empty: no movie
    std::string keys;
    std::optional<double> turntable_degrees;
    std::optional<int64_t> frames;
    std::optional<double> frames_per_second;
};
void add_movie_options(CLI::App& command, MovieOptions& options);

/// `camera`, `with_session`, `figure`: as for a picture. `common.settings` contains the size and the transfer function.
struct MovieRequest {
    Common common;
    std::string input, camera;
    bool with_session = false;
    FigureOptions figure;
    MovieOptions movie;
};
void render_movie(const MovieRequest& request);

}  // namespace shvr::cli
