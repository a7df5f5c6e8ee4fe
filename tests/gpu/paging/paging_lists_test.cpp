// Lists of the bricks that a view wants: their cost, and that no thread waits for them.

#include <chrono>
#include <ctime>
#include <random>
#include <thread>
#include <utility>

#include <doctest/doctest.h>

#include "engine/base/image_metrics.h"
#include "engine/live/annotator.h"
#include "tests/gpu/paging/paged_scenes.h"
#include "tests/support/nap.h"
#include "tests/support/slow.h"

using namespace shvr;
using namespace shvr::test;

namespace {

/// Of this thread.
double cpu_ms()
{
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return 1e3 * double(time.tv_sec) + 1e-6 * double(time.tv_nsec);
}

}  // namespace

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
            // Bricks of the coarse levels may stand for any leaf; they arrive once. Those of the levels between stand
            // for up to 512 leaves, whose entries change without a look-up.
            const uint64_t all = degrees == 0.0 ? 2 : 0;
            CHECK(after.leaves_looked_up - before.leaves_looked_up <= all * after.leaves + 3 * changes);
            constexpr uint64_t DIRECTORY = sizeof(uint32_t) << 17;
            CHECK(after.directory_bytes - before.directory_bytes >= DIRECTORY);
            CHECK(after.directory_bytes - before.directory_bytes <= (1 + 2 * all) * DIRECTORY + 512 * changes);
            CHECK(after.waits_for_lists == 0);
            // A picture that is drawn once more looks nothing up and writes no directory.
            if (mib != 256) continue;
            view.changed({Size3(0), source->info().size});
            double steady_ms = 0.0;
            for (int turns = 0; !view.complete(); ++turns) {
                nap(turns);
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
        // Every day one kind of volume has half of the places, and the other kind the rest.
        const auto is_tried = [&](size_t place) { return is_slow() || (place % 2 == 1) == is_sparse; };
        for (size_t place = 0; const int64_t x : {1, 9, 10, 13}) {
            if (!is_tried(place++)) continue;
            CAPTURE(x);
            const int64_t brick = x + ALONG * (8 + ALONG * 8);
            mask.apply({.brick = brick, .runs = {{.first = 0, .last = 32767, .before = 0, .after = 3}}},
                       Direction::forwards);
            on.renderer.scene().update_mask(mask, {&brick, 1});
            seen.push_back(follow(std::nullopt));
            CHECK(different_bits(seen.back(), seen[seen.size() - 2]) > 0);
        }
        for (size_t place = 0; const double x : {50.0, 270.0, 300.0, 420.0}) {
            if (!is_tried(place++)) continue;
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
