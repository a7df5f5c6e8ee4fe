// The executor and the memory accounting on a device: data survives a round trip, budgets hold, mistakes are reported,
// and the validation layer is silent.

#include <chrono>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <numeric>
#include <thread>

#include <doctest/doctest.h>

#include "engine/gpu/executor.h"
#include "shaders/leap.h"

using namespace shvr;

namespace {

struct Fixture {
    gpu::Device device{{.device = "", .validation = true}};
    gpu::Memory memory{device, {.device_bytes = uint64_t(64) << 20, .host_bytes = uint64_t(64) << 20}};
    gpu::Executor executor{device, memory};
    ~Fixture()
    {
        const std::vector<std::string> messages = device.take_validation_messages();
        CHECK_MESSAGE(messages.empty(), (messages.empty() ? std::string() : messages.front()));
    }
};

template <class T>
std::vector<T> values_of(const std::vector<std::byte>& bytes)
{
    std::vector<T> values(bytes.size() / sizeof(T));
    std::memcpy(values.data(), bytes.data(), bytes.size());
    return values;
}

std::string message_of(const std::function<void()>& action)
{
    try {
        action();
    } catch (const Error& error) {
        return error.what();
    }
    return "no error";
}

/// A pass that the device has not seen, after two copies. `into`: an image of `cells` texels; null: a transient one.
FrameGraph distances_of(const glm::uvec3& cells, bool tiled, const gpu::Storage* into = nullptr)
{
    FrameGraph graph;
    const Resource zero = graph.fill(graph.create("zero", buffer_desc(4)), 0);
    const Resource source = graph.copy_to_image(zero, graph.create("source", image_desc(Format::r32_uint, cells)),
                                                {{0, glm::uvec3(0), glm::uvec3(1)}});
    Pass pass = graph.compute("leap_distance");
    pass.read("source", source);
    pass.push(gpu::LeapDistanceParams{cells, glm::uvec3(0), cells, 0});
    pass.dispatch(cells, tiled ? glm::uvec3(128, 128, 1) : glm::uvec3(0));
    const ResourceDesc desc = image_desc(Format::r32_uint, cells);
    graph.keep(pass.write("leap", into ? graph.import("leap", into->import()) : graph.create("leap", desc)));
    return graph;
}

}  // namespace

TEST_CASE_FIXTURE(Fixture, "bytes go to a buffer, through an image and back unchanged")
{
    const glm::uvec3 texels(5, 7, 3);
    gpu::Storage upload = memory.create("upload", buffer_desc(5 * 7 * 3 * 4), gpu::Placement::upload);
    gpu::Storage image = memory.create("image", image_desc(Format::r32_uint, texels));
    std::vector<uint32_t> wanted(5 * 7 * 3);
    std::iota(wanted.begin(), wanted.end(), 1000u);
    std::memcpy(upload.mapped().data(), wanted.data(), upload.mapped().size());

    for (int frame = 0; frame < 3; ++frame) {  // the second and third frame follow work still in flight
        FrameGraph graph;
        const Resource written =
            graph.copy_to_image(graph.import("upload", upload.import()), graph.import("image", image.import()),
                                {{0, glm::uvec3(0), texels}});
        const uint32_t back = graph.read_back(written);
        CHECK(values_of<uint32_t>(executor.run(graph).read_backs[back]) == wanted);
    }
}

TEST_CASE_FIXTURE(Fixture,
                  "a fill reaches all bytes of a buffer and every texel of an image, however large its bricks make it")
{
    gpu::Storage buffer = memory.create("buffer", buffer_desc(10 * 4));
    gpu::Storage numbers = memory.create("numbers", image_desc(Format::r32_uint, {5, 7, 3}));
    gpu::Storage bytes = memory.create("bytes", image_desc(Format::r8_uint, {34, 34, 68}));
    FrameGraph graph;
    const uint32_t in_buffer = graph.read_back(graph.fill(graph.import("buffer", buffer.import()), 7));
    const uint32_t in_numbers = graph.read_back(graph.fill(graph.import("numbers", numbers.import()), 123456));
    const uint32_t in_bytes = graph.read_back(graph.fill(graph.import("bytes", bytes.import()), 255));
    const auto result = executor.run(graph);
    CHECK(values_of<uint32_t>(result.read_backs[in_buffer]) == std::vector<uint32_t>(10, 7));
    CHECK(values_of<uint32_t>(result.read_backs[in_numbers]) == std::vector<uint32_t>(5 * 7 * 3, 123456));
    CHECK(values_of<uint8_t>(result.read_backs[in_bytes]) == std::vector<uint8_t>(34 * 34 * 68, 255));
}

