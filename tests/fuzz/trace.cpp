// A trace: the first byte gives the format of the rest. A trace that opens is written in every format and read again.

#include <algorithm>

#include "engine/annotation/measures/measures.h"
#include "engine/annotation/trace/trace_file.h"
#include "tests/fuzz/support/attempt.h"
#include "tests/fuzz/support/input_folder.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size)
{
    using namespace shvr;
    using namespace shvr::fuzz;
    if (size < 1) return 0;
    const char* const names[] = {"a.graphml", "a.txt", "a.swc", "a.rsml"};
    const InputFolder& folder = input_folder();
    folder.clear();
    const auto file = folder.write(names[data[0] % 4], text_of({data + 1, size - 1}));
    accepts([&] {
        const TraceFile opened = load_trace(file, {});
        const TraceGraph& trace = opened.trace;
        const TraceSpace space = opened.space.value_or(TraceSpace{{4, 4, 4}, {1.0, 1.0, 1.0}, "um"});
        save_trace(folder.path() / "b.graphml", trace, space);
        expect(load_trace(folder.path() / "b.graphml", space).trace == trace, "a trace that GraphML does not keep");
        // Where physical positions are not too far away to be read.
        const bool is_near =
            glm::length(space.origin) < 1e12 && std::ranges::all_of(trace.nodes(), [](const auto& numbered) {
                return glm::length(numbered.second.position) < 1e12;
            });
        if (is_near && glm::length(space.spacing) < 1e12) {
            save_trace(folder.path() / "c.graphml", trace, space, Loops::refuse, Positions::physical);
            expect(load_trace(folder.path() / "c.graphml", space).trace == trace,
                   "a trace that GraphML does not keep in physical space");
        }
        save_trace(folder.path() / "b.txt", trace, space);
        const TraceGraph renumbered = load_trace(folder.path() / "b.txt", space).trace;
        expect(renumbered.nodes().size() == trace.nodes().size(), "a trace that the thesis's text does not keep");
        save_trace(folder.path() / "b.swc", trace, space, Loops::break_open);
        const TraceGraph tree = load_trace(folder.path() / "b.swc", space).trace;
        const Topology topology = topology_of(trace);
        expect(topology_of(tree) == Topology{topology.components, 0, 0}, "a trace whose trees SWC does not keep");
        save_trace(folder.path() / "b.rsml", trace, space, Loops::break_open);
        const TraceGraph roots = load_trace(folder.path() / "b.rsml", space).trace;
        expect(roots.nodes().size() == tree.nodes().size() && roots.internodes().size() == tree.internodes().size(),
               "a trace whose trees RSML does not keep");
        size_t internodes = 0;
        for (const SegmentMeasures& segment : measure(trace).segments) internodes += segment.internodes;
        expect(internodes == trace.internodes().size(), "an internode that belongs to no segment, or to two");
    });
    return 0;
}
