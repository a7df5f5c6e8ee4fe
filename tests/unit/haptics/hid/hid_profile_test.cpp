#include "haptics/hid/hid_profile.h"

#include <string>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "engine/base/error.h"
#include "engine/base/file.h"

using namespace shvr;

namespace {

const std::string FOLDER = "assets/devices";

nlohmann::json reference()
{
    return nlohmann::json::parse(read_text(FOLDER + "/shvr_reference.json", 1 << 20));
}

/// The error of a profile; empty if it is accepted.
std::string error_of_text(const std::string& text)
{
    try {
        parse_hid_profile(text, "x.json");
    } catch (const Error& error) {
        return error.what();
    }
    return "";
}
std::string error_of(const nlohmann::json& document)
{
    return error_of_text(document.dump());
}
/// The error of the reference with `value` at the JSON pointer.
std::string error_with(const char* pointer, const nlohmann::json& value)
{
    nlohmann::json document = reference();
    document[nlohmann::json::json_pointer(pointer)] = value;
    return error_of(document);
}
std::string error_without(const char* parent, const char* key)
{
    nlohmann::json document = reference();
    document[nlohmann::json::json_pointer(parent)].erase(key);
    return error_of(document);
}

}  // namespace

TEST_CASE("the profiles that are shipped load; the Touch's is only for recognising it")
{
    const std::vector<HidProfile> profiles = load_hid_profiles(FOLDER);
    REQUIRE(profiles.size() == 3);
    const HidProfile &reference = profiles[0], &mouse = profiles[1], &touch = profiles[2];
    CHECK(reference.verified);
    REQUIRE(reference.inputs.size() == 1);
    CHECK(reference.inputs[0].length == 32);
    CHECK(reference.matches[0].vendor == 0x1209);
    CHECK(reference.matches[0].product == 0x0001);
    CHECK(reference.matches[0].usage_page == 0xff00);
    CHECK(reference.limits.peak_force_n == 3.3);
    CHECK(reference.limits.senses_rotation);
    CHECK_FALSE(reference.limits.outputs_force);
    CHECK(reference.watchdog_ms == 20);
    CHECK_FALSE(touch.verified);
    CHECK(touch.inputs.empty());
    CHECK(mouse.name == "3Dconnexion SpaceMouse");
    CHECK(mouse.limits.rate_control);
    CHECK(mouse.limits.senses_rotation);
    CHECK_FALSE(mouse.output);
    CHECK(touch.matches[0].vendor == 0x2988);
    CHECK(touch.note.find("verified profile") != std::string::npos);
}

