#include "engine/session/session_patch.h"

#include <doctest/doctest.h>

#include "engine/session/words/setting_words.h"

using namespace shvr;

namespace {

/// Describes the changes that the patch makes.
std::string words_of(const char* patch, const char* before = "{}")
{
    const Session was = patched(Session(), before);
    return difference_in_words(was, patched(was, patch));
}

}  // namespace

TEST_CASE("a patch of an earlier version may set an option that was removed, which changes nothing")
{
    const char* const patch = R"({"render":{"adaptive_tolerance":0.05,"saturation":0.5}})";
    CHECK(words_of(patch) == "set saturation of the picture from 1 to 0.5");
    CHECK(words_of(R"({"render":{"adaptive_tolerance":null}})") == "");
}
