// The axis and the centre of a head, fitted to traces as hands make them: of flat heads, and with errors.

#include <cmath>
#include <numbers>
#include <random>

#include <doctest/doctest.h>

#include "tests/support/slow.h"
#include "tests/unit/annotation/patterns/flower_heads.h"

using namespace shvr;
using namespace shvr::test;

namespace {

using doctest::Approx;

struct FoundAxis {
    double degrees = 90.0;  ///< between the axis and the head's
    double off = 1.0;       ///< distance of the head's centre from the axis, in radii of the head
    bool is_up = false;
};

/// Of a head whose centre, direction and radius are known, in the space of the trace.
FoundAxis axis_of(const HeadBuilder& head, const glm::dvec3& centre, const glm::dvec3& up, double radius)
{
    const PatternRows rows = head.measure();
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

/// Rounds a head's stem off: keeps what is above a height.
HeadBuilder above(const HeadBuilder& head, double height)
{
    HeadBuilder kept;
    std::vector<int64_t> number(head.nodes.size(), -1);
    for (size_t i = 0; i < head.nodes.size(); ++i) {
        if (head.nodes[i].position.z < height) continue;
        number[i] = int64_t(kept.nodes.size());
        kept.nodes.push_back(head.nodes[i]);
    }
    for (const TraceInternode& link : head.links)
        if (number[link.a] >= 0 && number[link.b] >= 0)
            kept.links.push_back({uint32_t(number[link.a]), uint32_t(number[link.b]), link.group});
    return kept;
}

}  // namespace

// Kind (Traces): a head as flat as a disc, whose veins wave in its plane
TEST_CASE("the axis of a flat head is the normal of its plane, not a line in it, however its veins wave")
{
    // Turns of 360 / 13 degrees map the head onto itself, so its axis is known exactly.
    for (const double height : {0.0, 0.02})
        for (const double wave : {0.0, 0.02, 0.08}) {
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
            const FoundAxis found = axis_of(head, {70, 60, 50}, {0, 0, 1}, 50.0);
            CHECK(found.degrees < 1e-5);
            CHECK(found.off < 1e-6);
        }
}

// Kind (Traces): nodes off the centre lines by up to 3 % of the head's radius, in heads of all heights
TEST_CASE("errors of a hand turn the axis by a few degrees at most, however flat the head is")
{
    const glm::dvec3 centre(50.0);
    double worst = 0.0, worst_off = 0.0;
    for (const char* species : {"gerbera", "helianthus", "bellis"}) {
        const HeadBuilder truth = head_of(make_phantom({.size = Size3(100), .species = species}));
        for (const double factor : {1.0, 0.5, 0.2, 0.0})
            for (const glm::dvec3& errors : {glm::dvec3(0.02), glm::dvec3(0.03, 0.03, 0.0), glm::dvec3(0, 0, 0.03)})
                for (uint32_t seed = 1; seed <= repeats(1u, 20u); ++seed)
                    for (const bool has_stem : {true, false}) {
                        CAPTURE(species);
                        CAPTURE(factor);
                        CAPTURE(errors.x);
                        CAPTURE(errors.z);
                        CAPTURE(seed);
                        CAPTURE(has_stem);
                        HeadBuilder head = with_errors(flattened(truth, centre, factor), centre, errors, 40.0, seed);
                        if (!has_stem) head = above(head, centre.z - 40.0 * 0.62 * factor - 5.0);
                        const FoundAxis found = axis_of(head, centre, {0, 0, 1}, 40.0);
                        CHECK(found.degrees < 4.0);
                        CHECK(found.off < 0.05);
                        worst = std::max(worst, found.degrees);
                        worst_off = std::max(worst_off, found.off);
                    }
    }
    MESSAGE("at most " << worst << " degrees and " << worst_off << " radii");
}
