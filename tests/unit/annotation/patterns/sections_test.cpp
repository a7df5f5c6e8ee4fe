#include <map>

#include <doctest/doctest.h>

#include "engine/annotation/patterns/sections.h"
#include "engine/base/error.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

HeadSections sections(const std::string& stated, const std::map<int, SectionGroup>& groups = {})
{
    return head_sections(stated, "--sections", [&](uint8_t group) {
        const auto found = groups.find(group);
        return found == groups.end() ? SectionGroup{} : found->second;
    });
}
std::string in_words(const HeadSections& found)
{
    return found.groups_of(HeadPart::abaxial) + " " + found.groups_of(HeadPart::adaxial) + " " +
           found.groups_of(HeadPart::floret);
}

}  // namespace

TEST_CASE("sections are the thesis's groups, unless names or the option say otherwise")
{
    CHECK(in_words(sections("")) == "1 2 3");
    CHECK(!sections("").is_stated);
    CHECK(in_words(sections("adaxial=7,abaxial=2+9")) == "2+9 7 none");
    CHECK(sections("adaxial=7").is_stated);
    const std::map<int, SectionGroup> named = {{1, {"Adaxial veins"}}, {2, {"abaxial"}}, {8, {"florets"}}};
    CHECK(in_words(sections("", named)) == "2 1 8");
    CHECK(sections("", named).is_stated);
    // Group 2 is named as another part, so no group is adaxial.
    CHECK(in_words(sections("", {{2, {"Stem"}}})) == "2 none 3");
    // A name that states two parts states none.
    CHECK(in_words(sections("", {{5, {"floret and adaxial"}}})) == "1 2 3");
}

TEST_CASE("descendants of a section's group belong to it unless they are of another")
{
    const std::map<int, SectionGroup> tree = {
        {5, {"", 2}}, {6, {"", 5}}, {7, {"floret 7", 2}}, {8, {"", 9}}, {9, {"", 8}}};
    CHECK(in_words(sections("", tree)) == "1 2+5+6 7");
    CHECK(in_words(sections("abaxial=5", tree)) == "5+6 none none");
}

TEST_CASE("malformed sections are refused with what was found and expected")
{
    CHECK(error_of([] { sections("adaxial"); }) ==
          "--sections is 'adaxial': found 'adaxial'; expected abaxial, adaxial or floret, and its groups, such as "
          "abaxial=1+4,adaxial=2,floret=3");
    for (const char* text : {"xylem=1", "adaxial=", "adaxial=0", "adaxial=256", "adaxial=2+", "adaxial=2,floret=2",
                             "adaxial=1.5", "=1", ",", "adaxial=1,,floret=2", "adaxial=99999999999"})
        CHECK_MESSAGE(contains(error_of([&] { sections(text); }), "expected "), text);
}
