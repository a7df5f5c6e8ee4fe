#include "engine/graph/frame_graph.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <utility>

#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

constexpr Barrier COMPUTE_TO_COMPUTE{STAGE_COMPUTE, STAGE_COMPUTE, true};

/// Nothing is in flight: a first use needs no barrier.
constexpr ResourceState IDLE{};

Resource import_idle(FrameGraph& graph, const std::string& name, uint32_t id)
{
    return graph.import(name, {.id = id, .desc = buffer_desc(64), .state = IDLE});
}

/// A compute pass of one thread that reads and writes resources under their own names.
Resource pass(FrameGraph& graph, const std::string& name, const std::vector<Resource>& reads,
              std::optional<Resource> writes = {})
{
    Pass pass = graph.compute(name);
    pass.dispatch(glm::uvec3(1));
    for (size_t i = 0; i < reads.size(); ++i) pass.read("in" + std::to_string(i), reads[i]);
    return writes ? pass.write("out", *writes) : Resource{};
}

/// "a[compute->compute] b": the steps with the barriers in front of them; ! marks order only.
std::string steps_of(const FrameGraph& graph)
{
    const CompiledGraph compiled = graph.compile();
    std::string text;
    for (const Step& step : compiled.steps) {
        if (!text.empty()) text += ' ';
        if (step.barrier)
            text += "[" + names_of(step.barrier->from) + (step.barrier->memory ? "->" : "!->") +
                    names_of(step.barrier->to) + "]";
        text += graph.passes()[step.pass].name;
    }
    return text;
}

std::string here(int line)
{
    return "frame_graph_test.cpp:" + std::to_string(line);
}

bool holds(const std::string& text, const std::string& part)
{
    return text.find(part) != std::string::npos;
}

}  // namespace

// ---- Barriers -------------------------------------------------------------------------------------------------------

TEST_CASE("a read waits for the write before it")
{
    // write -> x -> read -> y
    FrameGraph graph;
    const Resource x = pass(graph, "write", {}, import_idle(graph, "x", 1));
    pass(graph, "read", {x}, import_idle(graph, "y", 2));
    CHECK(steps_of(graph) == "write [compute->compute]read");
    CHECK(graph.compile().steps[1].barrier == COMPUTE_TO_COMPUTE);
}

TEST_CASE("a write waits for the reads before it, in order only")
{
    // x -> read -> y
    // x <- write
    FrameGraph graph;
    const Resource x = import_idle(graph, "x", 1);
    pass(graph, "read", {x}, import_idle(graph, "y", 2));
    pass(graph, "write", {}, x);
    CHECK(steps_of(graph) == "read [compute!->compute]write");
}

TEST_CASE("a write waits for the write before it")
{
    // first -> x -> second -> x
    FrameGraph graph;
    const Resource x = pass(graph, "first", {}, import_idle(graph, "x", 1));
    pass(graph, "second", {}, x);
    CHECK(steps_of(graph) == "first [compute->compute]second");
}

TEST_CASE("a second read does not wait again")
{
    // write -> x -> read 1 -> y
    //          x -> read 2 -> z
    FrameGraph graph;
    const Resource x = pass(graph, "write", {}, import_idle(graph, "x", 1));
    pass(graph, "read 1", {x}, import_idle(graph, "y", 2));
    pass(graph, "read 2", {x}, import_idle(graph, "z", 3));
    CHECK(steps_of(graph) == "write [compute->compute]read 1 read 2");
}

TEST_CASE("a read at another stage waits on its own")
{
    // write -> x -> read (compute) -> y
    //          x -> read back (transfer)
    FrameGraph graph;
    const Resource x = pass(graph, "write", {}, import_idle(graph, "x", 1));
    pass(graph, "read", {x}, import_idle(graph, "y", 2));
    graph.read_back(x, "back");
    CHECK(steps_of(graph) == "write [compute->compute]read [compute->transfer]back");
}

