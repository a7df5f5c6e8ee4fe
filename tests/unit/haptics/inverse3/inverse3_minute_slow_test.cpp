#include <doctest/doctest.h>

#include "tests/support/inverse3_pace.h"

using namespace shvr;

TEST_CASE("at 1 kHz for a minute no message is lost")
{
    check_pace(60'000);
}
