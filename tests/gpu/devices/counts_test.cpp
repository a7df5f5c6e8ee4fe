// Driver calls of a session: layers (tests/layers) count them, and simulate a device that is infinitely fast or whose
// clock changes its speed.

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <utility>

#include <unistd.h>

#include <doctest/doctest.h>

#include "engine/live/view.h"
#include "tests/support/gpu.h"
#include "tests/support/nap.h"
#include "tests/support/stored_volume.h"

using namespace shvr;
using namespace shvr::test;

namespace {

constexpr VolumeStatistics BYTES{.minimum = 0.0, .maximum = 255.0};
constexpr uint64_t MIB = uint64_t{1} << 20;

/// Variables of the environment, for as long as it lives.
class Environment {
public:
    explicit Environment(std::map<const char*, std::string> values) : values_(std::move(values))
    {
        for (const auto& [name, value] : values_) setenv(name, value.c_str(), 1);
    }
    Environment(const Environment&) = delete;
    ~Environment()
    {
        for (const auto& [name, value] : values_) unsetenv(name);
    }

private:
    std::map<const char*, std::string> values_;
};

struct Worked {
    Session session;
    std::shared_ptr<const VolumeSource> source = stored_volume("tubes", {96, 64, 64}, 3);
    Mask mask{source->info().size};
    Renderer renderer;
    View view{renderer, {}};

    Worked(const glm::uvec2& pixels, Paging paging, uint64_t device_bytes = 256 * MIB)
        : renderer({.device = {}, .budget = {device_bytes, 0}, .threads = 1})
    {
        session.transfer_function = TransferFunction(
            {{90.0, glm::dvec3(0.8, 0.3, 0.1), 0.0}, {140.0, glm::dvec3(0.9, 0.7, 0.3), 0.3}, {255.0, WHITE, 0.6}});
        session.light.shaded = true;
        session.render.size = pixels;
        session.render.paging = paging;
        renderer.load(source, BYTES, session.render);
    }
    void settle()
    {
        for (int i = 0; !view.complete(); ++i) {
            nap(i);
            REQUIRE(i < 10'000'000);
            view.advance();
        }
    }
    /// The same, however many parts that takes: waits for each.
    void settle_in_parts()
    {
        for (int i = 0; !view.complete(); ++i) {
            nap(i);
            REQUIRE(i < 1'000'000);
            view.advance();
            view.wait();
        }
    }
    void turn(const char* side)
    {
        view.look(session.look(), session.interaction, Shot(camera_looking(side, source->info())), session.render.size);
        for (int i = 0; i < 3; ++i) view.advance();
    }
    /// Every second time it takes away what it painted the time before.
    void paint(int64_t brick, bool paints)
    {
        mask.apply({.brick = brick, .runs = {{.first = 3000, .last = 29000, .before = 0, .after = 3}}},
                   paints ? Direction::forwards : Direction::backwards);
        renderer.scene().update_mask(mask, {&brick, 1});
    }
};

/// The work of one round, which tests repeat; `grows`: more work in each round.
void do_round(Worked& worked, int round, bool grows)
{
    worked.paint(0, round % 2 == 0);
    worked.turn("front");
    if (grows) {  // everything: the picture, and what is painted
        worked.paint(round + 1, true);
        worked.session.render.size += glm::uvec2(32, 16);
        worked.turn("left");
    }
    worked.settle();
    worked.turn("top");
    worked.settle();
}

/// Calls of the driver in all, from start to end, of what is done; it makes its own device.
std::map<std::string, int64_t> calls_in(const std::function<void()>& work)
{
    const std::filesystem::path log = std::filesystem::temp_directory_path() / sentence("shvr-counts-", getpid());
    std::filesystem::remove(log);
    {
        const Environment environment(
            {{"VK_INSTANCE_LAYERS", "VK_LAYER_SHVR_faults:VK_LAYER_SHVR_speed"}, {"SHVR_FAULTS_LOG", log.string()}});
        work();
    }
    std::map<std::string, int64_t> calls;
    std::ifstream lines(log);
    std::string call;
    static std::map<std::string, int64_t> before;  // the layer counts on from device to device
    for (int64_t count = 0; lines >> call >> count;) calls[call] = count - std::exchange(before[call], count);
    REQUIRE(calls["vkQueueSubmit2"] > 0);
    std::filesystem::remove(log);
    return calls;
}

/// Counts the driver calls of a session with that number of rounds.
std::map<std::string, int64_t> calls_of(int rounds, Paging paging, bool grows)
{
    const auto work = [&] {
        Worked worked({160, 96}, paging);
        worked.paint(11, true);  // which stays
        for (int round = 0; round < rounds; ++round) do_round(worked, round, grows);
    };
    std::map<std::string, int64_t> calls = calls_in(work);
    REQUIRE(calls["vkQueueSubmit2"] > rounds);
    return calls;
}

}  // namespace

