#include "engine/passes/mix.h"

namespace shvr {

Resource mix(FrameGraph& graph, Resource other, Resource color, const gpu::MixParams& params)
{
    Pass pass = graph.compute("mix");
    pass.read("other", other);
    pass.push(params);
    pass.dispatch({params.size.x, params.size.y, 1});
    return pass.modify("color", color);
}

}  // namespace shvr
