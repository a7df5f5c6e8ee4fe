#include "haptics/replay/trace.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <string>

#include <doctest/doctest.h>

#include "haptics/replay/replay.h"
#include "tests/support/haptic_scenes.h"

using namespace shvr;

namespace {

const std::string HEAD = "{\"shvr_stylus_trace\":1,\"unit\":\"mm\"}\n";

std::string refusal(const std::string& text)
{
    try {
        parse_trace(text, "t.trace");
    } catch (const Error& error) {
        return error.what();
    }
    return "accepted";
}

/// A hand that wanders over a tube, with answers of every kind.
Trace wandering(int ticks)
{
    std::mt19937 random(61);
    Trace trace;
    trace.unit = "mm";
    trace.caps.outputs_force = true;
    TraceSettings settings;
    settings.force = {.assistance = true, .probe_radius = 2.5};
    settings.force.workspace = {glm::dmat3(1000.0), glm::dvec3(8.0)};
    settings.threshold = 0.1;
    trace.settings.push_back(settings);
    settings.force.mode = TouchMode::object;
    settings.force.clicks = true;
    settings.from_tick = size_t(ticks / 2);
    trace.settings.push_back(settings);
    for (int i = 0; i < ticks; ++i) {
        TraceTick tick;
        tick.now_ns = 1'000'000 * uint64_t(i + 1) + random() % 1000;
        if (random() % 50 == 0) tick.read = ReadResult::stale;
        tick.state.time_ns = tick.now_ns - 500;
        tick.state.sequence = uint32_t(i + 1);
        const double y = 0.001 * std::sin(0.01 * i);
        tick.state.position_m = {1e-14 * double(random()), i < 1500 ? y / 50.0 : y, 1e-4 / 3.0};
        trace.ticks.push_back(tick);
    }
    return trace;
}

void make_tube(const RegionWish&, double, RelevancePatch& patch)
{
    const Rod rod{.point = glm::dvec3(8.0), .radius = 1.0};
    fill_patch(patch, {0, 0, 0}, glm::ivec3(64), glm::dvec3(0.25), [&](const glm::dvec3& p) { return rod.holds(p); });
    patch.volume_size = glm::ivec3(64);
}

}  // namespace

TEST_CASE("a trace is read as it was written, bit for bit")
{
    Trace trace = wandering(300);
    trace.ticks[7].state.position_m.y = std::nan("");
    trace.ticks[8].state.position_m.z = -INFINITY;
    trace.ticks[9].force_n = glm::dvec3(0.1, 1.0 / 3.0, -1e-300);
    const std::string text = text_of(trace);
    const Trace again = parse_trace(text, "t");
    CHECK(text_of(again) == text);
    CHECK(again.ticks.size() == 300);
    CHECK(again.ticks[9].force_n == trace.ticks[9].force_n);
    CHECK(again.ticks[20].state.position_m == trace.ticks[20].state.position_m);
    CHECK(again.settings[1].from_tick == 150);
    CHECK(again.settings[1].force.mode == TouchMode::object);
    CHECK(again.settings[1].force.clicks);
    CHECK(!again.settings[0].force.clicks);
}

// Kind (Touch): a recording of a program that felt what was hidden
TEST_CASE("a trace states that it feels only what is seen, and one without that feels all")
{
    Trace trace = wandering(10);
    CHECK(!parse_trace(text_of(trace), "t").feels_seen);
    CHECK(text_of(trace).find("feels_seen") == std::string::npos);
    trace.feels_seen = true;
    CHECK(parse_trace(text_of(trace), "t").feels_seen);
    CHECK(!parse_trace(HEAD + "{\"at\":[0.001,0,0]}\n", "t").feels_seen);
}

TEST_CASE("what a tick leaves out follows from the one before")
{
    const Trace trace = parse_trace(HEAD + "{\"at\":[0.001,0,0]}\n{\"read\":\"stale\"}\n{\"buttons\":1}\n", "t");
    REQUIRE(trace.ticks.size() == 3);
    CHECK(trace.ticks[2].now_ns == 3'000'000);
    CHECK(trace.ticks[1].read == ReadResult::stale);
    CHECK(trace.ticks[2].state.sequence == 2);
    CHECK(trace.ticks[2].state.position_m.x == 0.001);
}

