// The axis and the centre of a head, fitted to traces as hands make them: of flat heads, and with errors.

#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include <doctest/doctest.h>

#include "tests/support/slow.h"
#include "tests/support/volume_files.h"
#include "tests/unit/annotation/patterns/flower_heads.h"

using namespace shvr;
using namespace shvr::test;

namespace {

using doctest::Approx;

struct AxisError {
    double degrees = 90.0;  ///< between the axis and the head's
    double off = 1.0;       ///< distance of the head's centre from the axis, in radii of the head
    bool is_up = false;
};

/// Of a head whose centre, direction and radius are known, in the space of the trace.
AxisError axis_of(const PatternRows& rows, const glm::dvec3& centre, const glm::dvec3& up, double radius)
{
    const auto value = [&](const char* name) {
        REQUIRE_MESSAGE(rows.value(name).has_value(), name << ": " << rows.reason("head_radius"));
        return *rows.value(name);
    };
    const glm::dvec3 through(value("axis_x"), value("axis_y"), value("axis_z"));
    const glm::dvec3 direction(value("axis_direction_x"), value("axis_direction_y"), value("axis_direction_z"));
    const double cosine = glm::dot(direction, up);
    // In physical space the middle of voxel 0 is the origin.
    return {.degrees = std::acos(std::min(1.0, std::abs(cosine))) * 180.0 / std::numbers::pi,
            .off = glm::length(glm::cross(centre - 0.5 - through, direction)) / radius,
            .is_up = cosine > 0.0};
}

/// A trace's nodes, each off by normal errors along the three axes of the head, in its radii; flatter by a factor.
HeadBuilder with_errors(const HeadBuilder& truth, const glm::dvec3& centre, const glm::dvec3& errors, double radius,
                        uint32_t seed)
{
    std::mt19937 random(seed);
    const auto unit = [&] { return (double(random()) + 0.5) / 4294967296.0; };
    const auto normal = [&] {
        const double size = std::sqrt(-2.0 * std::log(unit()));
        return size * std::cos(2.0 * std::numbers::pi * unit());
    };
    HeadBuilder head = truth;
    for (TraceNode& node : head.nodes) {
        const double x = normal(), y = normal(), z = normal();
        node.position = centre + (node.position - centre) + radius * errors * glm::dvec3(x, y, z);
    }
    return head;
}

HeadBuilder flattened(HeadBuilder head, const glm::dvec3& centre, double factor)
{
    for (TraceNode& node : head.nodes) node.position.z = centre.z + factor * (node.position.z - centre.z);
    return head;
}

/// The nodes of a head that `is_kept`, and the internodes between them.
HeadBuilder part_of(const HeadBuilder& head, const std::function<bool(const glm::dvec3&)>& is_kept)
{
    HeadBuilder kept;
    std::vector<int64_t> number(head.nodes.size(), -1);
    for (size_t i = 0; i < head.nodes.size(); ++i) {
        if (!is_kept(head.nodes[i].position)) continue;
        number[i] = int64_t(kept.nodes.size());
        kept.nodes.push_back(head.nodes[i]);
    }
    for (const TraceInternode& link : head.links)
        if (number[link.a] >= 0 && number[link.b] >= 0)
            kept.links.push_back({uint32_t(number[link.a]), uint32_t(number[link.b]), link.group});
    return kept;
}

HeadBuilder above(const HeadBuilder& head, double height)
{
    return part_of(head, [&](const glm::dvec3& at) { return at.z >= height; });
}

HeadBuilder sector(const HeadBuilder& head, const glm::dvec3& centre, double from, double width)
{
    return part_of(head, [&](const glm::dvec3& at) {
        const double turn = std::atan2(at.y - centre.y, at.x - centre.x) * 180.0 / std::numbers::pi - from;
        return turn - 360.0 * std::floor(turn / 360.0) <= width;
    });
}

}  // namespace

