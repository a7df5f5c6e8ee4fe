// What the window of operations suggests, and its refusals in the words of its rows.

#include <doctest/doctest.h>

#include "engine/workbench/actions/action_rows.h"
#include "engine/workbench/forms/operation_form.h"

using namespace shvr;
using namespace shvr::ui;

namespace {

/// Why the line is no action, in the words of the window.
std::string refusal_of(const char* line)
{
    try {
        static_cast<void>(read_action(line, "w"));
    } catch (const Error& error) {
        const std::string words = error.what();
        REQUIRE(words.starts_with("w: "));
        return with_label(words.substr(3));
    }
    return "";
}

}  // namespace

TEST_CASE("a suggested intensity is whole for scans of integers, and short for others")
{
    CHECK(suggested_intensity(133.623, VoxelType::uint8) == 134.0);
    CHECK(suggested_intensity(134.0, VoxelType::uint16) == 134.0);
    CHECK(suggested_intensity(-1000.3, VoxelType::int16) == -1000.0);
    CHECK(suggested_intensity(0.133622549019, VoxelType::float32) == 0.133623);
}

TEST_CASE("the window refuses values by the labels of their rows, not by the keys of scripts")
{
    CHECK(refusal_of(R"({"op":"threshold","group":3})") ==
          "From is empty; expected a lowest intensity, a highest one, or both");
    CHECK(refusal_of(R"({"op":"threshold","group":3,"from":120.5,"to":100.0})") ==
          "To is 100; expected at least the lowest intensity");
    CHECK(refusal_of(R"({"op":"grow","group":3,"distance":0.0})") ==
          "Distance is 0; expected a number above 0, up to 1e12");
    CHECK(refusal_of(R"({"op":"islands","group":3,"keep":"largest","connectivity":7})") ==
          "Connectivity is 7; expected 6 or 26");
    CHECK(with_label("key split_from is 7, and group 9 has 1 voxels already; expected 4 groups") ==
          "Split from is 7, and group 9 has 1 voxels already; expected 4 groups");
    CHECK(with_label("nothing is open") == "nothing is open");
    CHECK(with_label("group 3 has no voxels; expected some to trace") ==
          "group 3 has no voxels; expected some to trace");
}