// Kind (Touch): a trace with a sheared workspace or a direction without length
TEST_CASE("what is no trace is refused in a sentence with its line")
{
    CHECK(refusal("") == "t.trace is empty; expected a line {\"shvr_stylus_trace\":1}");
    CHECK(refusal(HEAD).starts_with("t.trace has no tick; expected"));
    CHECK(refusal("{\"shvr_stylus_trace\":4}\n").find("t.trace:1: key shvr_stylus_trace is 4; expected 1, 2 or 3") ==
          0);
    for (const char* line :
         {"{\"at\":[0,0]}", "{\"at\":[0,0,\"far\"]}", "{\"speed\":1}", "{\"read\":\"gone\"}", "7",
          "{\"settings\":{\"mode\":\"magic\"}}", "{\"settings\":{\"probe_radius\":0}}",
          "{\"settings\":{\"to_volume\":[0,0,0,0,0,0,0,0,0]}}", "{\"settings\":{\"to_volume\":[2,0,0,1,2,0,0,0,2]}}",
          "{\"settings\":{\"to_volume\":[2,0,0,0,2,0,0,0,2.1]}}", "{\"settings\":{\"to_camera\":[0,0,0]}}",
          "{\"settings\":{\"to_camera\":[1,1,0]}}", "{\"now\":-1}", "{\"at\":"}) {
        const std::string said = refusal(HEAD + line);
        CAPTURE(said);
        CHECK(said.find("t.trace:2") == 0);
        CHECK(said.find('\n') == std::string::npos);
    }
    // A shear doubles forces, and a direction of length 0 never lets go of a surface.
    CHECK(refusal(HEAD + "{\"settings\":{\"to_volume\":[2,0,0,1,2,0,0,0,2]}}")
              .find("to_volume is [2,0,0,1,2,0,0,0,2]; "
                    "expected nine numbers of a rotation") != std::string::npos);
    CHECK(refusal(HEAD + "{\"settings\":{\"to_camera\":[0,0,0]}}").find("to_camera is [0,0,0]; expected a direction") !=
          std::string::npos);
    // A mirrored or turned one is fine.
    CHECK(refusal(HEAD + "{\"settings\":{\"to_volume\":[0,2,0,2,0,0,0,0,2],\"to_camera\":[0.6,0,0.8]}}")
              .find("no tick") != std::string::npos);
    CHECK(refusal(HEAD + "{\"now\":5000000}\n{\"now\":4000000}").find("t.trace:3") == 0);  // time goes on
}

namespace {

/// Cubes that move with a hand, of changing thresholds and levels, some of them noisy.
std::vector<std::unique_ptr<RelevancePatch>> wandering_patches(int count)
{
    std::mt19937 random(77);
    std::vector<std::unique_ptr<RelevancePatch>> patches;
    glm::ivec3 origin(100);
    for (int i = 0; i < count; ++i) {
        const int32_t side = i % 7 == 3 ? 128 : i % 5 == 2 ? 33 : 64;
        for (int axis = 0; axis < 3; ++axis) origin[axis] += int32_t(random() % 41) - 20;
        origin = glm::max(origin, glm::ivec3(0));
        auto patch = std::make_unique<RelevancePatch>();
        const double radius = 0.8 + 0.1 * (i % 4);
        const Rod rod{.point = glm::dvec3(30.0), .radius = radius};
        fill_patch(*patch, origin, glm::ivec3(side), glm::dvec3(0.25),
                   [&](const glm::dvec3& p) { return rod.holds(p) != (i % 3 == 0 && random() % 100 == 0); });
        patch->volume_size = glm::ivec3(400);
        patch->level = i % 11 == 10;
        patch->sequence = uint64_t(2 * i + 1);
        patch->settings = uint32_t(i / 3);
        patches.push_back(std::move(patch));
    }
    return patches;
}

bool same_patch(const RelevancePatch& a, const RelevancePatch& b)
{
    return a.sequence == b.sequence && a.origin == b.origin && a.size == b.size && a.spacing == b.spacing &&
           a.words_per_row == b.words_per_row && a.volume_size == b.volume_size && a.level == b.level &&
           a.settings == b.settings &&
           std::equal(a.words.begin(), a.words.begin() + int64_t(a.word_count()), b.words.begin());
}

}  // namespace

