// All of what proof_test.cpp runs a part of.
#include <doctest/doctest.h>

#include "tests/support/haptic_proofs.h"

using namespace shvr;

TEST_CASE("10,000 contacts: no wall gives energy to a hand, and none rings")
{
    check_contacts(10'000, 81);
}

TEST_CASE("10,000,000 ticks of nonsense: every force is a number and within its limits")
{
    check_nonsense(10'000'000, 82);
}

TEST_CASE("1000 loops do no work, in every mode with a potential")
{
    check_loops(1000, 83);
}
