// Paged bricks: pictures equal those of resident volumes, bit for bit, whatever the budget; nothing is loaded twice;
// unreadable bricks are reported.

#include <doctest/doctest.h>

#include "engine/base/image_metrics.h"
#include "engine/live/annotator.h"
#include "engine/volume/levels/pyramid_source.h"
#include "shaders/counters.h"
#include "tests/gpu/paging/paged_scenes.h"
#include "tests/support/slow.h"

using namespace shvr;
using namespace shvr::test;

TEST_CASE("paged pictures of the finest level equal resident ones bit for bit")
{
    const Source source = tubes({150, 131, 170});
    Camera inside = camera_looking("front", source->info());
    inside.eye = glm::dvec3(70.0, 20.0, 80.0);
    Camera parallel = camera_looking("left", source->info());
    parallel.projection = Camera::Projection::orthographic;
    Budgeted all;
    for (const double opacity : {0.02, 1.0})
        for (const bool shaded : {false, true}) {
            size_t number = size_t(opacity < 1.0) + size_t(shaded);
            for (const Camera& camera : {camera_looking("front", source->info()), inside, parallel}) {
                // The everyday half has every pair of opacity, light and camera.
                if (const bool is_everyday = number++ % 2 == 0; !is_everyday && !is_slow()) continue;
                Session session = session_of(opacity, shaded);
                session.render.preintegration = shaded == (opacity < 1.0);
                const Picture expected = all.picture(source, session, Paging::never, camera);
                const Picture seen = all.picture(source, session, Paging::always, camera);
                CHECK(seen.complete);
                CAPTURE(opacity);
                CAPTURE(shaded);
                check_below("differing bits", double(different_bits(seen.image, expected.image)), 0.0);
                Session patient = session;
                patient.render.skip_empty_space = false;
                CHECK(different_bits(all.picture(source, patient, Paging::always, camera).image, expected.image) == 0);
            }
        }
}

TEST_CASE("pictures are the same at every budget, and the budget holds")
{
    // 1000 bricks of the finest level: 80 MB; the small budget holds only a part.
    const Source source = tubes({320, 320, 320});
    for (const double detail : {0.0, 1.0}) {
        Session session = session_of(0.05, true);
        session.render.detail = detail;
        session.render.size = {128, 128};
        const Camera camera = camera_looking("right", source->info());
        Budgeted unlimited;
        const Picture expected = unlimited.picture(source, session, Paging::always, camera);
        CHECK(expected.complete);
        if (detail == 0.0)
            CHECK(different_bits(unlimited.picture(source, session, Paging::never, camera).image, expected.image) == 0);
        for (const uint64_t mib : {24, 64, 256}) {
            // The smallest evicts most; each of the others is tried with one of the details every day.
            if (!is_slow() && mib == (detail == 0.0 ? 64 : 256)) continue;
            Budgeted small(mib, mib);
            const Picture seen = small.picture(source, session, Paging::always, camera);
            CAPTURE(mib);
            CHECK(seen.complete);
            check_below("differing bits", double(different_bits(seen.image, expected.image)), 0.0);
            CHECK(small.renderer.memory().peak_device_bytes() <= mib << 20);
            CHECK(small.renderer.peak_host_bytes() <= mib << 20);
            MESSAGE(detail, " voxels per pixel, ", mib, " MiB: ", small.counts().slots, " slots, ",
                    small.counts().uploads, " uploads, ", small.counts().evictions, " evictions");
        }
    }
}

TEST_CASE("only bricks that rays visit are loaded, each once")
{
    const Source source = tubes({256, 256, 256});
    // Opaque from the first voxel on: only the near faces are visible.
    Session session = session_of(1.0, false);
    session.transfer_function = TransferFunction({{0.0, WHITE, 1.0}, {255.0, WHITE, 1.0}});
    const Camera camera = camera_looking("front", source->info());
    Budgeted all;
    const Picture first = all.picture(source, session, Paging::always, camera);
    CHECK(first.complete);
    const DeviceVolume::Counts counts = all.counts();
    CHECK(counts.leaves == 512);
    CHECK(counts.reached <= 64 + 2 * 8);  // the face, and the sides visible in perspective
    // Coarser levels of 64 bricks or fewer are always on the device: 64 + 8 + 1.
    CHECK(counts.uploads <= counts.reached + 73);
    for (int i = 0; i < 3; ++i) CHECK(different_bits(all.renderer.render(session, camera).image, first.image) == 0);
    CHECK(all.counts().uploads == counts.uploads);
    CHECK(all.counts().store.loads == counts.store.loads);
}

