// Bricks and leaps are bookkeeping: they must not change one bit of a picture.

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include <doctest/doctest.h>

#include "engine/live/annotator.h"
#include "shaders/counters.h"
#include "tests/support/gpu.h"
#include "tests/support/slow.h"

using namespace shvr;
using namespace shvr::test;

namespace {

/// Blobs in empty space with noise between them: empty cells, full ones and borders everywhere.
TestVolume blobs(const glm::ivec3& size, uint32_t seed)
{
    const TestVolume noise = noise_volume(size, seed);
    TestVolume volume = noise;
    for (int z = 0; z < size.z; ++z)
        for (int y = 0; y < size.y; ++y)
            for (int x = 0; x < size.x; ++x) {
                const size_t at = size_t(x + size.x * (y + size.y * z));
                const double wave = std::sin(0.23 * x) * std::sin(0.31 * y + 1.0) * std::sin(0.27 * z + 2.0);
                volume.voxels[at] = std::floor(std::max(0.0, wave) * 60000.0 + noise.voxels[at] / 65535.0 * 3000.0);
            }
    return volume;
}

/// Ramps, steps, spikes a few codes wide and gaps, anywhere in the code range.
TransferFunction random_function(std::mt19937& random)
{
    std::uniform_real_distribution<double> code(0.0, 65535.0), unit(0.0, 1.0);
    std::vector<ControlPoint> points;
    const int groups = 1 + int(random() % 3);
    for (int i = 0; i < groups; ++i) {
        const double from = code(random), width = random() % 2 ? 4.0 + 200.0 * unit(random) : 20000.0 * unit(random);
        const double opacity = random() % 4 == 0 ? 1.0 : 0.3 * unit(random);
        points.push_back({std::floor(from), GREEN, random() % 3 == 0 ? opacity : 0.0});
        points.push_back({std::min(65535.0, from + width / 2), RED, opacity});
        points.push_back({std::min(65535.0, std::floor(from + width)), BLUE, 0.0});
    }
    return TransferFunction(points);
}

/// `inner` at `offset` in an empty volume.
TestVolume placed(const TestVolume& inner, const glm::ivec3& size, const glm::ivec3& offset)
{
    TestVolume volume = constant_volume(size, 0.0);
    for (int z = 0; z < inner.size.z; ++z)
        for (int y = 0; y < inner.size.y; ++y)
            for (int x = 0; x < inner.size.x; ++x) {
                const glm::ivec3 to = glm::ivec3(x, y, z) + offset;
                volume.voxels[size_t(to.x + size.x * (to.y + size.y * to.z))] =
                    inner.voxels[size_t(x + inner.size.x * (y + inner.size.y * z))];
            }
    return volume;
}

struct Leaping : OnDevice {
    /// The picture without leaps; with them it has the same bits.
    ImageF drawn_without_leaps(Session session, const Camera& camera)
    {
        const ImageF leaping = draw(session, camera);
        session.render.skip_empty_space = false;
        ImageF whole = draw(session, camera);
        check_below("differing bits", double(different_bits(leaping, whole)), 0.0);
        return whole;
    }
};

}  // namespace

TEST_CASE_FIXTURE(OnDevice, "leaping over empty space changes no bit, under random transfer functions")
{
    constexpr uint32_t SEED = 20261121;
    std::mt19937 random(SEED);
    load(blobs({70, 50, 45}, SEED));
    uint64_t with_leaps = 0, without = 0;
    // Any three of what i chooses come together within 140.
    const int functions = repeats(210, 1000);
    for (int i = 0; i < functions; ++i) {
        CAPTURE(i);
        std::uniform_real_distribution<double> unit(0.0, 1.0);
        Session session = plain_session({}, {16, 8});
        session.transfer_function = random_function(random);
        session.light.shaded = i % 3 == 0;
        session.render.step_voxels = std::array{0.25, 0.5, 0.77, 1.0, 2.0}[size_t(i % 5)];
        session.render.preintegration = session.render.step_voxels <= 1.0 && i % 7 < 3;
        if (i % 4 == 1) session.cut = {glm::dvec3(4.0 * unit(random)), glm::dvec3(12.0, 24.0, 40.0)};
        if (i % 4 == 3) {
            session.cut.plane_normal = glm::dvec3(unit(random) - 0.5, unit(random) - 0.5, 0.1 + unit(random));
            session.cut.plane_point = glm::dvec3(60.0 * unit(random), 40.0 * unit(random), 10.0 + 30.0 * unit(random));
        }
        const Camera camera =
            camera_along(volume(), {unit(random) - 0.5, unit(random) - 0.5, unit(random) - 0.5}, 60.0);
        const ImageF leaping = draw(session, camera);
        session.render.skip_empty_space = false;
        check_below("differing bits", double(different_bits(leaping, draw(session, camera))), 0.0);
        if (i % 100 != 0) continue;
        without += work(session, camera)[gpu::COUNTER_SAMPLES];
        session.render.skip_empty_space = true;
        with_leaps += work(session, camera)[gpu::COUNTER_SAMPLES];
    }
    CHECK(with_leaps < without);  // otherwise nothing was leapt over
}

