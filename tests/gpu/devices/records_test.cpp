// The engine on devices with other limits (tests/layers/records.h): views wider than 3-D images, and automatic budgets.

#include <functional>
#include <tuple>

#include <doctest/doctest.h>

#include "engine/base/image_metrics.h"
#include "engine/device/device_mask.h"
#include "engine/live/annotator.h"
#include "engine/live/view.h"
#include "engine/picture/picture_job.h"
#include "tests/gpu/devices/on_record.h"
#include "tests/support/nap.h"

using namespace shvr;
using namespace shvr::test;

namespace {

constexpr VolumeStatistics BYTES{.minimum = 0.0, .maximum = 255.0};
constexpr uint64_t MIB = uint64_t{1} << 20;

/// A mask with one painted voxel in each of the first `bricks` bricks.
Mask mask_of(size_t bricks)
{
    Mask mask({32 * 32, 32 * 32, 32});
    for (size_t i = 0; i < bricks; ++i)
        mask.apply({.brick = int64_t(i), .runs = {{.first = 5, .last = 5, .before = 0, .after = 3}}},
                   Direction::forwards);
    return mask;
}

}  // namespace

TEST_CASE("a view wider than a 3-D image of the device can be comes to rest on the picture of render")
{
    for (const char* record : {"amd", "intel", "minimum"}) {
        CAPTURE(std::string(record));
        On device(record);
        Session session = plain_session(busy_points(0.02), {2300, 24});
        const std::shared_ptr<const VolumeSource> source = open_procedural({.kind = "sphere", .size = {30, 30, 30}});
        device->load(source, BYTES, session.render);
        const Camera camera = camera_looking("front", source->info());
        View view(*device, {});
        view.look(session.look(), session.interaction, Shot(camera), session.render.size);
        for (int i = 0; !view.complete(); ++i) {
            nap(i);
            REQUIRE(i < 10'000'000);
            view.advance();
        }
        const Image8 rendered = to_image8(device->render(session, camera).image);
        CHECK(compare_pixels(view.read_back(), rendered).max_abs <= 1.0);
    }
}

TEST_CASE("times are right where a clock of 36 bits begins again")
{
    // The layer's clock does so 0.08 ms after its first stamp, and every ten minutes and more from then on.
    On intel("intel");
    REQUIRE(intel->device().traits().timestamp_bits == 36);
    double most_ms = 0.0;
    for (int frame = 0; frame < 5; ++frame) {
        FrameGraph graph;
        std::vector<Resource> filled;
        for (const uint32_t value : {1u, 2u, 3u}) {
            filled.push_back(graph.fill(graph.create(sentence("filled ", value), buffer_desc(8 << 20)), value,
                                        sentence("fill ", value)));
            static_cast<void>(graph.read_back(filled.back()));
        }
        const gpu::FrameResult result = intel->executor().run(std::move(graph));
        REQUIRE(result.passes.size() == 6);
        double last_ms = 0.0;
        for (const gpu::PassReport& pass : result.passes) {
            CHECK(pass.timed);
            CHECK(pass.start_ms >= last_ms);
            CHECK(pass.gpu_ms <= result.wall_ms + 0.3);
            CHECK(pass.start_ms + pass.gpu_ms <= result.wall_ms + 0.3);
            last_ms = pass.start_ms;
            most_ms = std::max(most_ms, pass.gpu_ms);
        }
        CHECK(result.gpu_ms <= result.wall_ms + 0.3);
    }
    CHECK(most_ms > 0.1);  // 8 MiB take longer than the clock needs to begin again
}

TEST_CASE("the automatic budget is what the device can spare")
{
    const std::pair<const char*, uint64_t> expected[] = {
        {"nvidia", 9 * 1024 * MIB},                // three quarters of its 12 GiB
        {"amd", 6 * 1024 * MIB},                   // of its 8 GiB, not of the 256 MiB that the host sees
        {"apu", uint64_t{7} * 1024 * MIB / 2},     // half of what it shares with the host, not of its own 8 MiB
        {"intel", uint64_t{12} * 1024 * MIB / 2},  // likewise
        {"minimum", 192 * MIB / 4 * 3}};
    for (const auto& [record, bytes] : expected) {
        CAPTURE(std::string(record));
        On device(record);
        CHECK(device->memory().device_budget() == bytes);
    }
    CHECK(gpu::automatic_device_bytes({.device_bytes = 400 * MIB}, 100 * MIB) == 100 * MIB);
    CHECK(gpu::automatic_device_bytes({.device_bytes = 400 * MIB}, std::nullopt) == 300 * MIB);
}

TEST_CASE("an integrated device takes memory of another heap where its own is full")
{
    On device("apu");
    std::vector<gpu::Storage> kept;
    for (int i = 0; i < 3; ++i) kept.push_back(device->memory().create("large", buffer_desc(6 * MIB)));
    CHECK(device->memory().device_bytes() >= 18 * MIB);
}

