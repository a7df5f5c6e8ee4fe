// A set of surfaces with a few changes at a time.

#include "engine/look/surfaces/surface_forest.h"

#include <algorithm>
#include <cstring>
#include <map>
#include <random>

#include <doctest/doctest.h>

#include "engine/base/error.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

const VolumeInfo VOLUME = volume_of_size(Size3(1000));

class Random {
public:
    explicit Random(uint32_t seed) : random_(seed) {}
    uint32_t below(uint32_t end) { return uint32_t(random_() % end); }
    SurfaceLook rod()
    {
        const glm::dvec3 from(below(1000), below(1000), below(1000));
        return {from, from + glm::dvec3(below(9), below(9), below(9)), 0.5 + below(4), 0.5 + below(4),
                glm::dvec3(below(256)) / 255.0};
    }

private:
    std::mt19937 random_;
};

std::vector<KeyedSurface> rods(size_t count, Random& random)
{
    std::vector<KeyedSurface> surfaces;
    for (uint32_t i = 0; i < count; ++i)
        surfaces.push_back({surface_key(i % 2 ? SurfaceKind::internode : SurfaceKind::node, i), random.rod()});
    return surfaces;
}

bool contains(const gpu::SurfaceNode& box, const gpu::Surface& surface)
{
    const glm::dvec3 from = glm::dvec3(surface.from) + glm::dvec3(surface.from_rest);
    const glm::dvec3 to = from + glm::dvec3(surface.along);
    const glm::dvec3 lower = glm::min(from - double(surface.radius_from), to - double(surface.radius_to));
    const glm::dvec3 upper = glm::max(from + double(surface.radius_from), to + double(surface.radius_to));
    return glm::all(glm::lessThanEqual(glm::dvec3(box.lower), lower)) &&
           glm::all(glm::greaterThanEqual(glm::dvec3(box.upper), upper));
}

template <class Value>
bool same_bytes(const Value& a, const Value& b)
{
    return std::memcmp(&a, &b, sizeof(Value)) == 0;
}

/// The surfaces that a search which opens every box visits, in any order; every surface must be inside all boxes opened
/// for it.
std::vector<gpu::Surface> found_in(const std::vector<gpu::SurfaceNode>& nodes, const std::vector<gpu::Surface>& list)
{
    std::vector<gpu::Surface> found;
    size_t outside = 0;
    for (uint32_t node = 0; node < nodes.size(); ++node)
        for (uint32_t i = nodes[node].begin; i < nodes[node].end; ++i) {
            found.push_back(list.at(i));
            for (uint32_t around = 0; around <= node; ++around)
                if (nodes[around].skip > node) outside += !contains(nodes[around], list[i]);
        }
    CHECK(outside == 0);
    return found;
}

bool is_before(const gpu::Surface& a, const gpu::Surface& b)
{
    return a.number < b.number;
}

/// The forest and the device's copy of it contain exactly `truth`.
struct Watched {
    SurfaceForest forest;
    std::map<uint64_t, SurfaceLook> truth;
    std::vector<gpu::SurfaceNode> sent_nodes;
    std::vector<gpu::Surface> sent_list;

    explicit Watched(const std::vector<KeyedSurface>& surfaces) : forest(surfaces, VOLUME)
    {
        for (const KeyedSurface& surface : surfaces) truth[surface.key] = surface.look;
        sent_nodes = forest.nodes();
        sent_list = forest.list();
        sent_nodes.resize(forest.max_nodes());
        sent_list.resize(forest.max_surfaces());
    }

    bool replace(const std::vector<uint64_t>& keys, const std::vector<KeyedSurface>& surfaces)
    {
        if (!forest.replace(keys, surfaces, VOLUME)) return false;
        for (const uint64_t key : keys) truth.erase(key);
        for (const KeyedSurface& surface : surfaces) truth[surface.key] = surface.look;
        return true;
    }

    std::vector<KeyedSurface> all() const
    {
        std::vector<KeyedSurface> surfaces;
        for (const auto& [key, look] : truth) surfaces.push_back({key, look});
        return surfaces;
    }

    bool restyle(const std::vector<KeyedSurface>& surfaces)
    {
        if (!forest.restyle(surfaces, VOLUME)) return false;
        truth.clear();
        for (const KeyedSurface& surface : surfaces) truth[surface.key] = surface.look;
        return true;
    }

    void send()
    {
        const SurfaceForest::Written written = forest.take_written();
        for (const uint32_t at : written.nodes)
            if (at < forest.nodes().size()) sent_nodes.at(at) = forest.nodes()[at];
        for (const uint32_t at : written.list)
            if (at < forest.list().size()) sent_list.at(at) = forest.list()[at];
    }

    void check()
    {
        send();
        std::vector<gpu::SurfaceNode> nodes(sent_nodes.begin(), sent_nodes.begin() + ptrdiff_t(forest.nodes().size()));
        std::vector<gpu::Surface> found = found_in(nodes, sent_list);
        std::vector<gpu::Surface> expected = surface_tree(all(), VOLUME).list;
        std::ranges::sort(found, is_before);
        std::ranges::sort(expected, is_before);
        REQUIRE(found.size() == expected.size());
        size_t wrong = 0;
        for (size_t i = 0; i < found.size(); ++i) wrong += !same_bytes(found[i], expected[i]);
        CHECK(wrong == 0);
    }
};

}  // namespace

