#pragma once
// Draws signs in a square, with coordinates in units of its side: x to the right, y down. Main thread.

#include <algorithm>

#include <imgui/imgui.h>

namespace shvr::ui {

struct Pen {
    ImDrawList& list;
    ImVec2 corner;
    float size;
    ImU32 color;

    ImVec2 at(float x, float y) const { return {corner.x + x * size, corner.y + y * size}; }
    float stroke() const { return std::max(1.3f, 0.09f * size); }
    void line(float ax, float ay, float bx, float by) const { list.AddLine(at(ax, ay), at(bx, by), color, stroke()); }
    void disc(float x, float y, float radius) const { list.AddCircleFilled(at(x, y), radius * size, color); }
    void ring(float x, float y, float radius) const { list.AddCircle(at(x, y), radius * size, color, 0, stroke()); }
    void frame(float ax, float ay, float bx, float by) const
    {
        list.AddRect(at(ax, ay), at(bx, by), color, 0.08f * size, 0, stroke());
    }
    void block(float ax, float ay, float bx, float by) const
    {
        list.AddRectFilled(at(ax, ay), at(bx, by), color, 0.06f * size);
    }
    /// Angles in radians, clockwise from the right.
    void arc(float x, float y, float radius, float from, float to) const
    {
        list.PathArcTo(at(x, y), radius * size, from, to, 24);
        list.PathStroke(color, ImDrawFlags_None, stroke());
    }
};

}  // namespace shvr::ui
