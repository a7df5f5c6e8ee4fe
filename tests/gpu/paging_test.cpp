// Paged bricks: pictures equal those of resident volumes, bit for bit, whatever the budget; nothing is loaded twice;
// unreadable bricks are reported.

#include <chrono>
#include <ctime>
#include <random>
#include <set>
#include <thread>
#include <utility>

#include <doctest/doctest.h>
#include <glm/gtc/matrix_transform.hpp>

#include "engine/base/image_metrics.h"
#include "engine/live/annotator.h"
#include "engine/live/view.h"
#include "engine/volume/pyramid_source.h"
#include "shaders/counters.h"
#include "tests/support/gpu.h"

using namespace shvr;
using namespace shvr::test;

namespace {

using Source = std::shared_ptr<const VolumeSource>;
constexpr VolumeStatistics BYTES{.minimum = 0.0, .maximum = 255.0};

Source tubes(const Size3& size)
{
    return open_procedural({.kind = "tubes", .size = size, .seed = 3});
}

/// Finest bricks everywhere, exact samples.
Session session_of(double opacity, bool shaded)
{
    Session session;
    session.transfer_function = TransferFunction({{90.0, glm::dvec3(0.8, 0.3, 0.1), 0.0},
                                                  {140.0, glm::dvec3(0.9, 0.7, 0.3), opacity},
                                                  {255.0, glm::dvec3(1.0), opacity}});
    session.light.shaded = shaded;
    session.render.size = {160, 120};
    session.render.sampling = Sampling::exact;
    session.render.detail = 0.0;
    return session;
}

/// A renderer with its own budget.
struct Budgeted {
    Renderer renderer;
    explicit Budgeted(uint64_t device_mib = 0, uint64_t host_mib = 0)
        : renderer({.device = {.validation = true}, .budget = {device_mib << 20, host_mib << 20}, .threads = 2})
    {}
    ~Budgeted()
    {
        for (const std::string& message : renderer.device().take_validation_messages()) FAIL_CHECK(message);
    }
    void load(const Source& source, Session session, Paging paging)
    {
        session.render.paging = paging;
        renderer.load(source, BYTES, session.render);
    }
    Picture picture(const Source& source, const Session& session, Paging paging, const Camera& camera)
    {
        load(source, session, paging);
        return renderer.render(session, camera);
    }
    DeviceVolume::Counts counts() { return renderer.volume().counts().value(); }
};

/// A source with some unreadable bricks.
class Broken final : public VolumeSource {
public:
    explicit Broken(Source source) : VolumeSource(source->info()), source_(std::move(source)) {}
    void read(const VoxelBox& box, std::span<std::byte> voxels) const override { read_level(0, box, voxels); }
    int levels() const override { return source_->levels(); }
    void read_level(int level, const VoxelBox& box, std::span<std::byte> voxels) const override
    {
        if (level == 0 && box.lower.x < 32) fail("chunk 0.0.0: is torn");
        source_->read_level(level, box, voxels);
    }

private:
    Source source_;
};

/// One value everywhere, with all its levels: as large as one likes.
class Plain final : public VolumeSource {
public:
    Plain(const Size3& size, int levels) : VolumeSource({.name = "plain", .size = size}), levels_(levels) {}
    void read(const VoxelBox& box, std::span<std::byte> voxels) const override { read_level(0, box, voxels); }
    int levels() const override { return levels_; }
    void read_level(int, const VoxelBox&, std::span<std::byte> voxels) const override
    {
        std::ranges::fill(voxels, std::byte{200});
    }

private:
    int levels_;
};

/// Says of its bricks that they hold nothing that is seen, but for those of x below 64.
class Sparse final : public VolumeSource {
public:
    Sparse(const Size3& size, int levels) : VolumeSource({.name = "sparse", .size = size}), levels_(levels) {}
    void read(const VoxelBox& box, std::span<std::byte> voxels) const override { read_level(0, box, voxels); }
    int levels() const override { return levels_; }
    void read_level(int level, const VoxelBox& box, std::span<std::byte> voxels) const override
    {
        size_t i = 0;
        for (int64_t z = box.lower.z; z < box.upper.z; ++z)
            for (int64_t y = box.lower.y; y < box.upper.y; ++y)
                for (int64_t x = box.lower.x; x < box.upper.x; ++x) voxels[i++] = std::byte(x << level < 64 ? 200 : 10);
    }
    std::optional<ValueRange> brick_range(int level, const Size3& brick) const override
    {
        return brick.x * 32 << level < 64 ? ValueRange{10.0, 200.0} : ValueRange{10.0, 10.0};
    }

private:
    int levels_;
};

Camera turned(const VolumeInfo& info, double degrees)
{
    Camera camera = camera_looking("front", info);
    const glm::dmat4 turn = glm::rotate(glm::dmat4(1.0), glm::radians(degrees), camera.up);
    camera.eye = camera.target + glm::dvec3(turn * glm::dvec4(camera.eye - camera.target, 0.0));
    return camera;
}

/// Of this thread.
double cpu_ms()
{
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return 1e3 * double(time.tv_sec) + 1e-6 * double(time.tv_nsec);
}

void settle(View& view)
{
    for (int i = 0; !view.complete(); ++i) {
        REQUIRE(i < 10'000'000);
        view.advance();
    }
}

}  // namespace

