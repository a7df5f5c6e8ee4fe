#include "engine/session/session_patch.h"

#include <doctest/doctest.h>

using namespace shvr;

namespace {

/// Describes the changes that the patch makes.
std::string words_of(const char* patch, const char* before = "{}")
{
    const Session was = patched(Session(), before);
    return difference_in_words(was, patched(was, patch));
}

}  // namespace

TEST_CASE("what differs between two sessions is said in words, by the names of few keys or by their section")
{
    CHECK(words_of("{}") == "");
    CHECK(words_of(R"({"light":{"ambient":0.5}})") == "light: ambient 0.3 to 0.5");
    CHECK(words_of(R"({"light":{"ambient":0.5,"diffuse":0.6}})") == "light: ambient 0.3 to 0.5, diffuse 0.7 to 0.6");
    CHECK(words_of(R"({"light":{"ambient":0.5,"diffuse":0.6,"specular":0,"shininess":3}})") == "light");
    CHECK(words_of(R"({"light":{"direction":[0,1,0]}})") == "light: direction (0, 0, 0) to (0, 1, 0)");
    CHECK(words_of(R"({"groups":{"3":{"name":"stem"}}})") == "groups: 3");
    CHECK(words_of(R"({"groups":{"3":{"name":"leaf"}}})", R"({"groups":{"3":{"name":"stem"}}})") ==
          "groups: 3 name stem to leaf");
    CHECK(words_of(R"({"groups":{"3":{"color":null}}})", R"({"groups":{"3":{"name":"stem","color":"#ff0000"}}})") ==
          "groups: 3 color #ff0000 given up");
}

TEST_CASE("a patch of an earlier version may set an option that was removed, which changes nothing")
{
    const char* const patch = R"({"render":{"adaptive_tolerance":0.05,"saturation":0.5}})";
    CHECK(words_of(patch) == "render: saturation 1 to 0.5");
    CHECK(words_of(R"({"render":{"adaptive_tolerance":null}})") == "");
}

TEST_CASE("a changed curve of ambient occlusion is told as one, not as the numbers of its points")
{
    const char* const two = R"({"light":{"occlusion":{"mapping":[{"arrives":0,"seen":0},{"arrives":1,"seen":1}]}}})";
    const char* const other =
        R"({"light":{"occlusion":{"mapping":[{"arrives":0,"seen":0},{"arrives":1,"seen":0.5}]}}})";
    const char* const three =
        R"({"light":{"occlusion":{"mapping":[{"arrives":0,"seen":0},{"arrives":0.5,"seen":1},{"arrives":1,"seen":1}]}}})";
    CHECK(words_of(two) == "light: occlusion curve 2 points");
    CHECK(words_of(other, two) == "light: occlusion curve");
    CHECK(words_of(three, two) == "light: occlusion curve 2 points to 3 points");
    CHECK(words_of(R"({"light":{"occlusion":{"mapping":null}}})", two) == "light: occlusion curve 2 points given up");
}
