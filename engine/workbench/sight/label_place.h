#pragma once
// Where labels are put: next to a line, so that their text does not cross it; and apart from each other. Pure; any
// thread.

#include <cmath>
#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <utility>

#include <glm/glm.hpp>

namespace shvr::ui {

struct LabelPlace {
    glm::dvec2 at{0.0};      ///< pixels of the pane
    glm::dvec2 anchor{0.0};  ///< point of the text that is placed at `at`; 0, 0: upper left corner; 1, 1: lower right
    /// From the point that the label belongs to towards `at`. The label may be moved along it and to its other side; 0:
    /// the label stays.
    glm::dvec2 away{0.0};
};

/// Returns the part of a line that lies in the pane; null if it has none.
std::optional<std::pair<glm::dvec2, glm::dvec2>> part_in_pane(const glm::dvec2& from, const glm::dvec2& to,
                                                              const glm::dvec2& pane);

/// A line that labels avoid, though less than each other.
struct LabelLine {
    glm::dvec2 from{0.0}, to{0.0};
};

/// A line with which labels avoid a point, such as the end of a measured line.
inline LabelLine avoided_around(const glm::dvec2& point, double reach)
{
    return {point - glm::dvec2(reach, 0.0), point + glm::dvec2(reach, 0.0)};
}

/// Moves labels that may be moved, so that they lie within the pane and cover no other label: in order, after all
/// labels that stay, on either side of their points, near these, and off the lines where that is not far. Where there
/// is no free place, a label covers as little as possible. `sizes`: of the texts, with their margins, in pixels.
/// `last`: for each label, its offset in the last frame; it stays there unless another place is better by some lines
/// of text. Null: it had none.
void spread(std::span<LabelPlace> labels, std::span<const glm::dvec2> sizes, const glm::dvec2& pane,
            std::span<const LabelLine> lines = {}, std::span<const std::optional<glm::dvec2>> last = {});
/// By a label's key, the offset of its text from its point in the last frame, in pixels.
using LabelMemory = std::map<size_t, glm::dvec2>;
/// Like spread(), and labels stay where they were in the last frame while the view turns. `keys`: of the first labels,
/// by which `memory` knows them; 0: not known. `memory`: of the last frame, renewed; null: none.
void spread_as_before(std::span<LabelPlace> labels, std::span<const glm::dvec2> sizes, const glm::dvec2& pane,
                      std::span<const LabelLine> lines, std::span<const size_t> keys, LabelMemory* memory);
/// Returns the offset of a text's upper left corner from its label's point. `before`: before the label was moved.
glm::dvec2 offset_of(const LabelPlace& before, const LabelPlace& after, const glm::dvec2& size);
/// Returns a line from a label's point to the label if that lies so far away that it may be taken for another one's;
/// null if it is near. `before`: before the label was moved.
std::optional<LabelLine> leader_of(const LabelPlace& before, const LabelPlace& after, const glm::dvec2& size);

/// Returns the place next to the middle of a line, on the side away from `centre`, or above the line if it goes through
/// `centre`. The whole text is on that side, whatever its size. `units`: pixels per unit of the interface.
inline LabelPlace place_next_to(const glm::dvec2& from, const glm::dvec2& to, const glm::dvec2& centre, double units)
{
    constexpr double GAP = 8.0;           // units
    constexpr double LEVEL_SINE = 0.005;  // a line that is nearly level has its text above its middle
    const glm::dvec2 middle = 0.5 * (from + to), way = to - from;
    const double length = glm::length(way);
    glm::dvec2 side = length > 0.0 ? glm::dvec2(way.y, -way.x) / length : glm::dvec2(0.0, -1.0);
    const double away = glm::dot(middle - centre, side);
    if (std::abs(away) > units ? away < 0.0 : side.y > 0.0) side = -side;
    const auto anchor = [](double part) { return std::abs(part) < LEVEL_SINE ? 0.5 : part > 0.0 ? 0.0 : 1.0; };
    return {middle + GAP * units * side, {anchor(side.x), anchor(side.y)}, GAP * units * side};
}

}  // namespace shvr::ui