TEST_CASE("paged pictures of the finest level equal resident ones bit for bit")
{
    const Source source = tubes({150, 131, 170});
    Camera inside = camera_looking("front", source->info());
    inside.eye = glm::dvec3(70.0, 20.0, 80.0);
    Camera parallel = camera_looking("left", source->info());
    parallel.projection = Camera::Projection::orthographic;
    Budgeted all;
    for (const double opacity : {0.02, 1.0})
        for (const bool shaded : {false, true})
            for (const Camera& camera : {camera_looking("front", source->info()), inside, parallel}) {
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

TEST_CASE("of 10^5 bricks in view those that come and go are looked up; a camera that turns sees each side as it is")
{
    const auto source = std::make_shared<Plain>(Size3(1536), 6);
    Session session = session_of(1.0, false);
    session.transfer_function = TransferFunction({{0.0, WHITE, 1.0}, {255.0, WHITE, 1.0}});
    session.render.size = {48, 48};
    // A side has up to 1300 bricks under 48 x 48 rays, and those of all views together are more than 4000.
    for (const uint64_t mib : {64, 256}) {
        CAPTURE(mib);
        Budgeted on(mib, 64);
        on.load(source, session, Paging::always);
        View view(on.renderer);
        double worst_ms = 0.0, ms = 0.0;
        for (const double degrees : {0.0, 30.0, 60.0, 90.0, 120.0}) {
            CAPTURE(degrees);
            const DeviceVolume::Counts before = on.counts();
            view.look(session, turned(source->info(), degrees), session.render.size);
            // Pictures are sketched, and their bricks listed, while this thread has other things to do.
            for (int i = 0; view.shown_camera() == nullptr || !view.is_sketched(); ++i) {
                REQUIRE(i < 100'000);
                const double begin_ms = cpu_ms();
                view.advance();
                if (degrees > 0.0) worst_ms = std::max(worst_ms, cpu_ms() - begin_ms);
                if (degrees > 0.0) ms += cpu_ms() - begin_ms;
                std::this_thread::sleep_for(std::chrono::milliseconds(1));
            }
            settle(view);
            const DeviceVolume::Counts after = on.counts();
            CHECK(after.leaves > 90'000);
            CHECK(after.uploads > before.uploads);
            CHECK((on.renderer.volume().state() == DeviceVolume::State::complete) == (mib == 256));
            const uint64_t changes = (after.uploads - before.uploads) + (after.evictions - before.evictions);
            // Bricks of the coarse levels may stand for any leaf; they arrive once.
            const uint64_t all = degrees == 0.0 ? 2 : 0;
            CHECK(after.leaves_looked_up - before.leaves_looked_up <= all * after.leaves + 3 * changes);
            constexpr uint64_t DIRECTORY = sizeof(uint32_t) << 17;
            CHECK(after.directory_bytes - before.directory_bytes >= DIRECTORY);
            CHECK(after.directory_bytes - before.directory_bytes <= (1 + 2 * all) * DIRECTORY + 64 * changes);
            CHECK(after.waits_for_lists == 0);
            // A picture that is drawn once more looks nothing up and writes no directory.
            if (mib != 256) continue;
            view.changed({Size3(0), source->info().size});
            double steady_ms = 0.0;
            for (int turns = 0; !view.complete(); ++turns) {
                REQUIRE(turns < 10'000'000);
                const double begin_ms = cpu_ms();
                view.advance();
                steady_ms = std::max(steady_ms, cpu_ms() - begin_ms);
            }
            MESSAGE("drawn once more: at most ", steady_ms, " ms of that thread at a time");
            CHECK(on.counts().leaves_looked_up == after.leaves_looked_up);
            CHECK(on.counts().directory_bytes == after.directory_bytes);
        }
        CHECK(on.counts().evictions > 0);
        MESSAGE(mib, " MiB: the sketch of a view of ", on.counts().leaves, " bricks takes the thread that asks ",
                ms / 4, " ms, at most ", worst_ms, " ms at a time");
    }
}

TEST_CASE("a camera that moves faster than 10^5 bricks are listed is followed all the same")
{
    const auto source = std::make_shared<Plain>(Size3(1536), 6);
    Session session = session_of(1.0, false);
    session.transfer_function = TransferFunction({{0.0, WHITE, 1.0}, {255.0, WHITE, 1.0}});
    session.render.size = {16, 16};
    Budgeted on(64, 64);
    on.load(source, session, Paging::always);
    View view(on.renderer);
    int turns = 0, pictures = 0;
    for (const Camera* last = nullptr; pictures < 5; ++turns) {
        REQUIRE(turns < 100'000);
        view.look(session, turned(source->info(), 0.01 * turns), session.render.size);
        view.advance();
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
        pictures += std::exchange(last, view.shown_camera()) != view.shown_camera();
    }
    CHECK(on.counts().waits_for_lists == 0);
    settle(view);
    const Picture wanted = on.renderer.render(session, turned(source->info(), 0.01 * (turns - 1)));
    CHECK(compare_pixels(view.read_back(), to_image8(wanted.image)).max_abs <= 1.0);
}

TEST_CASE("a stroke that comes to a new brick, or a shell that does, makes nobody wait until bricks are listed")
{
    constexpr int64_t ALONG = 16;  // bricks
    for (const bool is_sparse : {false, true}) {
        CAPTURE(is_sparse);
        const Size3 size(32 * ALONG);
        const Source source = is_sparse ? Source(std::make_shared<Sparse>(size, 4)) : std::make_shared<Plain>(size, 4);
        Session session = session_of(0.002, false);  // so that paint is seen in the middle
        session.render.size = {64, 48};
        session.groups[3] = {.opacity = 0.8};
        const Camera camera = turned(source->info(), 20.0);
        Budgeted on(96, 64);
        on.load(source, session, Paging::always);
        View view(on.renderer);
        view.look(session, camera, session.render.size);
        const auto follow = [&](const std::optional<ProbeLook>& probe) {
            for (int i = 0; !view.complete(); ++i) {  // while this thread has other things to do
                REQUIRE(i < 100'000);
                view.advance();
                std::this_thread::sleep_for(std::chrono::milliseconds(1));
            }
            CHECK(on.counts().waits_for_lists == 0);
            const Picture wanted = on.renderer.render(session, camera, {.probe = probe});
            CHECK(compare_pixels(view.read_back(), to_image8(wanted.image)).max_abs <= 1.0);
            return wanted.image;
        };
        std::vector<ImageF> seen{follow(std::nullopt)};
        Mask mask(size);
        for (const int64_t x : {1, 9, 10, 13}) {
            CAPTURE(x);
            const int64_t brick = x + ALONG * (8 + ALONG * 8);
            mask.apply({.brick = brick, .runs = {{.first = 0, .last = 32767, .before = 0, .after = 3}}},
                       Direction::forwards);
            on.renderer.scene().update_mask(mask, {&brick, 1});
            seen.push_back(follow(std::nullopt));
            CHECK(different_bits(seen.back(), seen[seen.size() - 2]) > 0);
        }
        for (const double x : {50.0, 270.0, 300.0, 420.0}) {
            CAPTURE(x);
            const ProbeLook probe{.center = {x, 250.0, 250.0},
                                  .radius = 20.0,
                                  .ball_share = 0.0,
                                  .shell = ShellLook{.threshold = 2000.0, .opacity = 0.5}};
            view.show_probe(probe);
            follow(probe);
        }
    }
}

TEST_CASE("panes that take turns have their bricks listed once")
{
    const auto source = std::make_shared<Plain>(Size3(512), 4);
    const Session session = session_of(0.3, false);
    Budgeted on(64, 64);
    on.load(source, session, Paging::always);
    std::vector<Picture> first;
    for (int round = 0; round < 3; ++round)
        for (size_t side = 0; side < 3; ++side) {
            const Picture seen = on.renderer.render(session, turned(source->info(), 40.0 * double(side)));
            if (round == 0) first.push_back(seen);
            CHECK(different_bits(seen.image, first[side].image) == 0);
        }
    CHECK(on.counts().waits_for_lists == 3);
}

TEST_CASE("the directory is the same, entry by entry, whether made anew or only where bricks came and went")
{
    const auto source = std::make_shared<Plain>(Size3(512), 4);
    Session session = session_of(0.3, false);
    for (const double detail : {0.0, 2.0}) {
        CAPTURE(detail);
        session.render.detail = detail;
        Budgeted on(48, 64);
        on.load(source, session, Paging::always);
        DeviceVolume& volume = on.renderer.volume();
        const auto directory = [&] {
            FrameGraph graph;
            const VolumeBinding bound = volume.prepare(graph, on.renderer.scene().mask(), std::nullopt, false);
            const uint32_t back = graph.read_back(bound.pages->directory);
            return on.renderer.executor().run(graph).read_backs[back];
        };
        const auto made_anew = [&] {
            volume.let_rays_wait(true);
            volume.let_rays_wait(false);
            return directory();
        };
        View view(on.renderer);
        view.look(session, camera_looking("front", source->info()), session.render.size);
        settle(view);
        const std::vector<std::byte> first = directory();
        CHECK(made_anew() == first);
        std::mt19937 random(7);
        std::vector<std::byte> before = first;
        int changes = 0;
        for (int i = 0; i < 30; ++i) {
            const Size3 lower(random() % 440, random() % 440, random() % 440);
            REQUIRE(volume.region({lower, lower + int64_t{64}}, true));
            const std::vector<std::byte> patched = directory();
            REQUIRE(made_anew() == patched);
            changes += patched != before;
            before = patched;
        }
        if (detail == 0.0) CHECK(changes > 10);
        CHECK(on.counts().evictions > 30);
    }
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
