// The thin-shell iso-surface around the probe against roots found in double precision. A pixel encodes the place where
// its ray stopped by its share of distance blending, which is linear in the depth.

#include <cmath>
#include <random>

#include <doctest/doctest.h>

#include "tests/support/gpu.h"

using namespace shvr;
using namespace shvr::test;

namespace {

/// Where the field crosses `threshold` from `begin` to `end`: signs at small steps, then bisection.
std::vector<double> crossings(const TestVolume& volume, const glm::dvec3& origin, const glm::dvec3& direction,
                              double begin, double end, double threshold)
{
    constexpr double STEP = 1.0 / 128;
    const auto is_inside = [&](double s) { return value_at(volume, origin + s * direction) >= threshold; };
    std::vector<double> found;
    for (double s = begin; s < end; s += STEP) {
        double low = s, high = std::min(s + STEP, end);
        const bool was = is_inside(low);
        if (was == is_inside(high)) continue;
        for (int i = 0; i < 40; ++i) (is_inside(0.5 * (low + high)) == was ? low : high) = 0.5 * (low + high);
        found.push_back(0.5 * (low + high));
    }
    return found;
}

class Shells : public OnDevice {
public:
    /// White where a shell is, black at the far end of the volume's box.
    Session session_of(const glm::uvec2& pixels) const
    {
        Session session = plain_session(unseen_points(), pixels);
        session.light = {.shaded = true, .ambient = 1.0, .diffuse = 0.0, .specular = 0.0};
        session.blend = {.size = 1.0, .rate = 1.0, .color = glm::dvec3(0.0)};
        session.render.background = glm::dvec4(0.0);
        return session;
    }
    ImageF picture(const Session& session, const Camera& camera, const ProbeLook& probe)
    {
        return renderer().render(session, camera, {.probe = probe}).image;
    }
    ProbeLook shell(double threshold, double opacity, double radius, bool is_box = true)
    {
        return {.center = 0.5 * glm::dvec3(volume().size) * volume().spacing,
                .radius = radius,
                .color = glm::dvec3(1.0),
                .ball_share = 0.0,
                .shell = ShellLook{.threshold = threshold, .opacity = opacity, .is_box = is_box}};
    }
    /// The ray of a pixel in voxel space, of unit length in a volume of cubic voxels, from the box on.
    struct Line {
        glm::dvec3 origin, direction;
    };
    Line ray(const Camera& camera, const glm::uvec2& pixels, uint32_t x, uint32_t y) const
    {
        const glm::dvec2 at = glm::dvec2(x, y) + 0.5;
        const glm::dvec3 a = unproject(camera, pixels, at, 1.0), b = unproject(camera, pixels, at, 2.0);
        return {a, glm::normalize(b - a)};
    }
};

TestVolume ball(double radius, const glm::dvec3& middle, const glm::ivec3& size)
{
    return volume_of(size, [=](const glm::dvec3& voxel) {
        return std::clamp(30000.0 - 900.0 * (glm::distance(voxel, middle) - radius), 0.0, 65535.0);
    });
}

}  // namespace

TEST_CASE_FIXTURE(Shells, "the first crossing is where the reference finds it, to a thousandth of a voxel")
{
    const glm::uvec2 pixels(40, 32);
    for (const bool is_noise : {false, true}) {
        load(is_noise ? noise_volume({24, 20, 22}, 5) : ball(9.3, {12.2, 10.1, 11.4}, {24, 20, 22}));
        const Session session = session_of(pixels);
        for (const glm::dvec3 direction : {glm::dvec3(0, 0, 1), glm::dvec3(1, 2, 3), glm::dvec3(-3, 1, 0.2)}) {
            const Camera camera = camera_along(volume(), direction, 30.0);
            const ImageF image = picture(session, camera, shell(30000.0, 1.0, 40.0));
            const glm::dvec4 depth = depth_plane(camera, glm::dvec3(0.0), glm::dvec3(volume().size), volume().spacing);
            double worst = 0.0, squares = 0.0, extent = 1.0 / glm::length(glm::dvec3(depth));
            size_t hits = 0, wrong = 0;
            for (uint32_t y = 0; y < pixels.y; ++y)
                for (uint32_t x = 0; x < pixels.x; ++x) {
                    const Line line = ray(camera, pixels, x, y);
                    const glm::dvec3 a = -line.origin / line.direction;
                    const glm::dvec3 b = (glm::dvec3(volume().size) - line.origin) / line.direction;
                    const glm::dvec3 low = glm::min(a, b), high = glm::max(a, b);
                    const double begin = std::max({low.x, low.y, low.z}), end = std::min({high.x, high.y, high.z});
                    const float* const pixel = &image.rgba[4 * size_t(x + pixels.x * y)];
                    if (!(begin < end)) {
                        CHECK(pixel[3] == 0.0f);
                        continue;
                    }
                    const std::vector<double> expected =
                        crossings(volume(), line.origin, line.direction, begin, end, 30000.0);
                    const bool is_hit = pixel[3] > 0.5f;
                    if (is_hit != !expected.empty()) {
                        ++wrong;
                        continue;
                    }
                    if (!is_hit) continue;
                    const glm::dvec3 at = line.origin + expected[0] * line.direction;
                    const double error =
                        std::abs((1.0 - double(pixel[0])) - (glm::dot(glm::dvec3(depth), at) + depth.w)) * extent;
                    // Either may miss a pair of crossings closer than the reference's step.
                    if (is_noise && error > 0.05) {
                        ++wrong;
                        continue;
                    }
                    worst = std::max(worst, error);
                    squares += error * error;
                    ++hits;
                }
            CHECK(hits > 150);
            CHECK(wrong <= (is_noise ? hits / 100 : 0));
            check_below("voxels from the root, rms", std::sqrt(squares / double(hits)), 1e-3);
            check_below("voxels from the root", worst, 1e-2);
        }
    }
}