TEST_CASE("one barrier settles every resource it covers")
{
    // write x -> x -> read x ->
    // write y -> y -> read y ->      the barrier before "read x" covers y too
    FrameGraph graph;
    const Resource x = pass(graph, "write x", {}, import_idle(graph, "x", 1));
    const Resource y = pass(graph, "write y", {}, import_idle(graph, "y", 2));
    pass(graph, "read x", {x}, import_idle(graph, "z", 3));
    pass(graph, "read y", {y}, import_idle(graph, "w", 4));
    CHECK(steps_of(graph) == "write x write y [compute->compute]read x read y");
}

TEST_CASE("a barrier that only orders does not settle a write")
{
    // write -> x            y -> read y
    //                       y <- write y     order only
    //          x -> read x                   still needs the memory of x
    FrameGraph graph;
    const Resource x = pass(graph, "write x", {}, import_idle(graph, "x", 1));
    const Resource y = import_idle(graph, "y", 2);
    pass(graph, "read y", {y}, import_idle(graph, "z", 3));
    pass(graph, "write y", {}, y);
    pass(graph, "read x", {x}, import_idle(graph, "w", 4));
    CHECK(steps_of(graph) == "write x read y [compute!->compute]write y [compute->compute]read x");
}

TEST_CASE("a read after the order was settled makes the next write wait again")
{
    // x -> read 1;  y -> write y (order);  x -> read 2;  x <- write x
    FrameGraph graph;
    const Resource x = import_idle(graph, "x", 1), y = import_idle(graph, "y", 2);
    pass(graph, "read 1", {x, y}, import_idle(graph, "z", 3));
    pass(graph, "write y", {}, y);
    pass(graph, "read 2", {x}, import_idle(graph, "w", 4));
    pass(graph, "write x", {}, x);
    CHECK(steps_of(graph) == "read 1 [compute!->compute]write y read 2 [compute!->compute]write x");
}

TEST_CASE("who waits for a read that came after all others waits for those as well")
{
    // x, y -> read (compute);  y <- fill (order, compute to transfer);  x -> back (transfer);  x <- write
    FrameGraph graph;
    const Resource x = import_idle(graph, "x", 1), y = import_idle(graph, "y", 2);
    pass(graph, "read", {x, y}, import_idle(graph, "z", 3));
    static_cast<void>(graph.fill(y, 0));
    graph.read_back(x, "back");
    pass(graph, "write", {}, x);
    CHECK(steps_of(graph) == "read [compute!->transfer]fill back [transfer!->compute]write");
}

TEST_CASE("one barrier stands for several waits of one pass")
{
    // fill -> x (transfer), write -> y (compute), both -> z
    FrameGraph graph;
    const Resource x = graph.fill(import_idle(graph, "x", 1), 0);
    const Resource y = pass(graph, "write", {}, import_idle(graph, "y", 2));
    pass(graph, "both", {x, y}, import_idle(graph, "z", 3));
    CHECK(steps_of(graph) == "fill write [compute+transfer->compute]both");
}

TEST_CASE("nothing is known of an import without a state, so its first use waits for everything")
{
    FrameGraph graph;
    const Resource x = graph.import("x", {.id = 1, .desc = buffer_desc(64)});
    pass(graph, "write", {}, x);
    CHECK(steps_of(graph) == "[compute+transfer->compute]write");
}

TEST_CASE("nothing is in flight on a transient")
{
    FrameGraph graph;
    graph.read_back(graph.fill(graph.create("x", buffer_desc(64)), 0), "back");
    CHECK(steps_of(graph) == "fill [transfer->transfer]back");
}

TEST_CASE("a transient takes the memory of an equal one that is not needed any more, and waits for its last use")
{
    // x -> y (x ends) -> z in the memory of x -> back
    FrameGraph graph;
    const Resource x = pass(graph, "write x", {}, graph.create("x", buffer_desc(64)));
    const Resource y = pass(graph, "write y", {x}, graph.create("y", buffer_desc(64)));
    const Resource z = pass(graph, "write z", {y}, graph.create("z", buffer_desc(64)));
    graph.read_back(z, "back");
    CHECK(graph.compile().memory_of == std::vector<uint32_t>{0, 1, 0});
    CHECK(steps_of(graph) == "write x [compute->compute]write y [compute->compute]write z [compute->transfer]back");
}

