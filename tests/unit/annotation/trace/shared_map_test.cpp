// Maps whose copies share pages: each is as if it were alone.

#include <map>
#include <random>
#include <thread>

#include <doctest/doctest.h>

#include "engine/annotation/trace/shared_map.h"

using namespace shvr;

namespace {

void check_equal(const SharedMap<int>& map, const std::map<uint32_t, int>& expected)
{
    REQUIRE(map.size() == expected.size());
    auto found = map.begin();
    for (const auto& [number, value] : expected) {
        REQUIRE(found->first == number);
        REQUIRE(found->second == value);
        ++found;
    }
    REQUIRE(found == map.end());
}

}  // namespace

TEST_CASE("copies of a shared map never see what is done to others")
{
    std::mt19937 random(3);
    std::vector<std::pair<SharedMap<int>, std::map<uint32_t, int>>> maps(1);
    for (int step = 0; step < 20000; ++step) {
        auto& [map, model] = maps[random() % maps.size()];
        const auto number = uint32_t(random() % 2000);
        switch (random() % 8) {
            case 0:
            case 1:
            case 2:
            case 3:
                map[number] = step;
                model[number] = step;
                break;
            case 4:
            case 5:
                map.erase(number);
                model.erase(number);
                break;
            case 6: CHECK(map.contains(number) == model.contains(number)); break;
            default:
                if (random() % 50 != 0) break;
                if (maps.size() > 5) maps.erase(maps.begin() + long(random() % maps.size()));
                maps.reserve(maps.size() + 1);
                maps.push_back(maps[random() % maps.size()]);
        }
    }
    for (const auto& [map, model] : maps) check_equal(map, model);
    const SharedMap<int> moved = std::move(maps[0].first);
    check_equal(moved, maps[0].second);
    CHECK(moved == SharedMap<int>(moved));
}

TEST_CASE("a copy is read on another thread while the original changes")
{
    SharedMap<int> map;
    for (uint32_t i = 0; i < 5000; ++i) map[i] = 1;
    const SharedMap<int> copy = map;
    int64_t sum = 0;
    std::thread reader([&] {
        for (int times = 0; times < 20; ++times)
            for (const auto& [number, value] : copy) sum += value;
    });
    for (uint32_t i = 0; i < 5000; ++i) map[i] = 2;
    reader.join();
    CHECK(sum == 20 * 5000);
}
