// Pictures where levels of detail meet.

#include <atomic>
#include <cmath>
#include <set>
#include <unordered_set>

#include <doctest/doctest.h>

#include "engine/base/image_metrics.h"
#include "tests/gpu/paging/paged_scenes.h"

using namespace shvr;
using namespace shvr::test;

TEST_CASE("an even medium is as opaque at every level of detail, and where levels meet")
{
    const auto source = std::make_shared<Plain>(Size3(256), 4);
    Session session = session_of(0.01, false);
    session.transfer_function = TransferFunction({{0.0, glm::dvec3(1.0), 0.01}, {255.0, glm::dvec3(1.0), 0.01}});
    session.render.background = glm::dvec4(0.0);
    session.render.size = {24, 24};
    Camera along = camera_looking("front", source->info());
    along.projection = Camera::Projection::orthographic;
    Camera near = camera_looking("front", source->info());
    near.eye = glm::dvec3(128.0, 10.0, 128.0);
    near.target = glm::dvec3(128.0, 200.0, 140.0);
    Budgeted all;
    const double depth = 256.0 * -std::log(0.99);
    const Picture finest = all.picture(source, session, Paging::always, near);
    std::set<uint64_t> loads;
    for (const double detail : {0.0, 2.0, 1.0, 0.5, 0.25}) {
        CAPTURE(detail);
        session.render.detail = detail;
        const ImageF slab = all.picture(source, session, Paging::always, along).image;
        loads.insert(all.counts().uploads);
        const size_t middle = 4 * (12 * 24 + 12) + 3;
        check_below("opacity of a slab", std::abs(double(slab.rgba[middle]) - (1.0 - std::exp(-depth))), 1e-4);
        const ImageF inside = all.picture(source, session, Paging::always, near).image;
        double worst = 0.0;
        for (size_t i = 0; i < inside.rgba.size(); ++i)
            worst = std::max(worst, std::abs(double(inside.rgba[i]) - double(finest.image.rgba[i])));
        check_below("opacity against the finest level's", worst, 1e-4);
    }
    CHECK(loads.size() >= 2);  // not of one level alone
}

TEST_CASE("pre-integrated steps have the same bits with and without leaps where levels meet")
{
    Budgeted all;
    Session session = session_of(0.3, true);
    session.transfer_function =
        TransferFunction({{70.0, glm::dvec3(0.8, 0.3, 0.1), 0.2}, {90.0, glm::dvec3(1.0), 0.4}});
    session.render.preintegration = true;
    session.render.step_voxels = 1.0;
    session.render.size = {60, 45};
    size_t coarser = 0;
    for (const char* kind : {"tubes", "speckles"}) {
        const Source source = open_procedural({.kind = kind, .size = Size3(192), .seed = 3});
        all.load(source, session, Paging::always);
        for (const glm::dvec3& target : {glm::dvec3(110, 190, 100), glm::dvec3(20, 150, 60), glm::dvec3(96, 60, 5)})
            for (const double detail : {0.5, 0.25}) {
                CAPTURE(std::string(kind));
                CAPTURE(detail);
                Camera camera = camera_looking("front", source->info());
                camera.eye = glm::dvec3(96.0, 10.0, 96.0);
                camera.target = target;
                session.render.detail = detail;
                const ImageF leaping = all.renderer.render(session, camera).image;
                session.render.skip_empty_space = false;
                CHECK(different_bits(all.renderer.render(session, camera).image, leaping) == 0);
                session.render.skip_empty_space = true;
                session.render.detail = 0.0;
                coarser += different_bits(all.renderer.render(session, camera).image, leaping);
            }
    }
    CHECK(coarser > 10000);  // levels differ
}

namespace {

/// The level at which the device draws a brick of level 0.
int drawn_level(const std::unordered_set<BrickKey, BrickKeyHash>& placed, BrickKey key)
{
    while (!placed.contains(key)) key = parent_of(key);
    return key.level;
}

/// The largest difference between the levels of neighbours along an axis.
int largest_step(const std::vector<DeviceVolume::Place>& places, const glm::ivec3& counts)
{
    std::unordered_set<BrickKey, BrickKeyHash> placed;
    for (const DeviceVolume::Place& place : places) placed.insert(place.key);
    int largest = 0;
    for (int z = 0; z < counts.z; ++z)
        for (int y = 0; y < counts.y; ++y)
            for (int x = 0; x < counts.x; ++x)
                for (int axis = 0; axis < 3; ++axis) {
                    glm::ivec3 next(x, y, z);
                    if (++next[axis] == counts[axis]) continue;
                    largest = std::max(largest,
                                       std::abs(drawn_level(placed, {0, {x, y, z}}) - drawn_level(placed, {0, next})));
                }
    return largest;
}

}  // namespace

namespace {

/// Holds back all reads but those of the coarsest level until it is opened.
class Closed final : public VolumeSource {
public:
    explicit Closed(Source source) : VolumeSource(source->info()), source_(std::move(source)) {}
    void open()
    {
        is_open_ = true;
        is_open_.notify_all();
    }
    void read(const VoxelBox& box, std::span<std::byte> voxels) const override { read_level(0, box, voxels); }
    int levels() const override { return source_->levels(); }
    void read_level(int level, const VoxelBox& box, std::span<std::byte> voxels) const override
    {
        if (level + 2 < levels()) is_open_.wait(false);
        source_->read_level(level, box, voxels);
    }

private:
    Source source_;
    std::atomic<bool> is_open_ = false;
};

}  // namespace

TEST_CASE("neighbours are at most a level apart while a picture refines")
{
    // 1024 bricks of level 0, 128 of level 1, and 16 and 2 of the coarser levels, which are always on the device.
    const auto source = std::make_shared<Closed>(std::make_shared<Plain>(Size3(512, 256, 256), 4));
    Session session = session_of(0.001, false);
    session.render.paging = Paging::always;
    Renderer renderer({.device = {.validation = true}, .threads = 1});
    renderer.load(source, BYTES, session.render);
    const std::shared_ptr<void> ends_open(nullptr, [&](void*) { source->open(); });
    const DeviceVolume& volume = renderer.volume();
    View view(renderer);
    view.look(session, camera_looking("front", source->info()), session.render.size);
    for (int i = 0; volume.counts()->reached < 1024; ++i) {
        nap(i);
        REQUIRE(i < 10'000'000);
        view.advance();
    }
    source->open();
    int largest = 0;
    for (int i = 0; !view.complete(); ++i) {
        nap(i);
        REQUIRE(i < 10'000'000);
        view.advance();
        largest = std::max(largest, largest_step(volume.places(), {16, 8, 8}));
    }
    CHECK(largest == 1);
    CHECK(volume.counts()->uploads == 1024 + 128 + 16 + 2);
}
