#include "tests/reference/occlusion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace shvr::reference {

namespace {

constexpr double EDGE_REACH = 1.5, LIFT = 0.07;
/// Of half voxels, of cells of two voxels and of four: shaders/occlusion/occlusion_bake.comp.
constexpr double MARGINS[] = {0.12, 0.1, 0.6}, WALLS[] = {1.0, 1.0, 1.6}, BENDS[] = {0.0, 0.2, 0.06};

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

/// Opacities along each axis of the cell that holds a voxel, over the stretch of a tap.
glm::dvec3 cell_opacities(const VoxelOpacity& opacity, const glm::ivec3& cell, int side, double stretched)
{
    glm::dvec3 opacities(0.0);
    for (int axis = 0; axis < 3; ++axis) {
        double through = 0.0;
        for (int j = 0; j < side; ++j)
            for (int i = 0; i < side; ++i) {
                double left = 1.0;
                for (int k = 0; k < side; ++k) {
                    glm::ivec3 in_cell;
                    in_cell[axis] = k, in_cell[(axis + 1) % 3] = i, in_cell[(axis + 2) % 3] = j;
                    left *= std::pow(1.0 - opacity(side * cell + in_cell), stretched);
                }
                through += left / (side * side);
            }
        opacities[axis] = kept(std::max(1.0 - through, 0.0));
    }
    return opacities;
}

/// Opacity over the stretch of a near tap: in sevenths of the voxel's maximum.
double near_opacity(const HalfOpacity& halves, const glm::ivec3& half_voxel, double stretch)
{
    const glm::ivec3 voxel(glm::floor(glm::dvec3(half_voxel) / 2.0)), half = half_voxel - 2 * voxel;
    double greatest = 0.0;
    for (int i = 0; i < 8; ++i)
        greatest = std::max(greatest, opacity_of(halves(voxel, {i & 1, i >> 1 & 1, i >> 2}), stretch));
    if (greatest == 0.0) return 0.0;
    return kept(greatest) * std::floor(7.0 * opacity_of(halves(voxel, half), stretch) / greatest + 0.5) / 7.0;
}

double beyond_surface(double opacity, double of_surface)
{
    const double own = std::min(of_surface, 0.95);
    return std::max(opacity - own, 0.0) / (1.0 - own);
}

/// The half-space behind a surface, and what cells hold of it.
struct Surface {
    glm::dvec3 place, normal, heights, wall;
    double strength, height;  ///< of the surface along the normal

