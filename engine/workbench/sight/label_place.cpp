#include "engine/workbench/sight/label_place.h"

#include <algorithm>
#include <limits>
#include <vector>

#include "engine/base/error.h"

namespace shvr::ui {

namespace {

struct LabelBox {
    glm::dvec2 begin, end;
};

LabelBox box_of(const LabelPlace& place, const glm::dvec2& size)
{
    const glm::dvec2 begin = place.at - place.anchor * size;
    return {begin, begin + size};
}

/// Returns the area that two boxes share.
double shared_area(const LabelBox& a, const LabelBox& b)
{
    const glm::dvec2 sides = glm::max(glm::min(a.end, b.end) - glm::max(a.begin, b.begin), glm::dvec2(0.0));
    return sides.x * sides.y;
}

/// Moves a box into the pane; its beginning counts where it is larger.
LabelPlace within(const LabelPlace& place, const glm::dvec2& size, const glm::dvec2& pane)
{
    const glm::dvec2 begin = box_of(place, size).begin;
    LabelPlace moved = place;
    moved.at += glm::max(glm::min(begin, pane - size), glm::dvec2(0.0)) - begin;
    return moved;
}

/// Returns the place on the other side of the label's point.
LabelPlace beyond(const LabelPlace& place)
{
    return {place.at - 2.0 * place.away, 1.0 - place.anchor, -place.away};
}

/// Returns the length of the part of a line that lies in a box.
double length_in(const LabelLine& line, const LabelBox& box)
{
    const auto part = part_in_pane(line.from - box.begin, line.to - box.begin, box.end - box.begin);
    return part ? glm::distance(part->first, part->second) : 0.0;
}

/// Returns the distance of a box from a point; 0 inside.
double distance_from(const LabelBox& box, const glm::dvec2& point)
{
    return glm::distance(glm::clamp(point, box.begin, box.end), point);
}

double distance_from(const LabelLine& line, const glm::dvec2& point)
{
    const glm::dvec2 way = line.to - line.from;
    const double square = glm::dot(way, way);
    const double share = square > 0.0 ? std::clamp(glm::dot(point - line.from, way) / square, 0.0, 1.0) : 0.0;
    return glm::distance(point, line.from + share * way);
}

/// Returns the distance between a box and a line; 0 where they meet.
double distance_between(const LabelBox& box, const LabelLine& line)
{
    if (part_in_pane(line.from - box.begin, line.to - box.begin, box.end - box.begin)) return 0.0;
    double least = std::min(distance_from(box, line.from), distance_from(box, line.to));
    for (const glm::dvec2& corner :
         {box.begin, box.end, glm::dvec2(box.begin.x, box.end.y), glm::dvec2(box.end.x, box.begin.y)})
        least = std::min(least, distance_from(line, corner));
    return least;
}

/// Returns by how much a label is nearer to a line of another label than to its own line, which goes through `point`.
double nearer_to_others(const LabelBox& box, const glm::dvec2& point, std::span<const LabelLine> lines)
{
    constexpr double ON_LINE = 0.5;  // pixels
    double own = distance_from(box, point), others = std::numeric_limits<double>::infinity();
    for (const LabelLine& line : lines) {
        double& least = distance_from(line, point) < ON_LINE ? own : others;
        least = std::min(least, distance_between(box, line));
    }
    return std::max(own - others, 0.0);
}

/// Tries places ever farther from the label's point, on both sides, then along the line, and returns the cheapest. To
/// cover a label costs far more than to cover a line or to be nearer to another line than to the own one, and that as
/// much as to be some lines of text farther away. The `last` offset is preferred to places that are nearer by fewer
/// than STAY lines of text.
LabelPlace free_place(const LabelPlace& place, const glm::dvec2& size, const glm::dvec2& pane,
                      const std::vector<LabelBox>& taken, std::span<const LabelLine> lines,
                      const std::optional<glm::dvec2>& last)
{
    constexpr double MAX_STEPS = 400.0, OF_LABELS = 100.0, OF_LINES = 0.5, OF_OTHERS = 0.3, OF_DISTANCE = 0.15,
                     STAY = 3.0, ROUNDING = 1e-6;
    const double height = std::max(std::min(size.x, size.y), 1.0), pace = 0.5 * height;
    const glm::dvec2 away = pace * place.away / glm::length(place.away), along(-away.y, away.x);
    const glm::dvec2 point = place.at - place.away;
    const int steps = int(std::min(std::ceil(glm::length(pane) / pace), MAX_STEPS));
    double least = std::numeric_limits<double>::infinity();
    LabelPlace best = place;
    const auto try_place = [&](LabelPlace moved, const glm::dvec2& way, double bonus = 0.0) {
        moved.at += way;
        moved = within(moved, size, pane);
        const LabelBox box = box_of(moved, size);
        double covered = 0.0, crossed = 0.0;
        for (const LabelBox& other : taken) covered += shared_area(box, other);
        for (const LabelLine& line : lines) crossed += length_in(line, box);
        const double farther = std::max(distance_from(box, point) - glm::length(place.away), 0.0);
        if (covered > 0.0) covered += height * height;  // however little: never for the sake of the distance
        double cost = OF_LABELS * covered + height * (OF_LINES * crossed + OF_DISTANCE * farther) - bonus;
        if (cost < least) cost += height * OF_OTHERS * nearer_to_others(box, point, lines);
        if (cost < least - ROUNDING) least = cost, best = moved;
    };
    if (last)
        try_place({point + *last + place.anchor * size, place.anchor, place.away}, glm::dvec2(0.0),
                  OF_DISTANCE * STAY * height * height);
    const LabelPlace other = beyond(place);
    for (const glm::dvec2& way : {away, along})
        for (int step = 0; step <= steps && least > height * OF_DISTANCE * pace * step; ++step) {
            try_place(place, double(step) * way);
            try_place(other, -double(step) * way);
        }
    return best;
}

}  // namespace

std::optional<std::pair<glm::dvec2, glm::dvec2>> part_in_pane(const glm::dvec2& from, const glm::dvec2& to,
                                                              const glm::dvec2& pane)
{
    double begin = 0.0, end = 1.0;  // Liang and Barsky 1984
    for (int axis = 0; axis < 2; ++axis)
        for (const int side : {-1, 1}) {
            const double room = side > 0 ? pane[axis] - from[axis] : from[axis];
            const double speed = side * (to - from)[axis];
            if (speed == 0.0 && room < 0.0) return std::nullopt;
            if (speed > 0.0) end = std::min(end, room / speed);
            if (speed < 0.0) begin = std::max(begin, room / speed);
        }
    if (begin > end) return std::nullopt;
    return std::pair{glm::mix(from, to, begin), glm::mix(from, to, end)};
}

std::optional<LabelLine> leader_of(const LabelPlace& before, const LabelPlace& after, const glm::dvec2& size)
{
    constexpr double NEAR = 1.2;  // heights of the text beyond its first distance
    const glm::dvec2 point = before.at - before.away;
    const LabelBox box = box_of(after, size);
    if (distance_from(box, point) <= glm::length(before.away) + NEAR * size.y) return std::nullopt;
    return LabelLine{point, glm::clamp(point, box.begin, box.end)};
}

glm::dvec2 offset_of(const LabelPlace& before, const LabelPlace& after, const glm::dvec2& size)
{
    return box_of(after, size).begin - (before.at - before.away);
}

void spread(std::span<LabelPlace> labels, std::span<const glm::dvec2> sizes, const glm::dvec2& pane,
            std::span<const LabelLine> lines, std::span<const std::optional<glm::dvec2>> last)
{
    SHVR_CHECK(labels.size() == sizes.size(), labels.size(), sizes.size());
    std::vector<LabelBox> taken;
    for (size_t i = 0; i < labels.size(); ++i)
        if (labels[i].away == glm::dvec2(0.0)) taken.push_back(box_of(labels[i], sizes[i]));
    std::vector<LabelLine> avoided(lines.begin(), lines.end());
    for (size_t i = 0; i < labels.size(); ++i) {
        if (labels[i].away == glm::dvec2(0.0)) continue;
        const LabelPlace before = labels[i];
        labels[i] = free_place(before, sizes[i], pane, taken, avoided, i < last.size() ? last[i] : std::nullopt);
        taken.push_back(box_of(labels[i], sizes[i]));
        if (const auto leader = leader_of(before, labels[i], sizes[i])) avoided.push_back(*leader);
    }
}

void spread_as_before(std::span<LabelPlace> labels, std::span<const glm::dvec2> sizes, const glm::dvec2& pane,
                      std::span<const LabelLine> lines, std::span<const size_t> keys, LabelMemory* memory)
{
    if (!memory) return spread(labels, sizes, pane, lines);
    std::vector<std::optional<glm::dvec2>> last(labels.size());
    for (size_t i = 0; i < keys.size(); ++i)
        if (const auto at = memory->find(keys[i]); at != memory->end()) last[i] = at->second;
    const std::vector<LabelPlace> before(labels.begin(), labels.end());
    spread(labels, sizes, pane, lines, last);
    memory->clear();
    for (size_t i = 0; i < keys.size(); ++i)
        if (keys[i] != 0) memory->emplace(keys[i], offset_of(before[i], labels[i], sizes[i]));
}

}  // namespace shvr::ui
