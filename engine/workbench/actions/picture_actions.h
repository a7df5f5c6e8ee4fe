#pragma once
// Actions that make pictures for publications: figures and movies.

#include <array>
#include <string>
#include <vector>

#include "engine/base/text.h"
#include "engine/workbench/actions/action_row.h"

namespace shvr::ui {

class Photographer;

/// A text at a point of the volume.
struct TextInFigure {
    glm::dvec3 voxel{0.0};
    std::string text;
};
inline constexpr size_t MAX_FIGURE_TEXTS = 100;
inline constexpr double MIN_TEXT_PIXELS = 6.0, MAX_TEXT_PIXELS = 1000.0;

/// What publications need over a picture (engine/workbench/sight/figure_elements.h).
struct DrawnElements {
    bool has_scale_bar = false;  ///< in each view and slice: a line of a rounded length. In perspective its label says
                                 ///< where it holds
    bool has_color_bar = false;  ///< colours of the transfer function, and its opacity relative to its maximum
    bool has_legend = false;     ///< colours and names of the groups that are drawn
    bool has_axes = false;       ///< directions of x, y and z
    bool has_measurements = false;  ///< in each view and slice: lines, names and values of the session's measurements
    std::string title;
    std::vector<TextInFigure> texts;
    double text_pixels = 0.0;  ///< height of a line of text; 0: automatic_text_pixels()
    bool is_empty() const
    {
        return !has_scale_bar && !has_color_bar && !has_legend && !has_axes && !has_measurements && title.empty() &&
               texts.empty();
    }
};

/// Draws the present view as a figure, with what publications need over it.
struct FigureTask {
    static constexpr const char* TITLE = "Figure";

    std::filesystem::path path;   ///< .png or .tif; with `is_copied` empty
    bool is_copied = false;       ///< the picture goes to the clipboard instead of to a file
    glm::ivec2 pixels{0};         ///< 0, 0: as the window's picture
    double dots_per_inch = 0.0;   ///< stored in the file; 0: none
    bool is_transparent = false;  ///< the background
    DrawnElements elements;
};

/// Draws a movie that turns the volume, or goes from view to view.
struct MovieTask {
    static constexpr const char* TITLE = "Movie";

    std::filesystem::path path;  ///< .webm, .mp4, or a folder for frames
    std::string views;           ///< names of views, with looks kept with them, one per line; empty: the present one
    double turntable_degrees = 0.0;
    int frames = 120;
    double frames_per_second = 30.0;
    glm::ivec2 pixels{0};    ///< as in FigureTask
    DrawnElements elements;  ///< over each frame
};

inline constexpr const char* PICTURES_GROUP = "Pictures";
inline constexpr const char* IS_DRAWING_PICTURE = "another picture is being drawn; wait for it, or cancel it";

/// Number of the job that draws a large screenshot, a figure or a movie.
inline constexpr uint64_t PICTURE_JOB = (uint64_t{1} << 49) + 1;
inline constexpr auto is_drawing_picture = [](const auto& model) {
    return std::ranges::any_of(model.jobs, [](const auto& job) { return job.number == PICTURE_JOB; });
};

template <class Visitor>
void size_field(Visitor& f, glm::ivec2& pixels)
{
    std::vector<int64_t> values{pixels.x, pixels.y};
    f.wholes("pixels", values, 0, 65536, {"width and height; 0, 0: as the window's picture"});
    pixels = {int(values[0]), int(values[1])};
}

/// Without the height of texts, which only `shvr render` states.
template <class Visitor>
void element_fields(Visitor& f, DrawnElements& elements)
{
    f.flag("scale_bar", elements.has_scale_bar, {"a line of a rounded length"});
    f.flag("color_bar", elements.has_color_bar, {"colours and opacity of the transfer function"});
    f.flag("legend", elements.has_legend, {"colours and names of the groups"});
    f.flag("axes", elements.has_axes, {"directions of x, y and z"});
    f.flag("measurements", elements.has_measurements, {"lines, names and values of the measurements"});
    f.text("title", elements.title, {"above the picture"});
    const auto visit = [&](auto& item, size_t index, size_t count) {
        elements.texts.resize(count);
        item.vector("voxel", elements.texts[index].voxel, VOXELS, {.is_required = true});
        item.text("text", elements.texts[index].text, {.is_required = true});
    };
    f.items("texts", elements.texts.size(), MAX_FIGURE_TEXTS, visit, {"texts at points"});
}

inline constexpr auto PICTURE_ACTIONS = std::tuple{
    row<FigureTask, Photographer>(
        {"figure", "Figure", PICTURES_GROUP,
         "draws the view as a figure for publications, into a file or into the clipboard"},
        [](auto& f, FigureTask& a) {
            f.path("path", a.path, {"the picture: .png, .tif"});
            f.flag("copied", a.is_copied, {"the picture goes to the clipboard instead"});
            size_field(f, a.pixels);
            f.number("dots_per_inch", a.dots_per_inch, {0.0, 10'000.0}, {"stored in the file; 0: none"});
            f.flag("transparent", a.is_transparent, {"the background"});
            element_fields(f, a.elements);
        },
        [](const auto& model, const FigureTask& task) -> std::string {
            if (is_drawing_picture(model)) return IS_DRAWING_PICTURE;
            if (task.is_copied) return task.path.empty() ? "" : "a copied figure has no path";
            const std::string ending = lower_case(task.path.extension().string());
            constexpr std::array ENDINGS{".png", ".tif", ".tiff"};
            return std::ranges::find(ENDINGS, ending) != ENDINGS.end()
                       ? ""
                       : "the figure's name is \"" + task.path.filename().string() +
                             "\"; expected one that ends in .png or .tif";
        }),
    row<MovieTask, Photographer>(
        {"movie", "Movie", PICTURES_GROUP, "draws a movie that turns the volume, or goes from view to view"},
        [](auto& f, MovieTask& a) {
            f.path("path", a.path,
                   {.meaning = "the movie: .webm, .mp4, or a folder for frames as .png", .is_required = true});
            f.text("views", a.views,
                   {"names of views to go through, one per line, with looks kept with them; empty: the present one"});
            f.number("turntable_degrees", a.turntable_degrees, {-360'000.0, 360'000.0},
                     {"degrees by which the volume turns"});
            f.whole("frames", a.frames, 1, 100'000, {"number of pictures"});
            f.number("frames_per_second", a.frames_per_second, {0.1, 240.0}, {"speed of a .webm or .mp4"});
            size_field(f, a.pixels);
            element_fields(f, a.elements);
        },
        [](const auto& model, const MovieTask& task) -> std::string {
            if (is_drawing_picture(model)) return IS_DRAWING_PICTURE;
            const bool goes = task.views.find('\n') != std::string::npos;
            if (!goes && task.turntable_degrees == 0.0)
                return "one view that does not turn stands still: add a second view, or let the volume turn";
            return why_not_through(model, task.views);
        })};

}  // namespace shvr::ui