TEST_CASE_FIXTURE(Fixture, "a dispatch split into tiles gives what one dispatch gives")
{
    const glm::uvec3 cells(50, 41, 3);
    const auto run = [&](const glm::uvec3& tile) {
        FrameGraph graph;
        const Resource buffer = graph.fill(graph.create("zero", buffer_desc(cells.x * cells.y * cells.z * 4)), 0);
        Resource source = graph.copy_to_image(buffer, graph.create("source", image_desc(Format::r32_uint, cells)),
                                              {{0, glm::uvec3(0), cells}});
        Pass pass = graph.compute("leap_distance");
        pass.read("source", source);
        pass.push(gpu::LeapDistanceParams{cells, glm::uvec3(0), cells, 0});
        pass.dispatch(cells, tile);
        const uint32_t back =
            graph.read_back(pass.write("leap", graph.create("leap", image_desc(Format::r32_uint, cells))));
        const gpu::FrameResult result = executor.run(graph);
        return std::pair(result.read_backs[back], result.passes[2].dispatches);
    };
    const auto [whole, one] = run(glm::uvec3(0));  // in one dispatch, since it is small
    const auto [tiled, many] = run(glm::uvec3(16, 16, 1));
    CHECK(one == 1);
    CHECK(many == 4 * 3 * 3);
    CHECK(whole == tiled);
}

TEST_CASE_FIXTURE(Fixture,
                  "an allocation over the budget is refused before it is made, with a remedy, and nothing is lost")
{
    const gpu::Storage some = memory.create("some", buffer_desc(uint64_t(40) << 20));
    const uint64_t used = memory.device_bytes();
    const std::string message = message_of([&] {
        static_cast<void>(
            memory.create("atlas", buffer_desc(uint64_t(30) << 20), gpu::Placement::device, "the volume"));
    });
    CHECK(message ==
          "device memory: the volume needs 30 MiB, and 24 MiB of 64 MiB are left; expected a larger budget, as "
          "--budget-device 141 gives");
    CHECK(memory.device_bytes() == used);
    CHECK(memory.create("small", buffer_desc(uint64_t(20) << 20)).desc().bytes == uint64_t(20) << 20);
    CHECK(memory.device_bytes() == used);  // the temporary has been freed
    CHECK(memory.bytes_by_name().at("some") >= uint64_t(40) << 20);
}

TEST_CASE_FIXTURE(Fixture, "transient memory is used again by frames of the same shape, and given back later")
{
    const auto run = [&](uint64_t bytes) {
        FrameGraph graph;
        static_cast<void>(graph.read_back(graph.fill(graph.create("transient", buffer_desc(bytes)), 7)));
        executor.run(graph);
    };
    run(1 << 20);
    const uint64_t after_one = memory.device_bytes();
    for (int i = 0; i < 5; ++i) run(1 << 20);
    CHECK(memory.device_bytes() == after_one);
    for (int i = 0; i < 520; ++i) run(1024);
    CHECK(memory.device_bytes() < after_one);
}

TEST_CASE_FIXTURE(Fixture, "memory that only the busiest moments need stays as long as such frames come")
{
    const auto graph_of = [](uint64_t bytes) {
        FrameGraph graph;
        static_cast<void>(graph.read_back(graph.fill(graph.create("transient", buffer_desc(bytes)), 7)));
        return graph;
    };
    constexpr uint64_t LARGE = 1 << 20;
    const auto run_three = [&] {  // each in flight while the next is submitted
        std::vector<gpu::Submission> running;
        for (int i = 0; i < 3; ++i) running.push_back(executor.submit(graph_of(LARGE)));
        for (gpu::Submission& one : running) static_cast<void>(one.finish());
    };
    run_three();
    const uint64_t made = memory.allocations_made(), bytes = memory.device_bytes();
    for (int i = 0; i < 600; ++i) executor.run(graph_of(LARGE));  // one at a time, of which three take turns
    run_three();
    CHECK(memory.allocations_made() == made);
    for (int i = 0; i < 520; ++i) executor.run(graph_of(1024));
    CHECK(memory.device_bytes() + 3 * LARGE <= bytes + 4096);
}

TEST_CASE_FIXTURE(Fixture, "what goes while a frame uses it is freed once that is done, or when its bytes are needed")
{
    const auto start = [&](const gpu::Storage& storage) {
        FrameGraph graph;
        static_cast<void>(graph.fill(graph.import("some", storage.import()), 7));
        return executor.submit(std::move(graph));
    };
    const uint64_t before = memory.device_bytes();
    gpu::Storage some = memory.create("some", buffer_desc(uint64_t(40) << 20));
    gpu::Submission running = start(some);
    some.reset();
    CHECK(memory.device_bytes() == before);                         // as reported
    some = memory.create("more", buffer_desc(uint64_t(41) << 20));  // does not fit the budget together with it
    CHECK(memory.peak_device_bytes() <= memory.device_budget());
    static_cast<void>(running.finish());
    running = start(some);
    some.reset();
    static_cast<void>(running.finish());
    CHECK(memory.bytes_by_name().count("more") == 0);
    CHECK(memory.device_bytes() == before);
}

