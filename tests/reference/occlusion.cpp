#include "tests/reference/occlusion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace shvr::reference {

namespace {

constexpr double EDGE_REACH = 1.5, LIFT = 0.07, LIFT_OF_TAPS = 0.13;
/// shaders/occlusion/occlusion_bake.comp.
constexpr int EDGE_TAPS = 6;
constexpr double FURTHEST = 1.2, MARGIN_4 = 0.853, WALL_4 = 8.2, BEND_4 = 0.08;
constexpr double SOFT[] = {1.25, 0.874, 0.734, 0.751, 0.59, 0.527, 0.5, 0.45};
/// Of ramps: shaders/occlusion/occlusion.h.
constexpr double HEIGHTS = 20.0, SLOPES = 10.0, UNEVEN = 230.0;

double saturated(double share)
{
    const double rest = 1.0 - std::clamp(share, 0.0, 1.0);
    return 1.0 - rest * rest;
}

/// Samples on both sides of a point, the nearest first; `greatest` is that of the surface.
struct Profile {
    std::vector<double> before, behind;
    double greatest = 0.0;
};

double edge_of(const Profile& profile)
{
    if (profile.greatest < 1e-6) return 0.0;
    const double apart = EDGE_REACH / double(profile.before.size());
    double least = 1.0, most = 0.0, offset = 0.0;
    for (size_t i = 0; i < profile.before.size(); ++i) {
        least = std::min(least, saturated(profile.before[i] / profile.greatest));
        most = std::max(most, saturated(profile.behind[i] / profile.greatest));
        offset += apart * (least + most - 1.0);
    }
    return offset;
}

Profile profile_of(const std::function<double(double)>& at, int samples)
{
    Profile profile;
    for (int i = 0; i < samples; ++i) {
        const double along = (i + 0.5) * EDGE_REACH / samples;
        profile.before.push_back(at(along));
        profile.behind.push_back(at(-along));
        profile.greatest = std::max(profile.greatest, profile.behind.back());
        if (along <= 0.25) profile.greatest = std::max(profile.greatest, profile.before.back());
    }
    return profile;
}

double opacity_of(double one, double stretch)
{
    return 1.0 - std::pow(1.0 - one, stretch);
}

/// The opacity, rounded to 8 bits.
double kept(double opacity)
{
    const double code = std::floor(255.0 * std::sqrt(opacity) + 0.5);
    return code * code / (255.0 * 255.0);
}

/// Opacities along each axis of a cell of 4^3 voxels, over the stretch of a tap.
glm::dvec3 cell_opacities(const VoxelOpacity& opacity, const glm::ivec3& cell, double stretch)
{
    constexpr int side = 4;
    glm::dvec3 opacities(0.0);
    for (int axis = 0; axis < 3; ++axis) {
        double through = 0.0;
        for (int j = 0; j < side; ++j)
            for (int i = 0; i < side; ++i) {
                double left = 1.0;
                for (int k = 0; k < side; ++k) {
                    glm::ivec3 in_cell;
                    in_cell[axis] = k, in_cell[(axis + 1) % 3] = i, in_cell[(axis + 2) % 3] = j;
                    left *= std::pow(1.0 - opacity(side * cell + in_cell), stretch / side);
                }
                through += left / (side * side);
            }
        opacities[axis] = kept(std::max(1.0 - through, 0.0));
    }
    return opacities;
}

double beyond_surface(double opacity, double of_surface)
{
    const double own = std::min(of_surface, 0.95);
    return std::max(opacity - own, 0.0) / (1.0 - own);
}

/// The half-space behind a surface, and what cells hold of it.
struct Surface {
    glm::dvec3 place, heights;
    double strength, height;  ///< along the normal
    double wall;

    /// Share of a cell's columns along each axis that end in the cell.
    glm::dvec3 shares_of_cell(const glm::ivec3& cell) const
    {
        constexpr double side = 4.0;
        const glm::dvec3 extent = glm::abs(heights);
        const double above = glm::dot(glm::dvec3(cell) + 0.5, heights) - (height + MARGIN_4) / side;
        glm::dvec3 shares;
        for (int axis = 0; axis < 3; ++axis) {
            const double across = std::max(extent.x + extent.y + extent.z - extent[axis], 0.1);
            shares[axis] = std::clamp(0.5 + (0.5 * extent[axis] - above) / across, 0.0, 1.0);
        }
        return shares;
    }
};

Surface surface_of(const EdgeOpacity& edge, const OcclusionRays& rays, const glm::dvec3& centre,
                   const OcclusionSide& side)
{
    const glm::dvec3& step = side.fall;
    const double pair = 2.0 * EDGE_REACH / EDGE_TAPS;
    const auto opacity = [&](double along) {
        const double between = std::copysign((std::floor(std::abs(along) / pair) + 0.5) * pair, along);
        return edge(centre + along * step, centre + between * step);
    };
    const Profile profile = profile_of(opacity, EDGE_TAPS);
    const double offset = std::clamp(edge_of(profile), -FURTHEST, FURTHEST);
    Surface surface{.place = centre + side.strength * (offset + LIFT_OF_TAPS) * step,
                    .heights = side.fall,
                    .strength = side.strength,
                    .height = 0.0,
                    .wall = 0.0};
    surface.height = glm::dot(surface.place, surface.heights) - side.strength * LIFT_OF_TAPS;
    const double clear = *std::ranges::min_element(profile.before);
    const double left = std::clamp((1.0 - profile.greatest) / std::max(1.0 - std::min(clear, 1.0), 1e-6), 1e-4, 1.0);
    surface.wall = side.strength * WALL_4 * (1.0 - std::pow(left, rays.stretch_of_4 / rays.near_stretch));
    return surface;
}

/// As in shaders/occlusion/occlusion_bake.comp: ramps that cannot be steeper stand for sharper edges.
double left_of(const OcclusionRamp& ramp, const glm::dvec3& place, double softened_by, double steepest,
               const glm::dvec3& voxels_per_unit)
{
    const double steep = glm::length(ramp.slope), physical = glm::length(ramp.slope * voxels_per_unit);
    const double share = steep / steepest, is_steepest = std::clamp((share * share - 0.5625) / 0.2475, 0.0, 1.0);
    const double soft = softened_by * glm::mix(1.0, steep / std::max(physical, 1e-6), is_steepest);
    OcclusionRamp softened = ramp;
    softened.height *= soft, softened.slope *= soft;
    return softened.left(place - glm::floor(place) - 0.5);
}

}  // namespace

