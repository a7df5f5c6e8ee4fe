#include <cmath>
#include <numbers>
#include <random>

#include <doctest/doctest.h>

#include "tests/support/volume_files.h"
#include "tests/unit/annotation/patterns/flower_heads.h"

using namespace shvr;
using namespace shvr::test;

namespace {

using doctest::Approx;

double value(const PatternRows& rows, const std::string& name)
{
    const std::optional<double> found = rows.value(name);
    REQUIRE_MESSAGE(found.has_value(), name << ": " << rows.reason(name));
    return *found;
}

glm::dmat3 turned(double x, double y)
{
    const glm::dmat3 about_x(1, 0, 0, 0, std::cos(x), std::sin(x), 0, -std::sin(x), std::cos(x));
    const glm::dmat3 about_y(std::cos(y), 0, -std::sin(y), 0, 1, 0, std::sin(y), 0, std::cos(y));
    return about_x * about_y;
}

HeadBuilder builder_of(const std::string& species, const std::string& stage)
{
    return head_of(make_phantom({.size = Size3(48), .seed = 9, .species = species, .stage = stage}));
}
PatternRows phantom_rows(const std::string& species, const std::string& stage)
{
    return builder_of(species, stage).measure();
}

constexpr double OUTERMOST = 0.948354;  // rho of the outermost floret of a phantom: 0.95 sqrt(143.5 / 144)
constexpr double HEAD = 0.40 * 48;

}  // namespace

TEST_CASE("spokes have radiality 1 and equal sectors, and end where they were drawn")
{
    HeadBuilder head;
    head.stem(8, 50.0);
    for (int i = 0; i < 12; ++i) head.vein({polar(45, 30.0 * i), polar(26, 30.0 * i), polar(12.5, 30.0 * i)}, 2);
    const PatternRows rows = head.measure();
    CHECK(value(rows, "head_radius") == Approx(50.0));
    CHECK(value(rows, "radiality") == Approx(1.0).epsilon(1e-12));
    CHECK(value(rows, "sectors_rho_0.5") == 12);
    CHECK(value(rows, "sector_gap_mean_rho_0.5") == 30.0);
    CHECK(value(rows, "sector_gap_cv_rho_0.5") < 1e-9);
    CHECK(value(rows, "sectors_rho_0.3") == 12);
    CHECK(value(rows, "adaxial_inner_end") == Approx(0.25));
    CHECK(value(rows, "reticulation") == 0.0);
    CHECK(value(rows, "adaxial_segments") == 12);
    CHECK(value(rows, "adaxial_nodes_degree_1") == 24);
    CHECK(value(rows, "adaxial_nodes_degree_2") == 12);
    CHECK(value(rows, "axis_residual") < 1e-6);
    CHECK(value(rows, "axis_direction_z") == Approx(1.0));
    CHECK(rows.reason("droop") != "");
}

TEST_CASE("a circle around the axis has radiality 0 and one loop, random directions have 2 / pi")
{
    HeadBuilder head;
    head.stem(8, 50.0);
    std::vector<glm::dvec3> circle;
    for (int i = 0; i <= 72; ++i) circle.push_back(polar(30, 5.0 * i));
    circle.pop_back();
    const uint32_t last = head.vein(circle, 2);
    head.link(last, last - 71);
    const PatternRows rows = head.measure();
    CHECK(value(rows, "radiality") < 1e-9);
    CHECK(value(rows, "adaxial_loops") == 1);
    CHECK(value(rows, "adaxial_segments") == 1);
    CHECK(value(rows, "reticulation") == 1);
    CHECK(value(rows, "adaxial_nodes_degree_2") == 72);

    HeadBuilder random;
    random.stem(8, 50.0);
    std::mt19937 numbers(4);
    const auto unit = [&] { return double(numbers()) / 4294967296.0; };
    for (int i = 0; i < 4000; ++i) {
        const glm::dvec3 at = polar(10 + 35 * unit(), 360 * unit()), by = polar(0.1, 360 * unit());
        random.vein({at - by, at + by}, 2);
    }
    // The standard deviation of the mean is 0.308 / sqrt(4000) = 0.005.
    CHECK(value(random.measure(), "radiality") == Approx(2.0 / std::numbers::pi).epsilon(0.03));
}

