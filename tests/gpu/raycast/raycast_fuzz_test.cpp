// The ray caster's loops end, whatever its parameters are: NaN, infinite, or smaller than any ray needs. The
// program's own parameters never are; a mistake of a driver, or one of ours, must not lose the device.

#include <cstring>
#include <functional>
#include <limits>
#include <random>
#include <string>

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
                             1e18f,
                             -1e18f,
                             3e9f};
    return numbers[random() % std::size(numbers)];
}

/// All but whole numbers, which are the host's own, and the colours of light and shells.
std::vector<float*> numbers_of(gpu::RaycastParams& params)
{
    std::vector<float*> numbers{&params.step,        &params.opacity_limit, &params.table_lower,   &params.table_upper,
                                &params.table_scale, &params.opaque_scale,  &params.ambient,       &params.diffuse,
                                &params.specular,    &params.shininess,     &params.shell_opacity, &params.shell_code,
                                &params.blend_size,  &params.blend_rate,    &params.gradient_fade};
    for (glm::vec3* each :
         {&params.near_corner, &params.near_dx, &params.near_dy, &params.far_corner, &params.far_dx, &params.far_dy,
          &params.box_lower, &params.box_upper, &params.position_limit, &params.spacing, &params.inverse_spacing,
          &params.light, &params.shell_center, &params.shell_reach})
        for (int axis = 0; axis < 3; ++axis) numbers.push_back(&(*each)[axis]);
    return numbers;
}

using Change = std::function<void(gpu::RaycastParams&)>;

/// Changes what the kernels are given. The host has counted the steps of the right numbers before: it knows no others.
/// Returns how many steps each ray may take, its last and shorter one included.
uint64_t change_params(FrameGraph& graph, const Change& change)
{
    uint64_t steps = 0;
    for (const PassData& pass : graph.passes())
        for (const auto& [name, bytes] : pass.blocks) {
            if (name != "params_block") continue;
            gpu::RaycastParams params;
            REQUIRE(bytes.size() == sizeof params);
            std::memcpy(&params, bytes.data(), sizeof params);
            change(params);
            std::memcpy(const_cast<std::byte*>(bytes.data()), &params, sizeof params);
            REQUIRE(steps == 0);  // one dispatch
            steps = params.end_step - params.first_step + 1;
        }
    return steps;
}

/// Shells that are searched for behind the volume, for lengths of which a float hardly knows the next: more turns than
/// any device makes.
void reach_far(gpu::RaycastParams& params)
{
    params.far_corner += 1e18f * glm::normalize(params.far_corner - params.near_corner);
    params.box_upper = params.shell_reach = glm::vec3(1e18f);
}

/// Steps without an end, and a shell that is not there at a length before it.
void end_nowhere(gpu::RaycastParams& params)
{
    params.step = std::numeric_limits<float>::infinity();
    params.shell_opacity = 0.0f;
    params.shell_reach = glm::vec3(std::numeric_limits<float>::quiet_NaN());
}

struct Tried {
    std::string name;
    TestVolume volume;
    std::vector<ControlPoint> points;
    bool leaps;
};

}  // namespace

TEST_CASE_FIXTURE(OnDevice, "rays of numbers that are none end, and so do those of endless ones")
{
    Random random(20);
    const glm::uvec2 pixels(2, 2);  // few, so that one ray that goes on and on is noticed
    const auto balls = [](const glm::dvec3& p) { return glm::distance(glm::mod(p, 40.0), glm::dvec3(20)) < 9.0; };
    const Tried volumes[] = {{"noise", noise_volume({40, 40, 40}, 3), busy_points(0.05), false},
                             {"balls",
                              volume_of({72, 40, 40}, [&](const glm::dvec3& p) { return balls(p) ? 33000.0 : 0.0; }),
                              {{15000.0, RED, 0.0}, {33000.0, BLUE, 0.02}},
                              true}};
    for (const Tried& tried : volumes)
        for (const Paging paging : {Paging::never, Paging::always})
            for (const Sampling sampling : {Sampling::exact, Sampling::hardware}) {
                CAPTURE(tried.name);
                CAPTURE(int(paging));
                CAPTURE(int(sampling));
                Session session = plain_session(tried.points);
                session.light.shaded = true;
                session.render.detail = 0.0;
                session.render.paging = paging;
                session.render.sampling = sampling;
                renderer().load(source_of(tried.volume),
                                {.minimum = tried.volume.minimum, .maximum = tried.volume.maximum}, session.render);
                const Camera camera = camera_along(tried.volume, {1, 2, 3}, 30.0);
                static_cast<void>(renderer().render(session, camera));
                Scene& scene = renderer().scene();
                for (const uint32_t shell : {gpu::SHELL_NONE, gpu::SHELL_BALL, gpu::SHELL_BOX}) {
                    CAPTURE(shell);
                    const ProbeLook probe{
                        .center = 0.5 * glm::dvec3(tried.volume.size),
                        .radius = 12.0,
                        .ball_share = 0.0,
                        .shell = ShellLook{.threshold = 30000.0, .opacity = 0.2, .is_box = shell == gpu::SHELL_BOX}};
                    uint64_t most = 0;
                    const auto run = [&](const Change& change) {
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
                        if (shell != gpu::SHELL_NONE) set_shell(input, probe, scene);
                        const Resource target = graph.create("light", picture_desc(Format::rgba32_float, pixels));
                        static_cast<void>(graph.read_back(raycast(graph, volume, input, target)));
                        const uint64_t steps = change_params(graph, change);
                        std::vector<uint64_t> counted(gpu::COUNTER_TURNS + 1);
                        for (const gpu::PassReport& pass : renderer().executor().run(std::move(graph)).passes)
                            for (size_t i = 0; i < counted.size() && pass.name == "raycast"; ++i)
                                counted[i] += pass.counters.at(i);
                        // A step is leapt over, or looked at when it is searched for and when it is taken: at most
                        // two turns of each of two loops within a third. Those of shells have a bound of their own.
                        const uint64_t most_turns = 5 * steps + (shell == gpu::SHELL_NONE ? 0 : gpu::MAX_TURNS);
                        REQUIRE(most_turns < 50'000);  // devices end endless loops after 65535 turns
                        CHECK(counted[gpu::COUNTER_TURNS] <= 4 * most_turns);
                        most = std::max(most, counted[gpu::COUNTER_TURNS]);
                        return counted;
                    };
                    const std::vector<uint64_t> right = run([](gpu::RaycastParams&) {});
                    CHECK((right[gpu::COUNTER_LEAPS] > 0) == tried.leaps);
                    CHECK(right[gpu::COUNTER_TURNS] > 4 * 15);
                    CHECK(right[gpu::COUNTER_TURNS] < 4 * 1500);  // far below what ends rays
                    CHECK(right[gpu::COUNTER_CUT_SHORT] == 0);
                    for (int round = 0; round < 60; ++round) {
                        CAPTURE(round);
                        run([&](gpu::RaycastParams& params) {
                            const std::vector<float*> numbers = numbers_of(params);
                            for (uint32_t changes = 1 + random() % 4; changes > 0; --changes)
                                *numbers[random() % numbers.size()] = odd_number(random);
                        });
                    }
                    CHECK(most > right[gpu::COUNTER_TURNS]);
                    run(end_nowhere);
                    const std::vector<uint64_t> far = run(reach_far);
                    const bool ends_by_bound = far[gpu::COUNTER_TURNS] >= gpu::MAX_TURNS;
                    CHECK(ends_by_bound == (shell != gpu::SHELL_NONE));
                    CHECK(far[gpu::COUNTER_CUT_SHORT] > 0);
                }
            }
}
