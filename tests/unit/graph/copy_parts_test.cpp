// Copies in parts: bounded in regions and bytes, in order, and together the whole.

#include "engine/graph/copy_parts.h"

#include <doctest/doctest.h>

using namespace shvr;

TEST_CASE("a copy of many regions is split by their number, in order")
{
    std::vector<ImageRegion> regions;
    for (uint32_t i = 0; i < 1000; ++i) regions.push_back({i, {34 * i, 0, 0}, glm::uvec3(34)});
    const auto parts = copy_parts(regions, Format::r8_uint);
    REQUIRE(parts.size() == 4);
    uint32_t next = 0;
    for (const auto& part : parts) {
        CHECK(part.size() <= MAX_COPY_REGIONS);
        for (const ImageRegion& region : part) CHECK(region.buffer_offset == next++);
    }
    CHECK(next == 1000);
}

TEST_CASE("a copy of many bytes is split by them, a long region too")
{
    const auto parts = copy_parts({{10, 20, 3 * MAX_COPY_BYTES + 5}, {7, 8, 9}});
    REQUIRE(parts.size() == 4);
    uint64_t at = 0;
    for (size_t i = 0; i < 4; ++i) {
        CHECK(parts[i][0].source_offset == 10 + at);
        CHECK(parts[i][0].target_offset == 20 + at);
        at += parts[i][0].bytes;
    }
    CHECK(at == 3 * MAX_COPY_BYTES + 5);
    REQUIRE(parts[3].size() == 2);
    CHECK(parts[3][1].bytes == 9);
}

TEST_CASE("an image is split between slices")
{
    const glm::uvec3 texels(1024, 1024, 70);  // 4 MiB a slice
    const auto parts = copy_parts({{0, {1, 2, 3}, texels}}, Format::r32_uint);
    REQUIRE(parts.size() == 5);
    uint32_t slices = 0;
    for (const auto& part : parts) {
        REQUIRE(part.size() == 1);
        CHECK(part[0].buffer_offset == uint64_t{slices} * 1024 * 1024 * 4);
        CHECK(part[0].texel == glm::uvec3(1, 2, 3 + slices));
        slices += part[0].texels.z;
        CHECK(part[0].texels.z <= 16);
    }
    CHECK(slices == 70);
}

TEST_CASE("what a graph was counted on for is forgotten unless it is submitted")
{
    std::string calls;
    {
        FrameGraph graph;
        graph.unless_submitted([&] { calls += 'a'; });
        graph.unless_submitted([&] { calls += 'b'; });
        const FrameGraph copy = graph;
        static_cast<void>(copy);
    }
    CHECK(calls == "ba");
    {
        FrameGraph graph;
        graph.unless_submitted([&] { calls += 'c'; });
        const FrameGraph copy = graph;
        copy.note_submitted();
    }
    CHECK(calls == "ba");
}