TEST_CASE("sectors at random have the coefficient of variation of uniform spacings")
{
    double sum = 0.0;
    constexpr int HEADS = 20, VEINS = 200;
    std::mt19937 numbers(5);
    for (int k = 0; k < HEADS; ++k) {
        HeadBuilder head;
        head.stem(8, 50.0);
        for (int i = 0; i < VEINS; ++i) {
            const double degrees = 360.0 * double(numbers()) / 4294967296.0;
            head.vein({polar(45, degrees), polar(12, degrees)}, 2);
        }
        sum += value(head.measure(), "sector_gap_cv_rho_0.5") / HEADS;
    }
    CHECK(sum == Approx(std::sqrt(199.0 / 201.0)).epsilon(0.05));
}

TEST_CASE("a grid has the loops, degrees and loops per area of a grid; a tree has none")
{
    HeadBuilder grid;
    grid.stem(8, 50.0);
    std::vector<uint32_t> nodes;
    for (int y = 0; y < 5; ++y)
        for (int x = 0; x < 7; ++x) nodes.push_back(grid.node({10 + 3 * x, -6 + 3 * y, 0}, 2));
    for (size_t i = 0; i < nodes.size(); ++i) {
        if (i % 7 != 6) grid.link(nodes[i], nodes[i + 1]);
        if (i + 7 < nodes.size()) grid.link(nodes[i], nodes[i + 7]);
    }
    const PatternRows rows = grid.measure();
    CHECK(value(rows, "adaxial_loops") == 24);
    CHECK(value(rows, "adaxial_parts") == 1);
    // Of 58 internodes, those at the four corners make four segments of two.
    CHECK(value(rows, "adaxial_segments") == 54);
    CHECK(value(rows, "reticulation") == Approx(24.0 / 54.0));
    CHECK(value(rows, "adaxial_nodes_degree_2") == 4);
    CHECK(value(rows, "adaxial_nodes_degree_3") == 16);
    CHECK(value(rows, "adaxial_nodes_degree_4") == 15);
    const double ring = std::numbers::pi * (28.0 * 28 + 6 * 6 - 10 * 10);
    CHECK(value(rows, "anastomoses_per_area") == Approx(24.0 / ring));

    HeadBuilder tree;
    tree.stem(8, 50.0);
    std::vector<uint32_t> level{tree.node({10, 0, 0}, 2)};
    for (int depth = 1; depth <= 5; ++depth) {
        std::vector<uint32_t> next;
        for (size_t i = 0; i < 2 * level.size(); ++i) {
            next.push_back(tree.node(polar(10 + 6 * depth, 90.0 * double(i) / double(level.size())), 2));
            tree.link(level[i / 2], next.back());
        }
        level = next;
    }
    CHECK(value(tree.measure(), "reticulation") == 0.0);
    CHECK(value(tree.measure(), "adaxial_segments") == 61);  // the root, of two, lies within a segment
}

