#include "engine/base/json.h"

#include <array>

#include <doctest/doctest.h>

using namespace shvr;

namespace {

JsonDocument document(const std::string& text, const JsonLimits& limits = {})
{
    return {text, "a.json", limits};
}

/// The sentence with which `read` refuses a text.
template <class Read>
std::string refusal(const std::string& text, const Read& read)
{
    try {
        const JsonDocument parsed = document(text);
        read(parsed.root());
    } catch (const Error& error) {
        return error.what();
    }
    return "(accepted)";
}

std::string refusal(const std::string& text)
{
    return refusal(text, [](const JsonNode&) {});
}

}  // namespace

TEST_CASE("what is missing or does not fit is named by its key in full, with what was found and expected")
{
    const std::string text = R"({"a": [{"b": {"c": 3}}, {}], "d": "x"})";
    const auto c_of = [](const JsonNode& root) { return root["a"].elements()[0]["b"]["c"]; };
    CHECK(c_of(document(text).root()).number({0, 3}) == 3.0);
    CHECK(refusal(text, [&](const JsonNode& root) {
              c_of(root).number({4, 5});
          }) == "a.json: key a.0.b.c is 3; expected a number from 4 to 5");
    CHECK(refusal(text, [&](const JsonNode& root) { c_of(root).text(); }) ==
          "a.json: key a.0.b.c is 3; expected a text that is not empty");
    CHECK(refusal(text, [](const JsonNode& root) { root["a"].elements()[1]["b"]["c"].whole(1, 2); }) ==
          "a.json: key a.1.b.c is missing; expected a whole number from 1 to 2");
    CHECK(refusal(text, [](const JsonNode& root) { root["d"]["e"].flag(); }) ==
          "a.json: key d.e is missing; expected true or false");
    CHECK(refusal(text, [](const JsonNode& root) { root["a"].elements()[0].allow({"f"}); }) ==
          "a.json: unknown key a.0.b; expected only f");
    CHECK(refusal(text, [](const JsonNode& root) {
              root.allow({"a", "e"});
          }) == "a.json: unknown key d; expected one of: a, e");
    CHECK(refusal(text, [](const JsonNode& root) {
              root["d"].choice(std::array<std::string_view, 2>{"y", "z"});
          }) == R"(a.json: key d is "x"; expected one of "y", "z")");
    CHECK(refusal("[1, 2]", [](const JsonNode& root) { root.vector(any_number()); }) ==
          "a.json: the document is [1,2]; expected three numbers, [x, y, z]");
    CHECK(refusal("[1, 2]", [](const JsonNode& root) { root.elements(3, 4); }) ==
          "a.json: the document is [1,2]; expected an array of 3 to 4, not of 2");
    CHECK(refusal(text, [&](const JsonNode& root) { c_of(root).checked([] { fail("the sum is odd"); }); }) ==
          "a.json: key a.0.b.c: the sum is odd");
}

TEST_CASE("values are shown on one line, cut to 60 characters, never within one")
{
    const auto shown = [](const std::string& text) {
        std::string message = refusal(text, [](const JsonNode& root) { root.flag(); });
        const std::string start = "a.json: the document is ";
        REQUIRE(message.starts_with(start));
        return message.substr(start.size(), message.find("; expected") - start.size());
    };
    CHECK(shown("\"" + std::string(58, 'x') + "\"") == "\"" + std::string(58, 'x') + "\"");
    CHECK(shown("\"" + std::string(59, 'x') + "\"") == "\"" + std::string(56, 'x') + "...");
    CHECK(shown(R"("a\nb\u007fc")") == R"("a\nb?c")");
    std::string umlauts = "\"";
    for (int i = 0; i < 40; ++i) umlauts += "\xc3\xbc";
    CHECK(shown(umlauts + "\"") == "\"" + umlauts.substr(1, 56) + "...");
}

TEST_CASE("texts are refused that are not JSON, repeat a key or nest too deep")
{
    CHECK(refusal("{").starts_with("a.json: is not JSON: parse error at line 1, column 2"));
    CHECK(refusal("{").ends_with("; expected an object"));
    CHECK(refusal("{} {}").starts_with("a.json: is not JSON: "));
    CHECK(refusal("\xff").starts_with("a.json: is not JSON: "));
    for (const char letter : refusal("\xff")) CHECK((letter >= ' ' && letter <= '~'));
    CHECK(refusal(std::string("{}\0x", 4)) == "a.json: is not JSON: byte 3 is zero; expected an object");
    CHECK(refusal("[1e999]") == "a.json: is not JSON: number overflow parsing '1e999'; expected an object");
    CHECK(refusal(R"({"a": {"b": 1, "c": 2, "b": 3}})") == "a.json: key b appears twice in one object; expected once");
    CHECK(refusal(R"([{"b": 1}, {"b": 1}])") == "(accepted)");
    CHECK(document(R"({"b": 1, "b": 2})", {.may_repeat_keys = true}).root()["b"].whole(0, 9) == 2);
    CHECK(refusal(std::string(16, '[') + std::string(16, ']')) == "(accepted)");
    CHECK(refusal(std::string(100000, '[')) == "a.json: JSON nests deeper than 16 levels; expected an object");
}

TEST_CASE("whole numbers are whole to the last digit, however they are spelled")
{
    const auto whole = [](const std::string& text) { return document(text).root().whole(INT64_MIN, INT64_MAX); };
    CHECK(whole("9223372036854775807") == INT64_MAX);
    CHECK(whole("-9223372036854775808") == INT64_MIN);
    CHECK(whole("3.0") == 3);
    CHECK(whole("1e3") == 1000);
    for (const char* bad :
         {"9223372036854775808", "18446744073709551615", "1e17", "3.5", "\"3\"", "true", "null", "[3]"})
        CHECK_THROWS_AS(whole(bad), Error);
    CHECK(refusal("4", [](const JsonNode& root) { root.whole(2, 2); }) == "a.json: the document is 4; expected 2");
}

TEST_CASE("a document may be moved: nodes are made from where it is")
{
    JsonDocument first = document(R"({"a": "b"})");
    const JsonDocument second = std::move(first);
    CHECK(second.root()["a"].text() == "b");
    CHECK(second.root()["a"].is("b"));
    CHECK_FALSE(second.root()["a"].is("c"));
    CHECK_FALSE(second.root()["c"].exists());
}
