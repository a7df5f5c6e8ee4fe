#include "haptics/proxy.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>

#include <doctest/doctest.h>

#include "tests/support/haptic_scenes.h"

using namespace shvr;

namespace {

constexpr glm::ivec3 WHOLE(64);

double ball_volume(double radius)
{
    return 4.0 / 3.0 * std::numbers::pi * radius * radius * radius;
}

glm::dvec3 random_direction(std::mt19937& random)
{
    std::normal_distribution<double> normal;
    return glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
}

/// A random point near the patch's middle, in a cube of that half side.
glm::dvec3 random_offset(std::mt19937& random, double half_side)
{
    std::uniform_real_distribution<double> uniform(-half_side, half_side);
    return {uniform(random), uniform(random), uniform(random)};
}

/// Across a rod near the middle, a rod 0.3 to 0.5 of the ball's radius thick.
Rod random_rod(std::mt19937& random, const glm::dvec3& middle, double ball_radius)
{
    const double share = std::uniform_real_distribution<double>(0.3, 0.5)(random);
    return {middle + random_offset(random, 1.0), random_direction(random), share * ball_radius};
}

glm::dvec3 offset_of(const BallIntegrals& ball, double radius, ProxyLaw law)
{
    if (law == ProxyLaw::mean) return ball.first / ball.volume;
    const double weighted = ball.volume - ball.second / (radius * radius);
    return ball.first / (weighted + POTENTIAL_FLOOR * ball_volume(radius));
}

/// RMS, in per cent of the radius, of the difference to 8 x 8 lines a row.
double proxy_error(const glm::dvec3& spacing, double radius, ProxyLaw law)
{
    std::mt19937 random(7);
    RelevancePatch patch;
    double sum = 0.0;
    int count = 0;
    for (int scene = 0; scene < 6; ++scene) {
        const Rod rod = random_rod(random, glm::dvec3(32) * spacing, radius);
        fill_patch(patch, {0, 0, 0}, WHOLE, spacing, [&](const glm::dvec3& p) { return rod.holds(p); });
        for (int place = 0; place < 3; ++place, ++count) {
            const glm::dvec3 centre = rod.point + random_offset(random, 0.3 * radius);
            const glm::dvec3 truth = offset_of(integrate_slowly(patch, centre, radius, 8), radius, law);
            const glm::dvec3 error = find_proxy(patch, centre, radius, law).offset - truth;
            sum += glm::dot(error, error);
        }
    }
    return 100.0 * std::sqrt(sum / count) / radius;
}

/// RMS, in per cent of the radius, of the second difference along paths of 0.02 voxels a step.
double grain(double radius, ProxyLaw law)
{
    std::mt19937 random(8);
    RelevancePatch patch;
    double sum = 0.0;
    int count = 0;
    for (int scene = 0; scene < 8; ++scene) {
        const Rod rod = random_rod(random, glm::dvec3(32), radius);
        fill_patch(patch, {0, 0, 0}, WHOLE, glm::dvec3(1), [&](const glm::dvec3& p) { return rod.holds(p); });
        const glm::dvec3 start = rod.point + random_offset(random, 0.3 * radius);
        const glm::dvec3 stride = 0.02 * random_direction(random);
        glm::dvec3 before(0.0), last(0.0);
        for (int i = 0; i < 200; ++i) {
            const glm::dvec3 offset = find_proxy(patch, start + stride * double(i), radius, law).offset;
            const glm::dvec3 bend = offset - 2.0 * last + before;
            if (i >= 2) sum += glm::dot(bend, bend);
            if (i >= 2) ++count;
            before = last;
            last = offset;
        }
    }
    return 100.0 * std::sqrt(sum / count) / radius;
}

}  // namespace

