#include <cmath>
#include <iterator>
#include <numbers>

#include "engine/workbench/appearance/panel_rows.h"
#include "ui/panels/signs/signs.h"

namespace shvr::ui {

namespace {

constexpr float PI = std::numbers::pi_v<float>;

void curve(const Pen& pen)
{
    const ImVec2 points[] = {pen.at(0.08f, 0.88f), pen.at(0.35f, 0.62f), pen.at(0.6f, 0.28f), pen.at(0.92f, 0.16f)};
    pen.list.AddPolyline(points, 4, pen.color, ImDrawFlags_None, pen.stroke());
    pen.disc(0.35f, 0.62f, 0.11f);
    pen.disc(0.6f, 0.28f, 0.11f);
}

void squares(const Pen& pen)
{
    pen.block(0.1f, 0.1f, 0.44f, 0.44f);
    pen.frame(0.56f, 0.12f, 0.88f, 0.44f);
    pen.frame(0.12f, 0.56f, 0.44f, 0.88f);
    pen.block(0.56f, 0.56f, 0.9f, 0.9f);
}

void brush(const Pen& pen)
{
    pen.ring(0.5f, 0.5f, 0.38f);
    pen.disc(0.5f, 0.5f, 0.1f);
}

void stylus(const Pen& pen)
{
    pen.line(0.9f, 0.08f, 0.42f, 0.56f);
    pen.disc(0.4f, 0.58f, 0.1f);
    pen.arc(0.3f, 0.68f, 0.24f, 0.25f * PI, 1.25f * PI);
    pen.arc(0.26f, 0.72f, 0.1f, 0.25f * PI, 1.25f * PI);
}

void network(const Pen& pen)
{
    pen.line(0.5f, 0.9f, 0.5f, 0.5f);
    pen.line(0.5f, 0.5f, 0.16f, 0.16f);
    pen.line(0.5f, 0.5f, 0.84f, 0.16f);
    constexpr float NODES[][2] = {{0.5f, 0.86f}, {0.5f, 0.5f}, {0.18f, 0.18f}, {0.82f, 0.18f}};
    for (const auto& node : NODES) pen.disc(node[0], node[1], 0.12f);
}

void list(const Pen& pen)
{
    for (const float y : {0.2f, 0.5f, 0.8f}) {
        pen.disc(0.16f, y, 0.09f);
        pen.line(0.36f, y, 0.92f, y);
    }
}

void ruler(const Pen& pen)
{
    pen.line(0.1f, 0.26f, 0.1f, 0.74f);
    pen.line(0.9f, 0.26f, 0.9f, 0.74f);
    pen.line(0.1f, 0.5f, 0.9f, 0.5f);
}

void surface(const Pen& pen)
{
    const ImVec2 corners[] = {pen.at(0.5f, 0.1f), pen.at(0.92f, 0.84f), pen.at(0.08f, 0.84f)};
    pen.list.AddPolyline(corners, 3, pen.color, ImDrawFlags_Closed, pen.stroke());
    pen.line(0.5f, 0.1f, 0.44f, 0.56f);
    pen.line(0.44f, 0.56f, 0.92f, 0.84f);
    pen.line(0.44f, 0.56f, 0.08f, 0.84f);
}

void sun(const Pen& pen)
{
    constexpr int RAYS = 8;
    pen.disc(0.5f, 0.5f, 0.19f);
    for (int ray = 0; ray < RAYS; ++ray) {
        const float x = std::cos(2.0f * PI * float(ray) / RAYS), y = std::sin(2.0f * PI * float(ray) / RAYS);
        pen.line(0.5f + 0.31f * x, 0.5f + 0.31f * y, 0.5f + 0.44f * x, 0.5f + 0.44f * y);
    }
}

void shade(const Pen& pen)
{
    pen.ring(0.5f, 0.5f, 0.38f);
    pen.list.PathArcTo(pen.at(0.5f, 0.5f), 0.38f * pen.size, 0.5f * PI, 1.5f * PI, 24);
    pen.list.PathFillConvex(pen.color);
}

void cut(const Pen& pen)
{
    pen.frame(0.14f, 0.3f, 0.7f, 0.86f);
    pen.line(0.3f, 0.94f, 0.94f, 0.08f);
}

void dial(const Pen& pen)
{
    pen.arc(0.5f, 0.62f, 0.38f, 0.9f * PI, 2.1f * PI);
    pen.line(0.5f, 0.62f, 0.72f, 0.36f);
    pen.disc(0.5f, 0.62f, 0.09f);
}

void eye(const Pen& pen)
{
    pen.arc(0.5f, 0.86f, 0.52f, 1.23f * PI, 1.77f * PI);
    pen.arc(0.5f, 0.14f, 0.52f, 0.23f * PI, 0.77f * PI);
    pen.disc(0.5f, 0.5f, 0.14f);
}

void panes(const Pen& pen)
{
    pen.frame(0.1f, 0.14f, 0.9f, 0.86f);
    pen.line(0.5f, 0.14f, 0.5f, 0.86f);
    pen.line(0.1f, 0.5f, 0.9f, 0.5f);
}

void clock(const Pen& pen)
{
    pen.ring(0.5f, 0.5f, 0.38f);
    pen.line(0.5f, 0.5f, 0.5f, 0.24f);
    pen.line(0.5f, 0.5f, 0.68f, 0.58f);
}

struct PanelSign {
    std::string_view id;
    void (*draw)(const Pen&);
};
constexpr PanelSign SIGNS[] = {{"transfer_function", curve},
                               {"groups", squares},
                               {"probe", brush},
                               {"touch", stylus},
                               {"trace", network},
                               {"trace_list", list},
                               {"measurements", ruler},
                               {"meshes", surface},
                               {"light", sun},
                               {"occlusion", shade},
                               {"cuts", cut},
                               {"quality", dial},
                               {"aids", eye},
                               {"views", panes},
                               {"history", clock}};

constexpr bool each_panel_has_a_sign()
{
    for (size_t i = 0; i < std::size(PANELS); ++i)
        if (i >= std::size(SIGNS) || SIGNS[i].id != PANELS[i].id) return false;
    return std::size(SIGNS) == std::size(PANELS);
}
static_assert(each_panel_has_a_sign(), "a row of panel_rows.h has no sign in this order");

}  // namespace

void draw_sign(std::string_view panel, const Pen& pen)
{
    for (const PanelSign& sign : SIGNS)
        if (sign.id == panel) return sign.draw(pen);
}

}  // namespace shvr::ui
