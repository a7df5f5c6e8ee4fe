// Looks that are kept with views, for movies: in the file, and given back to a session.

#include "engine/session/looks/key_look.h"

#include <doctest/doctest.h>

#include "engine/base/error.h"

using namespace shvr;

namespace {

Session parse(const std::string& keys)
{
    return parse_session(R"({"shvr_session": 1, "volume": {"path": "a.nhdr"}, )" + keys + "}", "/data", "s.json");
}

constexpr const char* LOOKS = R"("cameras": {"view 1": {"side": "left"}},
    "groups": {"3": {"name": "vein", "color": "#ff0000", "locked": true}},
    "key_looks": {"view 1": {"transfer_function": {"points": [{"intensity": 5, "color": "#ffffff", "opacity": 0.5}]},
                             "groups": {"3": {"name": "old", "color": "#0000ff"}, "4": {"visible": false}},
                             "light": {"ambient": 0.75}, "cut": {"upper": [9, 8, 7]}}})";

std::string refusal(const std::string& look)
{
    try {
        static_cast<void>(parse(R"("key_looks": {"mine": )" + look + "}"));
    } catch (const Error& error) {
        return error.what();
    }
    return "";
}

}  // namespace

TEST_CASE("a look kept with a view is written and read again")
{
    const Session session = parse(LOOKS);
    REQUIRE(session.key_looks.contains("view 1"));
    const KeyLook& look = session.key_looks.at("view 1");
    CHECK(look.transfer_function.points().size() == 1);
    CHECK(look.light.ambient == 0.75);
    CHECK(look.light.diffuse == Light().diffuse);
    CHECK(look.cut.upper == glm::dvec3(9.0, 8.0, 7.0));
    CHECK(look.blend == DistanceBlend());
    const std::string written = to_text(session, "/data");
    CHECK(parse_session(written, "/data", "written").key_looks == session.key_looks);
    CHECK(to_text(parse(R"("camera": "top")"), "/data").find("key_looks") == std::string::npos);
}

TEST_CASE("a malformed look is refused by its key")
{
    CHECK(refusal(R"({"cut": {}})").find("transfer_function is missing") != std::string::npos);
    CHECK(refusal(R"({"transfer_function": {"points": []}, "render": {}})").find("render") != std::string::npos);
    CHECK(refusal(R"({"transfer_function": {"points": []}, "light": {"ambient": -1}})").find("light.ambient is -1") !=
          std::string::npos);
    CHECK(refusal("3").find("key_looks.mine is 3") != std::string::npos);
    CHECK(refusal(R"({"transfer_function": {"points": []}})").empty());
}

TEST_CASE("a session takes a kept look, but for names and locks of groups, which are no look")
{
    const Session session = parse(LOOKS);
    const Session taken = with_key_look(session, "view 1");
    CHECK(taken.cut == session.key_looks.at("view 1").cut);
    CHECK(taken.light.ambient == 0.75);
    CHECK(taken.groups.at(3).name == "vein");
    CHECK(taken.groups.at(3).locked);
    CHECK(group_of(taken.groups, 3).color == glm::dvec3(0.0, 0.0, 1.0));
    CHECK_FALSE(group_of(taken.groups, 4).visible);
    CHECK(key_look_of(taken) == key_look_of(session, "view 1"));
    CHECK(taken.render == session.render);
    CHECK(with_key_look(session, "top") == session);
    CHECK(key_look_of(session, "top") == key_look_of(session));
}
