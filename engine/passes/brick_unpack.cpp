#include "engine/passes/brick_unpack.h"

namespace shvr {

Resource brick_unpack(FrameGraph& graph, Resource staged, Resource atlas, AtlasCodes codes, bool by_address,
                      Resource cell_ranges, std::span<const gpu::BrickUnpackJob> jobs)
{
    Pass pass =
        graph.compute("brick_unpack", {{"FILTERED", codes == AtlasCodes::filtered}, {"BY_ADDRESS", by_address}});
    if (codes != AtlasCodes::filtered) pass.constant("CODE_BYTES", code_bytes(codes));
    pass.read("staged", staged);
    pass.block("jobs", jobs);
    pass.dispatch({gpu::UNPACK_THREADS, gpu::BRICK_TEXELS, uint32_t(jobs.size())});
    static_cast<void>(pass.write("atlas", atlas));
    return pass.write("cell_ranges", cell_ranges);
}

}  // namespace shvr
