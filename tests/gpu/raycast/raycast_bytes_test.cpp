// Volumes of bytes are kept in a byte a voxel, and look as if their codes took 16 bits.

#include <algorithm>
#include <cmath>
#include <functional>

#include <doctest/doctest.h>

#include "tests/support/gpu.h"

using namespace shvr;
using namespace shvr::test;

namespace {

/// The same voxels and window, so the same codes.
struct Twins {
    TestVolume bytes, words;
};

Twins twins(const glm::ivec3& size, uint32_t seed)
{
    TestVolume bytes = noise_volume(size, seed);
    bytes.type = VoxelType::uint8;
    bytes.maximum = 255.0;
    for (double& voxel : bytes.voxels) voxel = std::floor(voxel / 257.0);
    TestVolume words = bytes;
    words.type = VoxelType::uint16;
    return {bytes, words};
}

struct Case {
    const char* name;
    std::function<void(Session&)> change;
    bool is_shelled = false;
};

}  // namespace

TEST_CASE_FIXTURE(OnDevice, "a volume of bytes is drawn as one of 16 bits with the same codes is, bit for bit")
{
    const Twins scene = twins({70, 45, 51}, 41);
    const Case cases[] = {
        {"unshaded", [](Session&) {}},
        {"every sample", [](Session& session) { session.render.skip_empty_space = false; }},
        {"shaded", [](Session& session) { session.light.shaded = true; }},
        {"pre-integrated", [](Session& session) { session.render.preintegration = true; }},
        {"ambient light",
         [](Session& session) {
             session.light.shaded = true;
             session.light.occlusion = {.strength = 0.8, .radius = 6.0};
         }},
        {"a shell", [](Session&) {}, true},
    };
    for (const Paging paging : {Paging::never, Paging::always})
        for (const Case& each : cases) {
            CAPTURE(int(paging));
            CAPTURE(std::string(each.name));
            ImageF images[2];
            for (const bool is_wide : {false, true}) {
                const TestVolume& volume = is_wide ? scene.words : scene.bytes;
                Session session = plain_session(
                    {{60.0, RED, 0.0}, {110.0, GREEN, 0.2}, {170.0, BLUE, 0.02}, {220.0, WHITE, 0.6}}, {48, 40});
                session.render.paging = paging;
                session.render.detail = 0.0;
                each.change(session);
                renderer().load(source_of(volume), measure(*source_of(volume)), session.render,
                                session.light.occlusion.strength > 0.0);
                RenderOptions options;
                if (each.is_shelled)
                    options.probe = ProbeLook{.center = glm::dvec3(volume.size) * 0.5,
                                              .radius = 18.0,
                                              .ball_share = 0.0,
                                              .shell = ShellLook{.threshold = 128.0, .opacity = 0.4}};
                const Picture picture = renderer().render(session, camera_along(volume, {1, 2, 3}, 70.0), options);
                CHECK(picture.complete);
                images[is_wide] = picture.image;
            }
            CHECK(different_bits(images[0], images[1]) == 0);
            const auto brighter = [](float value) { return value > 0.2f && value < 1.0f; };
            CHECK(std::ranges::count_if(images[0].rgba, brighter) > 500);  // something is seen
        }
}

TEST_CASE_FIXTURE(OnDevice, "a resident volume of bytes takes at most 1.5 bytes a voxel of device memory")
{
    for (const auto& [side, most] : {std::pair{64, 1.5}, std::pair{128, 1.37}, std::pair{256, 1.33}}) {
        CAPTURE(side);
        TestVolume volume = constant_volume(glm::ivec3(side), 100.0);
        volume.type = VoxelType::uint8;
        volume.maximum = 255.0;
        renderer().load(source_of(volume), {.minimum = 0.0, .maximum = 255.0}, {.sampling = Sampling::exact});
        uint64_t bytes = 0;
        for (const auto& [name, each] : renderer().memory().bytes_by_name())
            for (const char* of_volume :
                 {"atlas", "page table", "cell ranges", "leap grid", "sample bits", "leap scratch"})
                if (name == of_volume) bytes += each;
        const double voxels = double(side) * side * side;
        CHECK(double(bytes) > voxels);
        CHECK(double(bytes) <= most * voxels);
        CHECK(double(Scene::resident_bytes(volume.info(), AtlasCodes::exact8, false)) <= double(bytes));
    }
}
