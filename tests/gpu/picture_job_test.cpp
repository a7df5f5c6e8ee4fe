// Pictures made part by part, with every feature: the same bits as pictures drawn whole.

#include "engine/picture/picture_job.h"

#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <functional>
#include <mutex>
#include <thread>

#include <doctest/doctest.h>

#include "engine/base/image_file.h"
#include "engine/base/image_metrics.h"
#include "engine/picture/frame.h"
#include "engine/workbench/document/screenshots.h"
#include "tests/support/gpu.h"
#include "tests/support/slow.h"
#include "tests/support/stored_volume.h"

using namespace shvr;
using namespace shvr::test;

namespace {

constexpr int ALL = 1 << 30;

/// A disk that reads as often as it is let. A reader that has waited for half a minute opens it for good.
class Gated final : public VolumeSource {
public:
    explicit Gated(std::shared_ptr<const VolumeSource> source)
        : VolumeSource(source->info()), source_(std::move(source))
    {}
    Size3 block() const override { return source_->block(); }
    int levels() const override { return source_->levels(); }
    void read(const VoxelBox& box, std::span<std::byte> voxels) const override { read_level(0, box, voxels); }
    void read_level(int level, const VoxelBox& box, std::span<std::byte> voxels) const override
    {
        {
            std::unique_lock lock(mutex_);
            if (!changed_.wait_for(lock, std::chrono::seconds(30), [&] { return let_ > 0; })) {
                ++waited_for_;
                let_ = ALL;
                changed_.notify_all();
            }
            --let_;
            ++reads_;
        }
        source_->read_level(level, box, voxels);
    }
    void let(int reads)
    {
        const std::scoped_lock lock(mutex_);
        let_ = waited_for_ > 0 ? ALL : reads;
        changed_.notify_all();
    }
    /// Lets the readers read a little while no thread waits for them.
    void read_a_little()
    {
        let(8);
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
        let(0);
    }
    int reads() const
    {
        const std::scoped_lock lock(mutex_);
        return reads_;
    }
    /// Readers that have waited in vain.
    int waited_for() const
    {
        const std::scoped_lock lock(mutex_);
        return waited_for_;
    }

private:
    std::shared_ptr<const VolumeSource> source_;
    mutable std::mutex mutex_;
    mutable std::condition_variable changed_;
    mutable int let_ = 0, reads_ = 0, waited_for_ = 0;
};

struct SlowlyRead {
    std::shared_ptr<const VolumeSource> tubes = stored_volume("tubes", {128, 128, 128}, 3);
    std::shared_ptr<Gated> gated = std::make_shared<Gated>(tubes);
    Renderer renderer{{.device = {.validation = true}, .threads = 2}};
    Camera camera = camera_looking("front", tubes->info());
    Session session;
    ImageF expected;

