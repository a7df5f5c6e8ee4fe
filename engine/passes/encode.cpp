#include "engine/passes/encode.h"

namespace shvr {

Resource encode(FrameGraph& graph, Resource color, Resource display, const gpu::EncodeParams& params)
{
    Pass pass = graph.compute("encode");
    pass.read("color", color);
    pass.constant("ENLARGED", params.step != glm::vec2(1.0f));
    pass.push(params);
    pass.dispatch({params.size.x, params.size.y, 1});
    return pass.write("display", display);
}

}  // namespace shvr