TEST_CASE_FIXTURE(Shells, "a ball's shell has no hole from any side, with steps of a voxel")
{
    const glm::dvec3 middle(24.3, 23.8, 24.1);
    load(ball(20.3, middle, {48, 48, 48}));
    const glm::uvec2 pixels(24, 24);
    Session session = session_of(pixels);
    session.render.step_voxels = 1.0;
    std::mt19937 random(11);
    std::normal_distribution<double> normal;
    for (int view = 0; view < 300; ++view) {
        CAPTURE(view);
        size_t holes = 0, ghosts = 0;
        const Camera camera = camera_along(volume(), {normal(random), normal(random), normal(random)}, 48.0);
        const ImageF image = picture(session, camera, shell(30000.0, 1.0, 60.0));
        for (uint32_t y = 0; y < pixels.y; ++y)
            for (uint32_t x = 0; x < pixels.x; ++x) {
                const Line line = ray(camera, pixels, x, y);
                const glm::dvec3 way = middle - line.origin;
                const double distance = glm::length(way - glm::dot(way, line.direction) * line.direction);
                const bool is_hit = image.rgba[4 * size_t(x + pixels.x * y) + 3] > 0.5f;
                holes += distance < 20.2 && !is_hit;
                ghosts += distance > 20.4 && is_hit;
            }
        check_below("pixels that are holes", double(holes), 0.0);
        check_below("pixels beside the ball that are hit", double(ghosts), 0.0);
    }
}

TEST_CASE_FIXTURE(Shells, "every crossing counts once")
{
    load(ball(9.3, {12.2, 10.1, 11.4}, {24, 20, 22}));
    const Camera camera = camera_along(volume(), {1, 2, 3}, 4.0);  // through the middle: in and out
    const Session session = session_of({8, 8});
    const ImageF twice = picture(session, camera, shell(30000.0, 0.3, 40.0));
    const auto off = [](const ImageF& image, double opacity) {
        double most = 0.0;
        for (size_t i = 3; i < image.rgba.size(); i += 4)
            most = std::max(most, std::abs(double(image.rgba[i]) - opacity));
        return most;
    };
    check_below("opacity, in and out", off(twice, 1.0 - 0.7 * 0.7), 2e-6);
    // The region ends inside: only the entry is drawn. Its border is no surface.
    ProbeLook half = shell(30000.0, 0.3, 6.0, false);
    half.center = glm::dvec3(12.2, 10.1, 11.4) - 9.3 * glm::normalize(camera.target - camera.eye);
    const ImageF once = picture(session, camera, half);
    check_below("opacity, entry alone", off(once, 0.3), 2e-6);

    // Voxels exactly at the threshold, and a plateau there: inside from where it is reached.
    load(volume_of({16, 16, 16}, [](const glm::dvec3& voxel) { return voxel.z < 8.0 ? 10000.0 : 30000.0; }));
    const Camera along_z = camera_along(volume(), {0, 0, 1}, 8.0), across = camera_along(volume(), {1, 0, 0}, 16.0);
    const ImageF plateau = picture(session, along_z, shell(30000.0, 0.25, 40.0));
    check_below("opacity, a plateau at the threshold", off(plateau, 0.25), 2e-6);
    const ImageF grazing = picture(session, across, shell(30000.0, 0.25, 40.0));
    check_below("opacity, along a plateau, never through", off(grazing, 0.0), 0.0);
    // Thresholds that the volume never reaches.
    for (const double threshold : {5000.0, 60000.0})
        check_below("opacity, at thresholds never reached",
                    off(picture(session, along_z, shell(threshold, 0.25, 40.0)), 0.0), 0.0);
}

