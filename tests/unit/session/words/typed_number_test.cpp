// Numbers as a person types them.

#include <doctest/doctest.h>

#include "engine/session/words/typed_number.h"

using namespace shvr;

TEST_CASE("a decimal comma means what a decimal point means")
{
    for (const char* const text : {"1,5", "1.5", " 1,5 ", "+1,5", "1,50", "15e-1", "0,15e1"}) {
        CAPTURE(text);
        CHECK(typed_number(text) == 1.5);
    }
    CHECK(typed_number(",5") == 0.5);
    CHECK(typed_number("2,") == 2.0);
    CHECK(typed_number("-0,25") == -0.25);
    CHECK(typed_number("1,500") == 1.5);  // never a separator of thousands
    CHECK(typed_number("15") == 15.0);
}

TEST_CASE("what is not one number is none")
{
    for (const char* const text : {"", " ", "-", "1,5,5", "1.5,5", "1,5.5", "1.5.5", "1 5", "1,5 mm", "abc", "1e",
                                   "nan", "inf", "1e999", "0x10", "1;5",
                                   "1\xd9\xab"
                                   "5"}) {
        CAPTURE(text);
        CHECK_FALSE(typed_number(text).has_value());
    }
}

TEST_CASE("a whole number has digits alone")
{
    CHECK(typed_whole(" 12 ") == 12);
    CHECK(typed_whole("-3") == -3);
    for (const char* const text : {"", "1,5", "1.5", "1,000", "1.0", "1e3", "9223372036854775808", "12a"}) {
        CAPTURE(text);
        CHECK_FALSE(typed_whole(text).has_value());
    }
}

TEST_CASE("a beginning of a number is known as one")
{
    for (const char* const text : {"", "-", "1e", "1e-", ",", "1,"}) {
        CAPTURE(text);
        CHECK(may_become_number(text));
    }
    for (const char* const text : {"a", "1,5,", "1,5.", "--", "1x"}) {
        CAPTURE(text);
        CHECK_FALSE(may_become_number(text));
    }
    CHECK(may_become_whole(""));
    CHECK(may_become_whole("-"));
    CHECK_FALSE(may_become_whole("1,"));
}

TEST_CASE("a point takes the place of the comma of a number alone")
{
    CHECK(with_decimal_point("0,4") == "0.4");
    CHECK(with_decimal_point("0.4") == "0.4");
    CHECK(with_decimal_point("1,2,3") == "1,2,3");
    CHECK(with_decimal_point("[1,2]") == "[1,2]");
    CHECK(with_decimal_point("Smith, J") == "Smith, J");
}
