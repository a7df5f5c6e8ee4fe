// Labels next to lines: no text crosses its line, or covers another text.

#include "engine/workbench/sight/label_place.h"

#include <array>
#include <numbers>
#include <random>

#include <doctest/doctest.h>

using namespace shvr::ui;

TEST_CASE("a label is next to its line, whatever the direction, and away from the drawing's centre")
{
    const glm::dvec2 text(140.0, 16.0), middle(300.0, 200.0);
    for (const double units : {1.0, 2.0})
        for (int degrees = 0; degrees < 360; degrees += 3) {
            CAPTURE(degrees);
            const double angle = degrees * std::numbers::pi / 180.0;
            const glm::dvec2 along(std::cos(angle), std::sin(angle)), across(-along.y, along.x);
            for (const glm::dvec2& centre : {middle, middle + 30.0 * across, middle - 30.0 * across}) {
                const LabelPlace place = place_next_to(middle - 50.0 * along, middle + 50.0 * along, centre, units);
                const glm::dvec2 corner = place.at - place.anchor * text;
                const double sign = glm::dot(place.at - middle, across) > 0.0 ? 1.0 : -1.0;
                for (const glm::dvec2& share : {glm::dvec2(0.0), {1.0, 0.0}, {0.0, 1.0}, {1.0, 1.0}})
                    CHECK(sign * glm::dot(corner + share * text - middle, across) > 7.0 * units);
                if (centre != middle) CHECK(sign * glm::dot(centre - middle, across) < 0.0);
            }
        }
    // A line without length has its text above it.
    const LabelPlace place = place_next_to(middle, middle, middle, 1.0);
    CHECK(place.at == middle - glm::dvec2(0.0, 8.0));
    CHECK(place.anchor == glm::dvec2(0.5, 1.0));
}

namespace {

/// Whether the texts are in the pane and off each other.
bool are_apart(std::span<const LabelPlace> labels, std::span<const glm::dvec2> sizes, const glm::dvec2& pane)
{
    constexpr double ROUNDING = 1e-9;
    for (size_t i = 0; i < labels.size(); ++i) {
        const glm::dvec2 begin = labels[i].at - labels[i].anchor * sizes[i], end = begin + sizes[i];
        if (glm::any(glm::lessThan(begin, glm::dvec2(-ROUNDING)))) return false;
        if (glm::any(glm::greaterThan(end, pane + ROUNDING))) return false;
        for (size_t k = 0; k < i; ++k) {
            const glm::dvec2 other = labels[k].at - labels[k].anchor * sizes[k];
            if (glm::all(glm::lessThan(begin, other + sizes[k] - ROUNDING)) &&
                glm::all(glm::lessThan(other + ROUNDING, end)))
                return false;
        }
    }
    return true;
}

}  // namespace

TEST_CASE("labels of random pairs of lines are in the pane and cover each other nowhere")
{
    const glm::dvec2 pane(400.0, 300.0);
    std::mt19937 dice(5);
    std::uniform_real_distribution<double> share(-0.2, 1.2), width(20.0, 190.0), spread_of(-30.0, 30.0);
    int labelled = 0, overlapped = 0;
    for (int round = 0; round < 20000; ++round) {
        std::array<LabelPlace, 3> labels;
        const std::array<glm::dvec2, 3> sizes{glm::dvec2(width(dice), 16.0), {width(dice), 16.0}, {60.0, 16.0}};
        const glm::dvec2 from = pane * glm::dvec2(share(dice), share(dice)),
                         to = pane * glm::dvec2(share(dice), share(dice));
        const glm::dvec2 apart(spread_of(dice), spread_of(dice));  // lines next to each other: the common case
        const auto one = part_in_pane(from, to, pane), other = part_in_pane(from + apart, to + apart, pane);
        if (!one || !other) continue;
        labels[0] = place_next_to(one->first, one->second, 0.5 * (from + to), 1.0);
        labels[1] = place_next_to(other->first, other->second, 0.5 * (from + to) + apart, 1.0);
        labels[2] = {.at = {384.0, 286.0}, .anchor = {1.0, 1.0}};  // stays, as a scale bar's
        overlapped += !are_apart(labels, sizes, pane);
        spread(labels, sizes, pane);
        CAPTURE(round);
        CHECK(are_apart(labels, sizes, pane));
        CHECK(labels[2].at == glm::dvec2(384.0, 286.0));
        ++labelled;
    }
    CHECK(labelled > 10000);
    CHECK(overlapped > 3000);
}

TEST_CASE("a label that covers nothing stays where it is, and the next one goes no farther than it must")
{
    const glm::dvec2 pane(400.0, 300.0), from(100.0, 150.0), to(300.0, 150.0);
    const std::array<glm::dvec2, 2> sizes{glm::dvec2(80.0, 16.0), {80.0, 16.0}};
    const LabelPlace place = place_next_to(from, to, {200.0, 150.0}, 1.0);
    std::array<LabelPlace, 2> labels{place, place};
    spread(labels, sizes, pane);
    CHECK(labels[0].at == place.at);
    CHECK(labels[1].at == place.at + glm::dvec2(0.0, 16.0));  // on the other side of the line
    CHECK(labels[1].anchor == glm::dvec2(0.5, 0.0));
}