TEST_CASE("the first write to shared memory waits even where nothing else has to")
{
    FrameGraph graph;
    const Resource out = import_idle(graph, "out", 1);
    const Resource x = graph.fill(graph.create("x", buffer_desc(64)), 0);
    static_cast<void>(graph.copy(x, out, {{0, 0, 64}}));
    const Resource y = pass(graph, "write y", {}, graph.create("y", buffer_desc(64)));
    pass(graph, "read y", {y}, import_idle(graph, "other", 2));
    CHECK(graph.compile().memory_of == std::vector<uint32_t>{0, 1, 1, 3});
    CHECK(steps_of(graph) == "fill [transfer->transfer]copy [transfer->compute]write y [compute->compute]read y");
}

TEST_CASE("memory is not shared with what is unequal, imported, filled by the host, or still needed")
{
    const auto memory_of_next = [](const ResourceDesc& desc, const ResourceDesc& next) {
        FrameGraph graph;
        const Resource x = graph.create("x", desc);
        pass(graph, "read x", {pass(graph, "write x", {}, x)}, import_idle(graph, "other", 2));
        const Resource y = graph.create("y", next);
        pass(graph, "read y", {pass(graph, "write y", {}, y)}, import_idle(graph, "another", 3));
        return graph.compile().memory_of[y.index];
    };
    const ResourceDesc picture = picture_desc(Format::rgba32_float, {4, 4});
    CHECK(memory_of_next(picture, picture) == 0);
    CHECK(memory_of_next(picture, picture_desc(Format::rgba32_float, {4, 5})) == 2);
    CHECK(memory_of_next(picture, picture_desc(Format::r32_uint, {4, 4})) == 2);
    CHECK(memory_of_next(picture, image_desc(Format::rgba32_float, {4, 4, 1})) == 2);
    CHECK(memory_of_next(picture, buffer_desc(picture.bytes)) == 2);

    FrameGraph graph;
    const Resource out = import_idle(graph, "out", 1);  // 0
    const std::vector<uint8_t> bytes(64);
    Resource two = pass(graph, "read", {graph.upload<uint8_t>("from the host", bytes)}, out);  // 1
    const Resource x = pass(graph, "write x", {}, graph.create("x", buffer_desc(64)));         // 2
    const Resource y = pass(graph, "write y", {x}, graph.create("y", buffer_desc(64)));        // 3: x is in use
    two = pass(graph, "read both", {x, y}, two);
    const Resource later = graph.upload<uint8_t>("later", bytes);  // 4: filled before x is used
    pass(graph, "read later", {later}, two);
    CHECK(graph.compile().memory_of == std::vector<uint32_t>{0, 1, 2, 3, 4});
}

TEST_CASE("a frame waits for what the last frame left in flight")
{
    // frame 1: write -> x          frame 2: x -> read          frame 3: x -> read, x <- write
    const auto import_x = [](FrameGraph& graph, const ResourceState& state) {
        return graph.import("x", {.id = 1, .desc = buffer_desc(64), .state = state});
    };
    FrameGraph first;
    pass(first, "write", {}, import_x(first, IDLE));
    const ResourceState written = first.compile().final_states[0];
    CHECK(written == ResourceState{.written_by = STAGE_COMPUTE});

    FrameGraph second;
    const Resource x_read = import_x(second, written);
    pass(second, "read", {x_read}, import_idle(second, "y", 2));
    CHECK(steps_of(second) == "[compute->compute]read");
    const ResourceState read = second.compile().final_states[0];

    FrameGraph third;
    const Resource x = import_x(third, read);
    pass(third, "read", {x}, import_idle(third, "y", 2));
    pass(third, "write", {}, x);
    CHECK(steps_of(third) == "read [compute!->compute]write");
}

