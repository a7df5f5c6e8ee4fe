// Pictures by the filters of real devices, which round: a kernel that does so stands in for the sampler. lavapipe's own
// filter is as exact as arithmetic.

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include <doctest/doctest.h>

#include "engine/base/image_file.h"
#include "engine/base/image_metrics.h"
#include "tests/gpu/wrong_kernels.h"
#include "tests/support/gpu.h"
#include "tools/golden/run.h"

using namespace shvr;
using namespace shvr::test;

namespace {

// Filters like GPUs: weights of 8 bits, results of 16. The second one also errs by a code, up or down, by position.
#define SHVR_FILTER(error)                                                                                             \
    "    const ivec3 size = textureSize(atlas, 0);\n"                                                                  \
    "    const vec3 texel = at * vec3(size) - 0.5;\n"                                                                  \
    "    const vec3 f = round((texel - floor(texel)) * 256.0) / 256.0;\n"                                              \
    "    const ivec3 lower = ivec3(floor(texel));\n"                                                                   \
    "    float sum = 0.0;\n"                                                                                           \
    "    for (int i = 0; i < 8; ++i) {\n"                                                                              \
    "        const ivec3 corner = ivec3(i & 1, i >> 1 & 1, i >> 2);\n"                                                 \
    "        const vec3 w = mix(1.0 - f, f, vec3(corner));\n"                                                          \
    "        sum += w.x * w.y * w.z * texelFetch(atlas, clamp(lower + corner, ivec3(0), size - 1), 0).x;\n"            \
    "    }\n"                                                                                                          \
    "    return (round(65535.0 * sum) + " error ") / 65535.0;"
const Mistake EIGHT_BITS = {"a filter whose weights have 8 bits", "", "library/density_filtered.glsl",
                            "    return textureLod(atlas, at, 0.0).x;", SHVR_FILTER("0.0")};
const Mistake A_CODE_OFF = {"a filter that errs by a code", "", "library/density_filtered.glsl",
                            "    return textureLod(atlas, at, 0.0).x;",
                            SHVR_FILTER("float(1 - 2 * (lower.x + lower.y & 1))")};

/// A renderer whose kernels of that name filter so.
class Filtering {
public:
    Filtering(const Mistake& filter, const std::string& kernel)
        : kernel_(kernel), wrong_(filter, std::span(&kernel_, 1))
    {
        CHECK(wrong_.count() == 1);
        renderer_.emplace(Renderer::Options{.device = {.device = "", .validation = true}, .threads = 2});
    }
    Filtering(const Filtering&) = delete;
    ~Filtering()
    {
        for (const std::string& message : renderer_->device().take_validation_messages()) FAIL_CHECK(message);
    }
    ImageF draw(const TestVolume& volume, Session session, const Camera& camera, Sampling sampling,
                std::optional<ProbeLook> probe = std::nullopt)
    {
        session.render.sampling = sampling;
        renderer_->load(source_of(volume), {.minimum = volume.minimum, .maximum = volume.maximum}, session.render);
        const Picture picture = renderer_->render(session, camera, {.probe = std::move(probe)});
        const auto is_it = [&](const gpu::PassReport& pass) { return pass.kernel == kernel_; };
        CHECK(std::ranges::any_of(picture.passes, is_it) == (sampling == Sampling::hardware));
        return picture.image;
    }

private:
    std::string kernel_;
    WrongKernels wrong_;
    std::optional<Renderer> renderer_;
};

/// Names of the kernels of all passes in the golden's picture.
std::vector<std::string> kernels_in(const golden::Golden& one)
{
    golden::Studio studio(one);
    std::set<std::string> kernels;
    for (const gpu::PassReport& pass : studio.draw_counted().passes)
        if (!pass.kernel.empty()) kernels.insert(pass.kernel);
    return {kernels.begin(), kernels.end()};
}

}  // namespace

TEST_CASE("a picture by a filter of 8 bits is close to the exact one")
{
    Filtering device(EIGHT_BITS, "raycast_filtered");
    const TestVolume volume = noise_volume({40, 33, 50}, 18);
    const Session session = plain_session(busy_points(), {61, 47});
    const Camera camera = camera_along(volume, {3, 2, 1}, 60.0);
    const ImageF filtered = device.draw(volume, session, camera, Sampling::hardware);
    const ImageF exact = device.draw(volume, session, camera, Sampling::exact);
    CHECK(different_bits(filtered, exact) > 1000);  // it does round
    CHECK(compare_pixels(to_image8(filtered), to_image8(exact)).max_abs <= 2.0);
}

