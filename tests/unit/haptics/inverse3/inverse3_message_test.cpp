#include "haptics/inverse3/inverse3_message.h"

#include <bit>
#include <cmath>
#include <limits>
#include <random>
#include <string>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "tests/support/inverse3_service.h"

using namespace shvr;

namespace {

std::string trouble_of(const std::string& text)
{
    Inverse3State state;
    const char* trouble = read_inverse3_state(text, "", state);
    return trouble ? trouble : "";
}

/// A state whose place is the text.
std::string with_place(const std::string& place)
{
    return R"({"inverse3":[{"device_id":"A1","state":{"cursor_position":)" + place + "}}]}";
}

Inverse3Event event_of(const std::string& name, const std::string& safety)
{
    Inverse3Notice notice;
    const nlohmann::json text{{"name", name},
                              {"category", "device"},
                              {"level", "warning"},
                              {"data", {{"device_id", "049D"}, {"safety_type", safety}, {"extra", {1, {2, nullptr}}}}},
                              {"message", "said \"so\""}};
    CHECK(read_inverse3_notice(text.dump(), notice) == nullptr);
    CHECK(notice.device_id == "049D");
    return notice.event;
}

}  // namespace

TEST_CASE("a state is read: place, grip, buttons; of the device asked for")
{
    Inverse3State state;
    CHECK(read_inverse3_state(inverse3_state_text({0.01, -0.12, 0.15}), "", state) == nullptr);
    CHECK(state.device_id == "049D");
    CHECK(state.position_m == glm::dvec3(0.01, -0.12, 0.15));
    CHECK(from_inverse3(state.position_m) == glm::dvec3(0.01, 0.15, 0.12));
    CHECK(to_inverse3(from_inverse3(state.position_m)) == state.position_m);
    CHECK(state.has_rotation);
    CHECK(state.buttons == 1);
    CHECK(read_inverse3_state(inverse3_state_text({0, 0, 0}), "other", state) == nullptr);
    CHECK(state.device_id.empty());
    const std::string two =
        R"({ "session_id" : 7, "inverse3" : [ {"state":{"cursor_position":{"z":3,"y":2,"x":1e0}},)"
        R"("device_id":"A"}, {"device_id":"B","state":{"cursor_position":{"x":4,"y":5,"z":-6}}} ] })";
    CHECK(read_inverse3_state(two, "", state) == nullptr);
    CHECK(state.position_m == glm::dvec3(1, 2, 3));
    CHECK(read_inverse3_state(two, "B", state) == nullptr);
    CHECK(state.position_m == glm::dvec3(4, 5, -6));
    CHECK(trouble_of("{}").empty());
}

TEST_CASE("what is wrong with a state is said")
{
    CHECK(trouble_of(with_place(R"({"x":1,"y":2,"z":3})")).empty());
    CHECK(trouble_of(with_place(R"({"x":1,"y":2,"z":1e999})")) == "a number that is not finite");
    CHECK(trouble_of(with_place(R"({"x":1,"y":2,"z":-inf})")) == "a number that is not finite");
    CHECK(trouble_of(with_place(R"({"x":1,"y":2,"z":NaN})")) == "no number where one is expected");
    CHECK(trouble_of(with_place(R"({"x":1,"y":2,"z":null})")) == "no number where one is expected");
    CHECK(trouble_of(with_place(R"({"x":1,"y":2,"z":11})")) == "a place that no device reaches");
    CHECK(trouble_of(with_place(R"({"x":1,"y":2})")) == "a vector that lacks a component");
    CHECK(trouble_of(with_place(R"([1,2,3])")) == "a value of another type than expected");
    CHECK(trouble_of(with_place(R"({"x":1,"y":2,"z":3,})")) == "a value of another type than expected");
    CHECK(trouble_of(with_place(R"({"x":1,"y":2,"z":3})") + "x") == "more after its end");
    CHECK(trouble_of(R"({"inverse3":[{"device_id":"A"}]})") == "a state without cursor_position");
    CHECK(trouble_of(R"({"inverse3":[{"state":{}}]})") == "a device without device_id");
    CHECK(trouble_of(R"({"inverse3":[{"device_id":"A\"}"}]})") ==
          "a device_id with other signs than letters, digits, - and _");
    CHECK(trouble_of(std::string(30, '[')) == "a value of another type than expected");
    CHECK(trouble_of(R"({"a":)" + std::string(100'000, '[')) == "values that nest too deep");
    CHECK(trouble_of("{\"a\":\"\n\"}") == "a text with control characters");
}

TEST_CASE("a state that is cut anywhere is refused")
{
    const std::string whole = inverse3_state_text({0.01, -0.12, 0.15});
    CHECK(trouble_of(whole).empty());
    for (size_t size = 0; size < whole.size(); ++size) CHECK_FALSE(trouble_of(whole.substr(0, size)).empty());
}

TEST_CASE("numbers go out and come back bit for bit")
{
    std::mt19937_64 random(3);
    for (int i = 0; i < 10'000; ++i) {
        glm::dvec3 value;
        for (int axis = 0; axis < 3; ++axis) {
            value[axis] = std::bit_cast<double>(random());
            if (!(std::abs(value[axis]) <= 10.0)) value[axis] = double(random() % 100'000) * 1e-5;
        }
        std::string text;
        append_inverse3_command(text, "049D", value, i == 0);
        const auto vector = nlohmann::json::parse(text)["inverse3"][0]["commands"]["set_cursor_force"]["vector"];
        CHECK(vector["x"].get<double>() == value.x);
        CHECK(vector["y"].get<double>() == value.y);
        CHECK(vector["z"].get<double>() == value.z);
        Inverse3State state;
        CHECK(read_inverse3_state(inverse3_state_text(value), "", state) == nullptr);
        CHECK(state.position_m == value);
    }
}

TEST_CASE("the first command names the program")
{
    std::string text;
    append_inverse3_command(text, "049D", {0.0, 0.0, 1.5}, true);
    CHECK(text == R"({"session":{"configure":{"profile":{"name":"shvr"}}},"inverse3":[{"device_id":"049D",)"
                  R"("commands":{"set_cursor_force":{"vector":{"x":0,"y":0,"z":1.5}}}}]})");
}

TEST_CASE("events are told apart")
{
    using enum Inverse3Event;
    CHECK(event_of("device-safety-triggered", "ebrake_triggered") == ebrake_on);
    CHECK(event_of("device-safety-triggered", "ebrake_released") == ebrake_off);
    CHECK(event_of("device-safety-triggered", "stall_detected") == stall);
    CHECK(event_of("device-safety-triggered", "stability_ceiling") == ceiling);
    CHECK(event_of("device-safety-triggered", "fod_stage_changed") == other);
    CHECK(event_of("device-disconnected", "") == disconnected);
    CHECK(event_of("device-connected", "") == connected);
    CHECK(event_of("device-battery-low", "ebrake_triggered") == other);
    Inverse3Notice notice;
    CHECK(read_inverse3_notice("{\"name\":", notice) != nullptr);
    CHECK(read_inverse3_notice("[]", notice) != nullptr);
}