std::vector<glm::dvec3> occlusion_directions(uint32_t count)
{
    return occlusion_directions(count, {}, true);
}

std::vector<glm::dvec3> occlusion_directions(uint32_t count, const OcclusionSide& side, bool full_sphere)
{
    const double turn = std::numbers::pi * (3.0 - std::sqrt(5.0));  // the golden angle
    const double open = full_sphere ? 1.0 : 1.0 - side.strength;
    const glm::dvec3 n = side.normal;
    const double up = n.z < 0.0 ? -1.0 : 1.0, a = -1.0 / (up + n.z), b = n.x * n.y * a;
    const glm::dvec3 one(1.0 + up * n.x * n.x * a, up * b, -up * n.x), other(b, up + n.y * n.y * a, -n.y);
    std::vector<glm::dvec3> directions;
    for (uint32_t k = 0; k < count; ++k) {
        const double share = 1.0 - (k + 0.5) / count, z = share < open ? 2.0 * share - open : share;
        const double r = std::sqrt(std::max(1.0 - z * z, 0.0));
        directions.push_back(r * std::cos(turn * k) * one + r * std::sin(turn * k) * other + z * n);
    }
    return directions;
}

double occlusion_edge(const FieldOpacity& opacity, const glm::dvec3& centre, const glm::dvec3& fall)
{
    return edge_of(profile_of([&](double along) { return opacity(centre + along * fall); }, 48));
}

double occlusion_defined(const FieldOpacity& opacity, const OcclusionAsked& asked, const glm::ivec3& voxel,
                         const OcclusionSide& side, uint32_t directions, int steps)
{
    const glm::dvec3 centre = glm::dvec3(voxel) + 0.5;
    const double offset = side.strength * (occlusion_edge(opacity, centre, side.fall) + LIFT);
    const glm::dvec3 origin = centre + offset * side.fall;
    const double apart = asked.radius / steps;
    double sum = 0.0;
    for (const glm::dvec3& direction : occlusion_directions(directions, side, asked.full_sphere)) {
        const glm::dvec3 step = direction * asked.voxels_per_unit;
        const auto is_inside = [&](double along) { return glm::ivec3(glm::floor(origin + along * step)) == voxel; };
        double exit = 0.0;
        while (is_inside(exit)) exit += 0.02;
        const double limit = exit > 0.0 ? opacity(origin + (exit + 0.5) * step) : 0.0;
        double left = 1.0, light = 0.0;
        for (int i = 0; i < steps && left > 1e-9; ++i) {
            const double along = (i + 0.5) * apart, found = opacity(origin + along * step);
            const double after = left * std::pow(1.0 - (along < exit ? std::min(found, limit) : found), apart);
            light += 0.5 * (left + after);
            left = after;
        }
        sum += light / steps;
    }
    return sum / directions;
}

double occlusion_by_steps(const FieldOpacity& opacity, const std::vector<glm::dvec3>& directions, double radius,
                          int steps, const glm::dvec3& origin)
{
    const double step = radius / steps;
    double sum = 0.0;
    for (const glm::dvec3& direction : directions) {
        double left = 1.0;
        for (int i = 0; i < steps; ++i) {
            sum += left / steps;
            left *= std::pow(1.0 - opacity(origin + (i + 1) * step * direction), step);
        }
    }
    return sum / double(directions.size());
}

double OcclusionRamp::left(const glm::dvec3& from_middle) const
{
    return 1.0 - top * std::clamp(0.5 + height + glm::dot(slope, from_middle), 0.0, 1.0);
}

