// Smooth borders of painted groups: a sample is in the group that weighs most around it, whatever bricks, leaps and
// strokes there are.

#include <array>
#include <cmath>
#include <random>

#include <doctest/doctest.h>

#include "engine/live/annotator.h"
#include "tests/support/gpu.h"

using namespace shvr;
using namespace shvr::test;

namespace {

constexpr uint32_t SEED = 20261123;
/// Samples whose two heaviest labels differ by less are left out: rounding decides there.
constexpr double MIN_MARGIN = 1e-3;

struct Vote {
    uint8_t group = 0;
    double margin = 1.0;  ///< to the next label's weight
};

Vote vote_at(const Mask& mask, const Size3& size, const glm::dvec3& position)
{
    const glm::dvec3 corner = glm::floor(position - 0.5), upper = position - 0.5 - corner;
    std::array<double, 256> weights{};
    for (int i = 0; i < 8; ++i) {
        const glm::ivec3 offset(i & 1, i >> 1 & 1, i >> 2);
        const glm::dvec3 along = glm::mix(1.0 - upper, upper, glm::dvec3(offset));
        const Size3 voxel = glm::clamp(Size3(corner) + Size3(offset), Size3(0), size - int64_t{1});
        weights[mask.at(voxel)] += along.x * along.y * along.z;
    }
    Vote vote{.group = 0, .margin = 0.0};
    for (size_t group = 0; group < 256; ++group)
        if (weights[group] > weights[vote.group]) vote.group = uint8_t(group);
    double next = 0.0;
    for (size_t group = 0; group < 256; ++group)
        if (group != vote.group) next = std::max(next, weights[group]);
    vote.margin = weights[vote.group] - next;
    return vote;
}

/// Nothing but groups is visible, each in a colour of its own, and the first one hides what is behind it.
Session session_of(const glm::uvec2& pixels)
{
    Session session = plain_session(unseen_points(), pixels);
    session.render.smooth_borders = true;
    session.render.detail = 0.0;
    session.groups[1] = {.color = RED};
    session.groups[2] = {.color = GREEN};
    session.groups[3] = {.color = BLUE};
    session.render.background = {0.0, 0.0, 0.0, 1.0};
    return session;
}

/// A stroke where borders of bricks and of the volume are.
PaintOp random_stroke(std::mt19937& random, const glm::ivec3& size)
{
    const auto below = [&](int end) { return double(random() % uint32_t(end)) + 0.5; };
    const glm::dvec3 at(below(size.x), below(size.y), below(size.z));
    return {.brush = Brush::fill, .group = uint8_t(random() % 4), .radius_voxels = 0.9 + below(7), .path = {at}};
}

/// Colour of the first group that the ray meets, and whether rounding may decide about it.
std::pair<glm::dvec3, bool> expected_color(const Mask& mask, const Size3& size, const reference::Ray& ray, double step)
{
    double begin = ray.t_min, end = ray.t_max;
    for (int axis = 0; axis < 3; ++axis) {
        const bool is_beside = ray.origin[axis] < 0.0 || ray.origin[axis] > double(size[axis]);
        if (ray.direction[axis] == 0.0 && is_beside) return {glm::dvec3(0.0), false};
        if (ray.direction[axis] == 0.0) continue;
        const double a = -ray.origin[axis] / ray.direction[axis];
        const double b = (double(size[axis]) - ray.origin[axis]) / ray.direction[axis];
        begin = std::max(begin, std::min(a, b));
        end = std::min(end, std::max(a, b));
    }
    const double each = step / glm::length(ray.direction);
    for (double s = begin; s < end; s += each) {
        const glm::dvec3 position = ray.origin + std::min(s + 0.5 * each, 0.5 * (s + end)) * ray.direction;
        const Vote vote = vote_at(mask, size, position);
        if (vote.margin < MIN_MARGIN) return {glm::dvec3(0.0), true};
        if (vote.group != 0) return {std::array{RED, GREEN, BLUE}[vote.group - 1u], false};
    }
    return {glm::dvec3(0.0), false};
}

}  // namespace

TEST_CASE_FIXTURE(OnDevice, "with smooth borders a sample is in the group that weighs most around it")
{
    load(constant_volume({70, 41, 37}, 1000.0));
    Session session = session_of({90, 80});
    Annotator annotator(renderer());
    std::mt19937 random(SEED);
    for (int i = 0; i < 60; ++i) annotator.paint(random_stroke(random, volume().size));
    const Mask& mask = annotator.document().mask;
    for (const glm::dvec3& direction :
         {glm::dvec3(0.0, 0.0, 1.0), glm::dvec3(1.0, 2.0, 3.0), glm::dvec3(-3.0, 0.4, 1.0)}) {
        const Camera camera = camera_along(volume(), direction, 60.0);
        const ImageF smooth = draw(session, camera);
        session.render.skip_empty_space = false;
        check_below("differing bits", double(different_bits(draw(session, camera), smooth)), 0.0);
        session.render.skip_empty_space = true;
        const Pixels pixels = pixels_of(smooth);
        const std::vector<reference::Ray> rays = rays_of(volume(), session, camera);
        size_t wrong = 0, told = 0, seen = 0;
        for (size_t i = 0; i < rays.size(); ++i) {
            const auto [color, is_doubtful] =
                expected_color(mask, Size3(volume().size), rays[i], session.render.step_voxels);
            if (is_doubtful) continue;
            ++told;
            seen += color != glm::dvec3(0.0);
            wrong += glm::length(glm::dvec3(pixels[i]) - color) > 1e-5;
        }
        CHECK(wrong == 0);
        CHECK(told > rays.size() / 2);
        CHECK(seen > rays.size() / 5);
        session.render.smooth_borders = false;
        CHECK(different_bits(draw(session, camera), smooth) > 0);
        session.render.smooth_borders = true;
    }
}

TEST_CASE_FIXTURE(OnDevice, "smooth borders have the same bits after any strokes, in paged bricks and without leaps")
{
    const TestVolume dark = constant_volume({70, 41, 37}, 1000.0);
    Session session = session_of({64, 48});
    const Camera camera = camera_along(dark, {1.0, 2.0, 3.0}, 60.0);
    const auto pictures_of = [&](Paging paging) {
        session.render.paging = paging;
        renderer().load(source_of(dark), {.minimum = 0.0, .maximum = 65535.0}, session.render);
        Annotator annotator(renderer());
        std::mt19937 random(SEED + 1);
        std::vector<ImageF> pictures;
        for (int i = 0; i < 24; ++i) {
            if (i % 6 == 5)
                annotator.undo();
            else
                annotator.paint(random_stroke(random, dark.size));
            pictures.push_back(renderer().render(session, camera).image);
            if (i % 8 != 7) continue;
            session.render.skip_empty_space = false;  // everything is rebuilt
            check_below("differing bits",
                        double(different_bits(renderer().render(session, camera).image, pictures.back())), 0.0);
            session.render.skip_empty_space = true;
        }
        return pictures;
    };
    const std::vector<ImageF> resident = pictures_of(Paging::never), paged = pictures_of(Paging::always);
    for (size_t i = 0; i < resident.size(); ++i) {
        CAPTURE(i);
        check_below("differing bits", double(different_bits(resident[i], paged[i])), 0.0);
    }
}
