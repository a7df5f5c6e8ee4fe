// The species and stages of the thesis (5.2, figures 5.3 and 5.4) as predicates of phantoms' graphs.

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <set>

#include <doctest/doctest.h>

#include "engine/volume/phantoms/phantom.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

constexpr int64_t VOXELS = 48;
constexpr double HEAD = 0.40 * VOXELS;  // voxels of the head's radius
constexpr uint8_t ABAXIAL = 1, ADAXIAL = 2, FLORET = 3;

Phantom head(const std::string& species, const std::string& stage, const std::string& phyllotaxis = "fibonacci")
{
    return make_phantom(
        {.size = Size3(VOXELS), .seed = 9, .species = species, .stage = stage, .phyllotaxis = phyllotaxis});
}

glm::dvec3 from_axis(const glm::dvec3& voxel)
{
    return (voxel - glm::dvec3(0.5 * VOXELS)) / HEAD;
}
double rho_of(const glm::dvec3& voxel)
{
    return std::hypot(from_axis(voxel).x, from_axis(voxel).y);
}

struct Range {
    double least = 9.0, most = -9.0;
    int count = 0;
    void add(double value)
    {
        least = std::min(least, value);
        most = std::max(most, value);
        ++count;
    }
};
/// rho of the nodes of a section.
Range reach(const Phantom& phantom, uint8_t group)
{
    Range range;
    for (const auto& node : phantom.nodes)
        if (node.group == group) range.add(rho_of(node.voxel));
    return range;
}
/// rho of the internodes between two sections.
Range joins(const Phantom& phantom, uint8_t a, uint8_t b)
{
    Range range;
    for (const auto& [from, to] : phantom.links)
        if (std::minmax(phantom.nodes[from].group, phantom.nodes[to].group) == std::minmax(a, b) && a != b)
            range.add(rho_of(phantom.nodes[to].voxel));
    return range;
}

/// rho of the tips of bracts: abaxial nodes above the receptacle's edge that no link leaves.
Range tips(const Phantom& phantom)
{
    std::set<size_t> left;
    for (const auto& link : phantom.links) left.insert(link[0]);
    Range range;
    for (size_t i = 0; i < phantom.nodes.size(); ++i)
        if (phantom.nodes[i].group == ABAXIAL && !left.contains(i) && from_axis(phantom.nodes[i].voxel).z > 0.2)
            range.add(rho_of(phantom.nodes[i].voxel));
    return range;
}

/// Least distance between an adaxial and an abaxial vein's node, in radii of the head.
double adaxial_from_abaxial(const Phantom& phantom)
{
    double least = 9.0;
    for (const auto& a : phantom.nodes)
        for (const auto& b : phantom.nodes)
            if (a.group == ADAXIAL && b.group == ABAXIAL)
                least = std::min(least, glm::length(a.voxel - b.voxel) / HEAD);
    return least;
}

size_t parts(const Phantom& phantom)
{
    std::vector<size_t> root(phantom.nodes.size());
    std::iota(root.begin(), root.end(), size_t{0});
    const auto find = [&](size_t i) {
        while (root[i] != i) i = root[i] = root[root[i]];
        return i;
    };
    for (const auto& [from, to] : phantom.links) root[find(from)] = find(to);
    std::set<size_t> roots;
    for (size_t i = 0; i < root.size(); ++i) roots.insert(find(i));
    return roots.size();
}

/// Length-weighted mean of |t . r| of adaxial internodes, in the plane across the axis.
double radiality(const Phantom& phantom)
{
    double sum = 0.0, length = 0.0;
    for (const auto& [from, to] : phantom.links) {
        if (phantom.nodes[from].group != ADAXIAL || phantom.nodes[to].group != ADAXIAL) continue;
        const glm::dvec2 a(from_axis(phantom.nodes[from].voxel)), b(from_axis(phantom.nodes[to].voxel));
        if (glm::length(a + b) < 0.2) continue;  // no radial direction at the axis
        sum += std::abs(glm::dot(b - a, glm::normalize(a + b)));
        length += glm::length(b - a);
    }
    return sum / length;
}

/// Loops of the adaxial veins: links - nodes + parts.
int64_t adaxial_loops(const Phantom& phantom)
{
    Phantom net;
    std::map<size_t, size_t> number;
    for (size_t i = 0; i < phantom.nodes.size(); ++i)
        if (phantom.nodes[i].group == ADAXIAL) {
            number[i] = net.nodes.size();
            net.nodes.push_back(phantom.nodes[i]);
        }
    for (const auto& [from, to] : phantom.links)
        if (number.contains(from) && number.contains(to)) net.links.push_back({number[from], number[to]});
    return int64_t(net.links.size()) - int64_t(net.nodes.size()) + int64_t(parts(net));
}

