// Proofs by the servo's own step(): energy, limits, loss. `SHARE` of the whole is run every day.
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
