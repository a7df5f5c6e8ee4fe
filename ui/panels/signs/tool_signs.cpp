#include <cmath>

#include "ui/panels/signs/signs.h"

namespace shvr::ui {

namespace {

void draw_turn(const Pen& pen)
{
    constexpr float RADIUS = 0.34f, FROM = -0.6f, TO = 4.1f;
    pen.arc(0.5f, 0.52f, RADIUS, FROM, TO);
    const float x = 0.5f + RADIUS * std::cos(FROM), y = 0.52f + RADIUS * std::sin(FROM);
    pen.list.AddTriangleFilled(pen.at(x - 0.2f, y - 0.02f), pen.at(x + 0.14f, y + 0.06f), pen.at(x + 0.08f, y - 0.28f),
                               pen.color);
}

void draw_paint(const Pen& pen)
{
    pen.line(0.9f, 0.1f, 0.52f, 0.5f);
    pen.list.AddTriangleFilled(pen.at(0.44f, 0.42f), pen.at(0.6f, 0.58f), pen.at(0.1f, 0.92f), pen.color);
    pen.disc(0.36f, 0.66f, 0.15f);
}

void draw_erase(const Pen& pen)
{
    const ImVec2 block[] = {pen.at(0.1f, 0.62f), pen.at(0.52f, 0.18f), pen.at(0.82f, 0.44f), pen.at(0.42f, 0.88f)};
    pen.list.AddPolyline(block, 4, pen.color, ImDrawFlags_Closed, pen.stroke());
    pen.line(0.3f, 0.4f, 0.62f, 0.67f);
    pen.line(0.42f, 0.9f, 0.95f, 0.9f);
}

void draw_trace(const Pen& pen)
{
    pen.line(0.16f, 0.8f, 0.42f, 0.36f);
    pen.line(0.42f, 0.36f, 0.84f, 0.2f);
    pen.disc(0.16f, 0.8f, 0.13f);
    pen.disc(0.42f, 0.36f, 0.13f);
    pen.disc(0.84f, 0.2f, 0.13f);
}

void draw_select(const Pen& pen)
{
    const ImVec2 arrow[] = {pen.at(0.26f, 0.08f), pen.at(0.26f, 0.8f),  pen.at(0.44f, 0.63f), pen.at(0.57f, 0.92f),
                            pen.at(0.69f, 0.86f), pen.at(0.56f, 0.58f), pen.at(0.8f, 0.56f)};
    pen.list.AddPolyline(arrow, 7, pen.color, ImDrawFlags_Closed, pen.stroke());
}

void draw_measure(const Pen& pen)
{
    pen.line(0.1f, 0.3f, 0.1f, 0.7f);
    pen.line(0.9f, 0.3f, 0.9f, 0.7f);
    pen.line(0.1f, 0.5f, 0.9f, 0.5f);
    for (const float x : {0.3f, 0.5f, 0.7f}) pen.line(x, 0.5f, x, 0.62f);
}

}  // namespace

void draw_clip_box(const Pen& pen)
{
    pen.frame(0.2f, 0.24f, 0.8f, 0.8f);
    for (const float x : {0.2f, 0.8f}) pen.disc(x, 0.52f, 0.12f);
    for (const float y : {0.24f, 0.8f}) pen.disc(0.5f, y, 0.12f);
}

void draw_cut_plane(const Pen& pen)
{
    pen.line(0.04f, 0.72f, 0.96f, 0.28f);
    pen.line(0.2f, 0.64f, 0.2f, 0.9f);
    pen.line(0.8f, 0.36f, 0.8f, 0.9f);
    pen.line(0.2f, 0.9f, 0.8f, 0.9f);
}

void draw_sign(Tool tool, const Pen& pen)
{
    switch (tool) {
        case Tool::turn: return draw_turn(pen);
        case Tool::paint: return draw_paint(pen);
        case Tool::erase: return draw_erase(pen);
        case Tool::trace: return draw_trace(pen);
        case Tool::select: return draw_select(pen);
        case Tool::measure: return draw_measure(pen);
    }
}

}  // namespace shvr::ui