TEST_CASE("an import that no living pass touches keeps its state")
{
    const ResourceState state{.written_by = STAGE_TRANSFER, .visible_to = 0, .read_by = STAGE_COMPUTE};
    FrameGraph graph;
    const Resource x = graph.import("x", {.id = 1, .desc = buffer_desc(64), .state = state});
    pass(graph, "nobody needs this", {x}, graph.create("y", buffer_desc(64)));
    const CompiledGraph compiled = graph.compile();
    CHECK(compiled.steps.empty());
    CHECK_FALSE(compiled.used[0]);
    CHECK(compiled.final_states[0] == state);
}

// ---- Culling --------------------------------------------------------------------------------------------------------

TEST_CASE("a chain that nobody reads is culled as a whole")
{
    // a -> x -> b -> y -> c -> z           (all transient)
    // kept -> import
    FrameGraph graph;
    const Resource x = pass(graph, "a", {}, graph.create("x", buffer_desc(4)));
    const Resource y = pass(graph, "b", {x}, graph.create("y", buffer_desc(4)));
    pass(graph, "c", {y}, graph.create("z", buffer_desc(4)));
    pass(graph, "kept", {}, import_idle(graph, "import", 1));
    CHECK(steps_of(graph) == "kept");
    CHECK(graph.compile().used == std::vector<bool>{false, false, false, true});
}

TEST_CASE("a read-back keeps the whole chain behind it and nothing beside it")
{
    // a -> x -> b -> y -> back
    //      x -> aside -> z
    FrameGraph graph;
    const Resource x = pass(graph, "a", {}, graph.create("x", buffer_desc(4)));
    const Resource y = pass(graph, "b", {x}, graph.create("y", buffer_desc(4)));
    pass(graph, "aside", {x}, graph.create("z", buffer_desc(4)));
    CHECK(graph.read_back(y, "back") == 0);
    CHECK(graph.read_back(y, "again") == 1);
    CHECK(graph.read_back_count() == 2);
    CHECK(steps_of(graph) == "a [compute->compute]b [compute->transfer]back again");
}

TEST_CASE("keep() keeps what made a resource")
{
    FrameGraph graph;
    const Resource x = pass(graph, "a", {}, graph.create("x", buffer_desc(4)));
    CHECK(graph.compile().steps.empty());
    graph.keep(x);
    CHECK(graph.compile().steps.size() == 1);
}

TEST_CASE("a write keeps earlier writers, for it may cover only a part")
{
    FrameGraph graph;
    const Resource x = pass(graph, "left half", {}, graph.create("x", buffer_desc(4)));
    const Resource both = pass(graph, "right half", {}, x);
    pass(graph, "after the last reader", {}, both);
    const Resource y = graph.create("y", buffer_desc(4));
    graph.read_back(pass(graph, "other", {}, y), "back");
    CHECK(graph.compile().steps.size() == 2);  // no pass reads x

    FrameGraph read;
    const Resource half = pass(read, "left half", {}, read.create("x", buffer_desc(4)));
    const Resource whole = pass(read, "right half", {}, half);
    read.read_back(whole, "back");
    pass(read, "after the last reader", {}, whole);
    CHECK(read.compile().steps.size() == 3);
}

// ---- Wrong use ------------------------------------------------------------------------------------------------------

TEST_CASE("a stale handle is refused with both versions and the pass that ended it")
{
    FrameGraph graph;
    const Resource x = graph.create("density", buffer_desc(4));
    const Resource first = pass(graph, "fog", {}, x);
    Pass blur = graph.compute("blur");
    const int line = __LINE__ - 1;
    const Resource second = blur.modify("data", first);
    pass(graph, "sharpen", {}, second);

    Pass late = graph.compute("late");
    const int late_line = __LINE__ - 1;
    const std::string message = error_of([&] { late.read("data", first); });
    INFO(message);
    CHECK(message == "pass 'late' (" + here(late_line) +
                         ") binds 'data' to version 1 of 'density', which pass 'blur' (" + here(line) +
                         ") replaced; the last version is 3");
    CHECK(holds(error_of([&] { graph.keep(second); }), "keep() was given version 2 of 'density'"));
}

