#include "engine/workbench/curves/fine_drag.h"

#include <doctest/doctest.h>

using namespace shvr::ui;

TEST_CASE("what is dragged finely goes a tenth as far, and goes on from there without a jump")
{
    FineDrag drag({100.0f, 50.0f}, {104.0f, 48.0f});  // held beside its middle
    CHECK(drag.follow({100.0f, 50.0f}, false) == glm::vec2(104.0f, 48.0f));
    CHECK(drag.follow({110.0f, 30.0f}, false) == glm::vec2(114.0f, 28.0f));
    CHECK(drag.follow({110.0f, 30.0f}, true) == glm::vec2(114.0f, 28.0f));
    const glm::vec2 fine = drag.follow({130.0f, 10.0f}, true);
    CHECK(fine.x == doctest::Approx(116.0f));
    CHECK(fine.y == doctest::Approx(26.0f));
    CHECK(drag.follow({130.0f, 10.0f}, false) == fine);
    CHECK(drag.follow({133.0f, 10.0f}, false).x == doctest::Approx(119.0f));
}