TEST_CASE("a ball in the full has its own volume and no offset")
{
    RelevancePatch patch;
    fill_patch(patch, {5, -3, 100}, WHOLE, {0.5, 1.0, 2.0}, [](const glm::dvec3&) { return true; });
    const glm::dvec3 centre = (glm::dvec3(5, -3, 100) + 32.2) * patch.spacing;
    const BallIntegrals ball = integrate(patch, centre, 9.7);
    CHECK(ball.volume == doctest::Approx(ball_volume(9.7)).epsilon(0.002));
    CHECK(ball.second == doctest::Approx(0.6 * 9.7 * 9.7 * ball_volume(9.7)).epsilon(0.004));
    CHECK(glm::length(find_proxy(patch, centre, 9.7, ProxyLaw::mean).offset) < 0.01);
    CHECK(glm::length(find_proxy(patch, centre, 9.7, ProxyLaw::potential).offset) < 0.03);
}

TEST_CASE("the half space at the ball's middle has the analytic centroid and share")
{
    RelevancePatch patch;
    for (int axis = 0; axis < 3; ++axis) {
        fill_patch(patch, {0, 0, 0}, WHOLE, glm::dvec3(1), [&](const glm::dvec3& p) { return p[axis] < 32.0; });
        const Proxy proxy = find_proxy(patch, glm::dvec3(32), 20.0, ProxyLaw::mean);
        glm::dvec3 expected(0.0);
        expected[axis] = -3.0 / 8.0 * 20.0;
        CHECK(proxy.in_contact);
        CHECK(glm::distance(proxy.offset, expected) < 0.02);
        CHECK(proxy.relevant_share == doctest::Approx(0.5).epsilon(0.002));
    }
}

TEST_CASE("a single voxel in the ball is found exactly")
{
    RelevancePatch patch;
    const glm::dvec3 spacing(0.5, 0.25, 2.0), voxel = glm::dvec3(31.5, 20.5, 10.5) * spacing;
    fill_patch(patch, {0, 0, 0}, WHOLE, spacing, [&](const glm::dvec3& p) { return glm::distance(p, voxel) < 1e-9; });
    const glm::dvec3 centre = voxel + glm::dvec3(1.0, -2.0, 3.0);
    const BallIntegrals ball = integrate(patch, centre, 40.0);
    CHECK(ball.volume == doctest::Approx(0.25));
    CHECK(glm::distance(ball.first / ball.volume, glm::dvec3(-1.0, 2.0, -3.0)) < 1e-12);
    CHECK(ball.second == doctest::Approx(0.25 * (14.0 + 0.25 / 12.0)));  // plus the variance along x of its box
}

TEST_CASE("integrals are those of 40 random fields cut by slow lines through the voxels' middles")
{
    std::mt19937 random(11);
    RelevancePatch patch;
    for (int field = 0; field < 40; ++field) {
        // Densities from sparse to nearly full; 33, 63 and 64 voxels cover every kind of row end within a word.
        const auto threshold = random() % 17;
        const glm::ivec3 size(field % 3 == 0 ? 33 : field % 3 == 1 ? 63 : 64, 31, 37);
        fill_patch(patch, {-7, 3, 40}, size, {1.0, 0.8, 1.3},
                   [&](const glm::dvec3&) { return random() % 16 < threshold; });
        const glm::dvec3 middle = (glm::dvec3(patch.origin) + 0.5 * glm::dvec3(size)) * patch.spacing;
        const glm::dvec3 centre = middle + random_offset(random, 15.0);
        const double radius = 20.0;  // large enough for one line per row; partly outside the patch
        const BallIntegrals ball = integrate(patch, centre, radius);
        const BallIntegrals truth = integrate_slowly(patch, centre, radius, 1);
        CHECK(ball.volume == doctest::Approx(truth.volume).epsilon(1e-10));
        CHECK(glm::distance(ball.first, truth.first) <= 1e-9 * (1.0 + radius * truth.volume));
        CHECK(ball.second == doctest::Approx(truth.second).epsilon(1e-10));
    }
}