    double share_of_half(const glm::ivec3& half_voxel) const
    {
        const double at = height + MARGINS[0];
        return std::clamp(0.5 - 2.0 * (glm::dot(0.5 * (glm::dvec3(half_voxel) + 0.5), heights) - at), 0.0, 1.0);
    }
    /// Of a cell's columns along each axis, those that end in it.
    glm::dvec3 shares_of_cell(const glm::ivec3& cell, double side) const
    {
        const glm::dvec3 extent = glm::abs(heights);
        const double above = glm::dot(glm::dvec3(cell) + 0.5, heights) - (height + MARGINS[side == 2.0 ? 1 : 2]) / side;
        glm::dvec3 shares;
        for (int axis = 0; axis < 3; ++axis) {
            const double across = std::max(extent.x + extent.y + extent.z - extent[axis], 0.1);
            shares[axis] = std::clamp(0.5 + (0.5 * extent[axis] - above) / across, 0.0, 1.0);
        }
        return shares;
    }
};

Surface surface_of(const std::function<double(const glm::ivec3&)>& near, const OcclusionRays& rays,
                   const glm::dvec3& centre, const OcclusionSide& side)
{
    const auto between = [&](const glm::dvec3& place) {
        const glm::dvec3 lattice = 2.0 * place - 0.5, corner = glm::floor(lattice), f = lattice - corner;
        double sum = 0.0;
        for (int i = 0; i < 8; ++i) {
            const glm::ivec3 offset(i & 1, i >> 1 & 1, i >> 2);
            const glm::dvec3 weight = glm::mix(1.0 - f, f, glm::dvec3(offset));
            sum += weight.x * weight.y * weight.z * near(glm::ivec3(corner) + offset);
        }
        return sum;
    };
    const glm::dvec3 step = side.normal * rays.asked.voxels_per_unit;
    const Profile profile = profile_of([&](double along) { return between(centre + along * step); }, 4);
    Surface surface{.place = centre + side.strength * (edge_of(profile) + LIFT) * step,
                    .normal = side.normal,
                    .heights = side.normal / rays.asked.voxels_per_unit,
                    .wall = glm::dvec3(0.0),
                    .strength = side.strength,
                    .height = 0.0};
    surface.height = glm::dot(surface.place, surface.heights) - side.strength * LIFT;
    const double clear = *std::ranges::min_element(profile.before);
    const double left = std::clamp((1.0 - profile.greatest) / std::max(1.0 - std::min(clear, 1.0), 1e-6), 1e-4, 1.0);
    const double exponent = rays.stretched / rays.near_stretch;
    for (int i = 0; i < 3; ++i)
        surface.wall[i] = side.strength * WALLS[i] *
                          (1.0 - std::pow(left, std::array{1.0, 2.0 * exponent, 4.0 * exponent}[size_t(i)]));
    return surface;
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

double occlusion_edge(const FieldOpacity& opacity, const OcclusionAsked& asked, const glm::dvec3& centre,
                      const glm::dvec3& normal)
{
    const glm::dvec3 step = normal * asked.voxels_per_unit;
    return edge_of(profile_of([&](double along) { return opacity(centre + along * step); }, 48));
}

double occlusion_defined(const FieldOpacity& opacity, const OcclusionAsked& asked, const glm::ivec3& voxel,
                         const OcclusionSide& side, uint32_t directions, int steps)
{
    const glm::dvec3 centre = glm::dvec3(voxel) + 0.5;
    const double offset = side.strength * (occlusion_edge(opacity, asked, centre, side.normal) + LIFT);
    const glm::dvec3 origin = centre + offset * side.normal * asked.voxels_per_unit;
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

double occlusion_by_taps(const VoxelOpacity& opacity, const HalfOpacity& halves, const OcclusionRays& rays,
                         const glm::ivec3& voxel, const OcclusionSide& side)
{
    const auto near = [&](const glm::ivec3& half) { return near_opacity(halves, half, rays.near_stretch); };
    const Surface surface = surface_of(near, rays, glm::dvec3(voxel) + 0.5, side);
    double sum = 0.0;
    for (const glm::dvec3& direction : occlusion_directions(rays.count, side, rays.asked.full_sphere)) {
        const glm::dvec3 step = direction * rays.asked.voxels_per_unit, weights = direction * direction;
        const glm::dvec3 wall = glm::dot(direction, side.normal) > 1e-4 ? surface.wall : glm::dvec3(0.0);
        std::vector<double> stops;
        std::vector<bool> leaves;
        for (const OcclusionTap& tap : rays.taps) {
            const glm::dvec3 place = surface.place + tap.distance * step;
            leaves.push_back(glm::ivec3(glm::floor(place)) != voxel);
            if (tap.side == 0) {
                const glm::ivec3 half(glm::floor(2.0 * place));
                stops.push_back(beyond_surface(near(half), wall.x * surface.share_of_half(half)));
            } else {
                const glm::ivec3 cell(glm::floor(place / double(tap.side)));
                const double found = glm::dot(weights, cell_opacities(opacity, cell, tap.side, rays.stretched));
                const double own = glm::dot(weights, surface.shares_of_cell(cell, tap.side));
                stops.push_back(beyond_surface(found, (tap.side == 2 ? wall.y : wall.z) * own));
            }
        }
        for (size_t i = std::min<size_t>(stops.size(), 3); i-- > 0;)
            if (!leaves[i]) stops[i] = i + 1 < 3 ? std::min(stops[i], stops[i + 1]) : 0.0;
        double left = 1.0, light = rays.first;
        for (size_t i = 0; i < stops.size(); ++i) {
            const double a = stops[i], bend = BENDS[rays.taps[i].side / 2];
            light += left * rays.taps[i].stretch *
                     (rays.taps[i].side == 0 ? std::sqrt(1.0 - a) : 1.0 - a * (0.5 + bend * a));
            left *= 1.0 - a;
        }
        sum += light / rays.asked.radius;
    }
    return sum / double(rays.count);
}

double occlusion_by_taps(const VoxelOpacity& opacity, const OcclusionRays& rays, const glm::ivec3& voxel,
                         const OcclusionSide& side)
{
    const HalfOpacity halves = [&](const glm::ivec3& of, const glm::ivec3&) { return opacity(of); };
    return occlusion_by_taps(opacity, halves, rays, voxel, side);
}

}  // namespace shvr::reference