TEST_CASE("the droop of veins under a flat receptacle is the angle of their slope, whatever the frame")
{
    for (const double x : {0.0, 0.9, 2.5}) {
        HeadBuilder head;
        head.turn = turned(x, 0.4 * x);
        head.offset = {100, -300, 70};
        head.stem(8, 50.0);
        for (int k = 0; k < 60; ++k) {
            const glm::dvec3 top = polar(50 * std::sqrt((k + 0.5) / 60), 137.507764 * k, 20);
            head.vein({top, top - glm::dvec3(0, 0, 5)}, 3);
        }
        for (int i = 0; i < 9; ++i)
            head.vein({polar(45, 40.0 * i, 8), polar(25, 40.0 * i, 3), polar(5, 40.0 * i, -2)}, 2);
        const PatternRows rows = head.measure();
        CHECK(value(rows, "florets") == 60);
        CHECK(value(rows, "droop") == Approx(std::atan(0.25) * 180 / std::numbers::pi).epsilon(1e-9));
        CHECK(value(rows, "radiality") == Approx(1.0).epsilon(1e-12));
        const glm::dvec3 up = head.turn * glm::dvec3(0, 0, 1);
        CHECK(value(rows, "axis_direction_x") == Approx(up.x).epsilon(1e-9));
        CHECK(value(rows, "axis_direction_z") == Approx(up.z).epsilon(1e-9));
        const glm::dvec3 at(value(rows, "axis_x"), value(rows, "axis_y"), value(rows, "axis_z"));
        // In physical space the middle of voxel 0 is the origin.
        CHECK(glm::length(glm::cross(at + 0.5 - head.offset, up)) < 1e-6);
    }
}

TEST_CASE("planted connections are counted once, by internodes and by shared nodes, at their rho")
{
    HeadBuilder head;
    head.stem(8, 50.0);
    for (int k = 0; k < 40; ++k) {
        const glm::dvec3 top = polar(50 * std::sqrt((k + 0.5) / 40), 137.507764 * k, 20);
        const uint32_t root = head.vein({top, top - glm::dvec3(0, 0, 5)}, 3);
        // Three are joined in the middle, one after the other.
        if (k == 1 || k == 2) head.link(root - 2, root);
        if (k == 30) {  // an adaxial vein whose node it shares
            const uint32_t end = head.node(polar(20, 0), 2);
            head.links.push_back({root, end, 2});
        }
        if (k == 36) {  // a vein whose internode has the florets' group, between abaxial nodes
            const uint32_t a = head.node(polar(30, 77), 1), b = head.node(polar(40, 77), 1),
                           c = head.node(polar(40, 80), 1);
            head.links.push_back({a, b, 1});
            head.links.push_back({b, c, 3});
        }
    }
    const PatternRows rows = head.measure();
    CHECK(value(rows, "connections_adaxial_floret") == 1);
    CHECK(value(rows, "connections_abaxial_floret") == 1);
    CHECK(value(rows, "connections_abaxial_floret_rho_median") == Approx(40.0 / value(rows, "head_radius")));
    CHECK(value(rows, "connections_abaxial_floret_rho_0.8_to_1.0") == 1);
    CHECK(value(rows, "connections_floret_floret") == 2);
    CHECK(value(rows, "connections_floret_floret_rho_most") < 0.3);
    CHECK(value(rows, "connections_abaxial_adaxial") == 0);
    CHECK(rows.reason("connections_abaxial_adaxial_rho_least") == "there is no such connection");
}

TEST_CASE("a stage's truth has that stage's predicate and no other's, in each species")
{
    for (const char* species : {"gerbera", "helianthus", "bellis"})
        for (const char stage : {'a', 'b', 'c', 'd'}) {
            CAPTURE(species);
            CAPTURE(stage);
            const PatternRows rows = phantom_rows(species, std::string(1, stage));
            for (const char other : {'a', 'b', 'c', 'd'}) {
                CAPTURE(other);
                CHECK(value(rows, std::string("stage_") + other) == (stage == other ? 1.0 : 0.0));
            }
        }
}