TEST_CASE("what kernels read often is in the device's own memory where the host can write there")
{
    // By the records' tables of types.
    const std::tuple<const char*, uint32_t, uint32_t> expected[] = {
        {"nvidia", 4, 2}, {"amd", 3, 2}, {"apu", 1, 1}, {"intel", 0, 0}, {"minimum", 1, 1}};
    for (const auto& [record, values, upload] : expected) {
        CAPTURE(std::string(record));
        On device(record);
        const VkPhysicalDeviceMemoryProperties& memory = device->device().memory_properties();
        CHECK(gpu::memory_types(memory, ~0u, gpu::Placement::values).front() == values);
        CHECK(gpu::memory_types(memory, ~0u, gpu::Placement::upload).front() == upload);
    }
}

TEST_CASE("a GPU computes the light of many bricks at once, to the bits of a few at a time")
{
    Session session = plain_session({{0.0, RED, 0.05}, {255.0, BLUE, 0.3}}, {64, 64});
    session.light.shaded = true;
    session.render.sampling = Sampling::exact;
    session.light.occlusion = {.strength = 0.9, .radius = 4.0, .rays = 2};
    // 125 bricks: more than a row of columns of them (shaders/occlusion/occlusion.h).
    const std::shared_ptr<const VolumeSource> source = open_procedural({.kind = "ramp", .size = {160, 160, 160}});
    const Camera camera = camera_looking("front", source->info());
    const auto drawn = [&](Renderer& renderer, int& slices) {
        renderer.load(source, BYTES, session.render, true);
        const Picture picture = renderer.render(session, camera);
        CHECK(picture.complete);
        CHECK(renderer.scene().occlusion().counts().values == 125);
        for (const gpu::PassReport& pass : picture.passes)
            if (pass.name == "occlusion_bake") slices = int(pass.tiles);
        return picture.image;
    };
    int few = 0, many = 0;
    Renderer plain({.device = {.validation = true}, .threads = 1});
    const ImageF expected = drawn(plain, few);
    On device("nvidia");
    CHECK(different_bits(drawn(*device, many), expected) == 0);
    CHECK(few == 8);
    CHECK(many == 1);
    // Paged bricks, too, may take more of a GPU's memory than of a CPU's, which all programs share.
    CHECK(Scene::most_atlas_bytes(plain.device().traits(), AtlasCodes::exact16, false) <= 2048 * MIB);
    CHECK(Scene::most_atlas_bytes(device->device().traits(), AtlasCodes::exact16, true) > 2048 * MIB);
}

TEST_CASE("a GPU unpacks bricks by kernels, all of a batch at once, to the bits of copies")
{
    Session session = plain_session({{0.0, RED, 0.05}, {255.0, BLUE, 0.3}}, {40, 30});
    session.light.shaded = true;
    const std::shared_ptr<const VolumeSource> source =
        open_procedural({.kind = "tubes", .size = {131, 100, 70}, .seed = 5});
    const Camera camera = camera_looking("front", source->info());
    for (const Sampling sampling : {Sampling::exact, Sampling::hardware})
        for (const Paging paging : {Paging::never, Paging::always}) {
            CAPTURE(int(sampling));
            CAPTURE(int(paging));
            session.render.sampling = sampling;
            session.render.paging = paging;
            const auto drawn = [&](Renderer& renderer) {
                renderer.load(source, BYTES, session.render);
                return renderer.render(session, camera).image;
            };
            Renderer plain({.device = {.validation = true}, .threads = 1});
            On device("nvidia");
            // The place in the texture that a filter is asked for differs with its size.
            const ImageF seen = drawn(*device), expected = drawn(plain);
            if (sampling == Sampling::exact)
                CHECK(different_bits(seen, expected) == 0);
            else
                CHECK(compare_pixels(to_image8(seen), to_image8(expected)).max_abs <= 1.0);
        }
}

TEST_CASE("a GPU draws the next part of a picture while one is taken, to the bits of one part after the other")
{
    Session session = plain_session({{0.0, RED, 0.05}, {255.0, BLUE, 0.3}}, {90, 70});
    const std::shared_ptr<const VolumeSource> source = open_procedural({.kind = "ramp", .size = {40, 40, 40}});
    const Camera camera = camera_looking("front", source->info());
    /// The picture, and what was drawn after each step.
    const auto drawn = [&](Renderer& renderer, std::vector<double>& progress) {
        renderer.load(source, BYTES, session.render);
        ImageF image{90, 0, {}};
        PictureJob job(renderer, session, camera, {.part_pixels = 32}, [&](const ImageF& rows) {
            image.height += rows.height;
            image.rgba.insert(image.rgba.end(), rows.rgba.begin(), rows.rgba.end());
        });
        while (!job.is_done()) {
            job.step();
            progress.push_back(job.progress());
        }
        CHECK(job.take().complete);
        return image;
    };
    std::vector<double> one, two;
    Renderer plain({.device = {.validation = true}, .threads = 1});
    const ImageF expected = drawn(plain, one);
    On device("nvidia");
    CHECK(different_bits(drawn(*device, two), expected) == 0);
    REQUIRE(one.size() == 9);
    REQUIRE(two.size() == 9);
    CHECK(one[1] > one[0]);
    CHECK(two[0] == one[0]);  // the first is waited for: it tells how the others are divided
    for (size_t step = 1; step + 1 < 9; ++step) CHECK(two[step] == one[step - 1]);
    CHECK(two[8] == 1.0);
}

