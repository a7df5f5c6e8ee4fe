#pragma once
// shvr render --scale-bar, --color-bar, --legend, --axes, --measurements, --title, --text: what is drawn over a
// picture, or over each frame of a movie, for publications.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "engine/picture/picture_file.h"
#include "engine/workbench/sight/figure_elements.h"
#include "tools/cli/cli.h"

namespace shvr::cli {

struct FigureOptions {
    ui::DrawnElements elements;
    bool draws_none = false;              ///< not even those that the input keeps
    std::vector<std::string> texts;       ///< as given: "X,Y,Z:TEXT"
    std::optional<double> dots_per_inch;  ///< stored in the picture
};
void add_figure_options(CLI::App& command, FigureOptions& options);
/// Returns the size in pixels of "512x384" or "85x60mm", which chooses a resolution if none is given. Throws UsageError
/// for anything else.
glm::uvec2 take_picture_size(const std::string& text, FigureOptions& options);
/// Adds the elements to the texts of a picture if it keeps its session, and the resolution, if there is one.
void add_figure_texts(PictureTexts& texts, const FigureOptions& options);
/// Reads the texts into the elements. Throws UsageError for a text that is not as expected. Without elements, takes
/// those that `input` keeps, if it is a picture; likewise the resolution, unless another size is asked for.
void check_figure(FigureOptions& options, const std::filesystem::path& input, bool has_size);

/// Returns what draws the elements over rows of the picture of `session` from `camera`; empty if there are none. Adds
/// to `left_out` what it cannot draw, each sentence once. `memory`: as in ui::FigureScene.
PictureFile::Over figure_over(const FigureOptions& options, const Opened& opened, const Session& session,
                              const Camera& camera, std::vector<std::string>& left_out,
                              ui::FigureMemory* memory = nullptr);

}  // namespace shvr::cli
