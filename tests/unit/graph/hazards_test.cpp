// Any graph: no hazard is left. Random frames are laid end to end. An independent checker follows every access through
// the barriers after it, as the Vulkan specification defines dependency chains, and examines every later access to the
// same object.

#include "engine/graph/frame_graph.h"

#include <algorithm>
#include <array>
#include <random>
#include <utility>

#include <doctest/doctest.h>

#include "tests/support/slow.h"

using namespace shvr;
using namespace shvr::test;

namespace {

struct Access {
    uint64_t object = 0;
    Stages stage = 0;  // one bit
    bool writes = false;
    bool earlier = false;  // stands for any earlier work in flight; such accesses do not conflict with each other
};

/// A step of the device, in its order: either a barrier or the accesses of one pass.
struct Event {
    std::optional<Barrier> barrier;
    std::vector<Access> accesses;
};

/// The stages known to be ordered after one access.
struct Chain {
    Access access;
    Stages ordered = 0;          // stages that wait for it
    Stages after_available = 0;  // stages that wait until its write is available
    Stages visible = 0;          // stages that see its write

    void pass_through(const Barrier& barrier)
    {
        const bool direct = barrier.from & access.stage;
        if (direct || (barrier.from & ordered)) ordered |= barrier.to;
        // Only the writer's own stage can make a write available; available data can become visible to more stages.
        const bool available = barrier.memory && direct;
        if (barrier.memory && (direct || (barrier.from & after_available))) visible |= barrier.to;
        if (available || (barrier.from & after_available)) after_available |= barrier.to;
    }
    bool is_hazard(const Access& later) const
    {
        if (access.object != later.object || (!access.writes && !later.writes)) return false;
        if (access.earlier && later.earlier) return false;
        return (later.stage & ~(access.writes ? visible : ordered)) != 0;
    }
};

size_t count_hazards(const std::vector<Event>& events)
{
    size_t hazards = 0;
    std::vector<Chain> chains;
    for (const Event& event : events) {
        if (event.barrier)
            for (Chain& chain : chains) chain.pass_through(*event.barrier);
        for (const Access& later : event.accesses)
            for (const Chain& chain : chains) hazards += chain.is_hazard(later);
        for (const Access& access : event.accesses) chains.push_back({access});
    }
    return hazards;
}

/// The accesses that UNKNOWN_STATE stands for.
Event anything_in_flight(uint64_t object)
{
    Event event;
    for (const Stages stage : {STAGE_COMPUTE, STAGE_TRANSFER}) {
        event.accesses.push_back({object, stage, true, true});
        event.accesses.push_back({object, stage, false, true});
    }
    return event;
}

struct Generator {
    std::mt19937 random;
    bool compute_only = false;
    static constexpr uint32_t IMPORTS = 3, TRANSIENTS = 4, PASSES = 9;
    std::array<ResourceState, IMPORTS> states;

    Generator(uint32_t seed, bool only_compute) : random(seed), compute_only(only_compute)
    {
        states.fill(UNKNOWN_STATE);
    }
    uint32_t below(uint32_t bound) { return uint32_t(random() % bound); }

    /// One frame over the same imports as the earlier frames.
    FrameGraph frame()
    {
        FrameGraph graph;
        std::vector<Resource> handles;
        for (uint32_t i = 0; i < IMPORTS; ++i)
            handles.push_back(
                graph.import("import " + std::to_string(i), {.id = i, .desc = buffer_desc(16), .state = states[i]}));
        for (uint32_t i = 0; i < TRANSIENTS; ++i)
            handles.push_back(graph.create("transient " + std::to_string(i), buffer_desc(16)));
        const auto readable = [&](const Resource& r) { return r.index < IMPORTS || r.version > 0; };
        for (uint32_t i = 0; i < PASSES; ++i) {
            Resource& a = handles[below(uint32_t(handles.size()))];
            Resource& b = handles[below(uint32_t(handles.size()))];
            switch (compute_only ? 0 : below(5)) {
                case 1: a = graph.fill(a, 0); break;
                case 2:
                    if (readable(a) && a.index != b.index) b = graph.copy(a, b, {});
                    break;
                case 3:
                    if (readable(a)) graph.read_back(a);
                    break;
                default: add_compute(graph, handles, i); break;
            }
        }
        return graph;
    }

