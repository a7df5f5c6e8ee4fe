#include "haptics/modes.h"

#include <cmath>
#include <memory>

#include <doctest/doctest.h>

#include "haptics/force.h"
#include "tests/support/haptic_scenes.h"

using namespace shvr;

namespace {

/// A probe of 6 voxels in a scene of 64.
struct Scene {
    ForceSettings settings{.assistance = true, .probe_radius = 6.0};
    std::unique_ptr<RelevancePatch> patch = std::make_unique<RelevancePatch>();
    std::unique_ptr<GrowthMemory> growth = std::make_unique<GrowthMemory>();
    SurfaceMemory surface;
    uint64_t now_ns = 1'000'000;

    template <class Claim>
    explicit Scene(TouchMode mode, const Claim& claim)
    {
        settings.mode = mode;
        fill_patch(*patch, {0, 0, 0}, glm::ivec3(64), glm::dvec3(1), claim);
        patch->volume_size = glm::ivec3(64);
    }
    ModePull at(const glm::dvec3& probe)
    {
        now_ns += 1'000'000;
        patch->time_ns = now_ns;
        return pull_of(settings, *patch, probe, now_ns, surface, *growth);
    }
};

/// Solid below z = 32; the camera looks down from +z.
bool half_space(const glm::dvec3& p)
{
    return p.z < 32.0;
}

}  // namespace

TEST_CASE("a surface holds the probe where 40 % of its ball is relevant")
{
    Scene scene(TouchMode::surface, half_space);
    double z = 40.0;
    for (; !scene.at({32, 32, z}).in_contact; z -= 0.05) REQUIRE(z > 20.0);
    // A cap of 40 % of a ball's volume: h^2 (3 - h) / 4 = 0.4 at h = 0.866 of the radius.
    CHECK(z == doctest::Approx(32.0 + (1.0 - 0.866) * 6.0).epsilon(0.005));
    const double pinned = z;
    for (; z > 28.0; z -= 0.05) {
        const ModePull pull = scene.at({32, 32, z});
        REQUIRE(pull.in_contact);
        CHECK(pull.offset.z == doctest::Approx(pinned - z).epsilon(1e-9));
    }
    // Sideways it holds as well.
    CHECK(scene.at({34, 32, z}).offset.x == doctest::Approx(-2.0));
}

TEST_CASE("a surface lets go when the probe moves towards the camera, and holds again only from outside")
{
    Scene scene(TouchMode::surface, half_space);
    for (double z = 40.0; z > 29.0; z -= 0.05) scene.at({32, 32, z});
    REQUIRE(scene.at({32, 32, 29.0}).in_contact);
    CHECK(scene.at({32, 32, 29.0 + 0.9 * RELEASE_SHARE * 6.0}).in_contact);   // a tremble
    CHECK(!scene.at({32, 32, 29.0 + 1.1 * RELEASE_SHARE * 6.0}).in_contact);  // still deep inside, and free
    for (double z = 29.5; z < 33.4; z += 0.05) REQUIRE(!scene.at({32, 32, z}).in_contact);
    for (double z = 33.4; z > 30.0; z -= 0.05) REQUIRE(!scene.at({32, 32, z}).in_contact);  // never below 30 %
    for (double z = 30.0; z < 35.0; z += 0.05) scene.at({32, 32, z});
    bool holds = false;
    for (double z = 35.0; z > 30.0; z -= 0.05) holds = holds || scene.at({32, 32, z}).in_contact;
    CHECK(holds);
}

TEST_CASE("a surface lets go where little is left of it, whatever the view")
{
    Scene scene(TouchMode::surface, half_space);
    scene.settings.to_camera = {1.0, 0.0, 0.0};
    for (double z = 40.0; z > 31.0; z -= 0.05) scene.at({32, 32, z});
    REQUIRE(scene.at({32, 32, 31.0}).in_contact);
    double z = 31.0;
    for (; scene.at({32, 32, z}).in_contact; z += 0.05) REQUIRE(z < 40.0);
    // A cap of 30 %: h = 0.726 of the radius.
    CHECK(z == doctest::Approx(32.0 + (1.0 - 0.726) * 6.0).epsilon(0.005));
}

TEST_CASE("small objects do not hold a surface")
{
    Scene scene(TouchMode::surface, [](const glm::dvec3& p) { return glm::distance(p, glm::dvec3(32)) < 3.0; });
    for (double z = 45.0; z > 20.0; z -= 0.1) REQUIRE(!scene.at({32, 32, z}).in_contact);
}

TEST_CASE("object following stays with its tube beside one that nearly touches; proximity following does not")
{
    const Rod tube{.point = {32.0, 28.0, 32.0}, .radius = 3.0}, neighbour{.point = {32.0, 35.5, 32.0}, .radius = 3.0};
    const auto both = [&](const glm::dvec3& p) { return tube.holds(p) || neighbour.holds(p); };
    Scene proximity(TouchMode::proximity, both), object(TouchMode::object, both);
    object.at({20, 28, 32});
    object.at({20, 28, 32});
    for (double x = 20.0; x < 44.0; x += 0.25) {
        const glm::dvec3 probe(x, 28.0, 32.0);
        const ModePull near = proximity.at(probe), own = object.at(probe);
        REQUIRE(own.in_contact);
        CHECK(std::abs(own.offset.y) < 0.05);
        CHECK(near.offset.y > 0.25);
    }
    CHECK(object.at({44, 28, 32}).object == 1);
}

TEST_CASE("where two tubes truly touch, both are the object: connectivity cannot tell them apart")
{
    const Rod tube{.point = {32.0, 28.0, 32.0}, .radius = 3.0}, neighbour{.point = {32.0, 33.0, 32.0}, .radius = 3.0};
    Scene object(TouchMode::object, [&](const glm::dvec3& p) { return tube.holds(p) || neighbour.holds(p); });
    object.at({20, 28, 32});
    object.at({20, 28, 32});
    CHECK(object.at({20, 28, 32}).offset.y > 0.5);
}

TEST_CASE("relevance made with other settings is not used")
{
    Scene scene(TouchMode::proximity, half_space);
    CHECK(scene.at({32, 32, 32}).is_usable);
    scene.settings.relevance_settings = 1;
    CHECK(!scene.at({32, 32, 32}).is_usable);
    scene.patch->settings = 1;
    CHECK(scene.at({32, 32, 32}).is_usable);
}

TEST_CASE("3000 random points find the mean within what the thesis's sampling can")
{
    const Rod tube{.point = {32.0, 30.0, 32.0}, .radius = 4.0};
    Scene scene(TouchMode::proximity, [&](const glm::dvec3& p) { return tube.holds(p); });
    double squares = 0.0;
    int count = 0;
    for (double y = 26.0; y < 34.0; y += 0.1, ++count) {
        const glm::dvec3 probe(32.0, y, 32.0);
        const glm::dvec3 sampled = find_proxy(*scene.patch, probe, 12.0, ProxyLaw::thesis).offset;
        const glm::dvec3 exact = find_proxy(*scene.patch, probe, 12.0, ProxyLaw::mean).offset;
        squares += glm::dot(sampled - exact, sampled - exact);
    }
    const double error = 100.0 * std::sqrt(squares / count) / 12.0;
    MESSAGE("3000 random points: ", error, " % of the radius");
    CHECK(error < 6.0);
    CHECK(error > 0.2);  // they are not the exact law
}
