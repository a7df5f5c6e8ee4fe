// Opaque balls and the probe in a volume: what is drawn in front of them, in all variants of the ray caster.

#include <algorithm>
#include <cmath>
#include <map>

#include <doctest/doctest.h>

#include "engine/live/annotator.h"
#include "tests/support/gpu.h"

using namespace shvr;
using namespace shvr::test;

namespace {

SurfaceLook ball(const glm::dvec3& center, double radius, const glm::dvec3& color)
{
    return {center, center, radius, radius, color};
}

}  // namespace

TEST_CASE_FIXTURE(OnDevice, "a surface in fog is seen through what lies before it")
{
    load(constant_volume({32, 32, 64}, 30000.0));
    const glm::dvec3 fog(0.9, 0.5, 0.2), white(0.4, 0.7, 1.0);
    const double opacity = 0.05, sigma = depth_of_opacity(opacity);
    Session session = plain_session(uniform_points(fog, opacity), {1, 1});
    session.light = {.shaded = false, .ambient = 1.0, .diffuse = 0.0, .specular = 0.0};
    const Camera camera = camera_along(volume(), {0, 0, 1}, 1.0);
    for (const double depth : {-20.0, -1.0, 0.0, 0.3, 7.77, 20.0, 63.9, 64.0, 80.0}) {
        CAPTURE(depth);
        renderer().scene().set_surfaces({ball({16.0, 16.0, depth + 5.0}, 5.0, white)});
        const double through = std::exp(-sigma * std::clamp(depth, 0.0, 64.0));
        const glm::dvec4 pixel = pixels_of(draw(session, camera))[0];
        check_below("colour", glm::distance(glm::dvec3(pixel), fog * (1.0 - through) + through * white), 1e-5);
        const auto seen = renderer().pick(session.look(), camera, {1, 1}, {0, 0});
        REQUIRE(seen.has_value());
        // Behind fog of opacity below 0.5 the surface is picked; otherwise the fog, which adds most where it begins.
        const double half = std::log(2.0) / sigma;
        CHECK(std::abs(seen->point.z - (depth < half ? depth : 0.25)) < 1e-4);
        CHECK(std::abs(seen->opacity - 1.0) < 1e-5);
    }
    renderer().scene().set_surfaces({});
}

TEST_CASE_FIXTURE(OnDevice, "a session without surfaces is drawn as if there never had been any")
{
    load(noise_volume({40, 33, 50}, 97));
    const Session session = plain_session(busy_points(), {61, 47});
    const Camera camera = camera_along(volume(), {3, 2, 1}, 60.0);
    const auto bytes = [&] {  // of everything that outlives a frame
        const std::map<std::string, uint64_t> names = renderer().memory().bytes_by_name();
        return (names.contains("surface nodes") ? names.at("surface nodes") : 0) +
               (names.contains("surface list") ? names.at("surface list") : 0);
    };
    const auto passes = [&](const Picture& picture) {
        return std::ranges::count_if(picture.passes,
                                     [](const auto& pass) { return pass.name.find("surface") != std::string::npos; });
    };
    const Picture before = renderer().render(session, camera);
    CHECK(bytes() == 0);
    CHECK(passes(before) == 0);
    renderer().scene().set_surfaces({ball({20, 16, 25}, 6.0, WHITE)});
    const Picture with = renderer().render(session, camera);
    CHECK(different_bits(with.image, before.image) > 100);
    CHECK(bytes() > 0);
    CHECK(passes(with) > 0);
    CHECK(different_bits(renderer().render(session, camera).image, with.image) == 0);  // uploaded once
    renderer().scene().set_surfaces({ball({20, 16, 1e5}, 6.0, WHITE)});                // out of sight
    CHECK(different_bits(renderer().render(session, camera).image, before.image) == 0);
    renderer().scene().set_surfaces({});
    CHECK(bytes() == 0);
    const Picture after = renderer().render(session, camera);
    CHECK(different_bits(after.image, before.image) == 0);
    CHECK(passes(after) == 0);
    renderer().scene().set_surfaces({ball({20, 16, 25}, 6.0, WHITE)});
    load(noise_volume({40, 33, 50}, 97));
    CHECK(bytes() == 0);  // they belong to a volume
}