TEST_CASE("what is wrong in a profile is said in one sentence")
{
    CHECK(error_of(reference()).empty());
    CHECK(error_of_text("{") ==
          "x.json: is not JSON: parse error at line 1, column 2: syntax error while parsing object key - unexpected "
          "end of input; expected a device profile");
    CHECK(error_of_text("[1]") ==
          "x.json: the document is [1]; expected an object with keys out of: schema, name, match, input, output, "
          "feature, "
          "axes, limits, watchdog_ms, provenance, verified, note");
    CHECK(error_with("/colour", 1).starts_with("x.json: unknown key colour; expected one of: schema, name, match, "));
    CHECK(error_with("/limits/colour", 1).starts_with("x.json: unknown key limits.colour; expected one of: usable"));
    CHECK(error_with("/input/fields/2/colour", 1).starts_with("x.json: unknown key input.fields.2.colour;"));
    CHECK(error_without("", "provenance") == "x.json: key provenance is missing; expected a text that is not empty");
    CHECK(error_without("/limits", "peak_force_n") ==
          "x.json: key limits.peak_force_n is missing; expected a number from 0 to 40");
    CHECK(error_with("/verified", 1) == "x.json: key verified is 1; expected true or false");
    CHECK(error_with("/name", "") == "x.json: key name is \"\"; expected a text that is not empty");
    CHECK(error_with("/match", nlohmann::json::array()) ==
          "x.json: key match is []; expected an array of 1 or more, not of 0");
    CHECK(error_with("/match/0/vendor", 4617) ==
          "x.json: key match.0.vendor is 4617; expected four hexadecimal digits, as in \"0x1209\"");
    CHECK(error_with("/match/0/vendor", "0x12g9").find("expected four hexadecimal digits") != std::string::npos);
    CHECK(error_with("/input/id", 256) == "x.json: key input.id is 256; expected a whole number from 0 to 255");
    CHECK(error_with("/input/id", 1.5) == "x.json: key input.id is 1.5; expected a whole number from 0 to 255");
    CHECK(error_with("/input/length", 0) == "x.json: key input.length is 0; expected a whole number from 1 to 64");
    CHECK(error_with("/input/length", uint64_t{1} << 63).ends_with("expected a whole number from 1 to 64"));
    CHECK(error_with("/watchdog_ms", -1) == "x.json: key watchdog_ms is -1; expected a whole number from 0 to 255");
    CHECK(error_with("/limits/peak_force_n", 400) ==
          "x.json: key limits.peak_force_n is 400; expected a number from 0 to 40");
    CHECK(error_with("/limits/usable_lower_m", {1, 2}).ends_with("is [1,2]; expected three numbers, [x, y, z]"));
    CHECK(error_with("/limits/usable_upper_m", {0.1, 0.1, -0.1})
              .ends_with("expected values greater than usable_lower_m along every axis"));
    CHECK(error_without("", "limits")
              .starts_with("x.json: key limits is missing; expected an object with keys out of: "));
}

TEST_CASE("fields must fit into their report, apart from one another")
{
    CHECK(error_with("/input/fields/12/bit", 241).ends_with("expected at most bit 255, the last of 32 bytes"));
    CHECK(error_with("/input/fields/12/bit", 256) ==
          "x.json: key input.fields.12.bit is 256; expected a whole number from 0 to 255");
    CHECK(error_with("/input/fields/12/bits", 33) ==
          "x.json: key input.fields.12.bits is 33; expected a whole number from 1 to 32");
    CHECK(error_with("/input/length", 31).ends_with("expected at most bit 247, the last of 31 bytes"));
    CHECK(error_with("/input/fields/1/bit", 7).ends_with("expected bits that no other field uses; bit 7 is taken"));
    CHECK(error_with("/input/fields/1/name", "buttons")
              .ends_with("is \"buttons\"; expected a name that no other field has"));
    CHECK(error_with("/input/fields/1/name", "force_x").find("is \"force_x\"; expected one of \"buttons\", ") !=
          std::string::npos);
    CHECK(error_with("/input/fields/4/scale", 0).ends_with("is 0; expected a number other than 0"));
    CHECK(error_with("/input/fields/4/scale", nullptr).find("is null; expected a number from ") != std::string::npos);
}

TEST_CASE("a layout must hold what the servo needs")
{
    nlohmann::json document = reference();
    document["input"]["fields"].erase(4);
    CHECK(error_of(document).ends_with("expected a field named position_x"));
    document = reference();
    document["input"]["fields"].erase(7);
    CHECK(error_of(document).ends_with("expected a field named rotation_w"));
    document = reference();
    document["output"]["fields"].erase(0);
    CHECK(error_of(document).ends_with("expected a field named enable"));
    CHECK(error_without("", "input") ==
          "x.json: key verified is true; expected false, because the profile has no key input");
}