OcclusionRamp occlusion_ramp(double top, double level, double squares, const glm::dvec3& direction, double steepest)
{
    const double steepness = 1.0 / std::max(6.0 * (level - squares), 1.0 / steepest);
    const double share = std::min(UNEVEN * std::max(squares - level * level, 0.0), 1.0);
    OcclusionRamp ramp{.top = kept(std::clamp(top, 0.0, 1.0))};
    ramp.height = std::round(std::clamp(HEIGHTS * (level - 0.5) * steepness, -30.0, 30.0)) / HEIGHTS;
    for (int axis = 0; axis < 3; ++axis)
        ramp.slope[axis] = std::round(std::clamp(SLOPES * share * steepness * direction[axis], -31.0, 31.0)) / SLOPES;
    return ramp;
}

OcclusionRamp occlusion_ramp(const std::array<double, 8>& opacities)
{
    double sum = 0.0, squares = 0.0;
    glm::dvec3 slope(0.0);
    for (int i = 0; i < 8; ++i) {
        const double each = opacities[size_t(i)];
        sum += each / 8.0, squares += each * each / 8.0;
        slope += each / 4.0 * (2.0 * glm::dvec3(i & 1, i >> 1 & 1, i >> 2) - 1.0);
    }
    const double top = *std::ranges::max_element(opacities), whole = std::max(top, 1e-10);
    return occlusion_ramp(top, sum / whole, squares / (whole * whole), slope / std::max(glm::length(slope), 1e-6),
                          STEEPEST_OF_CELLS);
}

double occlusion_by_taps(const OcclusionMedium& medium, const OcclusionRays& rays, const glm::ivec3& voxel,
                         const OcclusionSide& side)
{
    const Surface surface = surface_of(medium.edge, rays, glm::dvec3(voxel) + 0.5, side);
    double sum = 0.0;
    for (const glm::dvec3& direction : occlusion_directions(rays.count, side, rays.asked.full_sphere)) {
        const glm::dvec3& per_unit = rays.asked.voxels_per_unit;
        const glm::dvec3 step = direction * per_unit, weights = step * step / glm::dot(step, step);
        const double wall = glm::dot(direction, side.normal) > 1e-4 ? surface.wall : 0.0;
        std::vector<double> lefts;
        std::vector<bool> leaves;
        for (const OcclusionTap& tap : rays.taps) {
            const glm::dvec3 place = surface.place + tap.distance * step;
            const size_t number = lefts.size();
            leaves.push_back(glm::ivec3(glm::floor(place)) != voxel);
            if (tap.side == 1) {
                const OcclusionRamp ramp = medium.voxel(glm::ivec3(glm::floor(place)));
                const double left = left_of(ramp, place, SOFT[number], STEEPEST_OF_VOXELS, per_unit);
                lefts.push_back(std::pow(left, tap.stretch / rays.near_stretch));
            } else if (tap.side == 2) {
                const OcclusionRamp ramp = medium.cell(glm::ivec3(glm::floor(place / 2.0)));
                lefts.push_back(left_of(ramp, place / 2.0, SOFT[number], STEEPEST_OF_CELLS, per_unit));
            } else {
                const glm::ivec3 cell(glm::floor(place / 4.0));
                const double found = glm::dot(weights, cell_opacities(medium.opacity, cell, rays.stretch_of_4));
                lefts.push_back(1.0 - beyond_surface(found, wall * glm::dot(weights, surface.shares_of_cell(cell))));
            }
        }
        for (size_t i = std::min<size_t>(lefts.size(), 3); i-- > 0;)
            if (!leaves[i]) lefts[i] = i + 1 < 3 ? std::max(lefts[i], lefts[i + 1]) : 1.0;
        double left = 1.0, light = rays.first;
        for (size_t i = 0; i < lefts.size(); ++i) {
            const double stopped = 1.0 - lefts[i];
            light += left * rays.taps[i].stretch *
                     (rays.taps[i].side == 4 ? 1.0 - stopped * (0.5 + BEND_4 * stopped) : std::sqrt(lefts[i]));
            left *= lefts[i];
        }
        sum += light / rays.asked.radius;
    }
    return sum / double(rays.count);
}

double occlusion_by_taps(const VoxelOpacity& opacity, const OcclusionRays& rays, const glm::ivec3& voxel,
                         const OcclusionSide& side)
{
    const auto of_voxel = [&](const glm::ivec3& at) { return opacity_of(opacity(at), rays.near_stretch); };
    const OcclusionMedium medium{
        .opacity = opacity,
        .voxel =
            [&](const glm::ivec3& at) {
                return occlusion_ramp(of_voxel(at), 1.0, 1.0, glm::dvec3(0.0), STEEPEST_OF_VOXELS);
            },
        .cell =
            [&](const glm::ivec3& cell) {
                std::array<double, 8> opacities{};
                for (int i = 0; i < 8; ++i)
                    opacities[size_t(i)] =
                        opacity_of(opacity(2 * cell + glm::ivec3(i & 1, i >> 1 & 1, i >> 2)), rays.stretch_of_2);
                return occlusion_ramp(opacities);
            },
        .edge = [&](const glm::dvec3& place, const glm::dvec3&) { return of_voxel(glm::ivec3(glm::floor(place))); }};
    return occlusion_by_taps(medium, rays, voxel, side);
}

}  // namespace shvr::reference