TEST_CASE("a stroke where paint is already sends its bricks, and no table of all bricks")
{
    for (const Paging paging : {Paging::always, Paging::never}) {
        const auto submits = [&](int strokes) {
            return calls_in([&] {
                       Worked worked({160, 96}, paging);
                       worked.paint(0, true);
                       const int64_t brick = 0;
                       for (int i = 0; i < strokes; ++i) {
                           const auto before = uint8_t(3 + i % 2), after = uint8_t(4 - i % 2);
                           worked.mask.apply({.brick = brick, .runs = {{3000, 29000, before, after}}},
                                             Direction::forwards);
                           worked.renderer.scene().update_mask(worked.mask, {&brick, 1});
                       }
                   })
                .at("vkQueueSubmit2");
        };
        CHECK(submits(11) - submits(1) == 10);
    }
}

TEST_CASE("turning and painting never wait for the whole device, whatever grows")
{
    for (const Paging paging : {Paging::never, Paging::always}) {
        CAPTURE(int(paging));
        const int64_t few = calls_of(1, paging, true)["vkDeviceWaitIdle"];
        CHECK(few <= 3);  // when the device goes
        CHECK(calls_of(8, paging, true)["vkDeviceWaitIdle"] == few);
    }
}

/// With a constant clock and as many graphs in flight each time, the counts are those of the rounds alone.
TEST_CASE("once all is there, turning and painting allocate nothing")
{
    const Environment environment(
        {{"VK_INSTANCE_LAYERS", "VK_LAYER_SHVR_clocks:VK_LAYER_SHVR_limits:VK_LAYER_SHVR_speed"},
         {"SHVR_LIMITS", "nvidia"},
         {"SHVR_CLOCKS", "2000"}});
    for (const Paging paging : {Paging::never, Paging::always}) {
        CAPTURE(int(paging));
        constexpr int UNTIL_ALL_IS_THERE = 8, ROUNDS = 200;
        Worked worked({160, 96}, paging);
        worked.paint(11, true);  // which stays
        const auto do_rounds = [&](int count) {
            for (int round = 0; round < count; ++round) {
                worked.paint(0, round % 2 == 0);
                for (const char* side : {"front", "top"}) {
                    worked.turn(side);
                    worked.settle_in_parts();
                }
            }
        };
        do_rounds(UNTIL_ALL_IS_THERE);
        const uint64_t before = worked.renderer.memory().allocations_made();
        CHECK(before > 0);
        do_rounds(ROUNDS);
        CHECK(worked.renderer.memory().allocations_made() == before);
    }
}

TEST_CASE("no submission takes long on a slow device, whatever is drawn")
{
    const std::filesystem::path log = std::filesystem::temp_directory_path() / sentence("shvr-longest-", getpid());
    // 64 rays take 100 us, so a picture takes over 3 s. The cost of a pass is unknown until its first part is done,
    // which has 1680 such workgroups: only a device that takes 39 s per picture would need two seconds for that part.
    {
        const Environment environment(
            {{"VK_INSTANCE_LAYERS", "VK_LAYER_SHVR_clocks:VK_LAYER_SHVR_limits:VK_LAYER_SHVR_speed"},
             {"SHVR_LIMITS", "intel"},
             {"SHVR_CLOCKS", "100000"},
             {"SHVR_CLOCKS_LOG", log.string()}});
        for (const Paging paging : {Paging::never, Paging::always}) {
            Worked worked({1920, 1080}, paging);
            worked.turn("front");
            worked.settle_in_parts();
            worked.session.light.occlusion = {.strength = 0.8, .radius = 4.0, .rays = 2};
            worked.paint(11, true);
            worked.turn("left");
            worked.settle_in_parts();
            static_cast<void>(worked.renderer.render(worked.session, camera_looking("top", worked.source->info())));
        }
    }
    std::string word;
    double longest_ns = 0.0;
    std::ifstream(log) >> word >> longest_ns;
    CHECK(longest_ns > 20e6);
    CHECK(longest_ns < 250e6);
    std::filesystem::remove(log);
}

/// How many are needed depends on how many graphs are in flight at a time, so a few more may be made by chance.
TEST_CASE("turning and painting make nothing once all is there")
{
    for (const Paging paging : {Paging::never, Paging::always}) {
        CAPTURE(int(paging));
        constexpr int FEW = 6, MANY = 36;
        std::map<std::string, int64_t> few = calls_of(FEW, paging, false), many = calls_of(MANY, paging, false);
        for (const char* call :
             {"vkAllocateMemory", "vkMapMemory", "vkCreateFence", "vkCreateCommandPool", "vkAllocateCommandBuffers",
              "vkCreateQueryPool", "vkCreateDescriptorPool", "vkCreateComputePipelines"}) {
            CAPTURE(std::string(call));
            CHECK(many[call] - few[call] < MANY - FEW);
        }
    }
}

