#include <cmath>
#include <map>
#include <numbers>
#include <random>

#include <doctest/doctest.h>

#include "tests/support/slow.h"
#include "tests/unit/annotation/patterns/flower_heads.h"

using namespace shvr;
using namespace shvr::test;

namespace {

using doctest::Approx;

constexpr double GOLDEN = 137.50776405003785, LUCAS = 99.50155281000757;

double number(const PatternRows& rows, const std::string& name)
{
    const std::optional<double> found = rows.value(name);
    REQUIRE_MESSAGE(found.has_value(), name << ": " << rows.reason(name));
    return *found;
}

/// A head whose florets are at `place` of their number; equal areas, if it returns no other rho.
struct Spiral {
    int florets = 144;
    double divergence = GOLDEN;
    double noise = 0.0;    ///< standard deviation of each coordinate, in mean distances of florets
    double missing = 0.0;  ///< share of florets
    double dome = 0.0;
    uint32_t seed = 1;
    int jugacy = 1;

    HeadBuilder build() const
    {
        std::mt19937 random(seed);
        const auto unit = [&] { return (double(random()) + 0.5) / 4294967296.0; };
        const auto normal = [&] {
            const double size = std::sqrt(-2.0 * std::log(unit()));
            return size * std::cos(2 * std::numbers::pi * unit());
        };
        HeadBuilder head;
        head.stem(13, 50.0);
        const double distance = 50.0 * std::sqrt(std::numbers::pi / florets);
        for (int k = 0; k < florets; ++k) {
            const double rho = std::sqrt((k + 0.5) / florets);
            const double degrees = divergence * (k / jugacy) + 360.0 / jugacy * (k % jugacy);
            const glm::dvec3 off = noise * distance * glm::dvec3(normal(), normal(), 0.0);
            const bool is_missing = unit() < missing;
            const glm::dvec3 top = polar(50.0 * rho, degrees, 10 + 50 * dome * (1 - rho * rho)) + off;
            if (!is_missing) head.vein({top, top - glm::dvec3(0, 0, 3)}, FLORET_GROUP);
        }
        return head;
    }
    PatternRows rows() const { return build().measure(); }
};

}  // namespace

TEST_CASE(
    "the golden angle gives consecutive Fibonacci numbers, Lucas's angle Lucas numbers, two in a whorl their doubles")
{
    const PatternRows golden = Spiral{}.rows();
    CHECK(number(golden, "divergence_angle") == Approx(GOLDEN).epsilon(1e-9));
    CHECK(number(golden, "divergence_angle_low") <= GOLDEN + 1e-6);
    CHECK(number(golden, "divergence_angle_high") >= GOLDEN - 1e-6);
    CHECK(number(golden, "jugacy") == 1);
    CHECK(number(golden, "handedness") == 1);
    CHECK(number(golden, "lattice_share") > 0.9);
    CHECK(number(golden, "floret_centre_offset") < 1e-6);
    const auto pair = [](const PatternRows& rows, const std::string& rho) {
        return 1000 * number(rows, "parastichies_M_rho_" + rho) + number(rows, "parastichies_N_rho_" + rho);
    };
    // At rho 0.5 there are 144 florets per radius. Steps 8 and 21 (to the left) are 0.184 and 0.160 long, 13 and 34 (to
    // the right) 0.141 and 0.240. Likewise elsewhere.
    CHECK(pair(golden, "0.3") == 8013);
    CHECK(pair(golden, "0.5") == 13021);
    CHECK(pair(golden, "0.9") == 21034);

    const PatternRows lucas = Spiral{.divergence = LUCAS}.rows();
    CHECK(number(lucas, "divergence_angle") == Approx(LUCAS).epsilon(1e-9));
    CHECK(pair(lucas, "0.9") == 18029);
    CHECK(pair(lucas, "0.5") == 11018);

    const PatternRows two = Spiral{.divergence = GOLDEN / 2, .jugacy = 2}.rows();
    CHECK(number(two, "divergence_angle") == Approx(GOLDEN / 2).epsilon(1e-3));
    CHECK(number(two, "jugacy") == 2);
    CHECK(pair(two, "0.9") == 16026);
}

TEST_CASE("phantoms have the phyllotaxis they were built with, to the left and to the right, in each species")
{
    for (const char* species : {"gerbera", "helianthus", "bellis"})
        for (const char* phyllotaxis : {"fibonacci", "lucas", "bijugate"})
            for (const bool is_left : {false, true}) {
                CAPTURE(species);
                CAPTURE(phyllotaxis);
                const PatternRows rows = head_of(make_phantom({.size = Size3(48),
                                                               .species = species,
                                                               .phyllotaxis = phyllotaxis,
                                                               .left_handed = is_left}))
                                             .measure();
                const std::map<std::string, double> angles = {
                    {"fibonacci", GOLDEN}, {"lucas", LUCAS}, {"bijugate", GOLDEN / 2}};
                CHECK(number(rows, "divergence_angle") == Approx(angles.at(phyllotaxis)).epsilon(1e-3));
                CHECK(number(rows, "handedness") == (is_left ? -1 : 1));
                CHECK(number(rows, "jugacy") == (std::string(phyllotaxis) == "bijugate" ? 2 : 1));
                CHECK(number(rows, "floret_centre_offset") < 0.01);
            }
}