TEST_CASE("bits beyond the end of a row are not relevant")
{
    RelevancePatch patch;
    fill_patch(patch, {0, 0, 0}, {40, 40, 40}, glm::dvec3(1), [](const glm::dvec3& p) { return p.x > 20.0; });
    const BallIntegrals clean = integrate(patch, {35, 20, 20}, 14.0);
    for (int row = 0; row < 40 * 40; ++row) patch.words[size_t(2 * row + 1)] |= ~0u << 8;
    CHECK(integrate(patch, {35, 20, 20}, 14.0).volume == clean.volume);
}

TEST_CASE("on rods the proxy is within 0.4 % of the radius at 6 voxels and within 0.2 % from 12 on")
{
    for (const ProxyLaw law : {ProxyLaw::mean, ProxyLaw::potential}) {
        const std::string name = law == ProxyLaw::mean ? "mean" : "potential";
        const double at_6 = proxy_error(glm::dvec3(1), 6.0, law), at_12 = proxy_error(glm::dvec3(1), 12.0, law);
        const double at_20 = proxy_error(glm::dvec3(1), 20.0, law), thick = proxy_error({1, 1, 2}, 12.0, law);
        MESSAGE(name, " law, error in % of the radius at 6, 12, 20 voxels: ", at_6, " ", at_12, " ", at_20,
                "; at 12 in slices twice as thick: ", thick);
        CHECK(at_6 <= 0.4);
        CHECK(at_12 <= 0.2);
        CHECK(at_20 <= 0.2);
        CHECK(thick <= 0.4);  // a radius of 6 slices
    }
}

TEST_CASE("along a slow path the offset's second difference is within 0.06 % at 6 voxels and 0.02 % from 12 on")
{
    for (const ProxyLaw law : {ProxyLaw::mean, ProxyLaw::potential}) {
        const std::string name = law == ProxyLaw::mean ? "mean" : "potential";
        const double at_6 = grain(6.0, law), at_12 = grain(12.0, law), at_13 = grain(13.0, law),
                     at_20 = grain(20.0, law);
        MESSAGE(name, " law, grain in % of the radius at 6, 12, 13, 20 voxels: ", at_6, " ", at_12, " ", at_13, " ",
                at_20);
        CHECK(at_6 <= 0.06);
        CHECK(at_12 <= 0.02);
        CHECK(at_13 <= 0.02);
        CHECK(at_20 <= 0.02);
    }
}

TEST_CASE("the potential law does no work around closed loops")
{
    std::mt19937 random(12);
    RelevancePatch patch;
    double worst = 0.0, worst_mean = 0.0;
    for (int loop = 0; loop < 12; ++loop) {
        // Rods in noise, the worst case of the thesis's mean law. Spacing and radius exercise both row rules.
        const glm::dvec3 spacing = loop % 2 == 0 ? glm::dvec3(1) : glm::dvec3(1, 0.7, 1.4);
        const double radius = loop % 4 < 2 ? 8.0 : 18.0;
        const Rod rod = random_rod(random, glm::dvec3(32) * spacing, radius);
        fill_patch(patch, {0, 0, 0}, WHOLE, spacing,
                   [&](const glm::dvec3& p) { return rod.holds(p) || random() % 100 == 0; });
        const glm::dvec3 u = random_direction(random), v = glm::normalize(glm::cross(u, random_direction(random)));
        const glm::dvec3 centre = glm::dvec3(32) * spacing + random_offset(random, 2.0);
        constexpr int STEPS = 1000;
        constexpr double LOOP_RADIUS = 4.0;
        const auto work_of = [&](ProxyLaw law) {
            double work = 0.0, most = 0.0;
            for (int i = 0; i < STEPS; ++i) {
                const double angle = 2.0 * std::numbers::pi * (i + 0.5) / STEPS;
                const glm::dvec3 place = centre + LOOP_RADIUS * (std::cos(angle) * u + std::sin(angle) * v);
                const glm::dvec3 along = std::cos(angle) * v - std::sin(angle) * u;
                const glm::dvec3 pull = find_proxy(patch, place, radius, law).offset;
                work += glm::dot(pull, along) / STEPS;
                most = std::max(most, glm::length(pull));
            }
            return std::abs(work) / most;
        };
        worst = std::max(worst, work_of(ProxyLaw::potential));
        worst_mean = std::max(worst_mean, work_of(ProxyLaw::mean));
    }
    MESSAGE("worst work of a loop, in its length times the largest force: ", worst, "; mean law: ", worst_mean);
    CHECK(worst <= 1e-4);
    CHECK(worst_mean > 1e-3);  // so the loops do distinguish the laws
}

