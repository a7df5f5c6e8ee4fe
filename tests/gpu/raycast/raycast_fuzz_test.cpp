// The ray caster's loops end, whatever its parameters are: numbers that are none, infinite, or smaller than any ray
// needs. The program's own never are; a driver's mistake, or one of ours, must not lose the device.

#include <cstring>
#include <limits>
#include <random>

#include <doctest/doctest.h>

#include "engine/picture/ray_params.h"
#include "shaders/counters.h"
#include "tests/support/gpu.h"

using namespace shvr;
using namespace shvr::test;

namespace {

using Random = std::mt19937;

float odd_number(Random& random)
{
    using Limits = std::numeric_limits<float>;
    const float numbers[] = {Limits::quiet_NaN(),
                             Limits::infinity(),
                             -Limits::infinity(),
                             0.0f,
                             -0.0f,
                             1e-45f,
                             -1e-38f,
                             1e38f,
                             -Limits::max(),
                             65536.5f,
                             -1.0f,
                             3e9f};
    return numbers[random() % std::size(numbers)];
}

/// What decides where rays run, what they meet and when they stop; not how many steps the host counts on.
std::vector<float*> numbers_of(gpu::RaycastParams& params)
{
    std::vector<float*> numbers{&params.opacity_limit, &params.table_lower, &params.table_upper,  &params.table_scale,
                                &params.opaque_scale,  &params.ambient,     &params.shininess,    &params.gradient_fade,
                                &params.blend_rate,    &params.shell_code,  &params.shell_opacity};
    for (glm::vec3* each :
         {&params.near_corner, &params.near_dx, &params.near_dy, &params.far_corner, &params.far_dx, &params.far_dy,
          &params.position_limit, &params.inverse_spacing, &params.light, &params.shell_center, &params.shell_reach})
        for (int axis = 0; axis < 3; ++axis) numbers.push_back(&(*each)[axis]);
    return numbers;
}

/// That each ray may take in all dispatches, its last and shorter ones included.
uint64_t steps_of(const FrameGraph& graph)
{
    uint64_t steps = 0;
    for (const PassData& pass : graph.passes())
        for (const auto& [name, bytes] : pass.blocks) {
            if (name != "params_block") continue;
            gpu::RaycastParams params;
            std::memcpy(&params, bytes.data(), sizeof params);
            steps += params.end_step - params.first_step + 1;
        }
    return steps;
}

}  // namespace

TEST_CASE_FIXTURE(OnDevice, "rays of numbers that are none end, and so do those of endless ones")
{
    Random random(20);
    Session session = plain_session(busy_points(0.05));
    session.light.shaded = true;
    const glm::uvec2 pixels(2, 2);  // few, so that one ray that goes on and on is noticed
    const ProbeLook probe{.center = glm::dvec3(20.0),
                          .radius = 12.0,
                          .ball_share = 0.0,
                          .shell = ShellLook{.threshold = 30000.0, .opacity = 0.2}};
    for (const Paging paging : {Paging::never, Paging::always})
        for (const Sampling sampling : {Sampling::exact, Sampling::hardware})
            for (const bool is_shelled : {false, true}) {
                CAPTURE(int(paging));
                CAPTURE(int(sampling));
                CAPTURE(is_shelled);
                const TestVolume field = noise_volume({40, 40, 40}, 3);
                session.render.paging = paging;
                session.render.sampling = sampling;
                renderer().load(source_of(field), {.minimum = field.minimum, .maximum = field.maximum}, session.render);
                const Camera camera = camera_along(field, {1, 2, 3}, 60.0);
                static_cast<void>(renderer().render(session, camera));
                Scene& scene = renderer().scene();
                uint64_t most = 0;
                for (int round = 0; round < 200; ++round) {
                    CAPTURE(round);
                    FrameGraph graph;
                    const PicturePart part{.pixels = pixels, .begin = {0, 0}, .end = pixels};
                    const Look look = session.look();
                    const double step = look_at(scene, look, Shot(camera), part);
                    RaycastInput input;
                    VolumeBinding volume = scene.volume().prepare(graph, scene.mask(), std::nullopt, true);
                    input.table = scene.tables().upload_function(graph, look, scene.volume().window(), step);
                    input.params = raycast_params(look, camera, scene, volume, part, step);
                    input.shaded = true;
                    input.count_work = true;
                    if (is_shelled) set_shell(input, probe, scene);
                    const std::vector<float*> numbers = numbers_of(input.params);
                    for (uint32_t changes = round == 0 ? 0 : 1 + random() % 4; changes > 0; --changes)
                        *numbers[random() % numbers.size()] = odd_number(random);
                    const Resource target = graph.create("light", picture_desc(Format::rgba32_float, pixels));
                    static_cast<void>(graph.read_back(raycast(graph, volume, input, target)));
                    const uint64_t steps = steps_of(graph);
                    uint64_t turns = 0;
                    for (const gpu::PassReport& pass : renderer().executor().run(std::move(graph)).passes)
                        if (pass.name == "raycast")
                            turns += pass.counters.at(gpu::COUNTER_SAMPLES) + pass.counters.at(gpu::COUNTER_LEAPS);
                    // A step is leapt over, or looked at when it is searched for and when it is taken.
                    REQUIRE(3 * 4 * steps < 50'000);  // devices end endless loops after 65535 turns
                    CHECK(turns <= 3 * 4 * steps);
                    most = std::max(most, turns);
                }
                CHECK(most > 30);
            }
}