TEST_CASE_FIXTURE(OnDevice, "cutting planes cut the volume and no surface, and the distance blends both")
{
    load(constant_volume({40, 40, 40}, 30000.0));
    Session session = plain_session(uniform_points(RED, 0.1), {1, 1});
    session.light = {.shaded = false, .ambient = 1.0, .diffuse = 0.0, .specular = 0.0};
    session.cut = {{0, 0, 30}, {40, 40, 40}};
    renderer().scene().set_surfaces({ball({20, 20, 15}, 5.0, GREEN)});
    const Camera camera = camera_along(volume(), {0, 0, 1}, 1.0);
    check_below("uncut", glm::distance(glm::dvec3(pixels_of(draw(session, camera))[0]), GREEN), 1e-6);
    session.cut = {{0, 0, 0}, {40, 40, 40}};
    session.blend = {.size = 0.8, .rate = 1.0, .color = BLUE};
    session.transfer_function = TransferFunction(uniform_points(RED, 0.0));
    const double share = 0.8 * 10.0 / 40.0;
    check_below("blended", glm::distance(glm::dvec3(pixels_of(draw(session, camera))[0]), glm::mix(GREEN, BLUE, share)),
                1e-6);
    renderer().scene().set_surfaces({});
}

TEST_CASE_FIXTURE(OnDevice, "every variant of the ray caster stops at surfaces")
{
    load(noise_volume({40, 40, 40}, 98));
    Session session = plain_session(busy_points(), {41, 41});
    session.light = {.shaded = true, .ambient = 1.0, .diffuse = 0.0, .specular = 0.0, .shininess = 1.0};
    const ProbeLook probe{.center = {10, 30, -8}, .radius = 6.0, .color = {0.2, 0.4, 0.6}};
    const Camera camera = camera_along(volume(), {0, 0, 1}, 41.0);
    const VolumeStatistics statistics = renderer().statistics();
    const std::shared_ptr<const VolumeSource> source = source_of(volume());
    std::vector<Sampling> samplings{Sampling::exact};
    if (renderer().device().traits().linear_r16) samplings.push_back(Sampling::hardware);
    for (const Sampling sampling : samplings)
        for (const Paging paging : {Paging::never, Paging::always})
            for (const bool painted : {false, true})
                for (const bool occluded : {false, true}) {
                    CAPTURE(int(sampling));
                    CAPTURE(int(paging));
                    CAPTURE(painted);
                    CAPTURE(occluded);
                    session.render.sampling = sampling;
                    session.render.paging = paging;
                    session.light.occlusion.strength = occluded ? 1.0 : 0.0;
                    renderer().load(source, statistics, session.render);
                    Annotator annotator(renderer());
                    if (painted) CHECK(annotator.paint({.radius_voxels = 5.0, .path = {{20, 20, 20}}}) > 0);
                    const Pixels bare = pixels_of(renderer().render(session, camera).image);
                    // In front of the volume, half inside it, behind it; and the probe.
                    renderer().scene().set_surfaces(
                        {ball({10, 10, -8}, 6.0, GREEN), ball({30, 10, 0}, 6.0, BLUE), ball({30, 30, 50}, 6.0, RED)});
                    const Picture picture = renderer().render(session, camera, {.probe = probe});
                    const std::string kernel =
                        sentence("raycast", paging == Paging::always ? "_paged" : "",
                                 sampling == Sampling::hardware ? "_filtered" : "", painted ? "_masked" : "",
                                 occluded ? "_occluded" : "", "_surfaced");
                    CHECK(std::ranges::count(picture.graph.passes(), kernel, &PassData::kernel) == 1);
                    const Pixels pixels = pixels_of(picture.image);
                    const auto seen = [&](const glm::dvec3& color) {
                        return std::ranges::count_if(pixels, [&](const glm::dvec4& pixel) {
                            return glm::distance(glm::dvec3(pixel), color) < 1e-6;
                        });
                    };
                    // Circles of 113 pixels, some with centres near the edge.
                    CHECK(std::abs(seen(GREEN) - 113) < 8);
                    CHECK(std::abs(seen(BLUE) - 113) < 8);
                    CHECK(std::abs(seen(probe.color) - 113) < 8);
                    size_t changed = 0;
                    for (size_t i = 0; i < pixels.size(); ++i) changed += pixels[i] != bare[i];
                    CHECK(std::abs(int(changed) - 4 * 113) < 32);
                }
}