TEST_CASE_FIXTURE(Leaping, "a sample that rounding takes for one of the next voxels is seen")
{
    // Nothing shows along the rays until sample 23, 1.8e-4 voxels past the centre of voxel 26, of which voxel 27 makes
    // it shine. Samples begin 1e-4 before such a centre and gain 1.2e-5 a step, which parts of a voxel round away, so
    // that its place in those (shaders/leap.h) is one before voxel 26. No cell is empty.
    constexpr double SHOWN = 32768.0;
    load(volume_of({48, 8, 8}, [](const glm::dvec3& voxel) {
        if (voxel.x == 27.5 || voxel.y < 2.0 || voxel.y > 6.0) return 65535.0;
        return voxel.x == 26.5 ? SHOWN - 2.0 : 0.0;
    }));
    Session session = plain_session({{SHOWN, GREEN, 0.0}, {65535.0, GREEN, 0.5}}, {4, 4});
    session.cut = {{3.0 - 1e-4, 0.0, 0.0}, {27.2, 8.0, 8.0}};
    session.render.step_voxels = 1.000012;
    const Camera camera = camera_along(volume(), {1.0, 0.0, 0.0}, 0.5);
    const ImageF whole = drawn_without_leaps(session, camera);
    session.cut.upper.x = 25.0;
    CHECK(different_bits(whole, draw(session, camera)) > 0);
}

TEST_CASE_FIXTURE(Leaping, "no leap passes the rest of a ray that shows something")
{
    // Steps of 6: three whole ones, whose middles show nothing, and a rest of 1.5 whose middle, at 18.75, is between
    // two voxels that do. A fourth whole step would have its middle in the next cell, which is empty.
    load(volume_of({32, 8, 8}, [](const glm::dvec3& voxel) { return std::abs(voxel.x - 18.0) < 1.0 ? 65535.0 : 0.0; }));
    Session session = plain_session({{32768.0, GREEN, 0.0}, {65535.0, GREEN, 0.5}}, {4, 4});
    session.cut = {{0.0, 0.0, 0.0}, {19.5, 8.0, 8.0}};
    session.render.step_voxels = 6.0;
    const Camera camera = camera_along(volume(), {1.0, 0.0, 0.0}, 3.0);
    const ImageF whole = drawn_without_leaps(session, camera);
    session.cut.upper.x = 18.0;
    CHECK(different_bits(whole, draw(session, camera)) > 0);
}

TEST_CASE_FIXTURE(Leaping, "leaping changes no bit under the widest angles of view")
{
    load(noise_volume({41, 37, 33}, 5));
    Session session = plain_session({{64000.0, GREEN, 0.0}, {65535.0, RED, 0.5}}, {24, 16});
    for (const double fov : {60.0, 110.0, 150.0, 170.0}) {
        CAPTURE(fov);
        drawn_without_leaps(session, perspective({-12.0, 14.0, 20.0}, {20.0, 18.0, 16.0}, fov));
    }
}

TEST_CASE_FIXTURE(OnDevice, "where brick borders fall changes no bit")
{
    // The same voxels in three places, with brick borders in different positions. Camera, planes and steps are chosen
    // so that every position is exact in float, and only the bricks differ.
    const TestVolume inner = noise_volume({40, 40, 40}, 11);
    const glm::ivec3 whole(80);
    Session session = plain_session(busy_points(), {40, 40});
    session.render.step_voxels = 0.375;
    const auto picture = [&](const glm::ivec3& offset, int axis, bool shaded) {
        load(placed(inner, whole, offset));
        session.light.shaded = shaded;
        session.cut = {glm::dvec3(offset), glm::dvec3(offset + 40)};
        glm::dvec3 back(0.0), up(0.0);
        back[axis] = 1.0;
        up[(axis + 1) % 3] = 1.0;
        Camera camera;
        camera.projection = Camera::Projection::orthographic;
        camera.target = glm::dvec3(offset) + 20.0625;
        camera.eye = camera.target + 64.0 * back;
        camera.up = up;
        camera.height = 40.0;
        camera.near_distance = 32.0;
        return draw(session, camera);
    };
    for (int axis = 0; axis < 3; ++axis)
        for (bool shaded : {false, true}) {
            CAPTURE(axis);
            CAPTURE(shaded);
            const ImageF here = picture(glm::ivec3(4), axis, shaded);
            check_below("differing bits", double(different_bits(here, picture(glm::ivec3(20), axis, shaded))), 0.0);
            check_below("differing bits", double(different_bits(here, picture(glm::ivec3(12, 24, 36), axis, shaded))),
                        0.0);
            CHECK(different_bits(here, draw(plain_session({}, {40, 40}), camera_along(volume(), {1, 0, 0}, 80.0))) > 0);
        }
}

