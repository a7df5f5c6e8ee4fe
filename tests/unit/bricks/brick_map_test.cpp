// Numbers of bricks, against a map of the standard library.

#include "engine/bricks/brick_map.h"

#include <map>
#include <random>
#include <tuple>

#include <doctest/doctest.h>

using namespace shvr;

TEST_CASE("numbers of bricks are those of a map, whatever is added, replaced and erased")
{
    const auto tuple_of = [](const BrickKey& key) {
        return std::tuple(key.level, key.brick.x, key.brick.y, key.brick.z);
    };
    size_t most = 0;
    for (uint32_t seed = 0; seed < 40; ++seed) {
        std::mt19937 random(seed);
        const auto below = [&](uint32_t end) { return int(random() % end); };
        // Few bricks at the corners of the largest volume, so that they meet, or many.
        const auto axis = [&] { return seed % 2 == 0 ? below(4) * (32767 / 3) : below(30); };
        BrickMap bricks;
        std::map<std::tuple<int, int, int, int>, uint32_t> model;
        CHECK(!bricks.contains({}));
        for (int step = 0; step < 20'000; ++step) {
            const BrickKey key{below(3), {axis(), axis(), axis()}};
            const auto found = model.find(tuple_of(key));
            REQUIRE(bricks.find(key) == (found == model.end() ? std::nullopt : std::optional(found->second)));
            REQUIRE(bricks.contains(key) == (found != model.end()));
            if (below(5) < 2) {
                bricks.erase(key);
                model.erase(tuple_of(key));
            } else {
                bricks.set(key, uint32_t(step));
                model[tuple_of(key)] = uint32_t(step);
            }
            if (below(8000) == 0) {
                bricks.clear(size_t(below(100)));
                model.clear();
            }
            REQUIRE(bricks.size() == model.size());
            most = std::max(most, model.size());
        }
        for (const auto& [key, number] : model) {
            const auto& [level, x, y, z] = key;
            CHECK(bricks.find({level, {x, y, z}}) == number);
        }
    }
    CHECK(most > 5000);
}
