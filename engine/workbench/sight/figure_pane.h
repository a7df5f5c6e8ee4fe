#pragma once
// Draws the shapes and texts of figure elements over one pane, in black or white, whichever stands out from what is
// behind (is_light_at), with a thin rim in the other, and keeps track of what is taken. Any thread, except for texts.

#include <span>
#include <string>
#include <vector>

#include "engine/workbench/sight/figure.h"

namespace shvr::ui {

class FigurePane {
public:
    /// Pixels of the pane.
    struct Box {
        glm::dvec2 begin{0.0}, end{0.0};
    };
    /// A line of text. Its anchor 0, 0 is its upper left corner, 1, 1 the lower right.
    struct Words {
        glm::dvec2 at, anchor;
        std::string text;
    };
    struct Ink {
        glm::dvec3 color, rim;
    };

    /// `line`: height of a line of text. `background`: linear light, and its opacity.
    FigurePane(const Pane& pane, const VolumeInfo& volume, const glm::dvec4& background, double line,
               const TextDrawer& draw_texts);

    glm::dvec2 size() const { return size_; }
    double line() const { return line_; }
    double edge() const { return 0.8 * line_; }  ///< distance of elements from the picture's edge
    double rim_width() const;
    Ink ink_at(const glm::dvec2& pixel) const;
    const TextDrawer& draw_texts() const { return draw_texts_; }

    /// Whether the box lies within the pane and off all boxes that are taken.
    bool is_free(const Box& box) const;
    void take(const Box& box) { taken_.push_back(box); }
    const std::vector<Box>& taken() const { return taken_; }

    /// A rectangle with fractional sides: pixels at its borders are partly covered.
    void rectangle(const glm::dvec2& begin, const glm::dvec2& end, const glm::dvec3& color);
    /// `color`: with the rim of the ink there.
    void line(const glm::dvec2& from, const glm::dvec2& to, const glm::dvec3& color, double width);
    /// Draws lines whose rims lie below all of them, each in the ink at its middle.
    void lines(std::span<const LabelLine> drawn, double width);
    void dot(const glm::dvec2& middle, double radius);
    void write(const std::vector<Words>& words, double height);
    /// Returns the width in pixels of the widest text, if its line is `height` pixels high.
    double widest_of(std::span<const std::string> texts, double height) const;

    Figure::Part take_part() { return std::move(part_); }

private:
    const Pane& pane_;
    const VolumeInfo& volume_;
    glm::dvec4 background_;
    glm::dvec2 size_;
    double line_;
    const TextDrawer& draw_texts_;
    Figure::Part part_;
    std::vector<Box> taken_;
};

}  // namespace shvr::ui
