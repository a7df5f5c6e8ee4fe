// When memory is short or a submission fails, the program goes on, leaves nothing half done, reports one sentence to
// the user, and later completes the missing work.

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include <unistd.h>

#include <doctest/doctest.h>

#include "engine/base/image_metrics.h"
#include "engine/live/view.h"
#include "tests/support/gpu.h"
#include "tests/support/nap.h"
#include "tests/support/slow.h"
#include "tests/support/stored_volume.h"

using namespace shvr;
using namespace shvr::test;

namespace {

constexpr VolumeStatistics BYTES{.minimum = 0.0, .maximum = 255.0};
constexpr uint64_t MIB = uint64_t{1} << 20;

struct Shown {
    Session session;
    std::shared_ptr<const VolumeSource> source = stored_volume("tubes", {128, 128, 96}, 3);
    Camera camera = camera_looking("front", source->info());
    Mask mask{source->info().size};

    explicit Shown(const glm::uvec2& pixels)
    {
        session.transfer_function = TransferFunction(
            {{90.0, glm::dvec3(0.8, 0.3, 0.1), 0.0}, {140.0, glm::dvec3(0.9, 0.7, 0.3), 0.3}, {255.0, WHITE, 0.6}});
        session.light.shaded = true;
        session.render.size = pixels;
        session.render.sampling = Sampling::exact;
    }
    void paint(int64_t brick)
    {
        mask.apply({.brick = brick, .runs = {{.first = 3000, .last = 29000, .before = 0, .after = 3}}},
                   Direction::forwards);
    }
    void look_with(View& view) const
    {
        view.look(session.look(), session.interaction, Shot(camera), session.render.size);
    }
};

void settle(View& view)
{
    for (int i = 0; !view.complete(); ++i) {
        nap(i);
        REQUIRE(i < 10'000'000);
        view.advance();
    }
}

std::string all_messages(Renderer& renderer)
{
    std::string all;
    for (const std::string& message : renderer.scene().take_messages()) all += message + "\n";
    return all;
}

/// Makes drivers refuse single allocations of `bytes` or more once `begins` was called (tests/layers/memory.cpp). Holds
/// for devices created during its lifetime.
class ShortOf {
public:
    explicit ShortOf(uint64_t bytes)
    {
        std::filesystem::create_directories(folder_);
        setenv("VK_INSTANCE_LAYERS", "VK_LAYER_SHVR_memory", 1);
        setenv("SHVR_DEVICE_SHORT_BYTES", std::to_string(bytes).c_str(), 1);
        setenv("SHVR_DEVICE_SHORT_WHILE", (folder_ / "while").c_str(), 1);
    }
    ShortOf(const ShortOf&) = delete;
    ~ShortOf()
    {
        for (const char* name : {"VK_INSTANCE_LAYERS", "SHVR_DEVICE_SHORT_BYTES", "SHVR_DEVICE_SHORT_WHILE"})
            unsetenv(name);
        std::filesystem::remove_all(folder_);
    }
    void begins() const { std::ofstream(folder_ / "while") << '\n'; }

private:
    std::filesystem::path folder_ = std::filesystem::temp_directory_path() / sentence("shvr-short-", getpid());
};

void check_valid(Renderer& renderer)
{
    for (const std::string& message : renderer.device().take_validation_messages()) FAIL_CHECK(message);
}

}  // namespace

TEST_CASE("a window that grows beyond the memory for sharp pictures shows coarse ones, and says so once")
{
    Renderer renderer({.device = {.validation = true}, .budget = {40 * MIB, 0}, .threads = 1});
    Shown shown({300, 200});
    renderer.load(shown.source, BYTES, shown.session.render);
    View view(renderer, {});
    shown.look_with(view);
    settle(view);
    CHECK(all_messages(renderer) == "");
    shown.session.render.size = {2500, 1400};
    shown.look_with(view);
    settle(view);
    const std::string said = all_messages(renderer);
    CAPTURE(said);
    CHECK(said.starts_with("pictures stay coarse: device memory: the sharp picture on the screen needs 13.5 MiB"));
    CHECK(std::ranges::count(said, '\n') == 1);
    CHECK(!view.layers().empty());
    // Paint added meanwhile is shown in the coarse picture.
    const uint64_t before = view.revision();
    shown.paint(0);
    const int64_t brick = 0;
    renderer.scene().update_mask(shown.mask, {&brick, 1});
    settle(view);
    CHECK(view.revision() > before);
    shown.session.render.size = {300, 200};
    shown.look_with(view);
    settle(view);
    const Image8 rendered = to_image8(renderer.render(shown.session, shown.camera).image);
    CHECK(compare_pixels(view.read_back(), rendered).max_abs <= 1.0);
    check_valid(renderer);
}

