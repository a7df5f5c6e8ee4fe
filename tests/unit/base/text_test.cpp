#include "engine/base/text.h"

#include <doctest/doctest.h>

using namespace shvr;

TEST_CASE("a text of several lines becomes one, with blanks between its words")
{
    CHECK(one_line("Bellis\nperennis") == "Bellis perennis");
    CHECK(one_line("Bellis\r\n\r\nperennis\n") == "Bellis perennis");
    CHECK(one_line("/a b/c.tif\n") == "/a b/c.tif");
    CHECK(one_line("\n\n").empty());
    CHECK(one_line("one  two") == "one  two");
}
