// The scenes of the bench: made at every size that it offers.

#include <algorithm>
#include <string>

#include <doctest/doctest.h>

#include "tools/bench/scenes.h"

using namespace shvr;

TEST_CASE("scenes are made at every size that the bench offers, with paint and a session that names its size")
{
    for (const int64_t side : {16, 64, 512}) {
        CAPTURE(side);
        const std::vector<bench::Scene> scenes = bench::own_scenes(side, {40, 30});
        CHECK(scenes.size() >= 14);
        const auto painted = std::ranges::find(scenes, "painted", &bench::Scene::name);
        REQUIRE(painted != scenes.end());
        CHECK(painted->drawn.script.size() == 2);
        const auto fog = std::ranges::find(scenes, "fog", &bench::Scene::name);
        REQUIRE(fog != scenes.end());
        const std::string number = std::to_string(side);
        CHECK(fog->drawn.session_text.find("[" + number + "," + number + "," + number + "]") != std::string::npos);
    }
}