TEST_CASE("a window that no picture has memory for fails in words each time, and shows the next one that has")
{
    Renderer renderer({.device = {.validation = true}, .budget = {24 * MIB, 0}, .threads = 1});
    Shown shown({2500, 2400});
    renderer.load(shown.source, BYTES, shown.session.render);
    View view(renderer, {});
    shown.look_with(view);
    for (int i = 0; i < 3; ++i) {
        std::string said;
        try {
            for (int turn = 0; turn < 1000; ++turn) view.advance();
        } catch (const gpu::MemoryError& error) {
            said = error.what();
        }
        CAPTURE(said);
        CHECK(said.starts_with("device memory: the picture on the screen needs 23 MiB"));
        CHECK(view.layers().empty());
    }
    shown.session.render.size = {300, 200};
    shown.look_with(view);
    settle(view);
    CHECK(!view.layers().empty());
    check_valid(renderer);
}

TEST_CASE("sharp tiles that there is no memory of their own for are drawn where the sketch was")
{
    Renderer renderer({.device = {.validation = true}, .budget = {64 * MIB, 0}, .threads = 1});
    Shown shown({600, 400});
    renderer.load(shown.source, BYTES, shown.session.render);
    const auto held = [&](const char* name) -> uint64_t {
        renderer.memory().collect();
        const auto all = renderer.memory().bytes_by_name();
        const auto found = all.find(name);
        return found == all.end() ? 0 : found->second;
    };
    uint64_t sharp_bytes = 0;
    {
        View usual(renderer, {});
        shown.look_with(usual);
        settle(usual);
        sharp_bytes = held("sharp picture");
        CHECK(held("light of tiles") > 0);
    }
    // However busy the machine is, the sketch is as fine as it may be, and its light large enough for tiles.
    View view(renderer, {.motion_ms = 1e9});
    shown.look_with(view);
    for (int i = 0; held("light") == 0; ++i) {  // of the sketch
        REQUIRE(i < 1000);
        view.advance();
    }
    REQUIRE(held("sharp picture") == 0);
    renderer.memory().free_idle();
    constexpr uint64_t MARGIN = 4096;
    const uint64_t left = renderer.memory().device_bytes_left();
    REQUIRE(left > sharp_bytes + MARGIN);
    const gpu::Storage other = renderer.memory().create("other", buffer_desc(left - sharp_bytes - MARGIN));
    settle(view);
    CHECK(held("sharp picture") == sharp_bytes);
    CHECK(held("light of tiles") == 0);
    CHECK(all_messages(renderer) == "");
    const Image8 seen = view.read_back();
    const Image8 rendered = to_image8(renderer.render(shown.session, shown.camera).image);
    CHECK(compare_pixels(seen, rendered).max_abs <= 1.0);
    check_valid(renderer);
}

TEST_CASE("paint that there was no memory for is shown once there is")
{
    Shown shown({120, 90});
    Renderer renderer({.device = {.validation = true}, .budget = {48 * MIB, 0}, .threads = 1});
    renderer.load(shown.source, BYTES, shown.session.render);
    const auto paint = [&](int64_t brick) {
        shown.paint(brick);
        renderer.scene().update_mask(shown.mask, {&brick, 1});
    };
    paint(3);
    static_cast<void>(renderer.render(shown.session, shown.camera));
    {
        const uint64_t left = renderer.memory().device_bytes_left();
        const gpu::Storage other = renderer.memory().create("other", buffer_desc(left - 64 * 1024));
        std::string said;
        for (int64_t brick = 4; brick < 40 && said.empty(); ++brick) try {
                paint(brick);
            } catch (const gpu::MemoryError& error) {
                said = error.what();
            }
        CAPTURE(said);
        CHECK(said.starts_with("device memory: what is painted needs "));
        CHECK(renderer.scene().mask().is_stale());
    }
    static_cast<void>(renderer.render(shown.session, shown.camera));  // without paint, but whole
    paint(40);
    const ImageF seen = renderer.render(shown.session, shown.camera).image;
    renderer.load(shown.source, BYTES, shown.session.render);
    renderer.scene().show(Document{shown.mask, TraceGraph{}});
    CHECK(different_bits(seen, renderer.render(shown.session, shown.camera).image) == 0);
    check_valid(renderer);
}