    void add_compute(FrameGraph& graph, std::vector<Resource>& handles, uint32_t index)
    {
        Pass pass = graph.compute("pass " + std::to_string(index));
        pass.dispatch(glm::uvec3(1));
        for (Resource& handle : handles) {
            const bool readable = handle.index < IMPORTS || handle.version > 0;
            const std::string name = "r" + std::to_string(handle.index);
            switch (below(5)) {
                case 0:
                    if (readable) pass.read(name, handle);
                    if (readable && below(3) == 0) pass.read(name + " again", handle);
                    break;
                case 1: handle = pass.write(name, handle); break;
                case 2:
                    if (readable) handle = pass.modify(name, handle);
                    break;
                default: break;
            }
        }
    }
};

/// Independent of compile(): the passes needed, as the smallest set closed under the rules of README.md.
std::vector<bool> needed_passes(const FrameGraph& graph)
{
    const auto& passes = graph.passes();
    const auto writes = [](const PassData& pass, uint32_t resource) {
        return std::any_of(pass.bindings.begin(), pass.bindings.end(),
                           [&](const Binding& binding) { return binding.writes && binding.resource == resource; });
    };
    std::vector<bool> needed(passes.size());
    for (bool grows = true; grows;) {
        grows = false;
        for (size_t i = 0; i < passes.size(); ++i) {
            bool now = passes[i].kind == PassData::Kind::read_back;
            for (const Binding& binding : passes[i].bindings)
                now = now || (binding.writes && graph.resources()[binding.resource].imported);
            for (size_t later = i + 1; later < passes.size(); ++later)
                for (const Binding& use : passes[later].bindings)
                    now = now || (needed[later] && writes(passes[i], use.resource));
            if (now && !needed[i]) needed[i] = grows = true;
        }
    }
    return needed;
}

/// No two resources of a pass have the same memory.
bool is_apart(const PassData& pass, const CompiledGraph& compiled)
{
    for (const Binding& a : pass.bindings)
        for (const Binding& b : pass.bindings)
            if (a.resource != b.resource && compiled.memory_of[a.resource] == compiled.memory_of[b.resource])
                return false;
    return true;
}

/// Compiles `frames` consecutive frames and lists the device's work.
std::vector<Event> run_frames(Generator& generator, uint32_t frames)
{
    std::vector<Event> events;
    for (uint32_t i = 0; i < Generator::IMPORTS; ++i) events.push_back(anything_in_flight(i));
    for (uint32_t frame = 0; frame < frames; ++frame) {
        const FrameGraph graph = generator.frame();
        const CompiledGraph compiled = graph.compile();
        // An executor gives a frame memory that no frame in flight uses. In the frame, transients share it.
        const uint64_t first_transient = (frame + 1) * 1000;
        const std::vector<bool> needed = needed_passes(graph);
        std::vector<bool> alive(needed.size());
        for (const Step& step : compiled.steps) alive[step.pass] = true;
        REQUIRE(alive == needed);

        for (const Step& step : compiled.steps) {
            Event event{.barrier = step.barrier};
            const PassData& pass = graph.passes()[step.pass];
            const Stages stage = pass.kind == PassData::Kind::compute ? STAGE_COMPUTE : STAGE_TRANSFER;
            REQUIRE(is_apart(pass, compiled));
            for (const Binding& binding : pass.bindings) {
                const bool imported = graph.resources()[binding.resource].imported;
                const uint32_t memory = compiled.memory_of[binding.resource];
                REQUIRE((imported ? memory == binding.resource : memory >= Generator::IMPORTS));
                const uint64_t object = imported ? memory : first_transient + memory;
                event.accesses.push_back({object, stage, binding.writes, false});
            }
            events.push_back(event);
        }
        for (uint32_t i = 0; i < Generator::IMPORTS; ++i)
            if (compiled.used[i]) generator.states[i] = compiled.final_states[i];
    }
    return events;
}

}  // namespace

TEST_CASE("the checker of hazards finds a hazard in each simple graph without its barrier")
{
    const Access write{1, STAGE_COMPUTE, true}, read{1, STAGE_COMPUTE, false}, fill{1, STAGE_TRANSFER, true};
    const Barrier memory{STAGE_COMPUTE, STAGE_COMPUTE, true}, order{STAGE_COMPUTE, STAGE_COMPUTE, false};
    const Barrier to_transfer{STAGE_COMPUTE, STAGE_TRANSFER, true}, from_transfer{STAGE_TRANSFER, STAGE_COMPUTE, true};
    CHECK(count_hazards({{{}, {read}}, {{}, {read}}}) == 0);
    CHECK(count_hazards({{{}, {write}}, {{}, {read}}}) == 1);
    CHECK(count_hazards({{{}, {write}}, {order, {read}}}) == 1);
    CHECK(count_hazards({{{}, {write}}, {to_transfer, {read}}}) == 1);
    CHECK(count_hazards({{{}, {write}}, {memory, {read}}}) == 0);
    CHECK(count_hazards({{{}, {read}}, {{}, {write}}}) == 1);
    CHECK(count_hazards({{{}, {read}}, {order, {write}}}) == 0);
    CHECK(count_hazards({{{}, {write}}, {to_transfer, {fill}}, {from_transfer, {read}}}) == 0);
    CHECK(count_hazards({{{}, {write}}, {order, {}}, {from_transfer, {read}}}) == 1);
}

TEST_CASE("no hazard is left in random sequences of frames")
{
    const uint32_t seeds = repeats(600, 3000);
    for (uint32_t seed = 0; seed < seeds; ++seed) {
        CAPTURE(seed);
        Generator generator(seed, seed % 4 == 0);
        REQUIRE(count_hazards(run_frames(generator, 1 + seed % 3)) == 0);
    }
}

TEST_CASE("among compute passes, leaving out any barrier of random frames leaves a hazard")
{
    const uint32_t seeds = repeats(400, 2000);
    for (uint32_t seed = 0; seed < seeds; ++seed) {
        CAPTURE(seed);
        Generator generator(seed, true);
        std::vector<Event> events = run_frames(generator, 1);
        for (Event& event : events) {
            if (!event.barrier) continue;
            const std::optional<Barrier> barrier = std::exchange(event.barrier, std::nullopt);
            REQUIRE(count_hazards(events) > 0);
            event.barrier = barrier;
        }
    }
}

TEST_CASE("with copies among the passes, few barriers could be left out")
{
    size_t barriers = 0, spare = 0;
    const uint32_t seeds = repeats(300, 1000);
    for (uint32_t seed = 0; seed < seeds; ++seed) {
        Generator generator(seed, false);
        std::vector<Event> events = run_frames(generator, 1 + seed % 3);
        for (Event& event : events) {
            if (!event.barrier) continue;
            const std::optional<Barrier> barrier = std::exchange(event.barrier, std::nullopt);
            ++barriers;
            spare += count_hazards(events) == 0;
            event.barrier = barrier;
        }
    }
    MESSAGE(spare << " of " << barriers << " barriers could be left out");
    CHECK(spare * 20 <= barriers);
}
