// No kernel reads or writes beside its buffers: by code that the validation layer adds to kernels (GPU-assisted
// validation). lavapipe lets it pass, and on a GPU it would be another buffer, or a lost device: hence robust access,
// which the program has and this test does without.

#include <cstdlib>
#include <optional>

#include <doctest/doctest.h>

#include "engine/live/annotator.h"
#include "tests/gpu/wrong_kernels.h"
#include "tests/support/gpu.h"

using namespace shvr;
using namespace shvr::test;

namespace {

/// Turns on the GPU-assisted checks of the validation layer for devices created during its lifetime.
class Assisted {
public:
    Assisted()
    {
        if (const char* const before = std::getenv(NAME)) before_ = before;
        setenv(NAME, "VK_VALIDATION_FEATURE_ENABLE_GPU_ASSISTED_EXT", 1);
    }
    Assisted(const Assisted&) = delete;
    ~Assisted()
    {
        if (before_)
            setenv(NAME, before_->c_str(), 1);
        else
            unsetenv(NAME);
    }

private:
    static constexpr const char* NAME = "VK_LAYER_ENABLES";
    std::optional<std::string> before_;
};

/// Validation messages of all passes that pictures and paint need.
std::vector<std::string> messages_of_work(Paging paging)
{
    Renderer renderer({.device = {.validation = true, .robust_buffers = false}, .threads = 1});
    Session session = plain_session(busy_points(), {24, 20});
    session.light.shaded = true;
    session.light.occlusion = {.strength = 0.8, .radius = 4.0, .rays = 4};
    session.render.paging = paging;
    session.surfaces = {{{5, 5, 5}, {40, 30, 35}, 2.0, 4.0, RED}};
    const std::shared_ptr<const VolumeSource> source =
        open_procedural({.kind = "tubes", .size = {70, 66, 68}, .seed = 3});
    renderer.load(source, {.minimum = 0.0, .maximum = 255.0}, session.render, true);
    renderer.scene().set_surfaces(session.surfaces);
    Annotator annotator(renderer);
    for (const Brush brush : {Brush::fill, Brush::flood, Brush::speckle}) {
        const PaintOp op{
            .brush = brush, .group = 3, .threshold = 60.0, .radius_voxels = 9.0, .path = {{30, 32, 33}, {34, 30, 33}}};
        annotator.paint(op);
    }
    const ProbeLook probe{.center = {30, 32, 33},
                          .radius = 12.0,
                          .ball_share = 0.3,
                          .shell = ShellLook{.threshold = 30000.0, .opacity = 0.3}};
    const Camera camera = camera_looking("front", source->info());
    static_cast<void>(renderer.render(session, camera, {.probe = probe, .count_work = true}));
    session.render.preintegration = true;
    session.render.smooth_borders = true;
    static_cast<void>(renderer.render(session, camera, {.probe = probe}));
    static_cast<void>(renderer.pick(session.look(), camera, session.render.size, {12, 10}, probe));
    return renderer.device().take_validation_messages();
}

}  // namespace

TEST_CASE("pictures and paint stay within their buffers")
{
    const Assisted assisted;
    for (const Paging paging : {Paging::never, Paging::always}) {
        CAPTURE(int(paging));
        for (const std::string& message : messages_of_work(paging)) FAIL_CHECK(message);
    }
}

TEST_CASE("a kernel that reads beside its buffer is found")
{
    const Assisted assisted;
    const Mistake beside = {"an entry that there is not", "", "library/pages.glsl",
                            "    uint entry = directory.entries[place.entry];",
                            "    uint entry = directory.entries[place.entry + 4000000u];"};
    const std::vector<std::string> kernels{"raycast_paged_masked_occluded_surfaced_shelled"};
    const WrongKernels wrong(beside, kernels);
    REQUIRE(wrong.count() == 1);
    const std::vector<std::string> messages = messages_of_work(Paging::always);
    REQUIRE(!messages.empty());
    CHECK(messages[0].find("out of bounds") != std::string::npos);
}