TEST_CASE("every golden is near its picture where a filter of 8 bits draws it")
{
    golden::set_environment();
    size_t filtered = 0, other = 0;
    for (golden::Golden one : golden::goldens_in("tests/golden")) {
        CAPTURE(one.name);
        one.settings.push_back("render.sampling=hardware");
        const WrongKernels eight_bits(EIGHT_BITS, kernels_in(one));
        filtered += eight_bits.count() > 0;
        const Image8 seen = golden::Studio(one).draw(), expected = read_png(one.picture());
        const PixelDifference difference = compare_pixels(seen, expected);
        CHECK(difference.rmse <= 0.5);
        other += difference.max_abs > 0.0;
    }
    CHECK(filtered > 20);
    CHECK(other > 10);  // it does round
}

/// There are bands, of up to 12 levels, where the highlight is sharp; `render.sampling=exact` has none.
TEST_CASE("light on a smooth field, magnified a hundred times, is near the exact one where a filter of 8 bits draws it")
{
    Filtering device(EIGHT_BITS, "raycast_filtered");
    // A pixel is a hundredth of a voxel: weights of 8 bits are seen one by one.
    const TestVolume volume = volume_of({12, 12, 12}, [](const glm::dvec3& voxel) {
        return 65535.0 * std::exp(-0.02 * glm::dot(voxel - 6.0, voxel - 6.0));
    });
    Session session = plain_session({{30000.0, WHITE, 0.0}, {31000.0, WHITE, 1.0}, {65535.0, WHITE, 1.0}}, {128, 128});
    session.light = {.shaded = true, .ambient = 0.1, .diffuse = 0.6, .specular = 0.4, .shininess = 32.0};
    session.render.step_voxels = 0.25;
    const Camera camera = camera_along(volume, {1, 2, 3}, 2.0);
    const ImageF filtered = device.draw(volume, session, camera, Sampling::hardware);
    const ImageF exact = device.draw(volume, session, camera, Sampling::exact);
    double worst_step = 0.0, worst = 0.0;
    for (int y = 0; y < 128; ++y)
        for (int x = 1; x < 128; ++x) {
            const size_t at = 4 * size_t(y * 128 + x);
            const double here = double(filtered.rgba[at]) - double(exact.rgba[at]);
            const double before = double(filtered.rgba[at - 4]) - double(exact.rgba[at - 4]);
            worst_step = std::max(worst_step, std::abs(here - before));
            worst = std::max(worst, std::abs(here));
        }
    CHECK(worst > 0.0);
    CHECK(worst <= 0.06);
    CHECK(worst_step <= 0.06);
}

TEST_CASE("an iso-surface is where it is by arithmetic, whatever the filter rounds")
{
    Filtering device(EIGHT_BITS, "raycast_filtered_shelled");
    // Steep and rough: a filter's rounding is a share of the difference between neighbours.
    const TestVolume volume = noise_volume({24, 20, 22}, 5);
    Session session = plain_session(unseen_points(), {80, 64});
    session.light = {.shaded = true, .ambient = 1.0, .diffuse = 0.0, .specular = 0.0};
    const Camera camera = camera_along(volume, {1, 2, 3}, 30.0);
    const ProbeLook probe{.center = 0.5 * glm::dvec3(volume.size),
                          .radius = 40.0,
                          .color = glm::dvec3(1.0),
                          .ball_share = 0.0,
                          .shell = ShellLook{.threshold = 30000.0, .opacity = 0.1, .is_box = true}};
    const ImageF filtered = device.draw(volume, session, camera, Sampling::hardware, probe);
    const ImageF exact = device.draw(volume, session, camera, Sampling::exact, probe);
    size_t seen = 0, other = 0;
    for (size_t i = 3; i < exact.rgba.size(); i += 4) {
        seen += exact.rgba[i - 1] > 0.0f;
        other += std::abs(exact.rgba[i - 1] - filtered.rgba[i - 1]) > 1e-4f;  // another number of crossings
    }
    CHECK(seen > 2000);
    CHECK(other == 0);
}

TEST_CASE("where a filter errs by a code, a picture is the same with and without skipping")
{
    Filtering device(A_CODE_OFF, "raycast_filtered");
    // Plateaus one code below what is seen, which the filter's error reaches.
    const TestVolume volume =
        volume_of({64, 64, 64}, [](const glm::dvec3& voxel) { return voxel.x < 32.0 ? 29999.0 : 20000.0; });
    Session session = plain_session({{29999.5, RED, 0.0}, {30000.0, RED, 0.2}, {30100.0, RED, 0.2}}, {32, 32});
    const Camera camera = camera_along(volume, {1, 2, 3}, 90.0);
    const ImageF leaping = device.draw(volume, session, camera, Sampling::hardware);
    session.render.skip_empty_space = false;
    const ImageF stepping = device.draw(volume, session, camera, Sampling::hardware);
    CHECK(different_bits(leaping, stepping) == 0);
    CHECK(different_bits(stepping, device.draw(volume, session, camera, Sampling::exact)) > 100);
}
