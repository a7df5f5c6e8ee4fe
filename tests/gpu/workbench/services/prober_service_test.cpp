// The prober alone: where each action puts the probe, and what follows it.

#include <doctest/doctest.h>

#include "engine/workbench/services/prober.h"
#include "tests/gpu/workbench/services/desk_with_scan.h"

using namespace shvr;
using namespace shvr::test;
using namespace shvr::ui;

namespace {

struct ProberAlone : DeskWithScan {
    std::optional<glm::dvec3> seen, near;
    Prober prober{desk,
                  {.pane = [this](size_t index) { return pane(index); },
                   .seen_at = [this](const Pane&, const glm::dvec2&) { return seen; },
                   .seen_near = [this](const Pane&, const glm::dvec2&, double, double) { return near; },
                   .extend_stroke = notes("extend_stroke"),
                   .note_edit = notes("note_edit"),
                   .note_to_keep = notes("note_to_keep")}};
    glm::dvec3 probe() { return document().touch.probe(); }
};

}  // namespace

TEST_CASE_FIXTURE(ProberAlone, "prober: a moved probe is kept and extends the stroke; without a place it stays")
{
    const glm::dvec3 before = probe();
    prober.act(ProbeOnto{.pane = 0, .pixel = {3.0, 4.0}});
    CHECK(probe() == before);
    CHECK(says("the probe stays where it is"));
    CHECK(take_calls().empty());
    seen = glm::dvec3(10.0, 11.0, 12.0);
    prober.act(ProbeOnto{.pane = 0, .pixel = {3.0, 4.0}});
    CHECK(probe() == *seen);
    CHECK(take_calls() == "note_to_keep extend_stroke");
    prober.act(PlaceProbe{glm::dvec3(5.0, 6.0, 7.0)});
    CHECK(prober.model().probe_voxel == glm::dvec3(5.0, 6.0, 7.0));
}

TEST_CASE_FIXTURE(ProberAlone, "prober: along a surface, an open stroke looks near its depth, and a jump lifts it")
{
    seen = glm::dvec3(10.0, 11.0, 12.0);
    near = glm::dvec3(20.0, 19.0, 16.0);
    prober.act(ProbeAlong{.pane = 0, .pixel = {3.0, 4.0}});
    CHECK(probe() == *seen);
    document().annotator.begin_stroke(document().stroke());
    prober.act(ProbeAlong{.pane = 0, .pixel = {3.0, 4.0}});
    CHECK(probe() == *near);
    prober.act(ProbeAlong{.pane = 0, .pixel = {3.0, 4.0}, .jumps = true});
    CHECK(probe() == *seen);
    document().annotator.end_stroke();
}

TEST_CASE_FIXTURE(ProberAlone, "prober: pushing goes along the view, and the radius keeps within its limits")
{
    const glm::dvec3 before = probe();
    prober.act(PushProbe{.voxels = 2.0});
    const glm::dvec3 moved = probe() - before;
    CHECK(glm::dot(moved, axes_of(document().camera).forward) > 1.9);
    take_calls();
    prober.act(ScaleProbe{1e9});
    CHECK(take_calls() == "note_edit");
    CHECK(document().session.probe.brush.radius_voxels == MAX_RADIUS_VOXELS);
    prober.act(ScaleProbe{1e-9});
    CHECK(document().session.probe.brush.radius_voxels == MIN_RADIUS_VOXELS);
}

TEST_CASE_FIXTURE(ProberAlone, "prober: slices stay where they are below a pointer that hovers, and follow all else")
{
    document().session.view.arrangement = Arrangement::slices;
    const auto cross = [&] { return document().session.view.slices.cross; };
    const glm::dvec3 first = document().probe_voxel();
    prober.act(ProbeTo{.pane = 0, .pixel = {3.0, 4.0}, .hovers = true});
    CHECK(cross() == first);
    seen = glm::dvec3(10.0, 11.0, 12.0);
    prober.act(ProbeAlong{.pane = 0, .pixel = {3.0, 4.0}, .hovers = true});
    CHECK(document().probe_voxel() == *seen);
    CHECK(cross() == first);
    // In a slice the probe comes into its plane, whatever its depth was.
    prober.act(ProbeTo{.pane = 1, .pixel = {10.0, 10.0}, .hovers = true});
    CHECK(document().probe_voxel().z == doctest::Approx(first.z));
    CHECK(document().probe_voxel().x != doctest::Approx(first.x));
    // A step of the wheel moves the slice by one voxel and leaves the others.
    prober.act(PushProbe{.pane = 1, .voxels = 1.0});
    CHECK(std::abs(cross()->z - first.z) == doctest::Approx(1.0));
    CHECK(cross()->x == doctest::Approx(first.x));
    CHECK(document().probe_voxel().z == doctest::Approx(cross()->z));
    prober.act(ProbeTo{.pane = 1, .pixel = {12.0, 10.0}});
    CHECK(!cross());
    // A script's placement leads the slices as it always has, and outside of slices nothing holds them.
    prober.act(PlaceProbe{.voxel = glm::dvec3(5.0, 6.0, 7.0), .hovers = true});
    CHECK(cross());
    prober.act(PlaceProbe{.voxel = glm::dvec3(5.0, 6.0, 8.0)});
    CHECK(!cross());
    document().session.view.arrangement = Arrangement::single;
    prober.act(ProbeTo{.pane = 0, .pixel = {3.0, 4.0}, .hovers = true});
    CHECK(!cross());
}