TEST_CASE_FIXTURE(OnDevice, "the device's own filter gives the picture of exact sampling")
{
    const TestVolume noise = noise_volume({37, 41, 35}, 5);
    Session session = plain_session(busy_points(), {24, 24});
    session.light.shaded = true;
    const Camera camera = camera_along(noise, {1.0, 2.0, 3.0}, 50.0);
    load(noise, Sampling::exact);
    const Pixels exact = pixels_of(draw(session, camera));
    if (!renderer().device().traits().linear_r16) return;
    load(noise, Sampling::hardware);
    const Pixels filtered = pixels_of(draw(session, camera));
    // lavapipe filters 16-bit texels in float; a GPU's weights have 8 bits.
    check_below("filtered", worst_difference(exact, filtered), renderer().device().traits().is_cpu ? 1e-4 : 2e-2);
}

TEST_CASE_FIXTURE(OnDevice, "work is counted exactly")
{
    // 64 rays straight through 64 voxels at half-voxel steps, everything visible, two bricks deep.
    load(constant_volume({64, 64, 64}, 30000.0));
    Session session = plain_session(uniform_points(RED, 0.001), {8, 8});
    session.render.step_voxels = 0.5;
    const std::vector<uint64_t> counted = work(session, camera_along(volume(), {0.0, 0.0, 1.0}, 64.0));
    CHECK(counted[gpu::COUNTER_RAYS] == 64);
    CHECK(counted[gpu::COUNTER_SAMPLES] == 64 * 128);
    CHECK(counted[gpu::COUNTER_SHADED] == 0);
    CHECK(counted[gpu::COUNTER_LEAPS] == 0);
    CHECK(counted[gpu::COUNTER_BRICKS_VISITED] == 64 * 2);
    CHECK(counted[gpu::COUNTER_BRICKS_SKIPPED] == 0);
    CHECK(counted == work(session, camera_along(volume(), {0.0, 0.0, 1.0}, 64.0)));
}

static_assert(gpu::COUNTERS_IN_ROW == gpu::COUNTERS);

TEST_CASE_FIXTURE(OnDevice, "groups count in rows of their own, and the report has the sums")
{
    load(constant_volume({64, 64, 64}, 30000.0));
    Session session = plain_session(uniform_points(RED, 0.001), {128, 256});  // 8 x 64 groups of 16 x 4 pixels
    session.render.step_voxels = 0.5;
    const Camera camera = camera_along(volume(), {0.0, 0.0, 1.0}, 64.0);
    const Picture picture = renderer().render(session, camera, {.count_work = true});
    const auto pass = std::ranges::find(picture.passes, "raycast", &gpu::PassReport::name);
    REQUIRE(pass != picture.passes.end());
    CHECK(pass->counted_rows == gpu::COUNTER_ROWS);
    CHECK(pass->counters[gpu::COUNTER_RAYS] == 128 * 256);
    CHECK(pass->counters[gpu::COUNTER_SAMPLES] == 128 * 256 * 128);
}

TEST_CASE_FIXTURE(OnDevice, "a volume that is loaded anew has none of the paint of the last one")
{
    const TestVolume noise = noise_volume({40, 40, 40}, 17);
    load(noise);
    const Session session = plain_session(busy_points(), {32, 32});
    const Camera camera = camera_along(volume(), {1, 2, 3}, 60.0);
    const ImageF unpainted = draw(session, camera);
    Annotator annotator(renderer());
    annotator.paint({.brush = Brush::fill, .group = 3, .radius_voxels = 12.0, .path = {{20, 20, 20}}});
    CHECK(different_bits(draw(session, camera), unpainted) > 0);
    load(noise);
    check_below("differing bits", double(different_bits(draw(session, camera), unpainted)), 0.0);
}
