// A volume on another machine where device memory runs short: it keeps fewer bricks, the thread that draws never reads
// it, what is known of it stays on display, and the picture sharpens when bricks arrive.

#include <atomic>
#include <thread>

#include <doctest/doctest.h>

#include "engine/base/waits/waits.h"
#include "engine/volume/levels/pyramid_source.h"
#include "tests/gpu/paging/paged_scenes.h"

using namespace shvr;
using namespace shvr::test;

namespace {

constexpr uint64_t MIB = uint64_t{1} << 20;

/// A volume on a machine that may be silent. Counts the reads of the thread that made it, and lets them pass.
class Silent final : public VolumeSource {
public:
    explicit Silent(std::shared_ptr<const VolumeSource> of) : VolumeSource(of->info()), of_(std::move(of)) {}
    void read(const VoxelBox& box, std::span<std::byte> voxels) const override { read_level(0, box, voxels); }
    int levels() const override { return of_->levels(); }
    void read_level(int level, const VoxelBox& box, std::span<std::byte> voxels) const override
    {
        const bool is_main = std::this_thread::get_id() == main_;
        reads_of_main += is_main;
        while (is_silent && !is_main) {
            stop_if_wait_is_over();
            std::this_thread::yield();
        }
        of_->read_level(level, box, voxels);
    }
    mutable std::atomic<int> reads_of_main = 0;
    std::atomic<bool> is_silent = false;

private:
    std::shared_ptr<const VolumeSource> of_;
    std::thread::id main_ = std::this_thread::get_id();
};

constexpr Size3 SIZE(192, 192, 192);
constexpr int64_t BRICKS = 6 * 6 * 6;
const RenderSettings EXACT{.sampling = Sampling::exact};

Document painted(int64_t bricks)
{
    Document document{Mask(SIZE), TraceGraph{}};
    for (int64_t brick = 0; brick < bricks; ++brick)
        document.mask.apply({.brick = brick, .runs = {{.first = 9000, .last = 21000, .before = 0, .after = 3}}},
                            Direction::forwards);
    return document;
}

/// Loads in slices, as the window does.
void load(Renderer& renderer, const std::shared_ptr<Silent>& source, const RenderSettings& settings, bool with_light)
{
    std::unique_ptr<Scene> scene = renderer.begin_loading(source, BYTES, settings, with_light, painted(0));
    for (int turn = 0; !scene->load_on(0.001); ++turn) nap(turn);
    renderer.show(std::move(scene));
    renderer.scene().read_in_background(true);
    source->reads_of_main = 0;
}

int lit_pixels(View& view)
{
    const Image8 image = view.read_back();
    int lit = 0;
    for (size_t i = 0; i < image.rgba.size(); i += 4)
        lit += image.rgba[i] > image.rgba[i + 2] + 20;  // redder than the background
    return lit;
}

}  // namespace

TEST_CASE("a far volume that must give way to paint keeps fewer bricks, shows what it has, and sharpens")
{
    const auto source = std::make_shared<Silent>(with_levels(tubes(SIZE), uint64_t{1} << 30));
    const Document work = painted(BRICKS);
    for (const bool with_light : {false, true}) {
        CAPTURE(with_light);
        Session session = session_of(0.3, false);
        session.transfer_function =  // coarse levels average thin tubes away
            TransferFunction({{0.0, glm::dvec3(0.8, 0.3, 0.1), 0.02}, {255.0, glm::dvec3(1.0, 0.7, 0.3), 0.3}});
        session.groups[3].color = glm::dvec3(0.8, 0.3, 0.1);
        const Camera camera = camera_looking("front", source->info());
        Budgeted budgeted(with_light ? 24 : 20);
        Renderer& renderer = budgeted.renderer;
        load(renderer, source, session.render, with_light);
        const uint64_t slots = budgeted.counts().slots, requested = budgeted.counts().store.loads;
        source->is_silent = true;
        renderer.scene().show(work);
        CHECK(source->reads_of_main == 0);
        CHECK(budgeted.counts().slots < slots);
        CHECK(budgeted.counts().resident > 0);
        {
            View view(renderer, {});
            view.look(session.look(), session.interaction, Shot(camera), session.render.size);
            for (int turn = 0; turn < 10'000 && (view.layers().empty() || lit_pixels(view) == 0); ++turn) {
                view.advance();
                nap(turn);
            }
            CHECK(lit_pixels(view) > 0);
            CHECK_FALSE(view.complete());
            CHECK(budgeted.counts().store.loads == requested);  // what is drawn was on the host
            source->is_silent = false;
            settle(view);
        }
        CHECK(source->reads_of_main == 0);
        const ImageF picture = renderer.render(session, camera).image;
        CHECK(renderer.memory().peak_device_bytes() <= renderer.memory().device_budget());

        Budgeted roomy;
        roomy.load(source, session, Paging::always);
        roomy.renderer.scene().show(work);
        CHECK(different_bits(picture, roomy.renderer.render(session, camera).image) == 0);
    }
}

TEST_CASE("a far volume that cannot become smaller without being read as a whole stays as it is")
{
    const Document work = painted(BRICKS);
    for (const Paging paging : {Paging::never, Paging::automatic}) {
        CAPTURE(int(paging));
        const auto source = std::make_shared<Silent>(tubes(SIZE));
        Budgeted budgeted(20);
        RenderSettings settings = EXACT;
        settings.paging = paging;
        load(budgeted.renderer, source, settings, false);
        REQUIRE_FALSE(budgeted.renderer.volume().counts());
        gpu::Memory& memory = budgeted.renderer.memory();
        memory.free_idle();
        const gpu::Storage other = memory.create("another", buffer_desc(memory.device_bytes_left() - MIB));
        source->is_silent = true;
        CHECK_THROWS_AS(budgeted.renderer.scene().show(work), gpu::BudgetError);
        CHECK(source->reads_of_main == 0);
        CHECK(budgeted.renderer.scene().is_behind());
        CHECK_FALSE(budgeted.renderer.volume().counts());
    }
}

TEST_CASE("a volume that fits alone, but not with the work on it, gets its levels before it is loaded")
{
    Budgeted budgeted(20);
    const auto source = std::make_shared<Silent>(tubes(SIZE));
    CHECK(budgeted.renderer.with_levels(source, EXACT, false) == source);
    CHECK(source->reads_of_main == 0);
    const auto leveled = budgeted.renderer.with_levels(source, EXACT, false, 12 * MIB);
    CHECK(leveled->levels() > 1);
    CHECK_FALSE(budgeted.renderer.fits_beside(*leveled, EXACT, false, painted(0)));
}