TEST_CASE("a rim of few rows of florets gives a reason where neighbours do not show the families of the lattice")
{
    for (const char* species : {"gerbera", "helianthus", "bellis"}) {
        CAPTURE(species);
        const auto rows = [&](char stage) {
            return head_of(make_phantom({.size = Size3(48), .species = species, .stage = std::string(1, stage)}))
                .measure();
        };
        const PatternRows rim = rows('b'), whole = rows('d');
        CHECK(number(rim, "divergence_angle") == Approx(GOLDEN).epsilon(1e-3));
        CHECK(!rim.value("parastichies_M_rho_0.9"));
        CHECK(rim.reason("parastichies_M_rho_0.9").find("% of neighbours lie along") != std::string::npos);
        CHECK(number(whole, "parastichies_share_rho_0.9") > 0.65);
        CHECK(number(rows('c'), "parastichies_M_rho_0.9") == number(whole, "parastichies_M_rho_0.9"));
    }
}

TEST_CASE("adaxial veins of bellis follow the parastichies, those of gerbera do not")
{
    std::map<std::string, double> aligned;
    for (const char* species : {"gerbera", "helianthus", "bellis"})
        aligned[species] =
            number(head_of(make_phantom({.size = Size3(48), .species = species})).measure(), "parastichy_alignment");
    CHECK(aligned["bellis"] > 0.9);
    CHECK(aligned["gerbera"] < 0.87);
    CHECK(aligned["helianthus"] < 0.9);
}

TEST_CASE("veins on the spirals have alignment 1")
{
    HeadBuilder head = Spiral{.dome = 0.3}.build();
    for (int start = 60; start < 70; ++start) {
        std::vector<glm::dvec3> vein;
        for (double k = start; k <= 90; k += 0.25) {  // along the family of 21, at 21 * 137.508 - 2880 degrees a step
            const double rho = std::sqrt((k + 0.5) / 144);
            vein.push_back(
                polar(50 * rho, GOLDEN * start + (21 * GOLDEN - 2880) * (k - start) / 21, 50 * 0.3 * (1 - rho * rho)));
        }
        head.vein(vein, ADAXIAL_GROUP);
    }
    CHECK(number(head.measure(), "parastichy_alignment") == Approx(1.0).epsilon(1e-4));
}

// Kind (Traces): florets that are irregular, missing in places, or on a dome
TEST_CASE("the interval holds the angle of irregular and incomplete heads, and widens with the noise")
{
    double last = 0.0;
    for (const double noise : {0.02, 0.06}) {
        int held = 0, found = 0;
        double width = 0.0;
        for (uint32_t seed = 1; seed <= 10; ++seed) {
            CAPTURE(noise);
            CAPTURE(seed);
            const PatternRows rows =
                Spiral{.noise = noise, .missing = seed % 2 * 0.15, .dome = seed % 3 * 0.2, .seed = seed}.rows();
            ++found;
            CHECK(number(rows, "divergence_angle") == Approx(GOLDEN).epsilon(0.002));
            CHECK(number(rows, "jugacy") == 1);
            held += number(rows, "divergence_angle_low") <= GOLDEN && number(rows, "divergence_angle_high") >= GOLDEN;
            width += number(rows, "divergence_angle_high") - number(rows, "divergence_angle_low");
        }
        CHECK(held >= found - 3);  // 95 % of 10; fewer than 7 has a chance of 0.1 %
        CHECK(width / found > 1.5 * last);
        last = width / found;
    }
}

// Kind (Traces): florets so irregular that wrong lattices fit a third to a half of them
TEST_CASE("strongly disturbed florets give the angle or a reason, never another angle")
{
    int found = 0, all = 0;
    for (const auto& [divergence, jugacy] : {std::pair(GOLDEN, 1), {LUCAS, 1}, {GOLDEN / 2, 2}})
        for (uint32_t seed = 1; seed <= repeats(5u, 100u); ++seed) {
            CAPTURE(divergence);
            CAPTURE(seed);
            const PatternRows rows =
                Spiral{.divergence = divergence, .noise = 0.12, .seed = seed, .jugacy = jugacy}.rows();
            ++all;
            if (!rows.value("divergence_angle")) {
                CHECK(rows.reason("divergence_angle").find("the florets are in no regular lattice") == 0);
                continue;
            }
            ++found;
            CHECK(number(rows, "divergence_angle") == Approx(divergence).epsilon(0.01));
            CHECK(number(rows, "jugacy") == jugacy);
        }
    CHECK(found > 0);
    MESSAGE(found << " of " << all);
}

TEST_CASE("florets at random are said to be in no lattice")
{
    for (uint32_t seed = 1; seed <= 20; ++seed) {
        std::mt19937 random(seed);
        HeadBuilder head;
        head.stem(13, 50.0);
        for (int k = 0; k < 144; ++k) {
            const double rho = std::sqrt(double(random()) / 4294967296.0);
            const glm::dvec3 top = polar(50 * rho, 360.0 * double(random()) / 4294967296.0, 10);
            head.vein({top, top - glm::dvec3(0, 0, 3)}, FLORET_GROUP);
        }
        const PatternRows rows = head.measure();
        CHECK(!rows.value("divergence_angle").has_value());
        CHECK(rows.reason("divergence_angle").find("beyond chance; expected 50 % or more") != std::string::npos);
    }
}

TEST_CASE("few florets, florets at one place and florets on a ring give reasons")
{
    CHECK(Spiral{.florets = 12}.rows().reason("divergence_angle") == "there are 12 florets; expected 20 or more");
    HeadBuilder head;
    head.stem(13, 50.0);
    for (int k = 0; k < 50; ++k) head.node({30, 10, 5}, FLORET_GROUP);
    CHECK(head.measure().reason("jugacy") == "there are 1 florets; expected 20 or more");
    HeadBuilder ring;
    ring.stem(13, 50.0);
    for (int k = 0; k < 60; ++k) ring.node(polar(50, 6 * k, 5), FLORET_GROUP);
    CHECK(!ring.measure().value("divergence_angle").has_value());
}