TEST_CASE("reading what was never written is refused")
{
    FrameGraph graph;
    const Resource x = graph.create("density", buffer_desc(4));
    Pass reader = graph.compute("reader");
    const std::string place = "pass 'reader' (" + here(__LINE__ - 1) + ")";
    CHECK(error_of([&] { reader.read("in", x); }) == place + " reads 'density', which no pass has written");
    CHECK(holds(error_of([&] { static_cast<void>(reader.modify("in", x)); }), "which no pass has written"));
    CHECK(holds(error_of([&] { graph.read_back(x); }), "which no pass has written"));
}

TEST_CASE("a handle of another graph is refused where it can be told")
{
    FrameGraph other;
    Resource later = other.create("x", buffer_desc(4));
    for (int i = 0; i < 3; ++i) later = other.fill(later, 0);

    FrameGraph graph;
    Pass reader = graph.compute("reader");
    CHECK(holds(error_of([&] { reader.read("in", later); }), "'in' to a handle that this graph did not make"));
    CHECK(holds(error_of([&] { reader.read("in", Resource{}); }), "a handle that this graph did not make"));
    // The same index, but a version that this graph has not reached.
    graph.create("x", buffer_desc(4));
    CHECK(
        holds(error_of([&] { reader.read("in", later); }), "version 3 of 'x', a handle that this graph did not make"));
    CHECK(holds(error_of([&] { graph.keep(later); }), "a handle that this graph did not make"));
    CHECK(holds(error_of([&] { graph.read_back(Resource{}); }), "a handle that this graph did not make"));
}

TEST_CASE("a name is bound once in a pass")
{
    FrameGraph graph;
    const Resource x = import_idle(graph, "x", 1), y = import_idle(graph, "y", 2);
    Pass reader = graph.compute("reader");
    reader.read("in", x);
    CHECK(holds(error_of([&] { reader.read("in", y); }), "binds 'in' twice"));
}

TEST_CASE("a resource that is written is bound once in a pass")
{
    FrameGraph graph;
    const Resource x = import_idle(graph, "x", 1), y = import_idle(graph, "y", 2);
    Pass reader = graph.compute("reader");
    reader.read("in", x);
    reader.read("filtered", x);  // two reads are fine: one sampled, one fetched
    CHECK(holds(error_of([&] { static_cast<void>(reader.write("out", x)); }),
                "binds 'x' twice, as 'in' and 'out', and writes it"));
    CHECK(holds(error_of([&] { static_cast<void>(graph.copy(y, y, {})); }), "binds 'y' twice"));
}

TEST_CASE("an object is imported once")
{
    FrameGraph graph;
    import_idle(graph, "atlas", 7);
    CHECK(error_of([&] { import_idle(graph, "bricks", 7); }) ==
          "'bricks' is imported twice (first as 'atlas'); expected one handle per object");
}

TEST_CASE("a pass without threads is refused")
{
    FrameGraph graph;
    Pass empty = graph.compute("empty");
    const int line = __LINE__ - 1;
    static_cast<void>(empty.write("out", import_idle(graph, "x", 1)));
    empty.dispatch({16, 0, 1});
    CHECK(error_of([&] { graph.compile(); }) ==
          "pass 'empty' (" + here(line) + ") dispatches 16 x 0 x 1 threads; expected at least one");
    empty.dispatch({65536, 65536, 1});  // 2^32 threads are not none
    CHECK(error_of([&] { graph.compile(); }).empty());
}

TEST_CASE("a resource without bytes is refused")
{
    FrameGraph graph;
    CHECK(error_of([&] { graph.create("x", buffer_desc(0)); }) == "resource 'x' has 0 bytes; expected at least one");
    CHECK(holds(error_of([&] { graph.create("y", image_desc(Format::r8_uint, {4, 0, 4})); }), "has 0 bytes"));
}

TEST_CASE("bytes of an image are counted in 64 bits")
{
    CHECK(image_desc(Format::rgba32_float, {4096, 4096, 4096}).bytes == uint64_t(1) << 40);
}