TEST_CASE("a volume that the driver has no memory for in one piece is paged")
{
    const ShortOf memory(34 * MIB);  // the volume takes 41, and paged bricks are tried with less and less
    Renderer renderer({.device = {.validation = true}, .budget = {256 * MIB, 0}, .threads = 2});
    const std::shared_ptr<const VolumeSource> source = open_procedural({.kind = "sphere", .size = {640, 256, 256}});
    renderer.load(source, BYTES, {.sampling = Sampling::exact});
    CHECK_FALSE(renderer.volume().counts().has_value());
    memory.begins();
    renderer.load(source, BYTES, {.sampling = Sampling::exact});
    CHECK(renderer.volume().counts().has_value());
    check_valid(renderer);
}

TEST_CASE("whichever submission of a view fails, it comes to rest on the same picture")
{
    // In folders of the process's own: the layer reads its faults from one file, and logs to the other.
    const std::filesystem::path folder = std::filesystem::temp_directory_path() / sentence("shvr-shortage-", getpid());
    std::filesystem::create_directories(folder);
    const std::filesystem::path now = folder / "now", log = folder / "log";
    setenv("VK_INSTANCE_LAYERS", "VK_LAYER_SHVR_faults", 1);
    setenv("SHVR_FAULTS_NOW", now.c_str(), 1);
    setenv("SHVR_FAULTS_LOG", log.c_str(), 1);
    for (const Paging paging : {Paging::never, Paging::always}) {
        CAPTURE(int(paging));
        Renderer renderer({.device = {.validation = true}, .budget = {256 * MIB, 0}, .threads = 1});
        Shown shown({96, 64});
        shown.session.render.paging = paging;
        shown.session.light.occlusion = {.strength = 0.8, .radius = 4.0, .rays = 2, .automatic = true};
        shown.session.surfaces = {{{10, 10, 10}, {60, 50, 55}, 2.0, 6.0, glm::dvec3(0.1, 0.9, 0.3)}};
        shown.paint(3);
        const auto load = [&] {
            renderer.load(shown.source, BYTES, shown.session.render, true);
            renderer.scene().show(Document{shown.mask, TraceGraph{}});
            renderer.scene().show_surfaces(shown.session.surfaces, TraceGraph{}, shown.session.groups);
        };
        load();
        std::optional<Image8> expected;
        int gave_way = 0;
        // The first ones differ in kind. Every day they are tried alternately, even ones resident and odd ones paged.
        const int stride = repeats(2, 1), begin = is_slow() || paging == Paging::always ? 1 : 2;
        for (int number = 0; number < 200; number = number == 0   ? begin
                                                    : number < 16 ? number + stride
                                                                  : number + 7 * stride) {
            CAPTURE(number);
            load();
            View view(renderer, {});
            shown.look_with(view);
            const auto let_fail = [&](const std::string& fault) {
                std::ofstream(folder / "new") << fault;
                std::filesystem::rename(folder / "new", now);
            };
            let_fail(number > 0 ? sentence("vkQueueSubmit2:", number, ":out_of_host_memory") : std::string());
            int failures = 0;
            for (int i = 0; !view.complete(); ++i) {
                nap(i);
                REQUIRE(i < 10'000'000);
                try {
                    view.advance();
                } catch (const gpu::MemoryError&) {
                    REQUIRE(++failures < 3);
                }
            }
            let_fail("");
            const bool has_fired = failures > 0 || renderer.scene().occlusion_has_no_room();
            gave_way += failures == 0 && renderer.scene().occlusion_has_no_room();
            if (renderer.scene().occlusion_has_no_room()) {  // occlusion was dropped: as if switched off and on
                Session without = shown.session;
                without.light.occlusion.strength = 0.0;
                view.look(without.look(), without.interaction, Shot(shown.camera), without.render.size);
                settle(view);
                shown.look_with(view);
                settle(view);
            }
            const Image8 seen = view.read_back();
            if (!expected) expected = seen;
            CHECK(compare_pixels(seen, *expected).max_abs == 0.0);
            if (number > 0 && !has_fired) break;  // there are no more
        }
        CHECK(gave_way > 0);  // the light, and the view never failed
        check_valid(renderer);
    }
    unsetenv("VK_INSTANCE_LAYERS");
    std::filesystem::remove_all(folder);
}