TEST_CASE("a view of paged bricks comes to rest on the direct picture and then does nothing")
{
    const Source source = tubes({200, 180, 220});
    const Session session = session_of(0.1, true);
    const Camera camera = camera_looking("left", source->info());
    Budgeted direct, seen;
    const Picture expected = direct.picture(source, session, Paging::never, camera);
    seen.load(source, session, Paging::always);
    View view(seen.renderer);
    view.look(session, camera, session.render.size);
    view.advance();
    settle(view);
    const Image8 shown = view.read_back();
    const Image8 wanted = to_image8(expected.image);
    size_t different = 0;
    for (size_t i = 0; i < shown.rgba.size(); ++i) different += std::abs(int(shown.rgba[i]) - int(wanted.rgba[i])) > 1;
    CHECK(different == 0);

    const DeviceVolume::Counts counts = seen.counts();
    CHECK(counts.evictions == 0);
    CHECK(counts.uploads <= counts.store.loads);
    const uint64_t submissions = view.submissions();
    for (int i = 0; i < 100; ++i) view.advance();
    CHECK(view.submissions() == submissions);
    CHECK(seen.counts().store.loads == counts.store.loads);
}

TEST_CASE("what lies around the probe is loaded before what is seen, where it takes little room")
{
    const Source source = tubes({200, 180, 220});
    const Session session = session_of(0.1, true);
    Budgeted device;
    device.load(source, session, Paging::always);
    DeviceVolume& volume = device.renderer.volume();
    const VoxelBox around{{90, 90, 90}, {100, 100, 100}};
    volume.prefer(around);
    CHECK(volume.advance(true).size() >= 8);  // two bricks along each axis, and coarse levels
    const std::optional<RegionBricks> bricks = volume.region(around, false);
    REQUIRE(bricks.has_value());
    CHECK(bricks->slots.size() == 8);
    // All of level 0 is too much to prefer: the earlier request stays.
    volume.prefer({Size3(0), source->info().size});
    static_cast<void>(volume.advance(true));
    CHECK(volume.counts()->resident < 100);
}

TEST_CASE("what is painted is the same on paged bricks, and is seen the same")
{
    const Source source = tubes({150, 131, 170});
    const Session session = session_of(0.3, true);
    const Camera camera = camera_looking("front", source->info());
    const std::vector<PaintOp> ops{
        {.brush = Brush::fill,
         .group = 3,
         .threshold = 30.0,
         .radius_voxels = 9.0,
         .path = {{20, 60, 80}, {120, 70, 90}}},
        {.brush = Brush::flood, .group = 5, .threshold = 35.0, .radius_voxels = 20.0, .path = {{70, 60, 80}}},
        {.brush = Brush::speckle, .group = 7, .threshold = 45.0, .radius_voxels = 15.0, .path = {{40, 50, 60}}}};
    std::vector<Picture> pictures;
    std::vector<std::array<int64_t, 256>> voxels;
    for (const Paging paging : {Paging::never, Paging::always}) {
        Budgeted device(paging == Paging::always ? 24 : 0);
        device.load(source, session, paging);
        Annotator annotator(device.renderer);
        for (const PaintOp& op : ops) annotator.paint(op);
        voxels.push_back(annotator.document().mask.voxels_by_group());
        pictures.push_back(device.renderer.render(session, camera));
        CHECK(annotator.undo() != nullptr);
        CHECK(annotator.undo() != nullptr);
        pictures.push_back(device.renderer.render(session, camera));
    }
    CHECK(voxels[0][3] > 0);
    CHECK(voxels[0] == voxels[1]);
    CHECK(different_bits(pictures[0].image, pictures[2].image) == 0);
    CHECK(different_bits(pictures[1].image, pictures[3].image) == 0);
    CHECK(different_bits(pictures[0].image, pictures[1].image) > 0);
}

