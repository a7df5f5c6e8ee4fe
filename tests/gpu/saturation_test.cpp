// Pictures with reduced saturation: the device draws the bits of a naive reference on the CPU.

#include <algorithm>
#include <bit>

#include <doctest/doctest.h>

#include "tests/support/gpu.h"

using namespace shvr;
using namespace shvr::test;

namespace {

/// Pixel by pixel, each product and sum rounded to float.
ImageF mixed_with_grey(ImageF image, double saturation)
{
    for (size_t i = 0; i < image.rgba.size(); i += 4) {
        float* const light = &image.rgba[i];
        const float red = 0.2126f * (light[0] - light[1]), blue = 0.0722f * (light[2] - light[1]);
        const float grey = (light[1] + red) + blue;
        for (int channel = 0; channel < 3; ++channel)
            light[channel] = grey + float(saturation) * (light[channel] - grey);
    }
    return image;
}

class Grey : public OnDevice {
public:
    Session session = plain_session(busy_points(), {150, 90});
    Camera camera;
    Grey()
    {
        load(noise_volume({40, 33, 50}, 61));
        camera = camera_along(volume(), {1, 2, 3}, 60.0);
    }
    ImageF drawn(double saturation)
    {
        session.render.saturation = saturation;
        return draw(session, camera);
    }
    std::vector<std::string> passes(double saturation)
    {
        session.render.saturation = saturation;
        std::vector<std::string> names;
        const Picture picture = renderer().render(session, camera);
        for (const PassData& pass : picture.graph.passes()) names.push_back(pass.name);
        return names;
    }
};

}  // namespace

TEST_CASE_FIXTURE(Grey, "a picture with less colour has the bits of the reference, whatever is behind the volume")
{
    for (const glm::dvec4& background : {glm::dvec4(0, 0, 0, 1), glm::dvec4(1), glm::dvec4(0.2, 0.5, 0.1, 0.3)}) {
        session.render.background = background;
        const ImageF plain = drawn(1.0);
        for (const double saturation : {0.0, 0.1, 0.5, 0.999}) {
            CAPTURE(saturation);
            const ImageF image = drawn(saturation);
            CHECK(different_bits(image, mixed_with_grey(plain, saturation)) == 0);
            CHECK(different_bits(image, plain) > 10000);
        }
    }
}

TEST_CASE_FIXTURE(Grey, "no colour at all leaves three equal channels, of the same luminance")
{
    const ImageF plain = drawn(1.0), grey = drawn(0.0);
    size_t wrong = 0;
    double worst = 0.0;
    for (size_t i = 0; i < grey.rgba.size(); i += 4) {
        wrong += grey.rgba[i] != grey.rgba[i + 1] || grey.rgba[i] != grey.rgba[i + 2] ||
                 grey.rgba[i + 3] != plain.rgba[i + 3];
        const double luminance =
            0.2126 * plain.rgba[i] + 0.7152 * plain.rgba[i + 1] + 0.0722 * double(plain.rgba[i + 2]);
        worst = std::max(worst, std::abs(luminance - double(grey.rgba[i])));
    }
    CHECK(wrong == 0);
    check_below("luminance", worst, 1e-6);
}

TEST_CASE_FIXTURE(Grey, "greys keep their bits: slices, and a white background")
{
    session.view.arrangement = Arrangement::slices;
    const ImageF plain = drawn(1.0), image = drawn(0.25);
    size_t greys = 0, changed = 0;
    for (size_t i = 0; i < plain.rgba.size(); i += 4) {
        if (plain.rgba[i] != plain.rgba[i + 1] || plain.rgba[i] != plain.rgba[i + 2]) continue;
        ++greys;
        for (size_t j = i; j < i + 4; ++j)
            changed += std::bit_cast<uint32_t>(plain.rgba[j]) != std::bit_cast<uint32_t>(image.rgba[j]);
    }
    CHECK(greys > 5000);
    CHECK(changed == 0);
}

TEST_CASE_FIXTURE(Grey, "each eye's picture is greyed before an anaglyph is made of them")
{
    session.view.arrangement = Arrangement::stereo;
    const ImageF both = drawn(0.25);
    session.view.stereo.output = StereoOutput::anaglyph;
    const ImageF glasses = drawn(0.25);
    session.view.arrangement = Arrangement::single;
    const auto [left, right] = eyes_of(camera, session.view.stereo);
    const ImageF red = draw(session, left), cyan = draw(session, right);
    size_t wrong = 0;
    for (size_t i = 0; i < glasses.rgba.size(); i += 4)
        wrong += glasses.rgba[i] != red.rgba[i] || glasses.rgba[i + 1] != cyan.rgba[i + 1] ||
                 glasses.rgba[i + 2] != cyan.rgba[i + 2];
    CHECK(wrong == 0);
    CHECK(different_bits(glasses, both) > 1000);
}

TEST_CASE_FIXTURE(Grey, "full colour adds no pass, less colour adds one")
{
    static_cast<void>(drawn(1.0));  // the first picture prepares the volume as well
    const std::vector<std::string> plain = passes(1.0);
    std::vector<std::string> less = passes(0.5);
    CHECK(std::count(less.begin(), less.end(), "saturation") == 1);
    std::erase(less, "saturation");
    CHECK((less == plain));
    CHECK((passes(1.0) == plain));
}
