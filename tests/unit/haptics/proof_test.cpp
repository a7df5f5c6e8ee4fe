// Proofs by the servo's own step(): energy, limits, loss. `SHARE` of the whole is run every day.
#include <algorithm>

#include <doctest/doctest.h>

#include "tests/support/haptic_proofs.h"

using namespace shvr;

namespace {
constexpr int SHARE = 100;
}

TEST_CASE("a hundredth of the contacts: no wall gives energy to a hand, and none rings")
{
    check_contacts(10'000 / SHARE, 71);
}

TEST_CASE("a hundredth of the nonsense: every force is a number and within its limits")
{
    check_nonsense(10'000'000 / SHARE, 72);
}

TEST_CASE("a tenth of the loops: they do no work, in every mode with a potential")
{
    check_loops(1000 / 10, 73);
}

TEST_CASE("an undamped wall of 400 N/m at two ticks makes nothing: the observer takes it back")
{
    double most_j = -1.0;
    for (int i = 0; i < 40; ++i)
        most_j = std::max(most_j, contact({.stiffness = 400.0,
                                           .damping = 0.0,
                                           .has_friction = false,
                                           .is_held = false,
                                           .jitter_s = 0.0003,
                                           .speed = 0.1 + 0.005 * i,
                                           .seed = uint32_t(i + 1)})
                                      .gained_j);
    MESSAGE("worst of 40 throws: ", 1e3 * most_j, " mJ");
    CHECK(most_j <= 0.05e-3);
}
