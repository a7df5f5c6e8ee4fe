#pragma once
// Parts of a picture compared with the picture drawn whole.

#include <cstring>

#include "engine/picture/frame.h"
#include "tests/support/gpu.h"

namespace shvr::test {

/// Counts the rows of the part `begin` ... `end` whose bits differ from those of `whole`.
inline size_t differing_rows(Renderer& renderer, const Session& session, const Camera& camera, const ImageF& whole,
                             const glm::uvec2& begin, const glm::uvec2& end, const std::optional<ProbeLook>& probe = {})
{
    FrameGraph graph;
    const glm::uvec2 size = session.render.size, extent = end - begin;
    const Resource target = graph.create("part", picture_desc(Format::rgba32_float, extent));
    graph.read_back(draw(graph, renderer.scene(), session.look(), camera,
                         {.pixels = size, .begin = begin, .end = end, .probe = probe}, target)
                        .target);
    const gpu::FrameResult result = renderer.executor().run(std::move(graph));
    size_t different = 0;
    for (uint32_t y = 0; y < extent.y; ++y)
        different += std::memcmp(result.read_backs[0].data() + size_t(y) * extent.x * 16,
                                 whole.rgba.data() + 4 * (size_t(begin.y + y) * size.x + begin.x), extent.x * 16) != 0;
    return different;
}

}  // namespace shvr::test