    SlowlyRead()
    {
        session.transfer_function =
            TransferFunction({{90.0, glm::dvec3(0.8, 0.3, 0.1), 0.0}, {140.0, glm::dvec3(0.9, 0.7, 0.3), 0.3}});
        session.render.size = {101, 77};
        session.render.sampling = Sampling::exact;
        session.render.detail = 0.0;
        session.render.paging = Paging::always;
        session.light.occlusion = {.strength = 0.8, .radius = 4.0, .rays = 2};
        renderer.load(tubes, {.minimum = 0.0, .maximum = 255.0}, session.render);
        expected = renderer.render(session, camera).image;
        gated->let(ALL);
        renderer.load(gated, {.minimum = 0.0, .maximum = 255.0}, session.render);
    }
    ~SlowlyRead()
    {
        gated->let(ALL);
        for (const std::string& message : renderer.device().take_validation_messages()) FAIL_CHECK(message);
    }
};

/// Draws the picture in steps, none of which may wait for a brick. After each that left some to come a little is read,
/// and after every fifth of them `others` come in between.
void check_steps(Renderer& renderer, const Session& session, const Camera& camera, const RenderOptions& options,
                 Gated& gated, const ImageF& expected, const std::function<void()>& others)
{
    ImageF image{expected.width, 0, {}};
    PictureJob job(renderer, session, camera, options, [&](const ImageF& rows) {
        image.height += rows.height;
        image.rgba.insert(image.rgba.end(), rows.rgba.begin(), rows.rgba.end());
    });
    gated.let(0);
    int waiting = 0;
    for (int steps = 0; !job.is_done() && gated.waited_for() == 0; ++steps) {
        REQUIRE(steps < 20'000);
        const int before = gated.reads();
        job.step(false);
        CHECK(gated.reads() == before);
        if (!job.is_waiting()) continue;
        gated.read_a_little();
        if (++waiting % 5 == 0) others();
    }
    REQUIRE(gated.waited_for() == 0);  // by a step
    CHECK(waiting > 10);
    const Picture picture = job.take();
    for (const std::string& warning : picture.warnings) FAIL_CHECK(warning);
    CHECK(picture.complete);
    CHECK(different_bits(image, expected) == 0);
}

}  // namespace

TEST_CASE("a picture in parts has the bits of one drawn whole, resident and with paged bricks")
{
    const std::shared_ptr<const VolumeSource> tubes = stored_volume("tubes", {128, 128, 128}, 3);
    Session session;
    session.transfer_function =
        TransferFunction({{90.0, glm::dvec3(0.8, 0.3, 0.1), 0.0}, {140.0, glm::dvec3(0.9, 0.7, 0.3), 0.3}});
    session.render.size = {101, 77};
    session.render.sampling = Sampling::exact;
    session.render.detail = 0.0;
    session.light.occlusion = {.strength = 0.8, .radius = 4.0, .rays = 2};
    session.blend = {.size = 0.5};
    const ProbeLook probe{.center = {60.0, 66.0, 70.0},
                          .radius = 25.0,
                          .color = {1.0, 0.5, 0.1},
                          .ball_share = 0.3,
                          .shell = ShellLook{.threshold = 100.0}};
    Renderer renderer({.device = {.validation = true}, .threads = 2});
    const Camera camera = camera_looking("front", tubes->info());
    for (const Paging paging : {Paging::never, Paging::always}) {
        session.render.paging = paging;
        renderer.load(tubes, {.minimum = 0.0, .maximum = 255.0}, session.render);
        for (const Arrangement arrangement : {Arrangement::single, Arrangement::slices, Arrangement::stereo}) {
            session.view.arrangement = arrangement;
            session.view.stereo.output = StereoOutput::anaglyph;
            RenderOptions options{.probe = probe, .outlines_probe = true};
            const Picture whole = renderer.render(session, camera, options);
            CHECK(whole.complete);
            for (const uint32_t side : {16u, 33u, 64u}) {
                // Every day each side has each arrangement and each kind of paging once or twice.
                if (!is_slow() && (side + size_t(arrangement)) % 2 != size_t(paging == Paging::always)) continue;
                options.part_pixels = side;
                ImageF image{101, 0, {}};
                PictureJob job(renderer, session, camera, options, [&](const ImageF& rows) {
                    CHECK(rows.width == image.width);
                    image.height += rows.height;
                    image.rgba.insert(image.rgba.end(), rows.rgba.begin(), rows.rgba.end());
                });
                int steps = 0;
                double before = 0.0;
                for (; !job.is_done(); ++steps) {
                    job.step();
                    CHECK(job.progress() >= before);
                    before = job.progress();
                }
                CHECK(before == 1.0);
                CHECK(steps >= int(101 / side * (77 / side)));
                CHECK(job.take().complete);
                CHECK(different_bits(image, whole.image) == 0);
            }
        }
    }
    for (const std::string& message : renderer.device().take_validation_messages()) FAIL_CHECK(message);
}

TEST_CASE_FIXTURE(SlowlyRead, "a picture whose steps wait for no brick has the same bits, whoever looks in between")
{
    check_steps(renderer, session, camera, {.part_pixels = 48}, *gated, expected, [&] {
        look_at(renderer.scene(), session.look(), Shot(camera_looking("left", tubes->info())),
                {.pixels = {40, 30}, .begin = glm::uvec2(0), .end = {40, 30}});
    });
}

TEST_CASE("rays that wait for bricks wait for no disk where a step must not, whoever draws in between")
{
    // 232 bricks along x, each of which shows something; a budget of 16 MiB has room for 199.
    const std::shared_ptr<const VolumeSource> fog = stored_volume("fog", {7424, 34, 20}, 5);
    Session session;
    session.transfer_function =
        TransferFunction({{50.0, glm::dvec3(0.9, 0.2, 0.1), 1e-4}, {170.0, glm::dvec3(0.3, 0.4, 1.0), 5e-4}});
    // Light costs by the voxels that show: every day those are a third, in each brick some.
    if (!is_slow())
        session.transfer_function =
            TransferFunction({{118.0, glm::dvec3(0.9, 0.2, 0.1), 0.0}, {150.0, glm::dvec3(0.3, 0.4, 1.0), 1e-3}});
    session.render.size = {2, 2};
    session.render.sampling = Sampling::exact;
    const Camera camera = camera_along({.size = {7424, 34, 20}}, {1.0, 0.001, 0.0005}, 16.0);
    ImageF unlit;
    for (const bool is_lit : {false, true}) {
        CAPTURE(is_lit);
        if (is_lit) session.light.occlusion = {.strength = 1.0, .radius = 24.0, .rays = 1, .curve = 50.0};
        Renderer large({.device = {.validation = true}, .threads = 2});
        large.load(fog, {.minimum = 0.0, .maximum = 255.0}, session.render, is_lit);
        const ImageF expected = large.render(session, camera).image;
        if (is_lit) CHECK(different_bits(expected, unlit) > 0);
        unlit = expected;
        const auto gated = std::make_shared<Gated>(fog);
        gated->let(ALL);
        Renderer small({.device = {.validation = true}, .budget = {16 << 20, 0}, .threads = 2});
        small.load(gated, {.minimum = 0.0, .maximum = 255.0}, session.render, is_lit);
        check_steps(small, session, camera, {}, *gated, expected, [&] {
            small.executor().run(prepared(small.scene(), session.look(), Shot(camera_looking("front", fog->info())),
                                          {.pixels = {40, 30}, .begin = glm::uvec2(0), .end = {40, 30}}));
        });
        CHECK(small.volume().counts()->evictions > 0);
        gated->let(ALL);
        for (const std::string& message : small.device().take_validation_messages()) FAIL_CHECK(message);
    }
}

TEST_CASE_FIXTURE(SlowlyRead, "a large screenshot waits for its bricks beside the window, which shows its own view")
{
    const std::filesystem::path folder =
        std::filesystem::temp_directory_path() / sentence("shvr-slowly-read-", std::this_thread::get_id());
    std::filesystem::create_directories(folder);
    Screen screen(renderer, {});
    Session shown = session;
    shown.render.detail = Session().render.detail;
    const Camera other = camera_looking("left", tubes->info());
    const glm::uvec2 pixels(40, 30);
    screen.look(shown, other, pixels, glm::dvec3(64.0));
    screen.show_probe(ProbeLook{.center = glm::dvec3(64.0), .radius = 6.0});
    const auto settle = [&] {
        while (!screen.complete()) {
            screen.advance();
            screen.wait();
        }
    };
    settle();
    ui::Screenshots screenshots;
    const auto texts = [](const std::filesystem::path&) { return PictureTexts(); };
    screenshots.take_large(folder / "scan", renderer, session, camera, {.part_pixels = 48}, texts, {});
    gated->let(0);
    bool was_held = false, is_followed = false;
    std::string said;
    for (int turns = 0; said.empty() && gated->waited_for() == 0; ++turns) {
        REQUIRE(turns < 200'000);
        const bool is_held = screen.is_held();
        screen.advance();
        CHECK(screen.is_held() == is_held);  // whatever bricks arrive
        if (was_held && !is_followed) {      // the volume is turned: the window follows, and the picture goes on later
            screen.look_from(camera_looking("top", tubes->info()), glm::dvec3(64.0));
            screen.advance();
            CHECK_FALSE(screen.is_held());
            is_followed = true;
        }
        const int before = gated->reads();
        said = screenshots.advance(screen, folder / "scan", true, texts, [] { return ui::Figure(); }).said;
        CHECK(gated->reads() == before);
        was_held = was_held || screen.is_held();
        gated->read_a_little();
    }
    REQUIRE(gated->waited_for() == 0);  // by an iteration of the window's loop
    CHECK(is_followed);
    gated->let(ALL);
    CHECK_FALSE(screen.is_held());
    settle();
    CHECK(said == sentence("Screenshot: ", (folder / "scan-view-1.png").string()));
    const Image8 kept = read_png(folder / "scan-view-1.png");
    CHECK(compare_pixels(kept, to_image8(expected)).max_abs == 0.0);
    std::filesystem::remove_all(folder);
}

TEST_CASE("a picture that memory does not hold is refused before any is taken")
{
    Renderer renderer({.device = {.validation = true}, .budget = {0, 64 << 20}, .threads = 1});
    renderer.load(open_procedural({.kind = "sphere", .size = {16, 16, 16}}), {.minimum = 0.0, .maximum = 255.0});
    Session session;
    session.render.size = {4096, 4096};
    CHECK_THROWS_WITH(renderer.render(session, camera_looking("front", renderer.volume().info())),
                      "render.size is 4096 x 4096 pixels, which take 256 MiB of memory; expected at most the host's "
                      "budget, 64 MiB");
}