// Kind (Traces): a head as flat as a disc, whose veins wave in its plane
TEST_CASE("the axis of a flat head is the normal of its plane, not a line in it, however its veins wave")
{
    // Turns of 360 / 13 degrees map the head onto itself, so its axis is known exactly.
    for (const double height : {0.0, 0.02})
        for (const double wave : {0.0, 0.02, 0.03}) {
            CAPTURE(height);
            CAPTURE(wave);
            HeadBuilder head;
            for (int i = 0; i < 13; ++i) {
                std::vector<glm::dvec3> vein;
                for (int k = 0; k <= 8; ++k) {
                    const double rho = 0.2 + 0.1 * k, aside = k % 2 == 0 ? wave : -wave;
                    const double degrees = 360.0 * i / 13 + aside / rho * 180.0 / std::numbers::pi;
                    vein.push_back(glm::dvec3(70, 60, 50) + polar(50.0 * rho, degrees, 50.0 * height * (k % 3)));
                }
                head.vein(vein, ABAXIAL_GROUP);
            }
            const AxisError found = axis_of(head.measure(), {70, 60, 50}, {0, 0, 1}, 50.0);
            CHECK(found.degrees < 1e-5);
            CHECK(found.off < 1e-6);
        }
}

// Of the heads of a test, every how many-th is measured; coprime to the numbers of species, widths and errors.
const int EVERY = repeats(7, 1);

// Kind (Traces): nodes off the centre lines by up to 3 % of the head's radius, in heads of all heights
TEST_CASE("errors of a hand turn the axis by two degrees at most, however flat the head is")
{
    const glm::dvec3 centre(50.0);
    double worst = 0.0, worst_off = 0.0;
    int heads = 0;
    for (const char* species : {"gerbera", "helianthus", "bellis"}) {
        const HeadBuilder truth = head_of(make_phantom({.size = Size3(100), .species = species}));
        for (const double factor : {1.0, 0.5, 0.2, 0.0})
            for (const glm::dvec3& errors : {glm::dvec3(0.02), glm::dvec3(0.03, 0.03, 0.0), glm::dvec3(0, 0, 0.03)})
                for (uint32_t seed = 1; seed <= repeats(1u, 20u); ++seed)
                    for (const bool has_stem : {true, false}) {
                        if (heads++ % EVERY != 0) continue;
                        CAPTURE(species);
                        CAPTURE(factor);
                        CAPTURE(errors.x);
                        CAPTURE(errors.z);
                        CAPTURE(seed);
                        CAPTURE(has_stem);
                        HeadBuilder head = with_errors(flattened(truth, centre, factor), centre, errors, 40.0, seed);
                        if (!has_stem) head = above(head, centre.z - 40.0 * 0.62 * factor - 5.0);
                        const AxisError found = axis_of(head.measure(), centre, {0, 0, 1}, 40.0);
                        CHECK(found.degrees < 2.0);
                        CHECK(found.off < 0.02);
                        worst = std::max(worst, found.degrees);
                        worst_off = std::max(worst_off, found.off);
                    }
    }
    MESSAGE("at most " << worst << " degrees and " << worst_off << " radii");
}

// Kind (Traces): a half, a third and a quarter of a head, with or without a stem, nodes off by up to 5 % of its radius
TEST_CASE("a part of a head gives the axis of the head or a reason, never another axis")
{
    const glm::dvec3 centre(50.0);
    int heads = 0, answers = 0, refusals = 0, outside = 0;
    std::mt19937 random(5);
    for (const char* species : {"gerbera", "helianthus", "bellis"}) {
        const HeadBuilder truth = head_of(make_phantom({.size = Size3(100), .species = species}));
        const HeadBuilder bowl = above(truth, centre.z - 40.0 * 0.62 - 5.0);
        for (const double width : {360.0, 180.0, 120.0, 90.0})
            for (const double error : {0.0, 0.01, 0.02, 0.03, 0.05})
                for (uint32_t seed = 1; seed <= repeats(1u, 100u); ++seed) {
                    if (heads++ % EVERY != 0) continue;
                    CAPTURE(species);
                    CAPTURE(width);
                    CAPTURE(error);
                    CAPTURE(seed);
                    const double from = 360.0 * double(random()) / 4294967296.0;
                    const HeadBuilder part = sector(random() % 2 == 0 ? truth : bowl, centre, from, width);
                    const PatternRows rows =
                        with_errors(part, centre, glm::dvec3(error), 40.0, uint32_t(random())).measure();
                    CHECK(rows.value("adaxial_segments").has_value());
                    if (!rows.value("axis_x")) {
                        ++refusals;
                        CHECK(width < 360.0);
                        CHECK(error > 0.0);
                        CHECK(rows.reason("axis_x").find("do not determine it: ") != std::string::npos);
                        CHECK(!rows.value("divergence_angle").has_value());
                        CHECK(!rows.value("radiality").has_value());
                        continue;
                    }
                    ++answers;
                    const AxisError found = axis_of(rows, centre, {0, 0, 1}, 40.0);
                    CHECK(found.degrees < 5.0);
                    CHECK(found.off < 0.05);
                    outside += found.degrees > *rows.value("axis_direction_error") + 1e-6;
                    CHECK(found.is_up);
                    // Gaps between sectors are those of a whole head only.
                    CHECK(rows.value("sector_gap_cv_rho_0.5").has_value() == (width == 360.0));
                    CHECK(std::abs(*rows.value("covered_angle") - width) < 35.0);
                    const auto angle = rows.value("divergence_angle");
                    CHECK((!angle || (width == 360.0 && *angle == Approx(137.508).epsilon(0.01))));
                }
    }
    CHECK(answers > refusals);
    CHECK(outside <= 2 + answers / 50);  // 1 of 100 is expected outside of its interval
    MESSAGE(answers << " answers, " << refusals << " refusals");
}

