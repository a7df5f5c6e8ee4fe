#include "engine/passes/saturation.h"

namespace shvr {

Resource saturation(FrameGraph& graph, Resource color, const gpu::SaturationParams& params)
{
    Pass pass = graph.compute("saturation");
    pass.push(params);
    pass.dispatch({params.size.x, params.size.y, 1});
    return pass.modify("color", color);
}

}  // namespace shvr