/// Upper ends of florets' veins, from the axis outwards.
std::vector<glm::dvec3> florets(const Phantom& phantom)
{
    std::set<size_t> joined;
    for (const auto& link : phantom.links) joined.insert(link[1]);
    std::vector<glm::dvec3> tops;
    for (size_t i = 0; i < phantom.nodes.size(); ++i)
        if (phantom.nodes[i].group == FLORET && !joined.contains(i)) tops.push_back(phantom.nodes[i].voxel);
    std::ranges::sort(tops, {}, rho_of);
    return tops;
}

double degrees_between(const glm::dvec3& a, const glm::dvec3& b)
{
    const glm::dvec3 p = from_axis(a), q = from_axis(b);
    const double turn = (std::atan2(q.y, q.x) - std::atan2(p.y, p.x)) * 180.0 / std::numbers::pi;
    return turn - 360.0 * std::floor(turn / 360.0);
}

}  // namespace

TEST_CASE("stage a shows the stem's, abaxial and bract veins alone")
{
    const Phantom a = head("gerbera", "a");
    CHECK(std::ranges::all_of(a.nodes, [](const auto& node) { return node.group == ABAXIAL; }));
    CHECK(reach(a, ABAXIAL).most > 1.0);  // in the bracts
    CHECK(parts(a) == 13);
}

TEST_CASE("stage b adds adaxial veins that are separate, and florets' veins at the rim alone")
{
    const Phantom b = head("gerbera", "b");
    CHECK(reach(b, ADAXIAL).count > 0);
    CHECK(reach(b, FLORET).count > 0);
    CHECK(reach(b, FLORET).least > 0.8);
    for (const auto& [one, other] : {std::pair(ABAXIAL, ADAXIAL), {ABAXIAL, FLORET}, {ADAXIAL, FLORET}})
        CHECK(joins(b, one, other).count == 0);
    // Abaxial veins have grown outwards with the head, and its bracts open.
    CHECK(tips(head("gerbera", "a")).most < 0.95);
    CHECK(tips(b).least > tips(head("gerbera", "a")).most + 0.1);
}

TEST_CASE("at stage c adaxial veins are longer, florets' veins reach further inwards, and join abaxial ones at the rim")
{
    const Phantom b = head("gerbera", "b"), c = head("gerbera", "c");
    CHECK(reach(c, ADAXIAL).most > reach(b, ADAXIAL).most + 0.1);
    CHECK(reach(c, ADAXIAL).least < reach(b, ADAXIAL).least);
    CHECK(adaxial_from_abaxial(c) < adaxial_from_abaxial(b) - 0.05);
    CHECK(tips(c).least > tips(b).most);
    CHECK(reach(c, FLORET).least < reach(b, FLORET).least - 0.2);
    CHECK(joins(c, ABAXIAL, FLORET).count > 10);
    CHECK(joins(c, ABAXIAL, FLORET).least > 0.8);
    CHECK(joins(c, ADAXIAL, FLORET).count == 0);
    CHECK(joins(c, ABAXIAL, ADAXIAL).count == 0);
}

TEST_CASE("at stage d florets join abaxial veins at the rim, adaxial ones further inwards, each other in the middle")
{
    const Phantom d = head("gerbera", "d");
    CHECK(parts(d) == 13);  // stem bundles; all else is joined to one of them
    CHECK(reach(d, ADAXIAL).least > 0.25);
    CHECK(reach(d, FLORET).least < 0.1);
    CHECK(joins(d, ABAXIAL, FLORET).least > 0.8);
    CHECK(joins(d, ADAXIAL, FLORET).least > 0.25);
    CHECK(joins(d, ADAXIAL, FLORET).most < joins(d, ABAXIAL, FLORET).least);
    Range middle;  // links from one floret's vein to another's
    for (const auto& [from, to] : d.links) {
        const bool is_within_one = from + 1 == to;
        if (d.nodes[from].group != FLORET || d.nodes[to].group != FLORET || is_within_one) continue;
        middle.add(rho_of(d.nodes[to].voxel));
    }
    CHECK(middle.count > 8);
    CHECK(middle.most < 0.3);
}

TEST_CASE("adaxial veins run as the species' do: straight, joined and drooping, or in a net along parastichies")
{
    const Phantom gerbera = head("gerbera", "d"), helianthus = head("helianthus", "d"), bellis = head("bellis", "d");
    CHECK(radiality(gerbera) > 0.999);
    CHECK(radiality(helianthus) < 0.99);
    CHECK(radiality(helianthus) > 0.75);
    CHECK(radiality(bellis) < 0.75);
    CHECK(adaxial_loops(gerbera) == 0);
    CHECK(adaxial_loops(helianthus) > 10);
    CHECK(adaxial_loops(bellis) > 2 * adaxial_loops(helianthus));
    CHECK(reach(gerbera, ADAXIAL).least > 0.25);
    CHECK(reach(helianthus, ADAXIAL).least < 0.1);
    CHECK(reach(bellis, ADAXIAL).least < 0.15);

    // Every vein of the net joins neighbours on a parastichy: their numbers differ by a Fibonacci number.
    const std::vector<glm::dvec3> tops = florets(bellis);
    REQUIRE(tops.size() == 144);
    const auto number = [&](const glm::dvec3& voxel) {
        const auto is_below = [&](const glm::dvec3& top) { return glm::length(glm::dvec2(top - voxel)) < 1e-6; };
        return std::ranges::find_if(tops, is_below) - tops.begin();
    };
    const std::set<ptrdiff_t> fibonacci = {1, 2, 3, 5, 8, 13, 21, 34, 55, 89};
    for (const auto& [from, to] : bellis.links)
        if (bellis.nodes[from].group == ADAXIAL && bellis.nodes[to].group == ADAXIAL)
            CHECK(fibonacci.contains(std::abs(number(bellis.nodes[to].voxel) - number(bellis.nodes[from].voxel))));
}