TEST_CASE_FIXTURE(Fixture, "where a budget would refuse, memory that frames have left idle is freed first")
{
    const auto run = [&](uint64_t mib) {
        FrameGraph graph;
        static_cast<void>(graph.read_back(graph.fill(graph.create("transient", buffer_desc(mib << 20)), 7)));
        executor.run(graph);
    };
    for (const uint64_t mib : {20, 21, 22, 23, 24}) run(mib);
    CHECK(memory.create("large", buffer_desc(uint64_t(50) << 20)).desc().bytes == uint64_t(50) << 20);
    CHECK(memory.peak_device_bytes() <= memory.device_budget());
}

TEST_CASE_FIXTURE(Fixture, "frames in flight see what those before them wrote, whoever waits first")
{
    gpu::Storage sum = memory.create("sum", buffer_desc(4096));
    std::vector<gpu::Submission> frames;
    for (uint32_t i = 0; i < 20; ++i) {
        const std::vector<uint32_t> values(1024, i);
        FrameGraph graph;
        const Resource written =
            graph.copy(graph.upload<uint32_t>("values", values), graph.import("sum", sum.import()), {{0, 0, 4096}});
        graph.read_back(written);
        frames.push_back(executor.submit(std::move(graph)));
    }
    for (uint32_t i = 20; i-- > 0;)
        CHECK(values_of<uint32_t>(frames[i].finish().read_backs[0]) == std::vector<uint32_t>(1024, i));
}

TEST_CASE_FIXTURE(Fixture, "a frame is done without being waited for, and one nobody waits for leaves nothing behind")
{
    const auto submit = [&] {
        FrameGraph graph;
        graph.read_back(graph.fill(graph.create("transient", buffer_desc(1 << 20)), 7));
        return executor.submit(std::move(graph));
    };
    gpu::Submission frame = submit();
    while (!frame.done()) {
    }
    CHECK(frame.finish().read_backs[0].size() == 1 << 20);
    CHECK(!frame);
    const uint64_t bytes = memory.device_bytes();
    for (int i = 0; i < 10; ++i) static_cast<void>(submit());
    CHECK(memory.device_bytes() == bytes);
}

TEST_CASE_FIXTURE(Fixture, "a pass that disagrees with its kernel is refused by name")
{
    const glm::uvec3 cells(8);
    const auto refused = [&](const std::function<void(FrameGraph&, Pass&)>& declare) {
        FrameGraph graph;
        Pass pass = graph.compute("leap_distance");
        declare(graph, pass);
        pass.dispatch(cells);
        return message_of([&] { executor.run(graph); });
    };
    const auto image = [&](FrameGraph& graph, const char* name) {
        return graph.create(name, image_desc(Format::r32_uint, cells));
    };
    const auto filled = [&](FrameGraph& graph) {
        const Resource zero = graph.fill(graph.create("zero", buffer_desc(8 * 8 * 8 * 4)), 0);
        return graph.copy_to_image(zero, image(graph, "source"), {{0, glm::uvec3(0), cells}});
    };
    CHECK(refused([&](FrameGraph& graph, Pass& pass) {
              graph.keep(pass.write("leep", image(graph, "leap")));
          }).find("binds 'leep'; kernel 'leap_distance' declares source, leap") != std::string::npos);
    CHECK(refused([&](FrameGraph& graph, Pass& pass) {
              graph.keep(pass.write("leap", image(graph, "leap")));
          }).find("leaves 'source'") != std::string::npos);
    CHECK(refused([&](FrameGraph& graph, Pass& pass) {
              const Resource source = filled(graph);
              graph.keep(pass.modify("source", source));
          }).find("only reads") != std::string::npos);
    CHECK(refused([&](FrameGraph& graph, Pass& pass) {
              pass.read("source", filled(graph));
              pass.push(uint32_t(1));
              graph.keep(pass.write("leap", image(graph, "leap")));
          }).find("pushes 4 bytes") != std::string::npos);
    CHECK(refused([&](FrameGraph& graph, Pass& pass) {
              pass.read("source", filled(graph));
              pass.push(gpu::LeapDistanceParams{cells, glm::uvec3(0), cells, 0});
              pass.constant("SPEED", 1);
              graph.keep(pass.write("leap", image(graph, "leap")));
          }).find("no specialization constant 'SPEED'") != std::string::npos);
    FrameGraph graph;
    Pass pass = graph.compute("warp");
    graph.keep(pass.write("leap", image(graph, "leap")));
    pass.dispatch(cells);
    const std::string message = message_of([&] { executor.run(graph); });
    CHECK(message.find("there is no kernel 'warp'; expected one of ") != std::string::npos);
    CHECK(message.find("raycast") != std::string::npos);
}

