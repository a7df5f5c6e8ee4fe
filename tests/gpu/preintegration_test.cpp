// Pre-integrated classification on the device, against the integral without a step size.

#include <cmath>
#include <random>

#include <doctest/doctest.h>

#include "engine/device/look_table.h"
#include "tests/support/gpu.h"

using namespace shvr;
using namespace shvr::test;

namespace {

/// A peak 1/256 of the code range wide; nothing elsewhere.
std::vector<ControlPoint> peak_at(double middle)
{
    const double half_width = 65535.0 / 512;
    return {{0.0, RED, 0.0},
            {middle - half_width, RED, 0.0},
            {middle, RED, 0.9},
            {middle + half_width, RED, 0.0},
            {65535.0, RED, 0.0}};
}

struct Errors {
    double plain, preintegrated;
};

}  // namespace

class Preintegrating : public OnDevice {
protected:
    Pixels pixels(Session session, const Camera& camera, bool preintegrated)
    {
        session.render.preintegration = preintegrated;
        return pixels_of(draw(session, camera));
    }
    Errors errors(const Session& session, const Camera& camera, const Pixels& truth)
    {
        return {rms_difference(pixels(session, camera, false), truth),
                rms_difference(pixels(session, camera, true), truth)};
    }
};

TEST_CASE_FIXTURE(Preintegrating, "a homogeneous slab is what it is without")
{
    load(constant_volume({10, 8, 8}, 30000.0));
    const Camera camera = camera_along(volume(), {1, 0.2, 0.1}, 6.0);
    for (const double depth : {0.01, 1.0, 5.0})
        for (const double step : {1.0, 0.77, 0.5, 0.125}) {
            CAPTURE(depth);
            CAPTURE(step);
            Session session = plain_session(uniform_points(RED, opacity_of_depth(depth / 10.0)));
            session.render.step_voxels = step;
            check_below("without", worst_difference(pixels(session, camera, true), pixels(session, camera, false)),
                        2e-6);
        }
}

TEST_CASE_FIXTURE(Preintegrating, "steps of a voxel see a peak that is 1/256 of all codes wide")
{
    load(volume_of({64, 8, 8}, [](const glm::dvec3& p) { return 32000.0 + 30000.0 * std::sin(0.2 * p.x); }));
    const Camera camera = camera_along(volume(), {1, 0, 0}, 5.0);
    for (const double middle : {20000.0, 32000.0, 45000.0}) {
        CAPTURE(middle);
        Session session = plain_session(peak_at(middle));
        session.render.step_voxels = 1.0;
        const Pixels truth = expected(session, camera, reference::ExactOptions{});
        const Errors of = errors(session, camera, truth);
        check_below("pre-integrated", of.preintegrated, 2e-3);
        CHECK(of.plain > 0.05);  // otherwise there is nothing to show
    }
}

TEST_CASE_FIXTURE(Preintegrating, "steps of a voxel are as good as plain ones of 1/16 where a function has peaks")
{
    load(volume_of({48, 48, 48}, [](const glm::dvec3& p) {
        const glm::dvec3 from_middle = p - glm::dvec3(23.0, 24.5, 25.0);
        return 60000.0 * std::exp(-glm::dot(from_middle, from_middle) / (2.0 * 9.0 * 9.0));
    }));
    const Camera camera = camera_along(volume(), {0.7, 0.5, 0.3}, 30.0);
    Session session = plain_session(peak_at(30000.0), {24, 24});
    const Pixels truth = expected(session, camera, reference::ExactOptions{});
    const Errors whole = errors(session, camera, truth);
    session.render.step_voxels = 0.0625;
    const Errors sixteenth = errors(session, camera, truth);
    session.render.step_voxels = 1.0;
    const Errors voxel = errors(session, camera, truth);
    MESSAGE("rms error, plain / pre-integrated: step 1 ", voxel.plain, " / ", voxel.preintegrated, ", 0.5 ",
            whole.plain, " / ", whole.preintegrated, ", 1/16 ", sixteenth.plain, " / ", sixteenth.preintegrated);
    CHECK(voxel.preintegrated < sixteenth.plain);
    CHECK(voxel.plain > 8.0 * voxel.preintegrated);
}

TEST_CASE_FIXTURE(Preintegrating, "pictures converge with order 2")
{
    load(volume_of({48, 48, 48}, [](const glm::dvec3& p) {
        const glm::dvec3 from_middle = p - glm::dvec3(23.0, 24.5, 25.0);
        return 60000.0 * std::exp(-glm::dot(from_middle, from_middle) / (2.0 * 9.0 * 9.0));
    }));
    Session session = plain_session({{0.0, RED, 0.0}, {65535.0, BLUE, 0.5}}, {12, 12});
    const Camera camera = camera_along(volume(), {0.7, 0.5, 0.3}, 20.0);
    const Pixels truth = expected(session, camera, reference::ExactOptions{});
    session.render.step_voxels = 1.0;
    const double one = errors(session, camera, truth).preintegrated;
    session.render.step_voxels = 0.25;
    const double quarter = errors(session, camera, truth).preintegrated;
    CAPTURE(one);
    CAPTURE(quarter);
    CHECK(std::log2(one / quarter) / 2.0 > 1.8);
}

