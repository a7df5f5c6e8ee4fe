#include <doctest/doctest.h>

#include "engine/session/looks/new_scan.h"

using namespace shvr;

TEST_CASE("A new scan has ambient occlusion unless the device would take long, or the light is stated")
{
    const auto strength = [](const Size3& size, int64_t most, std::vector<std::string> settings) {
        Session session;
        light_new_scan(session, size, most, settings);
        return session.light.occlusion.strength;
    };
    CHECK(strength({1024, 1024, 1024}, MAX_OCCLUDED_BY_CPU, {}) > 0.0);
    CHECK(strength({1024, 1024, 1025}, MAX_OCCLUDED_BY_CPU, {}) == 0.0);
    CHECK(strength({1 << 20, 1 << 20, 1 << 20}, MAX_OCCLUDED_BY_CPU, {}) == 0.0);  // no overflow
    CHECK(strength({1024, 1024, 1024}, MAX_OCCLUDED_BY_CPU, {"render.size=[9,9]"}) > 0.0);
    CHECK(strength({1024, 1024, 1024}, MAX_OCCLUDED_BY_CPU, {"light.ambient=0.5"}) == 0.0);
}
