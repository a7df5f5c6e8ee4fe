// The probe's ball: a translucent one blends the pictures with an opaque ball and without; and the things that hide it.

#include <algorithm>

#include <doctest/doctest.h>

#include "tests/support/gpu.h"

using namespace shvr;
using namespace shvr::test;

namespace {

class Ball : public OnDevice {
public:
    Session session = plain_session(busy_points(), {150, 90});
    Camera camera;
    Ball()
    {
        load(noise_volume({40, 33, 50}, 62));
        camera = camera_along(volume(), {1, 2, 3}, 60.0);
    }
    static ProbeLook look(double opacity)
    {
        return {.center = {20, 16, 25},
                .radius = 9.0,
                .color = {0.9, 0.2, 0.1},
                .ball_opacity = opacity,
                .shell = {},
                .preview = {}};
    }
    Picture picture(const std::optional<ProbeLook>& probe)
    {
        return renderer().render(session, camera, {.probe = probe});
    }
    ImageF drawn(double opacity) { return picture(look(opacity)).image; }
    std::vector<std::string> passes(double opacity)
    {
        std::vector<std::string> names;
        const Picture seen = picture(look(opacity));
        for (const PassData& pass : seen.graph.passes()) names.push_back(pass.name);
        return names;
    }
};

/// Each product and sum rounded to float.
ImageF mixed(ImageF opaque, const ImageF& without, double opacity)
{
    for (size_t i = 0; i < opaque.rgba.size(); ++i)
        opaque.rgba[i] = opaque.rgba[i] + float(1.0 - opacity) * (without.rgba[i] - opaque.rgba[i]);
    return opaque;
}

}  // namespace

TEST_CASE_FIXTURE(Ball, "a translucent ball has the bits of two pictures that are mixed")
{
    const ImageF opaque = drawn(1.0), without = picture(std::nullopt).image;
    CHECK(different_bits(opaque, without) > 1000);
    for (const double opacity : {0.25, 0.5, 0.9}) {
        CAPTURE(opacity);
        CHECK(different_bits(drawn(opacity), mixed(opaque, without, opacity)) == 0);
    }
    CHECK(different_bits(drawn(0.0), without) == 0);
}

TEST_CASE_FIXTURE(Ball, "each eye's ball is translucent before an anaglyph is made of them")
{
    session.view.arrangement = Arrangement::stereo;
    session.view.stereo.output = StereoOutput::anaglyph;
    const ImageF opaque = drawn(1.0), without = picture(std::nullopt).image, half = drawn(0.5);
    double worst = 0.0;  // opacities are joined after mixing
    for (size_t i = 0; i < half.rgba.size(); ++i)
        worst =
            std::max(worst, std::abs(double(half.rgba[i]) - 0.5 * (double(opaque.rgba[i]) + double(without.rgba[i]))));
    check_below("difference to the mean", worst, 1e-6);
}

TEST_CASE_FIXTURE(Ball, "an opaque ball adds no pass, a translucent one draws twice and mixes")
{
    static_cast<void>(drawn(1.0));  // the first picture prepares the volume as well
    const std::vector<std::string> plain = passes(1.0);
    std::vector<std::string> translucent = passes(0.5);
    CHECK(std::count(translucent.begin(), translucent.end(), "mix") == 1);
    CHECK(std::count(translucent.begin(), translucent.end(), "raycast_surfaced") ==
          std::count(plain.begin(), plain.end(), "raycast_surfaced"));
    CHECK(translucent.size() == plain.size() + 2);  // another picture, without surfaces, and the mixing
    CHECK(passes(1.0) == plain);
}

TEST_CASE_FIXTURE(Ball,
                  "without what is solid neither surfaces nor the ball are drawn, and without the volume only they")
{
    renderer().scene().set_surfaces({{{5, 5, 5}, {30, 20, 40}, 3.0, 1.0, glm::dvec3(0.1, 0.8, 0.2)}});
    const ImageF all = drawn(1.0);
    session.view.meshes = false;
    const ImageF volume_alone = drawn(1.0);
    renderer().scene().set_surfaces({});
    CHECK(different_bits(volume_alone, picture(std::nullopt).image) == 0);
    CHECK(different_bits(volume_alone, all) > 1000);
    session.view.meshes = true;
    session.view.volume = false;
    const ImageF nothing = picture(std::nullopt).image;
    size_t others = 0;
    for (size_t i = 4; i < nothing.rgba.size(); ++i) others += nothing.rgba[i] != nothing.rgba[i - 4];
    CHECK(others == 0);
    CHECK(different_bits(drawn(1.0), nothing) > 500);
}

TEST_CASE_FIXTURE(Ball, "what is unpainted fades as its opacity is multiplied, at 1 with the same bits")
{
    const ImageF plain = picture(std::nullopt).image;
    session.unpainted.opacity = 0.5;
    Session halved = session;
    halved.unpainted.opacity = 1.0;
    std::vector<ControlPoint> points(session.transfer_function.points().begin(),
                                     session.transfer_function.points().end());
    for (ControlPoint& point : points) point.opacity *= 0.5;
    halved.transfer_function = TransferFunction(points);
    const ImageF faded = picture(std::nullopt).image;
    CHECK(different_bits(faded, plain) > 10000);
    CHECK(different_bits(faded, renderer().render(halved, camera).image) == 0);
}