TEST_CASE("heads are flat, depressed and elongated, and helianthus's veins hang lower towards the axis")
{
    const auto height = [](const Phantom& phantom, double rho) {
        const std::vector<glm::dvec3> tops = florets(phantom);
        return from_axis(*std::ranges::min_element(tops, {},
                                                   [&](const glm::dvec3& top) { return std::abs(rho_of(top) - rho); }))
            .z;
    };
    std::map<std::string, double> dome;
    for (const char* species : {"gerbera", "helianthus", "bellis"}) {
        const Phantom phantom = head(species, "d");
        dome[species] = height(phantom, 0.0) - height(phantom, 0.95);
    }
    CHECK(dome["gerbera"] == doctest::Approx(0.11).epsilon(0.1));
    CHECK(dome["helianthus"] < -0.1);
    CHECK(dome["bellis"] > 0.5);

    const Phantom helianthus = head("helianthus", "d");
    Range at_edge, at_axis;
    for (const auto& node : helianthus.nodes) {
        if (node.group != ADAXIAL) continue;
        const double rho = rho_of(node.voxel);
        const double below = 0.15 - 0.18 * (1.0 - rho * rho) - from_axis(node.voxel).z;
        if (rho > 0.8) at_edge.add(below);
        if (rho < 0.2) at_axis.add(below);
    }
    CHECK(at_axis.least > at_edge.most + 0.1);
}

TEST_CASE("successive florets turn by the golden angle, Lucas's, or half the golden angle in pairs")
{
    for (const auto& [phyllotaxis, step, angle] : {std::tuple("fibonacci", 1, 137.50776405003785),
                                                   {"lucas", 1, 99.50155281000757},
                                                   {"bijugate", 2, 68.75388202501893}}) {
        CAPTURE(phyllotaxis);
        const std::vector<glm::dvec3> tops = florets(head("gerbera", "d", phyllotaxis));
        REQUIRE(tops.size() == 144);
        for (size_t i = 0; i + size_t(step) < tops.size(); ++i)
            CHECK(degrees_between(tops[i], tops[i + size_t(step)]) == doctest::Approx(angle).epsilon(1e-9));
    }
    PhantomSpec spec{.size = Size3(VOXELS)};
    const std::vector<glm::dvec3> right = florets(make_phantom(spec));
    spec.left_handed = true;
    const std::vector<glm::dvec3> left = florets(make_phantom(spec));
    CHECK(degrees_between(left[1], left[0]) == doctest::Approx(degrees_between(right[0], right[1])));
}

TEST_CASE("a bundle of double tubes has its phloem beside its xylem, in the same section")
{
    PhantomSpec spec{.size = Size3(96), .flaws = {.noise = 0}};
    const std::vector<uint8_t> single = voxels_of<uint8_t>(*make_phantom(spec).mask);
    spec.double_tubes = true;
    const Phantom doubled = make_phantom(spec);
    const std::vector<uint8_t> both = voxels_of<uint8_t>(*doubled.mask);
    int64_t lost = 0, more = 0;
    for (size_t i = 0; i < both.size(); ++i) {
        lost += single[i] != 0 && both[i] == 0;
        more += single[i] == 0 && both[i] != 0;
    }
    CHECK(lost == 0);
    CHECK(more > std::ranges::count_if(single, [](uint8_t group) { return group != 0; }) / 5);
    // Across the first piece of a stem bundle: xylem, a gap, phloem further out.
    const glm::dvec3 at = 0.5 * (doubled.nodes[0].voxel + doubled.nodes[1].voxel);
    const glm::dvec2 out = glm::normalize(glm::dvec2(at) - glm::dvec2(48.0));
    const double radius = doubled.nodes[0].radius_voxels;
    const auto group = [&](double away) {
        const Size3 voxel(glm::floor(at + glm::dvec3(out * away, 0.0)));
        return both[size_t(voxel.x + 96 * (voxel.y + 96 * voxel.z))];
    };
    CHECK(group(0.0) == ABAXIAL);
    CHECK(group(2.0 * radius) == ABAXIAL);
    CHECK(group(4.0 * radius) == 0);
}
