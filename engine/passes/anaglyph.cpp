#include "engine/passes/anaglyph.h"

namespace shvr {

Resource anaglyph(FrameGraph& graph, Resource left, Resource right, Resource color, const glm::uvec2& size,
                  const glm::uvec2& target)
{
    Pass pass = graph.compute("anaglyph");
    pass.read("left", left);
    pass.read("right", right);
    pass.push(glm::uvec4(size, target));
    pass.dispatch({size.x, size.y, 1});
    return pass.write("color", color);
}

}  // namespace shvr
