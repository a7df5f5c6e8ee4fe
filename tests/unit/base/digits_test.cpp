// Numbers as people type and read them: all digits, and no exponent where none is needed.

#include <utility>

#include <doctest/doctest.h>

#include "engine/base/text.h"

using namespace shvr;

// Kind (Values): numbers with more than six digits
TEST_CASE("a number has all of its digits, and no exponent up to 1e15")
{
    const std::pair<double, const char*> cases[] = {{16777217.0, "16777217"},
                                                    {99999999.0, "99999999"},
                                                    {100.123456, "100.123456"},
                                                    {1e7, "10000000"},
                                                    {1e15, "1000000000000000"},
                                                    {-1234567.25, "-1234567.25"},
                                                    {0.1, "0.1"},
                                                    {0.000001, "0.000001"},
                                                    {0.0, "0"},
                                                    {-0.0, "0"},
                                                    {1e16, "1e+16"},
                                                    {1e-7, "1e-07"}};
    for (const auto& each : cases) {
        CAPTURE(each.second);
        CHECK(plain_digits_of(each.first) == each.second);
    }
    for (const double value : {1.0 / 3.0, -2.0 / 3e6, 123456789012345.678, 1.7976931348623157e308})
        CHECK(number_of(plain_digits_of(value)) == value);
}
