#include "engine/workbench/sight/figure.h"

#include <cmath>
#include <utility>

namespace shvr::ui {

namespace {

/// Returns the labels' texts with their rims, and adds to the strokes the lines to labels that are far away.
std::vector<Stamp> stamps_of(Marks& marks, const glm::dvec2& pane, double units, const TextDrawer& draw_texts)
{
    const std::vector<Label>& labels = marks.labels;
    std::vector<std::string> texts;
    for (const Label& label : labels) texts.push_back(label.text);
    std::vector<TextImage> images = draw_texts(texts, FONT_UNITS * units);
    std::vector<glm::dvec2> sizes;
    for (const TextImage& image : images) sizes.push_back(image.pixels);
    spread_labels(marks, sizes, LABEL_MARGIN * units, pane);
    std::vector<Stamp> stamps;
    for (size_t i = 0; i < labels.size(); ++i) {
        const glm::dvec2 begin = labels[i].at - labels[i].anchor * glm::dvec2(images[i].pixels);
        Stamp words{.begin = glm::ivec2(glm::round(begin)),
                    .pixels = images[i].pixels,
                    .coverage = std::move(images[i].coverage),
                    .color = labels[i].color};
        stamps.push_back(rim_of(words, int(rim_width(FONT_UNITS * units)), rim_color(words.color)));
        stamps.push_back(std::move(words));
    }
    return stamps;
}

}  // namespace

Figure figure_of(const Model& model, std::span<const Pane> panes, double units, const TextDrawer& draw_texts)
{
    Figure figure;
    for (size_t i = 0; i < panes.size(); ++i) {
        Marks marks = marks_of(model, panes[i], i, units, MarksFor::picture);
        Figure::Part part{.box = panes[i].box, .strokes{}, .stamps{}};
        if (draw_texts && !marks.labels.empty()) part.stamps = stamps_of(marks, panes[i].pixels(), units, draw_texts);
        part.strokes = std::move(marks.strokes);
        figure.parts.push_back(std::move(part));
    }
    return figure;
}

void draw(const Figure& figure, ImageF& rows, uint32_t first_row)
{
    for (const Figure::Part& part : figure.parts) {
        draw_strokes(rows, part.strokes, part.box, first_row);
        draw_stamps(rows, part.stamps, part.box, first_row);
    }
}

void draw(const Figure& figure, Image8& picture)
{
    for (const Figure::Part& part : figure.parts) {
        draw_strokes(picture, part.strokes, part.box);
        draw_stamps(picture, part.stamps, part.box);
    }
}

}  // namespace shvr::ui