TEST_CASE("axes are turned and flipped, never bent")
{
    CHECK(error_with("/axes", {{1, 0, 0}, {0, 0, -1}, {0, 1, 0}}).empty());
    const std::string expected = "expected one 1 or -1 in each row and column";
    CHECK(error_with("/axes", {{1, 0, 0}, {1, 0, 0}, {0, 0, 1}}).ends_with(expected));
    CHECK(error_with("/axes", {{0.5, 0, 0}, {0, 1, 0}, {0, 0, 1}}).ends_with(expected));
    CHECK(error_with("/axes", {{1, 1, 0}, {0, 1, 0}, {0, 0, 1}}).ends_with(expected));
    CHECK(error_with("/axes", {{1, 0, 0}, {0, 1, 0}}).ends_with("expected an array of 3, not of 2"));
    nlohmann::json document = reference();
    document["axes"] = {{1, 0, 0}, {0, 0, -1}, {0, 1, 0}};
    const HidProfile profile = parse_hid_profile(document.dump(), "x.json");
    CHECK(profile.axes * glm::dvec3(1, 2, 3) == glm::dvec3(1, -3, 2));
}

TEST_CASE("a file that is absent, too long or nested without end is refused with a sentence")
{
    CHECK_THROWS_AS(load_hid_profile("/nowhere/x.json"), Error);
    CHECK_THROWS_AS(load_hid_profiles("/nowhere"), Error);
    CHECK(error_of_text(std::string(20'000, ' ')) == "x.json: holds 20000 bytes; expected at most 16384");
    CHECK(error_of_text(std::string(8000, '[') + std::string(8000, ']')) ==
          "x.json: JSON nests deeper than 8 levels; expected a device profile");
    CHECK(error_of_text(R"({"name": 1e999})") ==
          "x.json: is not JSON: number overflow parsing '1e999'; expected a device profile");
}

TEST_CASE("schema 2: several reports and speeds, refused with a sentence where they do not fit together")
{
    const nlohmann::json mouse = nlohmann::json::parse(read_text(FOLDER + "/spacemouse.json", 1 << 20));
    const auto error_at = [&](const char* pointer, const nlohmann::json& value) {
        nlohmann::json document = mouse;
        document[nlohmann::json::json_pointer(pointer)] = value;
        return error_of(document);
    };
    CHECK(error_of(mouse).empty());
    CHECK(error_at("/schema", 3) == "x.json: key schema is 3; expected a whole number from 1 to 2");
    CHECK(error_at("/schema", 1)
              .starts_with("x.json: unknown key ignored_ids; expected one of: schema, name, match, input,"));
    CHECK(error_at("/inputs/1/length", 6).ends_with("is 48; expected a whole number from 0 to 47"));
    CHECK(error_at("/inputs/2/id", 1).ends_with("is 1; expected an id and a length that no other input report has"));
    CHECK(error_at("/inputs/2/id", 0).ends_with("is 0; expected ids above 0, or 0 in all input reports"));
    CHECK(error_at("/inputs/2/fields/0/name", "battery").ends_with("expected a field named turn_x"));
    CHECK(error_at("/ignored_ids/0", 3) == "x.json: key ignored_ids.0 is 3; expected an id that no input report has");
    CHECK(error_at("/rate/gamma", 0) == "x.json: key rate.gamma is 0; expected a number from 0.5 to 5");
    CHECK(error_at("/rate/rest_ms", 1).ends_with("expected a whole number from 20 to 10000"));
    nlohmann::json document = mouse;
    document.erase("rate");
    CHECK(error_of(document) == "x.json: key rate is missing; expected how fields named rate_ and turn_ become speeds");
    document = mouse;
    document["inputs"] = {mouse["inputs"][2]};
    CHECK(error_of(document).ends_with("expected a field named rate_x"));
    document["inputs"] = {reference()["input"]};
    CHECK(error_of(document).ends_with("expected a field named rate_x"));
    document.erase("rate");
    document.erase("ignored_ids");
    CHECK(error_of(document).empty());  // schema 2 with places
    document["inputs"].push_back(mouse["inputs"][2]);
    document["rate"] = mouse["rate"];
    CHECK(error_of(document).ends_with("expected either places or rates"));
    document = mouse;
    document["output"] = reference()["output"];
    CHECK(error_of(document).ends_with("expected no such key: rate control feels no force"));
}
