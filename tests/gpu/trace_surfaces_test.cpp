// The surfaces of a changing trace.

#include <random>

#include <doctest/doctest.h>

#include "engine/device/trace_surfaces.h"
#include "tests/support/gpu.h"

using namespace shvr;
using namespace shvr::test;

TEST_CASE_FIXTURE(OnDevice, "a trace that changed is drawn as one that always was so, to the bit")
{
    load(constant_volume({60, 60, 60}, 0.0));
    Session session = plain_session(uniform_points(glm::dvec3(1.0), 0.0), {70, 60});
    session.groups[2] = {.color = glm::dvec3(0.1, 0.9, 0.2)};
    session.groups[3] = {.visible = false};
    const Camera camera = camera_along(volume(), {3, 2, 1}, 60.0);
    std::mt19937 random(81);  // seed 81
    const auto below = [&](uint32_t end) { return uint32_t(random() % end); };
    const auto node = [&] {
        return TraceNode{
            .position = {below(60), below(60), below(60)}, .radius = 0.25 * below(5), .group = uint8_t(1 + below(3))};
    };
    TraceGraph trace;
    for (uint32_t i = 0; i < 4800; ++i) {  // pairs, with room between numbers
        trace.apply(TraceNodeChange{2 * i, {}, node()}, Direction::forwards);
        if (i % 2 == 1)
            trace.apply(TraceInternodeChange{i, {}, TraceInternode{2 * i - 2, 2 * i, uint8_t(1 + i % 3)}},
                        Direction::forwards);
    }
    for (uint32_t i = 0; i < 2400; ++i)
        if (!trace.internode_between(4 * i, (4 * i + 4) % 9600))
            trace.apply(TraceInternodeChange{5000 + i, {}, TraceInternode{4 * i, (4 * i + 4) % 9600, 1}},
                        Direction::forwards);
    const std::vector<SurfaceLook> of_session{{{30, 30, 30}, {30, 30, 30}, 3.0, 3.0, glm::dvec3(0.0, 0.0, 1.0)}};
    renderer().scene().show_surfaces(of_session, trace, session.groups);
    draw(session, camera);
    REQUIRE(renderer().scene().replace_surfaces({}, {}));  // enough of them to be patched

    const auto copied = [](const Picture& picture) {
        for (const gpu::PassReport& pass : picture.passes)
            if (pass.name == "upload surface list") return true;
        return false;
    };
    std::vector<std::pair<TraceGraph, Pixels>> patched;  // after several patches in a row
    std::vector<Change> done;
    for (int turn = 0; turn < 12; ++turn) {
        CAPTURE(turn);
        std::vector<Change> changes;
        const auto change = [&](const TraceChange& what) {
            trace.apply(what, Direction::forwards);
            changes.push_back(what);
        };
        if (turn % 4 == 3) {  // undo
            for (auto at = done.rbegin(); at != done.rend(); ++at)
                trace.apply(std::get<TraceChange>(*at), Direction::backwards);
            changes = done;
        } else {
            for (uint32_t i = 0; i < 8; ++i) {
                const uint32_t number = 2 * below(4800);
                change(TraceNodeChange{number, trace.node(number), node()});
                const uint32_t internode = 1 + 2 * below(2400);
                if (trace.internodes().contains(internode))
                    change(TraceInternodeChange{internode, trace.internode(internode), {}});
                const uint32_t added = 10000 + uint32_t(turn) * 8 + i;
                change(TraceNodeChange{added, {}, node()});
                change(TraceInternodeChange{added, {}, TraceInternode{added, number, 2}});
            }
            if (turn == 5) change(TraceSizeChange{2, {}, 0.5});
        }
        done = changes;
        renderer().scene().show_trace(trace, changes);
        const Picture picture = renderer().render(session, camera);
        CHECK(copied(picture));
        patched.emplace_back(trace, pixels_of(picture.image));
    }
    for (size_t turn = 0; turn < patched.size(); ++turn) {
        CAPTURE(turn);
        renderer().scene().show_surfaces(of_session, patched[turn].first, session.groups);
        CHECK(pixels_of(draw(session, camera)) == patched[turn].second);
    }
    CHECK(patched[0].second != patched[1].second);
}
