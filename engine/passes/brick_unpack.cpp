#include "engine/passes/brick_unpack.h"

namespace shvr {

Resource brick_unpack(FrameGraph& graph, Resource staged, Resource atlas, Resource cell_ranges, bool filtered,
                      std::span<const gpu::BrickUnpackJob> jobs)
{
    Pass pass = graph.compute("brick_unpack", {{"FILTERED", filtered}});
    pass.read("staged", staged);
    pass.block("jobs", jobs);
    pass.dispatch({gpu::UNPACK_THREADS, gpu::BRICK_TEXELS, uint32_t(jobs.size())});
    static_cast<void>(pass.write("atlas", atlas));
    return pass.write("cell_ranges", cell_ranges);
}

}  // namespace shvr
