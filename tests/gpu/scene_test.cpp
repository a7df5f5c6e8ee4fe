// A loaded volume and its data on the device: it reports every kind of change, and is replaced as a whole.

#include <algorithm>

#include <doctest/doctest.h>

#include "engine/live/annotator.h"
#include "tests/support/gpu.h"

using namespace shvr;
using namespace shvr::test;

namespace {

const glm::ivec3 SIZE{70, 40, 40};

Camera from_the_front(const TestVolume& volume)
{
    return camera_along(volume, {0, 0, 1}, 60.0);
}

/// The box of voxels changed for one reason; empty if none.
VoxelBox changed_by(Scene& scene, Scene::Cause cause)
{
    std::optional<VoxelBox> box;
    for (const Scene::Changed& changed : scene.take_changed()) {
        CHECK(changed.cause == cause);
        box = box ? united(*box, changed.voxels) : changed.voxels;
    }
    CHECK(!scene.has_changed());
    return box.value_or(VoxelBox{});
}

/// A source that fails when voxels are read.
class Torn final : public VolumeSource {
public:
    explicit Torn(const TestVolume& volume) : VolumeSource(volume.info()) {}

    void read(const VoxelBox& /*box*/, std::span<std::byte> /*voxels*/) const override { fail("torn voxels"); }
};

}  // namespace

TEST_CASE_FIXTURE(OnDevice,
                  "paint, offsets and the trace come to the device with their command, and go with its undoing")
{
    load(constant_volume(SIZE, 20000.0));
    Session session = plain_session({{0.0, RED, 0.0}, {65535.0, RED, 0.1}}, {60, 60});
    session.groups[1] = {.color = GREEN, .opacity = 0.5};
    const Camera camera = from_the_front(volume());
    Annotator annotator(renderer());
    Scene& scene = renderer().scene();
    scene.show_surfaces({}, annotator.document().trace, session.groups);
    static_cast<void>(scene.take_changed());
    const ImageF before = draw(session, camera);

    SUBCASE("paint")
    {
        annotator.paint({.brush = Brush::fill, .group = 1, .radius_voxels = 4.0, .path = {{40, 20, 20}}});
        // Its brick, and a voxel around it, where borders of groups may be smooth.
        const VoxelBox expected{{31, 0, 0}, glm::min(Size3(65, 33, 33), Size3(SIZE))};
        CHECK((changed_by(scene, Scene::Cause::edit) == expected));
    }
    SUBCASE("paint by hand, of which the brush knows where it was")
    {
        annotator.begin_stroke({.brush = Brush::fill, .group = 1, .radius_voxels = 4.0});
        annotator.extend_stroke({40, 20, 20});
        annotator.end_stroke();
        while (annotator.stroke_is_running()) static_cast<void>(annotator.advance());
        const VoxelBox changed = changed_by(scene, Scene::Cause::edit);
        CHECK(glm::all(glm::greaterThanEqual(changed.lower, Size3(35, 15, 15))));
        CHECK(glm::all(glm::lessThanEqual(changed.upper, Size3(46, 26, 26))));
        CHECK(glm::all(glm::lessThan(changed.lower, changed.upper)));
    }
    SUBCASE("offsets")
    {
        annotator.paint({.brush = Brush::fill,
                         .radius_voxels = 4.0,
                         .path = {{40, 20, 20}},
                         .density = DensityBrush{.offset = 30000.0},
                         .paints_group = false});
        const VoxelBox changed = changed_by(scene, Scene::Cause::edit);
        CHECK(glm::all(glm::lessThanEqual(changed.lower, Size3(36, 16, 16))));
        CHECK(glm::all(glm::greaterThanEqual(changed.upper, Size3(45, 25, 25))));
    }
    SUBCASE("the trace")
    {
        annotator.edit_trace("node",
                             {TraceNodeChange{0, {}, TraceNode{.position = {40, 20, 20}, .radius = 5.0, .group = 1}}});
        const VoxelBox changed = changed_by(scene, Scene::Cause::edit);
        CHECK(glm::all(glm::lessThanEqual(changed.lower, Size3(35, 15, 15))));
        CHECK(glm::all(glm::greaterThanEqual(changed.upper, Size3(45, 25, 25))));
    }
    CHECK(different_bits(draw(session, camera), before) > 0);
    REQUIRE(annotator.undo() != nullptr);
    CHECK(changed_by(scene, Scene::Cause::edit) != VoxelBox{});
    CHECK(different_bits(draw(session, camera), before) == 0);
}

TEST_CASE_FIXTURE(OnDevice, "a volume that cannot be loaded leaves the one before as it was, with its paint")
{
    load(constant_volume(SIZE, 20000.0));
    Session session = plain_session({{0.0, RED, 0.0}, {65535.0, RED, 0.1}}, {60, 60});
    session.groups[1] = {.color = GREEN, .opacity = 0.5};
    const Camera camera = from_the_front(volume());
    Annotator annotator(renderer());
    annotator.paint({.brush = Brush::fill, .group = 1, .radius_voxels = 4.0, .path = {{40, 20, 20}}});
    const ImageF before = draw(session, camera);
    const TestVolume other = constant_volume({40, 40, 40}, 1.0);
    CHECK_THROWS_WITH_AS(renderer().load(std::make_shared<Torn>(other), {}), "torn voxels", Error);
    CHECK(different_bits(draw(session, camera), before) == 0);
    RenderSettings impossible;
    impossible.sampling = Sampling::hardware;
    if (!renderer().device().traits().linear_r16)
        CHECK_THROWS_AS(renderer().load(source_of(other), {}, impossible), Error);
    CHECK(different_bits(draw(session, camera), before) == 0);
}

TEST_CASE_FIXTURE(OnDevice, "changes that nobody takes do not pile up, and none of them is forgotten")
{
    load(constant_volume(SIZE, 20000.0));
    Annotator annotator(renderer());
    Scene& scene = renderer().scene();
    static_cast<void>(scene.take_changed());
    const std::vector<int64_t> bricks{0, 2};
    for (int turn = 0; turn < 5000; ++turn) scene.update_mask(annotator.document().mask, bricks);
    const std::vector<Scene::Changed> changed = scene.take_changed();
    CHECK(changed.size() < 4096);
    for (const int64_t x : {0, 69})
        CHECK(std::ranges::any_of(
            changed, [&](const Scene::Changed& one) { return one.voxels.lower.x <= x && x < one.voxels.upper.x; }));
}