TEST_CASE("under the potential law a speck that enters the ball pulls from nothing on; under the mean law at once")
{
    RelevancePatch patch;
    fill_patch(patch, {0, 0, 0}, WHOLE, glm::dvec3(1), [](const glm::dvec3& p) {
        return std::abs(p.x - 40.5) < 0.1 && std::abs(p.y - 32.5) < 0.1 && std::abs(p.z - 32.5) < 0.1;
    });
    double largest_step = 0.0, largest_mean_step = 0.0, last = 0.0, last_mean = 0.0;
    bool touched = false;
    for (double x = 27.0; x < 36.0; x += 0.13) {
        const Proxy proxy = find_proxy(patch, {x, 32.3, 32.4}, 10.0, ProxyLaw::potential);
        const double mean = glm::length(find_proxy(patch, {x, 32.3, 32.4}, 10.0, ProxyLaw::mean).offset);
        largest_step = std::max(largest_step, std::abs(glm::length(proxy.offset) - last));
        largest_mean_step = std::max(largest_mean_step, std::abs(mean - last_mean));
        last = glm::length(proxy.offset);
        last_mean = mean;
        touched = touched || proxy.in_contact;
    }
    CHECK(touched);
    CHECK(largest_step <= 0.06 * 10.0);
    CHECK(largest_mean_step > 0.9 * 10.0);
}

TEST_CASE("where nothing can be integrated there is no contact")
{
    RelevancePatch patch;
    CHECK_FALSE(find_proxy(patch, glm::dvec3(0), 1.0, ProxyLaw::mean).in_contact);
    fill_patch(patch, {0, 0, 0}, {32, 32, 32}, glm::dvec3(1), [](const glm::dvec3&) { return true; });
    const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
    for (const double x : {nan, infinity, -infinity, 1e300, -1e300, -100.0})
        CHECK_FALSE(find_proxy(patch, {x, 16, 16}, 4.0, ProxyLaw::potential).in_contact);
    for (const double radius : {nan, 0.0, -1.0, infinity})
        CHECK_FALSE(find_proxy(patch, glm::dvec3(16), radius, ProxyLaw::potential).in_contact);
    RelevancePatch broken = patch;
    broken.size = {64, 64, 65};
    CHECK_FALSE(find_proxy(broken, glm::dvec3(16), 4.0, ProxyLaw::mean).in_contact);
    broken = patch;
    broken.words_per_row = 100;
    CHECK_FALSE(find_proxy(broken, glm::dvec3(16), 4.0, ProxyLaw::mean).in_contact);
}

TEST_CASE("a patch covers a ball that lies in it, apart from what lies outside the volume")
{
    RelevancePatch patch;
    CHECK_FALSE(patch.covers(glm::dvec3(0), 1.0));  // nothing is known
    fill_patch(patch, {10, 20, 0}, {20, 20, 20}, {1, 1, 2}, [](const glm::dvec3&) { return false; });
    patch.volume_size = {100, 100, 20};
    CHECK(patch.covers({20, 30, 20}, 9.9));
    CHECK_FALSE(patch.covers({20, 30, 20}, 10.1));  // x from 9.9 on
    CHECK(patch.covers({20, 30, 1}, 9.9));          // below the volume nothing is relevant
    CHECK(patch.covers({20, 30, 39}, 9.9));
    CHECK(patch.covers({-50, 30, 20}, 9.9));  // all of it outside
    CHECK_FALSE(patch.covers({60, 30, 20}, 9.9));
    CHECK_FALSE(patch.covers({20, 30, std::numeric_limits<double>::quiet_NaN()}, 1.0));
}