TEST_CASE("bricks that cannot be read are named once, drawn from coarser ones, and stop nothing")
{
    const Source source = std::make_shared<Broken>(with_levels(tubes({150, 131, 170}), uint64_t{4} << 30));
    const Session session = session_of(0.1, true);
    Budgeted device;
    const Picture seen = device.picture(source, session, Paging::always, camera_looking("front", source->info()));
    CHECK(!seen.complete);
    REQUIRE(seen.warnings.size() == 1);
    CHECK(seen.warnings[0] == "chunk 0.0.0: is torn");
    CHECK(device.renderer.volume().missing() > 0);
    // Work on such a brick is refused with the same message.
    Annotator annotator(device.renderer);
    CHECK_THROWS_WITH(annotator.paint({.group = 1, .threshold = 0.0, .radius_voxels = 3.0, .path = {{10, 60, 60}}}),
                      doctest::Contains("torn"));
    // A hand's stroke there ends with the same message, and does not wait forever.
    annotator.begin_stroke({.group = 1, .threshold = 0.0, .radius_voxels = 3.0});
    annotator.extend_stroke({10, 60, 60});
    annotator.end_stroke();
    const auto finish = [&] {
        for (int i = 0; annotator.stroke_is_running(); ++i) {
            REQUIRE(i < 10'000);
            static_cast<void>(annotator.advance());
            static_cast<void>(device.renderer.volume().advance(true));
        }
    };
    CHECK_THROWS_WITH(finish(), doctest::Contains("torn"));
    CHECK(!annotator.stroke_is_running());
}

TEST_CASE("65536^3 voxels: a picture of the whole, and of voxels in its far corner")
{
    const Source source = open_procedural({.kind = "sphere", .size = Size3(65536)});
    CHECK(source->levels() == 12);
    const VolumeStatistics statistics = measure(*source);
    Session session = session_of(0.2, true);
    session.render.detail = 1.0;
    session.render.size = {96, 96};
    session.transfer_function = TransferFunction({{100.0, RED, 0.0}, {130.0, RED, 0.3}, {250.0, WHITE, 0.3}});
    Budgeted device(64, 64);
    device.renderer.load(source, statistics, session.render);
    const Picture whole = device.renderer.render(session, camera_looking("front", source->info()));
    CHECK(whole.complete);

    // The same sphere in 512^3 voxels, of the same level: the picture differs only in the step's length in voxels.
    const Source small = open_procedural({.kind = "sphere", .size = Size3(512)});
    const int level = device.renderer.volume().finest_level();
    Session same = session;
    same.render.step_voxels = std::ldexp(session.render.step_voxels, level - 7);
    // Opacities are per reference length, and a ray is 128 times as many of them long.
    CHECK(level >= 7);
    CHECK(device.renderer.memory().peak_device_bytes() <= uint64_t{64} << 20);
    CHECK(device.counts().resident <= device.counts().slots);

    // Level 0 in the corner: a camera 40 voxels before the last voxel looks at voxels beyond any 32-bit count.
    Camera corner = camera_looking("right", source->info());
    corner.projection = Camera::Projection::orthographic;
    const glm::dvec3 end(65536.0);
    corner.target = end - glm::dvec3(16.0);
    corner.eye = corner.target + glm::dvec3(4.0, 0.0, 0.0);
    corner.height = 24.0;
    corner.far_distance = 20.0;
    session.transfer_function = TransferFunction({{-1.0, GREEN, 0.05}, {250.0, GREEN, 0.05}});
    const Picture near = device.renderer.render(session, corner);
    CHECK(near.complete);
    CHECK(device.renderer.volume().finest_level() == 0);
    // Everything there is the sphere's outside: 20 voxels of one density, 0.05 opacity each.
    const double through = std::pow(1.0 - 0.05, 20.0);
    const Pixels pixels = pixels_of(near.image);
    for (const size_t at : {size_t{0}, pixels.size() / 2, pixels.size() - 1}) {
        CHECK(pixels[at].x == doctest::Approx((1.0 - through) * GREEN.x * 1.0 + through).epsilon(0.02));
        CHECK(pixels[at].w == doctest::Approx(1.0));
    }
}

TEST_CASE("work and bricks follow the picture, not the volume")
{
    std::vector<uint64_t> samples, wanted;
    for (const int64_t side : {256, 512, 1024, 2048, 4096}) {
        int levels = 1;
        while (side >> levels >= 32) ++levels;
        const Source source = open_procedural({.kind = "sphere", .size = Size3(side), .levels = levels});
        Session session = session_of(0.05, true);
        session.render.detail = 1.0;
        session.render.size = {128, 128};
        session.render.paging = Paging::always;
        // Opacities are per voxel of the finest level: the same transparency at every size.
        const double opacity = 0.2 * 256.0 / double(side);
        session.transfer_function =
            TransferFunction({{100.0, RED, 0.0}, {130.0, RED, opacity}, {250.0, WHITE, opacity}});
        Budgeted device(64, 64);
        device.renderer.load(source, BYTES, session.render);
        const Picture picture =
            device.renderer.render(session, camera_looking("front", source->info()), {.count_work = true});
        CHECK(picture.complete);
        for (const gpu::PassReport& pass : picture.passes)
            if (pass.name == "raycast") samples.push_back(pass.counters[gpu::COUNTER_SAMPLES]);
        wanted.push_back(device.counts().reached);
        MESSAGE(side, "^3: ", samples.back(), " samples, ", wanted.back(), " bricks of level ",
                device.renderer.volume().finest_level(), " or coarser");
    }
    // Sides are powers of two, so every picture is made of bricks with the same share of the volume. Only the coarse
    // voxels' values at the surface differ.
    for (size_t i = 1; i < samples.size(); ++i) {
        CHECK(double(samples[i]) <= 1.1 * double(samples[0]));
        CHECK(double(wanted[i]) <= 1.1 * double(wanted[0]));
    }
}