TEST_CASE("a label avoids the line of another one, and has a line to its point where it is far away")
{
    const glm::dvec2 pane(400.0, 300.0), size(80.0, 16.0);
    const std::array<LabelLine, 2> lines{LabelLine{{100.0, 150.0}, {300.0, 150.0}}, {{100.0, 136.0}, {300.0, 136.0}}};
    const LabelPlace above = place_next_to(lines[0].from, lines[0].to, {200.0, 160.0}, 1.0);
    LabelPlace moved = above;
    spread(std::span(&moved, 1), std::span(&size, 1), pane, lines);
    const double top = moved.at.y - moved.anchor.y * size.y;
    CHECK((top >= 150.0 || top + size.y <= 136.0));
    CHECK(std::abs(top - 150.0) < 50.0);
    CHECK_FALSE(leader_of(above, above, size).has_value());
    LabelPlace far = above;
    far.at.y -= 100.0;
    const auto leader = leader_of(above, far, size);
    REQUIRE(leader.has_value());
    CHECK(leader->from == glm::dvec2(200.0, 150.0));
    CHECK(leader->to == glm::dvec2(200.0, 42.0));
}

TEST_CASE("labels stay where they are while a line turns, as long as no other place is much better")
{
    // Two lines turn to and fro about the level, where their labels change from above their middles to a side.
    const glm::dvec2 pane(400.0, 300.0), middle(200.0, 150.0), apart(0.0, 60.0);
    const std::array<glm::dvec2, 2> sizes{glm::dvec2(120.0, 16.0), {120.0, 16.0}};
    const auto jumps = [&](bool remembers) {
        std::array<std::optional<glm::dvec2>, 2> last{}, before{};
        int found = 0;
        for (int step = 0; step < 360; ++step) {
            std::array<LabelPlace, 2> labels;
            std::array<LabelLine, 2> lines;
            for (size_t i = 0; i < 2; ++i) {
                const double angle = 0.03 * std::sin((i == 0 ? 0.1 : 0.07) * step);
                const glm::dvec2 reach = 60.0 * glm::dvec2(std::cos(angle), std::sin(angle));
                const glm::dvec2 centre = middle + double(i) * apart;
                lines[i] = {centre - reach, centre + reach};
                labels[i] = place_next_to(lines[i].from, lines[i].to, centre, 1.0);
            }
            std::array<LabelPlace, 2> placed = labels;
            if (remembers)
                spread(placed, sizes, pane, lines, last);
            else
                spread(placed, sizes, pane, lines);
            CHECK(are_apart(placed, sizes, pane));
            for (size_t i = 0; i < 2; ++i) {
                last[i] = offset_of(labels[i], placed[i], sizes[i]);
                if (before[i] && glm::distance(*last[i], *before[i]) > 30.0) ++found;
                before[i] = last[i];
            }
        }
        return found;
    };
    const int without = jumps(false), with = jumps(true);
    CAPTURE(without);
    CAPTURE(with);
    CHECK(without > 12);
    CHECK(with <= 2);
}

TEST_CASE("a label returns to its line from a remembered place that is far away or covers another label")
{
    const glm::dvec2 pane(400.0, 300.0), from(100.0, 150.0), to(300.0, 150.0), size(80.0, 16.0);
    const LabelPlace place = place_next_to(from, to, {200.0, 150.0}, 1.0);
    for (const glm::dvec2& offset : {glm::dvec2(60.0, 90.0), {-40.0, -24.0}}) {
        std::array<LabelPlace, 2> labels{LabelPlace{.at = {160.0, 126.0}}, place};
        const std::array<glm::dvec2, 2> sizes{size, size};
        const std::array<std::optional<glm::dvec2>, 2> last{std::nullopt, offset};
        spread(labels, sizes, pane, {}, last);
        CHECK(are_apart(labels, sizes, pane));
        CHECK(glm::length(offset_of(place, labels[1], size) - glm::dvec2(-40.0, -24.0)) < 50.0);
    }
}

TEST_CASE("the part of a line in a pane is found, and none of a line beside it")
{
    const glm::dvec2 pane(100.0, 50.0);
    const auto part = part_in_pane({-50.0, 25.0}, {150.0, 25.0}, pane);
    REQUIRE(part.has_value());
    CHECK(part->first == glm::dvec2(0.0, 25.0));
    CHECK(part->second == glm::dvec2(100.0, 25.0));
    CHECK_FALSE(part_in_pane({-50.0, 60.0}, {150.0, 60.0}, pane).has_value());
    CHECK_FALSE(part_in_pane({-10.0, 10.0}, {20.0, -50.0}, pane).has_value());
    CHECK(part_in_pane({10.0, 10.0}, {10.0, 10.0}, pane).has_value());
}
