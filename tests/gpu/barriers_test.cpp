// The barriers of compiled graphs are all needed: with any of them left out the validation layer has something to say,
// within a submission and between two; with all of them it has not. This also shows that it would notice.

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <unistd.h>

#include <doctest/doctest.h>

#include "engine/gpu/executor.h"
#include "shaders/leap.h"

using namespace shvr;

namespace {

constexpr glm::uvec3 CELLS(40, 24, 3);
constexpr uint64_t BYTES = uint64_t{40} * 24 * 3 * 4;

/// Sets variables of the environment for as long as it lives.
class Environment {
public:
    void set(const char* name, const std::string& value)
    {
        setenv(name, value.c_str(), 1);
        names_.push_back(name);
    }
    Environment() = default;
    Environment(const Environment&) = delete;
    ~Environment()
    {
        for (const char* name : names_) unsetenv(name);
    }

private:
    std::vector<const char*> names_;
};

Resource distance_of(FrameGraph& graph, Resource source, Resource target)
{
    Pass pass = graph.compute("leap_distance");
    pass.read("source", source);
    pass.push(gpu::LeapDistanceParams{CELLS, glm::uvec3(0), CELLS, 0});
    pass.dispatch(CELLS, {16, 16, 1});
    return pass.write("leap", target);
}

/// Every kind of pass, and each two that can meet: in a graph, and in two of which the second one is submitted while
/// the first one runs.
std::vector<std::string> messages_of_run()
{
    gpu::Device device({.device = "", .validation = true});
    {
        gpu::Memory memory(device, {.device_bytes = 64 << 20, .host_bytes = 64 << 20});
        gpu::Executor executor(device, memory);
        gpu::Storage buffer = memory.create("buffer", buffer_desc(BYTES)),
                     other = memory.create("other", buffer.desc());
        gpu::Storage a = memory.create("a", image_desc(Format::r32_uint, CELLS)), b = memory.create("b", a.desc());
        const std::vector<ImageRegion> all{{0, glm::uvec3(0), CELLS}};
        FrameGraph first;
        Resource filled = first.fill(first.import("buffer", buffer.import()), 0);
        const Resource image = first.copy_to_image(filled, first.import("a", a.import()), all);
        const Resource leap = distance_of(first, image, first.import("b", b.import()));
        static_cast<void>(first.copy_to_image(filled, leap, all));
        filled = first.fill(filled, 1);
        static_cast<void>(first.copy(filled, first.import("other", other.import()), {{0, 0, BYTES}}));
        gpu::Submission running = executor.submit(std::move(first));
        FrameGraph second;
        const Resource again = distance_of(second, second.import("b", b.import()), second.import("a", a.import()));
        static_cast<void>(second.copy_to_image(second.import("other", other.import()), again, all));
        static_cast<void>(second.fill(second.import("buffer", buffer.import()), 2));
        gpu::Submission after = executor.submit(std::move(second));
        FrameGraph third;
        static_cast<void>(third.read_back(third.import("a", a.import())));
        static_cast<void>(third.read_back(third.import("buffer", buffer.import())));
        static_cast<void>(executor.run(std::move(third)));
        static_cast<void>(running.finish());
        static_cast<void>(after.finish());
    }
    return device.take_validation_messages();
}

}  // namespace

TEST_CASE("with any one of their barriers left out, graphs are found fault with; with all of them they are not")
{
    const std::filesystem::path log = std::filesystem::temp_directory_path() / sentence("shvr-barriers-", getpid());
    Environment environment;
    environment.set("VK_INSTANCE_LAYERS", "VK_LAYER_SHVR_barriers");
    environment.set("SHVR_BARRIERS_LOG", log.string());
    environment.set("SHVR_DROP_BARRIER", "0");
    CHECK(messages_of_run() == std::vector<std::string>());
    std::string word;
    int count = 0;
    std::ifstream(log) >> word >> count;
    CHECK(count == 8);
    for (int number = 1; number <= count; ++number) {
        CAPTURE(number);
        environment.set("SHVR_DROP_BARRIER", std::to_string(number));
        const std::vector<std::string> messages = messages_of_run();
        REQUIRE(!messages.empty());
        CHECK(messages[0].find("SYNC-HAZARD") != std::string::npos);
    }
    std::filesystem::remove(log);
}