TEST_CASE_FIXTURE(Preintegrating,
                  "densities that the function leaves out are a part of the step in which there is nothing")
{
    // The density crosses the visible range, 30000 to 30100, within a small part of a step.
    load(volume_of({32, 8, 8}, [](const glm::dvec3& p) { return 2000.0 * p.x; }));
    const Camera camera = camera_along(volume(), {1, 0, 0}, 5.0);
    for (const double opacity : {0.2, 0.999}) {
        Session session = plain_session({{30000.0, RED, opacity}, {30100.0, RED, opacity}});
        session.render.step_voxels = 1.0;
        const double seen = opacity_of_depth(depth_of_opacity(opacity) * 100.0 / 2000.0);
        const Pixels truth(64, glm::dvec4(seen * RED, 1.0));
        check_below("closed form", worst_difference(pixels(session, camera, true), truth), 1e-5);
    }
}

TEST_CASE_FIXTURE(Preintegrating, "nothing of it is there without it")
{
    load(noise_volume({20, 20, 20}, 3));
    const Camera camera = camera_along(volume(), {1, 0.3, 0.2}, 20.0);
    Session session = plain_session(busy_points());
    const ImageF before = draw(session, camera);
    const auto bytes = [&] {
        uint64_t sum = 0;
        const Picture picture = renderer().render(session, camera);
        for (const FrameGraph::ResourceData& resource : picture.graph.resources())
            if (resource.name == "transfer function") sum += resource.desc.bytes;
        return sum;
    };
    const uint64_t rows = (tabulated(volume(), session).table_entries + 255) / 256, side = STEP_TABLE_SIDE;
    CHECK(bytes() == 256 * (sizeof(glm::vec4) * rows + sizeof(float) * ((rows + 3) / 4 * 4)));
    session.render.preintegration = true;
    CHECK(different_bits(draw(session, camera), before) > 0);
    CHECK(bytes() == 2 * sizeof(glm::vec4) * side * side);
    session.render.preintegration = false;
    check_below("differing bits", double(different_bits(draw(session, camera), before)), 0.0);
}

TEST_CASE_FIXTURE(Preintegrating, "a peak whose apex is opaque ends the ray, whatever the step and the table's entries")
{
    const auto tent = [](double at, double half_width, const glm::dvec3& color) {
        return std::vector<ControlPoint>{
            {at - half_width, color, 0.0}, {at, color, 1.0}, {at + half_width, color, 0.0}};
    };
    const auto with_ends = [](std::vector<ControlPoint> points) {
        points.insert(points.begin(), {0.0, RED, 0.0});
        points.push_back({65535.0, RED, 0.0});
        return points;
    };
    std::vector<ControlPoint> two = tent(20000.0, 40.0, BLUE), more = tent(20200.0, 40.0, GREEN);
    two.insert(two.end(), more.begin(), more.end());
    const std::vector<std::vector<ControlPoint>> functions = {
        with_ends(tent(32125.0, 128.0, GREEN)),  // 125 entries of 257 codes
        with_ends(tent(32200.4, 3.0, GREEN)),
        with_ends(two),
        with_ends({{40000.0, RED, 0.0}, {40000.0, BLUE, 1.0}, {40001.0, GREEN, 1.0}, {40001.0, RED, 0.0}}),
    };
    load(volume_of({64, 8, 8}, [](const glm::dvec3& p) { return 32000.0 + 30000.0 * std::sin(0.2 * p.x); }));
    for (const double sign : {1.0, -1.0})
        for (const auto& function : functions)
            for (const double step : {1.0, 0.37, 0.05}) {
                CAPTURE(sign);
                CAPTURE(step);
                CAPTURE(function[2].intensity);
                Session session = plain_session(function);
                session.render.background = glm::dvec4(0.0);
                session.render.step_voxels = step;
                const Camera camera = camera_along(volume(), {sign, 0.1, 0.05}, 5.0);
                const Pixels seen = pixels(session, camera, true);
                const Pixels truth = expected(session, camera, reference::ExactOptions{});
                for (const glm::dvec4& pixel : seen) CHECK(pixel.a == doctest::Approx(1.0).epsilon(1e-6));
                check_below("exact", worst_difference(seen, truth), 0.02);
            }
}

TEST_CASE_FIXTURE(Preintegrating, "a ray that comes near an opaque density, and not to it, goes on")
{
    load(volume_of({64, 8, 8}, [](const glm::dvec3& p) { return 32000.0 + 10000.0 * std::sin(0.2 * p.x); }));
    const Camera camera = camera_along(volume(), {1, 0, 0}, 5.0);
    Session session = plain_session({{0.0, RED, 0.0}, {41990.0, RED, 0.0}, {42100.0, GREEN, 1.0}, {42200.0, RED, 0.0}});
    session.render.background = glm::dvec4(0.0);
    session.render.step_voxels = 0.5;
    for (const glm::dvec4& pixel : pixels(session, camera, true)) CHECK(pixel.a < 0.9);
}