TEST_CASE_FIXTURE(Shells, "a shell lies in fog at its true depth, to half a step")
{
    load(volume_of({32, 32, 32}, [](const glm::dvec3& voxel) { return 20000.0 + 1000.0 * voxel.z; }));
    Session session = plain_session({{0.0, RED, 0.03}, {65535.0, RED, 0.03}}, {4, 4});
    session.light = {.shaded = true, .ambient = 1.0, .diffuse = 0.0, .specular = 0.0};
    const Camera camera = camera_along(volume(), {0, 0, -1}, 4.0);  // down: the way is 32 - z
    const double sigma = depth_of_opacity(0.03), opacity = 0.5;
    for (const double z : {7.3, 15.0, 24.9}) {
        ProbeLook look = shell(20000.0 + 1000.0 * z, opacity, 60.0);
        look.color = BLUE;
        const ImageF image = picture(session, camera, look);
        const double before = std::exp(-sigma * (32.0 - z)), whole = std::exp(-sigma * 32.0);
        const glm::dvec3 expected =
            RED * (1.0 - before) + before * (opacity * BLUE) + (1.0 - opacity) * RED * (before - whole);
        const double bound = 0.5 * session.render.step_voxels * sigma * opacity + 1e-4;
        for (int c = 0; c < 3; ++c) {
            CAPTURE(z);
            check_below("colour", std::abs(double(image.rgba[size_t(c)]) - expected[c]), bound);
        }
    }
}

TEST_CASE_FIXTURE(Shells, "a shell that is not seen changes no bit")
{
    load(noise_volume({40, 33, 50}, 18));
    Session session = plain_session(busy_points(), {61, 47});
    const Camera camera = camera_along(volume(), {3, 2, 1}, 60.0);
    const ImageF without = draw(session, camera);
    check_below("differing bits", double(different_bits(picture(session, camera, shell(30000.0, 0.0, 10.0)), without)),
                0.0);
    ProbeLook elsewhere = shell(30000.0, 0.5, 10.0);
    elsewhere.center = {-500.0, 0.0, 0.0};
    check_below("differing bits", double(different_bits(picture(session, camera, elsewhere), without)), 0.0);
    CHECK(different_bits(picture(session, camera, shell(30000.0, 0.5, 10.0)), without) > 100);
}

TEST_CASE("a shell is the same with paged bricks, though nothing else of them is seen")
{
    const std::shared_ptr<const VolumeSource> tubes =
        open_procedural({.kind = "tubes", .size = {128, 128, 128}, .seed = 3});
    Session session;
    session.transfer_function = TransferFunction({{300.0, glm::dvec3(1.0), 0.0}, {400.0, glm::dvec3(1.0), 1.0}});
    session.render.size = {96, 80};
    session.render.sampling = Sampling::exact;
    session.render.detail = 0.0;
    Renderer renderer({.device = {.validation = true}, .threads = 2});
    const Camera camera = camera_looking("front", tubes->info());
    for (const bool is_box : {false, true}) {
        const ProbeLook probe{.center = {60.0, 66.0, 70.0},
                              .radius = 25.0,
                              .color = {1.0, 0.5, 0.1},
                              .ball_share = 0.1,
                              .shell = ShellLook{.threshold = 100.0, .opacity = 0.4, .is_box = is_box}};
        ImageF images[2];
        for (const Paging paging : {Paging::always, Paging::never}) {
            session.render.paging = paging;
            renderer.load(tubes, {.minimum = 0.0, .maximum = 255.0}, session.render);
            const Picture picture = renderer.render(session, camera, {.probe = probe});
            CHECK(picture.complete);
            images[paging == Paging::never] = picture.image;
        }
        CHECK(different_bits(images[0], images[1]) == 0);
        CHECK(different_bits(images[0], renderer.render(session, camera).image) > 50);
    }
    for (const std::string& message : renderer.device().take_validation_messages()) FAIL_CHECK(message);
}