TEST_CASE("values of mature phantoms are those that they were built with")
{
    const PatternRows gerbera = phantom_rows("gerbera", "d"), helianthus = phantom_rows("helianthus", "d"),
                      bellis = phantom_rows("bellis", "d");
    for (const PatternRows* rows : {&gerbera, &helianthus, &bellis}) {
        CHECK(value(*rows, "axis_direction_z") == Approx(1.0).epsilon(1e-12));
        CHECK(value(*rows, "axis_x") == Approx(23.5).epsilon(1e-9));
        CHECK(value(*rows, "axis_y") == Approx(23.5).epsilon(1e-9));
        CHECK(value(*rows, "head_radius") == Approx(OUTERMOST * HEAD).epsilon(1e-5));
        CHECK(value(*rows, "florets") == 144);
    }
    CHECK(value(gerbera, "radiality") == Approx(1.0).epsilon(1e-9));
    CHECK(value(gerbera, "droop") == Approx(0.0).epsilon(1e-6));
    CHECK(value(gerbera, "adaxial_inner_end") == Approx(0.28 / OUTERMOST).epsilon(1e-4));
    CHECK(value(gerbera, "reticulation") == 0.0);
    CHECK(value(gerbera, "sectors_rho_0.5") == 12);
    CHECK(value(gerbera, "sector_gap_cv_rho_0.5") < 0.15);
    // A node of the adaxial vein at 0.84 is joined to the abaxial veins; the florets' connections follow inwards.
    CHECK(value(gerbera, "connections_abaxial_adaxial") == 12);
    CHECK(value(gerbera, "connections_abaxial_floret_rho_least") > 0.86);
    CHECK(value(gerbera, "connections_floret_floret_rho_most") < 0.28 / OUTERMOST + 0.05);
    // Joins between neighbours run along the receptacle rather than inwards.
    CHECK(value(helianthus, "droop") > 10.0);
    CHECK(value(helianthus, "droop") < 14.0);
    CHECK(value(helianthus, "radiality") < 0.99);
    CHECK(value(helianthus, "adaxial_inner_end") == Approx(0.06 / OUTERMOST).epsilon(1e-4));
    CHECK(value(bellis, "adaxial_inner_end") < 0.15);
    CHECK(std::abs(value(bellis, "droop")) < 3.0);
    CHECK(value(bellis, "radiality") < value(helianthus, "radiality"));
    CHECK(value(bellis, "reticulation") > 0.2);
    CHECK(value(bellis, "anastomoses_per_area") > 2.0 * value(helianthus, "anastomoses_per_area"));
}

TEST_CASE("the droop of helianthus's veins without their joins is that of the curves they were built on")
{
    HeadBuilder head = builder_of("helianthus", "d");
    std::erase_if(head.links, [&](const TraceInternode& link) {
        return head.nodes[link.a].group == 2 && head.nodes[link.b].group == 2 && link.b != link.a + 1;
    });
    // The mean of atan(0.36 rho + 0.28) - atan(0.36 rho) from the inner ends, 0.06 and 0.34, to 0.84.
    double sum = 0.0, all = 0.0;
    for (const double from : {0.06, 0.34})
        for (double rho = from + 0.0005; rho < 0.84; rho += 0.001) {
            const double length = std::hypot(1.0, 0.36 * rho + 0.28);
            sum += length * (std::atan(0.36 * rho + 0.28) - std::atan(0.36 * rho));
            all += length;
        }
    // Waves lengthen the way down by 1 / radiality.
    const PatternRows rows = head.measure();
    CHECK(value(rows, "radiality") > 0.9);
    CHECK(value(rows, "droop") == Approx(sum / all * 180 / std::numbers::pi * value(rows, "radiality")).epsilon(0.02));
}

TEST_CASE("stages b and c of gerbera have the ends and connections they were built with")
{
    const PatternRows b = phantom_rows("gerbera", "b"), c = phantom_rows("gerbera", "c");
    CHECK(value(b, "adaxial_inner_end") == Approx(0.44 / OUTERMOST).epsilon(1e-4));
    CHECK(value(c, "adaxial_inner_end") == Approx(0.28 / OUTERMOST).epsilon(1e-4));
    CHECK(value(c, "connections_abaxial_floret_rho_least") > 0.86);
    CHECK(value(c, "connections_adaxial_floret") == 0);
    CHECK(b.reason("droop") != "");
}