TEST_CASE("small buffers share allocations, of which a device may allow few, and so do small images")
{
    On device("minimum");
    const std::function<ResourceDesc(uint32_t)> kinds[] = {
        [](uint32_t i) { return buffer_desc(1000 + 16 * i); },
        [](uint32_t i) {
            return picture_desc(Format::rgba8_unorm, {16, 16 + i / 4});
        }};
    for (const auto& desc : kinds) {
        const auto create = [&](uint32_t i) { return device->memory().create("small", desc(i)); };
        std::vector<gpu::Storage> kept;
        const uint64_t before = device->memory().allocations();
        for (uint32_t i = 0; i < 500; ++i) kept.push_back(create(i));
        CHECK(device->memory().allocations() - before <= 8);
        const uint64_t made = device->memory().allocations_made();
        for (uint32_t i = 0; i < 500; i += 2) kept[i].reset();
        for (uint32_t i = 0; i < 500; i += 2) kept[i] = create(i);
        CHECK(device->memory().allocations_made() == made);
        kept.clear();
        CHECK(device->memory().allocations() - before <= 1);  // one is kept for the next small one
    }
}

TEST_CASE("paint is drawn as long as it fits, though there is no room for more of it")
{
    On device("minimum");  // images of 256^3: 512 bricks, one of which stays unused
    for (const size_t bricks : {size_t(340), size_t(400), size_t(511)}) {
        CAPTURE(bricks);
        const Mask mask = mask_of(bricks);
        DeviceMask on_device(device->executor(), device->memory(), false);
        on_device.update(mask, mask.painted_bricks());
        for (const int64_t brick : mask.painted_bricks()) CHECK(on_device.slot_of(brick) != gpu::NO_SLOT);
    }
    const Mask mask = mask_of(512);
    DeviceMask on_device(device->executor(), device->memory(), false);
    CHECK_THROWS_AS(on_device.update(mask, mask.painted_bricks()), gpu::MemoryError);
    CHECK(on_device.is_stale());
}

TEST_CASE("where memory has priorities, all has one, and what rays look up has a higher one than pictures")
{
    // The layer says so of memory that has none there, and of any elsewhere.
    for (const auto& [record, has] : {std::pair{"nvidia", true}, {"amd", true}, {"intel", false}}) {
        CAPTURE(std::string(record));
        On device(record);
        CHECK(device->device().traits().has_memory_priority == has);
        for (const gpu::Placement placement : {gpu::Placement::device, gpu::Placement::values, gpu::Placement::upload})
            for (const uint64_t bytes : {uint64_t{1000}, MIB})  // with others, and alone
                static_cast<void>(device->memory().create("some", buffer_desc(bytes), placement));
        static_cast<void>(device->memory().create("voxels", image_desc(Format::r32_uint, {16, 16, 16})));
    }
    using gpu::memory_priority, gpu::Placement;
    const float of_picture = memory_priority(picture_desc(Format::rgba8_unorm, {64, 64}), Placement::device);
    CHECK(memory_priority(image_desc(Format::r32_uint, {64, 64, 1}), Placement::device) > of_picture);
    CHECK(memory_priority(buffer_desc(64), Placement::values) > of_picture);
    CHECK(memory_priority(buffer_desc(64), Placement::upload) <= of_picture);
}

TEST_CASE("what is larger than the device allows is refused in words, and can be asked before")
{
    On device("minimum");
    gpu::Memory& memory = device->memory();
    CHECK(memory.can_create(image_desc(Format::r8_uint, {256, 256, 256})));
    CHECK_FALSE(memory.can_create(image_desc(Format::r8_uint, {257, 1, 1})));
    CHECK_FALSE(memory.can_create(image_desc(Format::rgba32_float, {256, 256, 256})));
    CHECK(memory.can_create(picture_desc(Format::rgba8_unorm, {4096, 16})));
    CHECK_FALSE(memory.can_create(picture_desc(Format::rgba8_unorm, {4097, 16})));
    CHECK_FALSE(memory.can_create(buffer_desc(64 * MIB + 1)));
    CHECK(*memory.why_not("sketch", picture_desc(Format::rgba8_unorm, {4370, 360})) ==
          "image 'sketch' is 4370 x 360 x 1 texels; the device allows 4096 x 4096 x 1");
    CHECK(*memory.why_not("all", buffer_desc(65 * MIB)) == "buffer 'all' takes 65 MiB; the device allows 64 MiB");
}