TEST_CASE("a stated axis is used where the trace does not determine it")
{
    const glm::dvec3 centre(50.0);
    const HeadBuilder truth = head_of(make_phantom({.size = Size3(100)}));
    const HeadBuilder quarter = with_errors(sector(truth, centre, 20.0, 90.0), centre, glm::dvec3(0.02), 40.0, 1);
    CHECK(!quarter.measure().value("radiality").has_value());
    const StatedAxis stated{.through = {49.5, 49.5, 12.0}, .direction = {0, 0, 1}};
    const PatternRows rows = quarter.measure({}, stated);
    CHECK(*rows.value("axis_x") == 49.5);
    CHECK(*rows.value("axis_direction_z") == 1.0);
    CHECK(rows.reason("axis_direction_error") == "the axis is stated");
    CHECK(*rows.value("radiality") > 0.8);
    const PatternRows down = quarter.measure({}, StatedAxis{.through = {49.5, 49.5, 12.0}, .direction = {0, 0, -1}});
    CHECK(*down.value("axis_direction_z") == -1.0);

    CHECK(!stated_axis("", "--axis").has_value());
    CHECK(stated_axis("1,2,-3e1,0,0,2", "--axis")->direction == glm::dvec3(0, 0, 1));
    const auto refusal = [](const std::string& text) { return error_of([&] { stated_axis(text, "--axis"); }); };
    CHECK(refusal("1,2,3") ==
          "--axis is '1,2,3': found 3 numbers; expected six: a point of the axis and its direction "
          "towards the florets, X,Y,Z,DX,DY,DZ");
    CHECK(refusal("1,2,3,a,5,6") == "--axis is '1,2,3,a,5,6': found 'a'; expected a number");
    CHECK(refusal("1,2,3,,5,6") == "--axis is '1,2,3,,5,6': found ''; expected a number");
    CHECK(refusal("1,2,3,inf,5,6") == "--axis is '1,2,3,inf,5,6': found 'inf'; expected a number");
    CHECK(refusal("1,2,3,0,0,0") ==
          "--axis is '1,2,3,0,0,0': the direction is 0,0,0; expected one towards the florets");
}

TEST_CASE("half a head without abaxial veins has no middle, and says so")
{
    const glm::dvec3 centre(50.0);
    HeadBuilder florets = head_of(make_phantom({.size = Size3(100)}));
    florets.links.clear();
    std::erase_if(florets.nodes, [](const TraceNode& node) { return node.group != FLORET_GROUP; });
    const AxisError whole = axis_of(florets.measure(), centre, {0, 0, 1}, 40.0);
    CHECK(whole.degrees < 2.0);
    CHECK(whole.off < 0.02);
    CHECK(sector(florets, centre, 40.0, 180.0).measure().reason("head_radius").find("do not determine it") !=
          std::string::npos);
}