TEST_CASE_FIXTURE(Fixture, "every pass has a time, in order, and the sum is within the frame's")
{
    FrameGraph graph;
    const Resource a = graph.fill(graph.create("a", buffer_desc(1 << 22)), 1, "fill a");
    const Resource b = graph.fill(graph.create("b", buffer_desc(1 << 22)), 2, "fill b");
    static_cast<void>(graph.read_back(a));
    static_cast<void>(graph.read_back(b));
    const gpu::FrameResult result = executor.run(graph);
    REQUIRE(result.passes.size() == 4);
    if (device.traits().timestamp_bits == 0) return;
    double sum = 0.0;
    for (size_t i = 0; i < result.passes.size(); ++i) {
        CHECK(result.passes[i].timed);
        if (i > 0) CHECK(result.passes[i].start_ms >= result.passes[i - 1].start_ms);
        sum += result.passes[i].gpu_ms;
    }
    CHECK(result.passes[0].name == "fill a");
    CHECK(result.passes[2].barrier == "transfer -> transfer");
    if (device.traits().is_cpu) CHECK(sum <= result.wall_ms * 1.05 + 0.3);  // passes of a GPU may overlap
}

TEST_CASE_FIXTURE(Fixture, "invocations are counted in all submissions of a pass, where they are asked for")
{
    if (!device.traits().has_pipeline_statistics) return;
    const auto run = [&](bool statistics) {
        return executor.run(distances_of({256, 256, 24}, true), {.statistics = statistics}).passes;
    };
    const std::vector<gpu::PassReport> passes = run(true);
    CHECK(passes[2].submissions > 20);  // it might be long
    CHECK(passes[2].invocations == 256 * 256 * 24);
    CHECK(!passes[0].invocations);  // a fill
    CHECK(run(true)[2].invocations == 256 * 256 * 24);
    CHECK(!run(false)[2].invocations);
}

TEST_CASE("a long pass is several submissions until it is known to be short")
{
    setenv("VK_INSTANCE_LAYERS", "VK_LAYER_SHVR_speed", 1);  // nothing takes any time
    gpu::Device fast({.device = "", .validation = false});
    gpu::Memory memory(fast, {.device_bytes = uint64_t(64) << 20, .host_bytes = uint64_t(64) << 20});
    for (const bool tiled : {true, false}) {
        CAPTURE(tiled);
        gpu::Executor executor(fast, memory);
        const auto graph = [&] { return distances_of({256, 256, 24}, tiled); };
        const auto run = [&] {
            const gpu::PassReport report = executor.run(graph()).passes.at(2);
            CHECK(report.tiles == (tiled ? 96u : 1u));  // however it is divided
            return std::pair(report.dispatches, report.submissions);
        };
        // A tile is taken for 25 ms, and all of the pass without tiles for 157 ms; copies come first.
        CHECK(run() == (tiled ? std::pair(96u, 25u) : std::pair(4u, 2u)));
        CHECK(run() == (tiled ? std::pair(96u, 1u) : std::pair(1u, 1u)));
        // A pass that was not timed is not taken for a long one, however late its result is requested.
        gpu::Submission untimed = executor.submit(graph(), {.timestamps = false});
        std::this_thread::sleep_for(std::chrono::seconds(1));
        static_cast<void>(untimed.finish());
        CHECK(run() == (tiled ? std::pair(96u, 1u) : std::pair(1u, 1u)));
    }
    unsetenv("VK_INSTANCE_LAYERS");
}

TEST_CASE("of a frame that was submitted in part nobody counts on what it has done")
{
    const glm::uvec3 cells(256, 256, 24);
    setenv("VK_INSTANCE_LAYERS", "VK_LAYER_SHVR_faults", 1);
    setenv("SHVR_FAULTS", "vkQueueSubmit2:2:out_of_host_memory", 1);
    Fixture fixture;
    unsetenv("VK_INSTANCE_LAYERS");
    unsetenv("SHVR_FAULTS");
    const gpu::Storage kept =
        fixture.memory.create("kept", image_desc(Format::r32_uint, cells), gpu::Placement::device, "a test");
    CHECK(kept.import().state != UNKNOWN_STATE);
    CHECK_THROWS_AS(fixture.executor.run(distances_of(cells, true, &kept)), gpu::MemoryError);
    CHECK(kept.import().state == UNKNOWN_STATE);
    fixture.executor.run(distances_of(cells, true, &kept));
    CHECK(kept.import().state != UNKNOWN_STATE);
}

TEST_CASE("a device that does not exist is refused with the list of those that do")
{
    const std::string message =
        message_of([] { gpu::Device device({.device = "no such device", .validation = false}); });
    CHECK(message.find("--device is 'no such device', which no device matches; found 0: ") != std::string::npos);
}
