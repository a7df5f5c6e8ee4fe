// Pictures by the filters of real devices, which round: a kernel that does so stands in for the sampler. lavapipe's own
// filter is as exact as arithmetic.

#include <algorithm>
#include <cmath>
#include <optional>

#include <doctest/doctest.h>

#include "engine/base/image_metrics.h"
#include "tests/gpu/wrong_kernels.h"
#include "tests/support/gpu.h"

using namespace shvr;
using namespace shvr::test;

namespace {

// As GPUs filter: weights of 8 bits, results of 16. The second one also errs by a code, up or down, by place.
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

TEST_CASE("an iso-surface is where it is by arithmetic, whatever the filter rounds")
{
    Filtering device(EIGHT_BITS, "raycast_filtered_shelled");
    // Steep and rough: what a filter rounds is a share of the difference between neighbours.
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