TEST_CASE("a picture that nobody times makes no query and reads none")
{
    const auto queries_of = [](bool timestamps, bool statistics) {
        std::map<std::string, int64_t> calls = calls_in([&] {
            Renderer renderer({.device = {}, .budget = {256 * MIB, 0}, .threads = 1});
            const std::shared_ptr<const VolumeSource> source = stored_volume("tubes", {64, 64, 64}, 3);
            Session session;
            session.render.size = {64, 48};
            renderer.load(source, BYTES, session.render);
            for (int i = 0; i < 2; ++i)  // the first one prepares
                renderer.render(session, camera_looking("front", source->info()),
                                {.timestamps = timestamps, .statistics = statistics});
        });
        return std::pair(calls["vkCreateQueryPool"], calls["vkGetQueryPoolResults"]);
    };
    CHECK(queries_of(false, false) == std::pair<int64_t, int64_t>(0, 0));
    CHECK(queries_of(true, false).first > 0);
    CHECK(queries_of(true, false).second > 0);
    CHECK(queries_of(false, true).second > 0);
}

TEST_CASE("the pictures of a 4K screen are few submissions where the device is fast, and its clock tells so")
{
    const Environment environment(
        {{"VK_INSTANCE_LAYERS", "VK_LAYER_SHVR_clocks:VK_LAYER_SHVR_limits:VK_LAYER_SHVR_speed"},
         {"SHVR_LIMITS", "nvidia"},
         {"SHVR_CLOCKS", "20"}});  // nanoseconds of 64 rays: a frame of such a screen in 3 ms
    Worked worked({3840, 2160}, Paging::never, 2048 * MIB);
    const auto submissions_of = [&](const char* side) {
        const uint64_t before = worked.view.submissions();
        worked.turn(side);
        worked.settle();
        return worked.view.submissions() - before;
    };
    CHECK(submissions_of("front") <= 96);  // while it is not known how fast it is
    CHECK(submissions_of("left") <= 64);   // sketches and 510 tiles
    worked.session.light.occlusion = {.strength = 0.8, .radius = 4.0, .rays = 2};
    CHECK(submissions_of("top") <= 64);
}

TEST_CASE("sharp tiles of two graphs wait for each other's light nowhere")
{
    Worked worked({320, 200}, Paging::never);
    worked.turn("front");
    worked.settle();
    uint64_t sketched = 0;
    // Only the tiles of a picture at rest are drawn again.
    for (int round = 0; round < 4; ++round) {
        worked.view.changed({Size3(0), worked.source->info().size});
        worked.settle();
        for (const View::PassTime& pass : worked.view.pass_times()) {
            if (pass.name != "raycast") continue;
            if (round == 0) sketched = pass.waits;
            CHECK(pass.waits == sketched);
        }
    }
}

TEST_CASE("after a clock that ran ten times slower, or stamps that came early, a picture takes few graphs more")
{
    const Environment environment(
        {{"VK_INSTANCE_LAYERS", "VK_LAYER_SHVR_clocks:VK_LAYER_SHVR_limits:VK_LAYER_SHVR_speed"},
         {"SHVR_LIMITS", "nvidia"},
         {"SHVR_CLOCKS", "2000"}});
    Worked worked({1000, 700}, Paging::never);
    const auto graphs_of = [&](const char* side) {
        worked.turn(side);
        worked.settle();
        const std::vector<View::PassTime>& passes = worked.view.pass_times();
        return std::ranges::find(passes, "raycast", &View::PassTime::name)->runs;
    };
    for (const char* side : {"front", "left", "top"}) graphs_of(side);
    const uint64_t usual = graphs_of("front");
    CAPTURE(usual);
    setenv("SHVR_CLOCKS", "20000", 1);
    const uint64_t slow = graphs_of("left");
    CHECK(slow > 2 * usual);  // each is as long as before
    setenv("SHVR_CLOCKS", "2000", 1);
    CHECK(graphs_of("top") <= usual + Pace::GRAPHS + 3);
    CHECK(graphs_of("front") <= usual + 2);
    setenv("SHVR_CLOCKS_EARLY", "30000000", 1);
    graphs_of("left");
    unsetenv("SHVR_CLOCKS_EARLY");
    CHECK(graphs_of("top") <= usual + Pace::GRAPHS + 3);
    CHECK(graphs_of("front") <= usual + 2);
}