TEST_CASE("after any changes a search finds the surfaces there are, on the device too")
{
    Random random(71);  // seed 71
    Watched watched(rods(5000, random));
    uint32_t next = 5000;
    for (int turn = 0; turn < 60; ++turn) {
        CAPTURE(turn);
        std::vector<uint64_t> keys;
        std::map<uint64_t, SurfaceLook> now;
        for (uint32_t i = random.below(turn % 10 == 9 ? 150 : 6); i > 0; --i) {
            auto at = watched.truth.begin();
            std::advance(at, random.below(uint32_t(watched.truth.size())));
            keys.push_back(at->first);
            if (random.below(3) > 0) now[at->first] = random.rod();  // changed, not removed
        }
        if (random.below(4) == 0) keys.push_back(surface_key(SurfaceKind::session, 7));  // does not exist
        for (uint32_t i = random.below(4); i > 0; --i) now[surface_key(SurfaceKind::node, next++)] = random.rod();
        std::vector<KeyedSurface> surfaces;
        for (const auto& [key, look] : now) surfaces.push_back({key, look});
        REQUIRE(watched.replace(keys, surfaces));
        if (turn % 3 == 0) watched.check();  // otherwise several changes are uploaded at once
    }
    watched.check();
}

TEST_CASE("a leaf may lose all of its surfaces, and they may come again")
{
    Random random(72);  // seed 72
    Watched watched(rods(4200, random));
    const std::map<uint64_t, SurfaceLook> all = watched.truth;
    std::vector<uint64_t> keys;
    for (uint32_t i = 0; i < 2000; ++i)
        keys.push_back(surface_key(i % 2 ? SurfaceKind::internode : SurfaceKind::node, i));
    REQUIRE(watched.replace(keys, {}));
    watched.check();
    CHECK(watched.truth.size() == 2200);
    std::vector<KeyedSurface> again;
    for (const uint64_t key : keys) again.push_back({key, all.at(key)});
    REQUIRE(watched.replace({}, again));
    CHECK(watched.truth == all);
    watched.check();
}

TEST_CASE("what would cost as much as a new forest is left to one, and what is refused changes nothing")
{
    Random random(73);  // seed 73
    CHECK(!Watched(rods(2 * SurfaceForest::MAX_SURFACES_ADDED, random)).replace({}, rods(1, random)));
    CHECK(!Watched({}).replace({}, rods(1, random)));

    Watched watched(rods(5000, random));
    std::vector<KeyedSurface> many;
    for (uint32_t i = 0; i <= SurfaceForest::MAX_SURFACES_ADDED; ++i)
        many.push_back({surface_key(SurfaceKind::session, i), random.rod()});
    CHECK(!watched.replace({}, many));
    const KeyedSurface last = many.back();
    many.pop_back();
    CHECK(watched.replace({}, many));
    CHECK(!watched.replace({}, {last}));
    CHECK(watched.replace({many[0].key}, {last}));  // one is removed, one is added
    watched.check();

    KeyedSurface broken{surface_key(SurfaceKind::node, 12), {}};
    broken.look.radius_from = -1.0;
    const std::vector<uint64_t> gone{surface_key(SurfaceKind::node, 0), many[1].key};
    CHECK_THROWS_WITH_AS(watched.replace(gone, {broken}),
                         doctest::Contains("node 12: a radius is -1; expected more than 0"), Error);
    watched.check();
}

TEST_CASE("other colours and sizes are written where they are, and boxes fit them")
{
    Random random(74);  // seed 74
    Watched watched(rods(5000, random));
    std::vector<uint64_t> gone;
    for (uint32_t i = 0; i < 40; ++i) gone.push_back(surface_key(SurfaceKind::node, 2 * i));
    REQUIRE(watched.replace(gone, {{surface_key(SurfaceKind::node, 9000), random.rod()},
                                   {surface_key(SurfaceKind::internode, 4001), random.rod()}}));
    watched.check();

    std::vector<KeyedSurface> all = watched.all();
    for (size_t i = 0; i < all.size(); i += 5) all[i].look.color = glm::dvec3(0.25, 0.5, 2.0);
    const size_t recoloured = (all.size() + 4) / 5;
    REQUIRE(watched.restyle(all));
    const SurfaceForest::Written written = SurfaceForest(watched.forest).take_written();
    CHECK(written.list.size() <= recoloured + 2);  // the two of the small hierarchy are written together
    CHECK(written.list.size() >= recoloured - 2);
    CHECK(written.nodes.size() <= 3);
    watched.check();

    const std::vector<gpu::SurfaceNode> before = watched.forest.nodes();
    for (size_t i = 0; i < all.size(); i += 7) all[i].look.radius_to *= i % 2 ? 3.0 : 0.25;
    REQUIRE(watched.restyle(all));
    watched.check();
    size_t smaller = 0, larger = 0;
    for (size_t i = 0; i < before.size(); ++i) {
        smaller += glm::any(glm::greaterThan(watched.forest.nodes()[i].lower, before[i].lower));
        larger += glm::any(glm::lessThan(watched.forest.nodes()[i].lower, before[i].lower));
    }
    CHECK(smaller > 50);
    CHECK(larger > 50);
    REQUIRE(watched.restyle(all));  // the same again
    CHECK(watched.forest.take_written().list.empty());

    std::vector<KeyedSurface> fewer = all;
    fewer.pop_back();
    CHECK(!watched.restyle(fewer));
    std::vector<KeyedSurface> others = all;
    others[2000].key = surface_key(SurfaceKind::session, 3);
    CHECK(!watched.restyle(others));
    all[100].look.color.x = 0.125;
    all[4000].look.radius_from = -1.0;
    CHECK_THROWS_WITH_AS(watched.restyle(all), doctest::Contains("a radius is -1; expected more than 0"), Error);
    watched.check();
    CHECK(!Watched(rods(100, random)).restyle(rods(100, random)));
}