TEST_CASE("relevance is read from a trace as it was noted, bit for bit, through moves, levels, sizes and noise")
{
    const auto patches = wandering_patches(60);
    Trace trace = wandering(60);
    trace.holds_relevance = true;
    const RelevancePatch none;
    const RelevancePatch* before = &none;
    for (size_t i = 0; i < patches.size(); ++i) {
        trace.relevance.push_back(note_relevance(*patches[i], *before));
        trace.relevance.back().from_tick = i;
        trace.ticks[i].relevance_time_ns = 1000 * i;
        before = patches[i].get();
    }
    trace.later_caps.push_back({{.peak_force_n = 2.5, .outputs_force = true}, 30});
    const std::string text = text_of(trace);
    const Trace again = parse_trace(text, "t");
    CHECK(text_of(again) == text);
    CHECK(again.later_caps.at(0).caps == trace.later_caps[0].caps);
    CHECK(again.later_caps[0].from_tick == 30);
    CHECK(again.ticks[59].relevance_time_ns == 59'000);
    REQUIRE(again.relevance.size() == 60);
    auto last = std::make_unique<RelevancePatch>(), now = std::make_unique<RelevancePatch>();
    size_t words = 0;
    for (size_t i = 0; i < 60; ++i) {
        CAPTURE(i);
        now->words.fill(0xdeadbeef);
        REQUIRE(read_relevance(again.relevance[i], *last, *now));
        CHECK(same_patch(*now, *patches[i]));
        words += now->word_count();
        last.swap(now);
    }
    // Without noise a cube of 64 takes a small part of its 32 KiB.
    CHECK(trace.relevance[1].runs.size() < 4000);
}

TEST_CASE("relevance that does not fit is refused by its line: runs too short, too long, of other characters, or old")
{
    const std::string head = "{\"shvr_stylus_trace\":2,\"unit\":\"mm\"}\n";
    const auto line = [](const std::string& runs, int sequence = 1, const char* size = "[32,2,1]") {
        return sentence("{\"relevance\":{\"sequence\":", sequence, ",\"origin\":[0,0,0],\"size\":", size,
                        ",\"words_per_row\":1,\"spacing\":[1,1,1],\"volume_size\":[99,99,99],\"runs\":\"", runs,
                        "\"}}\n");
    };
    const std::string tick = "{\"at\":[0,0,0],\"relevance_time\":5}\n";
    // 64 bits: 60 and 4; a length of 60 is 28 + 32 * 1.
    CHECK(refusal(head + line("8BE") + tick) == "accepted");
    for (const char* runs : {"8B", "8BD", "8BF", "8BEA", "8B E", "8BE8", "88888888B", "!"}) {
        CAPTURE(runs);
        const std::string said = refusal(head + line(runs) + tick);
        CAPTURE(said);
        CHECK(said.find("t.trace:2") == 0);
        CHECK(said.find("expected runs that fill its words") != std::string::npos);
    }
    CHECK(refusal(head + line("8BE") + line("8BE", 1) + tick).find("t.trace:3") == 0);
    CHECK(refusal(head + line("8BE", 1, "[64,2,1]") + tick).find("t.trace:2") == 0);
    CHECK(refusal(head + line("8BE", 1, "[32,200,1]") + tick).find("t.trace:2") == 0);
    CHECK(refusal(head + tick).find("expected a relevance before it") != std::string::npos);
    CHECK(refusal(HEAD + line("8BE") + tick).find("version 2") != std::string::npos);
}

TEST_CASE("a trace that was cut off or changed is refused in words, wherever that was")
{
    const std::string text = text_of(wandering(40));
    REQUIRE(refusal(text) == "accepted");
    CHECK(refusal(text + "\n \n") == "accepted");
    const size_t end = text.rfind("{\"end\"");
    REQUIRE(end != std::string::npos);
    for (size_t size = 1; size + 2 < text.size(); size += 7) {  // what is left out last is the line break
        CAPTURE(size);
        const std::string said = refusal(text.substr(0, size));
        CAPTURE(said);
        CHECK(said.starts_with("t.trace"));
        if (size > text.find('\n') + 1) CHECK(said.find("cut off or changed, copy it anew") != std::string::npos);
    }
    // A digit changed anywhere after the head.
    for (size_t at = text.find('\n') + 1; at < end; ++at) {
        if (text[at] < '0' || text[at] > '8' || at % 3 != 0) continue;
        std::string changed = text;
        ++changed[at];
        CAPTURE(at);
        CHECK(refusal(changed).find("something in it was changed") != std::string::npos);
    }
    // A line taken out, put in twice, and one after the end.
    const size_t line = text.find("\n{\"now\"") + 1, next = text.find('\n', line) + 1;
    CHECK(refusal(text.substr(0, line) + text.substr(next)).find("lines were lost or added") != std::string::npos);
    CHECK(refusal(text.substr(0, next) + text.substr(line)).find("lines were lost or added") != std::string::npos);
    CHECK(refusal(text + text.substr(line, next - line)).find("has no end line") != std::string::npos);
}

TEST_CASE("where the device was swapped a replay begins anew: no force, no object, nothing felt of before")
{
    Trace trace = wandering(3000);
    const std::string never = text_of(trace);
    trace.swaps.push_back(1500);
    const Trace again = parse_trace(text_of(trace), "t");
    REQUIRE(again.swaps == std::vector<size_t>{1500});
    CHECK(text_of(again) == text_of(trace));
    const ReplayResult whole = replay_trace(parse_trace(never, "t"), {}, make_tube, true);
    const ReplayResult swapped = replay_trace(again, {}, make_tube, true);
    CHECK(swapped.swaps == 1);
    CHECK(whole.swaps == 0);
    REQUIRE(glm::length(whole.steps[1500].force_n) > 0.02);
    CHECK(glm::length(swapped.steps[1499].force_n) == glm::length(whole.steps[1499].force_n));
    CHECK(glm::length(swapped.steps[1500].force_n) < 0.01 * glm::length(whole.steps[1500].force_n));  // engages again
    // The later steps are those of a servo that starts there.
    Trace later = trace;
    later.swaps.clear();
    later.ticks.erase(later.ticks.begin(), later.ticks.begin() + 1500);
    later.settings.erase(later.settings.begin());
    later.settings.front().from_tick = 0;
    const ReplayResult alone = replay_trace(later, {}, make_tube, true);
    size_t same = 0;
    for (size_t i = 0; i < 1500; ++i) same += alone.steps[i].force_n == swapped.steps[1500 + i].force_n;
    CHECK(same == 1500);
    const std::string second = "{\"device\":\"swapped\"}\n";
    CHECK(refusal(HEAD + second + "{\"at\":[0,0,0]}\n").find("of version 3") != std::string::npos);
}

TEST_CASE("a replay gives the same forces again, bit for bit, and knows those that the trace holds")
{
    Trace trace = wandering(4000);
    const ReplayResult first = replay_trace(trace, {}, make_tube, true);
    CHECK(first.ticks == 4000);
    CHECK(first.late == 0);
    CHECK(first.largest_force_n > 0.1);
    CHECK(first.largest_step_n <= SLEW_N + 1e-12);
    for (size_t i = 0; i < trace.ticks.size(); ++i) trace.ticks[i].force_n = first.steps[i].force_n;
    const ReplayResult again = replay_trace(parse_trace(text_of(trace), "t"), {}, make_tube);
    CHECK(again.hash == first.hash);
    CHECK(again.told_equal == 4000);
    ReplayOptions softer;
    softer.stiffness = 299.0;
    const ReplayResult other = replay_trace(trace, softer, make_tube);
    CHECK(other.hash != first.hash);
    CHECK(other.told_equal < 4000);
}

TEST_CASE("a modelled Touch drawn along a trace is reproducible, and its seed decides")
{
    const Trace trace = wandering(2500);
    ReplayOptions options;
    options.touch = TouchModel{.coulomb_n = 0.0};  // with all of its friction it stays where it is
    const uint64_t first = replay_trace(trace, options, make_tube).hash;
    CHECK(replay_trace(trace, options, make_tube).hash == first);
    options.touch->seed = 2;
    CHECK(replay_trace(trace, options, make_tube).hash != first);
}

TEST_CASE("the modelled Touch sticks below its friction, moves above it, and answers in counts, late")
{
    ModelledTouch device(TouchModel{.jitter_s = 0.0, .hand_stiffness = 0.0});
    DeviceState state;
    for (uint32_t i = 1; i <= 50; ++i) {
        device.read(state);
        device.write({0.25, 0.0, 0.0}, i);
    }
    CHECK(state.position_m.x == 0.0);
    CHECK(state.force_sequence == 47);  // two ticks and the one in which it acts
    for (uint32_t i = 51; i <= 100; ++i) {
        device.read(state);
        device.write({0.5, 0.0, 0.0}, i);
    }
    // (0.5 - 0.26) N on 45 g for about 47 ms.
    CHECK(state.position_m.x == doctest::Approx(0.5 * 0.24 / 0.045 * 0.047 * 0.047).epsilon(0.15));
    CHECK(std::abs(state.position_m.x / 55e-6 - std::round(state.position_m.x / 55e-6)) < 1e-6);
}
