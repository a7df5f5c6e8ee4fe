#include "tools/cli/figure/figure_options.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "engine/base/text.h"
#include "engine/workbench/actions/figure_text.h"
#include "engine/workbench/lists/group_list.h"
#include "engine/workbench/sight/print_size.h"
#include "ui/picture_texts.h"

namespace shvr::cli {

namespace {

/// Reads "X,Y,Z:TEXT".
ui::TextInFigure parse_figure_text(const std::string& given)
{
    const size_t colon = given.find(':');
    ui::TextInFigure result{.voxel = {}, .text = colon == given.npos ? "" : given.substr(colon + 1)};
    std::string_view rest = std::string_view(given).substr(0, std::min(colon, given.size()));
    bool fits = !trimmed(result.text).empty();
    for (int axis = 0; axis < 3 && fits; ++axis) {
        const size_t comma = std::min(rest.find(','), rest.size());
        const std::optional<double> number = number_of(trimmed(rest.substr(0, comma)));
        fits = number && std::isfinite(*number) && (comma < rest.size()) == (axis < 2);
        if (fits) result.voxel[axis] = *number;
        rest.remove_prefix(std::min(comma + 1, rest.size()));
    }
    if (!fits)
        throw UsageError(
            sentence("--text is ", in_quotes(given), "; expected X,Y,Z:TEXT in voxels, as in 12.5,40,7:stem"));
    return result;
}

/// Returns what the input keeps, if it is a picture, with the given height of texts, or if that is 0 with the kept one.
ui::DrawnElements kept_elements(const std::filesystem::path& input, double text_pixels)
{
    ui::DrawnElements kept = ui::elements_in_picture(input).value_or(ui::DrawnElements());
    if (text_pixels != 0.0) kept.text_pixels = text_pixels;
    return kept;
}

}  // namespace

void add_figure_options(CLI::App& command, FigureOptions& options)
{
    ui::DrawnElements& elements = options.elements;
    command.add_flag("--scale-bar", elements.has_scale_bar, "Draw a line of a rounded length, with the length");
    command.add_flag("--color-bar", elements.has_color_bar,
                     "Draw colours and opacity of the transfer function, with intensities");
    command.add_flag("--legend", elements.has_legend,
                     "Draw colours and names of the groups that are painted or traced");
    command.add_flag("--axes", elements.has_axes, "Draw the directions of x, y and z");
    command.add_flag("--measurements", elements.has_measurements,
                     "Draw lines, names and values of the session's measurements");
    command.add_option("--title", elements.title, "Draw a title");
    command.add_option("--text", options.texts, "Draw a dot and a text at a voxel, as in 12.5,40,7:stem; repeatable")
        ->allow_extra_args(false);
    command.add_flag("--no-elements", options.draws_none,
                     "Draw none of these, not even those that a picture which is drawn again keeps");
    command.add_option(
        "--dpi", options.dots_per_inch,
        sentence("Dots per inch, stored in the picture, and for a --size in mm (default there: ", PRINT_DPI, ")"));
    command.add_option(
        "--text-pixels", elements.text_pixels,
        "Height of a line of text in these (default: 1/28 of the shorter side of the first view, at least 10)");
}

glm::uvec2 take_picture_size(const std::string& text, FigureOptions& options)
{
    if (!text.ends_with("mm")) return parse_size(text);
    if (!options.dots_per_inch) options.dots_per_inch = PRINT_DPI;
    const std::string numbers = text.substr(0, text.size() - std::string_view("mm").size());
    const size_t times = std::min(numbers.find('x'), numbers.size());
    const std::optional<double> width = number_of(trimmed(std::string_view(numbers).substr(0, times)));
    const std::optional<double> height =
        times < numbers.size() ? number_of(trimmed(std::string_view(numbers).substr(times + 1))) : std::nullopt;
    const glm::uvec2 size =
        width && height ? pixels_of_print({*width, *height}, *options.dots_per_inch) : glm::uvec2(0);
    if (size.x == 0 || size.y == 0)
        throw UsageError(sentence("--size is ", in_quotes(text), "; expected WIDTHxHEIGHTmm with 1 to ", MAX_IMAGE_SIDE,
                                  " pixels along each side, as in 85x60mm"));
    return size;
}

void add_figure_texts(PictureTexts& texts, const FigureOptions& options)
{
    if (!texts.empty()) ui::add_elements(texts, options.elements);
    if (options.dots_per_inch) texts.emplace_back(PICTURE_DPI, digits_of(*options.dots_per_inch));
}

void check_figure(FigureOptions& options, const std::filesystem::path& input, bool has_size)
{
    if (!options.dots_per_inch && !has_size)
        if (const std::optional<std::string> kept = text_in_picture(input, PICTURE_DPI))
            options.dots_per_inch = number_of(*kept);
    const double dpi = options.dots_per_inch.value_or(PRINT_DPI);
    if (!(dpi >= MIN_PRINT_DPI && dpi <= MAX_PRINT_DPI))
        throw UsageError(sentence("--dpi is ", dpi, "; expected a number from ", MIN_PRINT_DPI, " to ", MAX_PRINT_DPI));
    const double pixels = options.elements.text_pixels;
    if (pixels != 0.0 && !(pixels >= ui::MIN_TEXT_PIXELS && pixels <= ui::MAX_TEXT_PIXELS))
        throw UsageError(sentence("--text-pixels is ", pixels, "; expected a number from ", ui::MIN_TEXT_PIXELS, " to ",
                                  ui::MAX_TEXT_PIXELS));
    for (const std::string& text : options.texts) options.elements.texts.push_back(parse_figure_text(text));
    if (options.elements.is_empty() && !options.draws_none) options.elements = kept_elements(input, pixels);
    if (pixels != 0.0 && options.elements.is_empty())
        throw UsageError(
            "--text-pixels is given without anything to draw; expected it with --title, --scale-bar, "
            "--color-bar, --legend, --axes, --measurements or --text");
}

PictureFile::Over figure_over(const FigureOptions& options, const Opened& opened, const Session& session,
                              const Camera& camera, std::vector<std::string>& left_out, ui::FigureMemory* memory)
{
    if (options.elements.is_empty()) return {};
    const VolumeInfo& volume = opened.source->info();
    const glm::dvec3 probe_voxel = session.probe.voxel.value_or(0.5 * glm::dvec3(volume.size));
    const std::vector<Pane> panes = panes_of(session.view, camera, session.render.size, volume, probe_voxel);
    const Document& document = opened.annotator->document();
    const std::vector<uint8_t> groups = ui::drawn_groups(session, document.mask.voxels_by_group(), document.trace);
    std::vector<std::string> sentences;
    auto figure = std::make_shared<ui::Figure>(
        ui::figure_of(options.elements, {session, volume, panes, groups, memory}, ui::draw_picture_texts, sentences));
    for (const std::string& each : sentences)
        if (std::ranges::find(left_out, each) == left_out.end()) left_out.push_back(each);
    return [figure](ImageF& rows, uint32_t first_row) { ui::draw(*figure, rows, first_row); };
}

}  // namespace shvr::cli
