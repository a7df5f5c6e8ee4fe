#include "tests/support/occlusion.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "engine/device/look_table.h"
#include "engine/passes/occlusion_stretch.h"

namespace shvr::test {

Session occluded(std::vector<ControlPoint> points, double radius, const glm::uvec2& pixels)
{
    Session session = plain_session(std::move(points), pixels);
    session.light = {.shaded = true, .ambient = 1.0, .diffuse = 0.0, .specular = 0.0};
    session.light.occlusion = {.strength = 1.0, .radius = radius};
    return session;
}

Camera overview(const TestVolume& volume)
{
    return camera_along(volume, {1.0, 2.0, 3.0}, 1.2 * glm::length(glm::dvec3(volume.size) * volume.spacing));
}

TestVolume blobs(const glm::ivec3& size, const glm::dvec3& spacing)
{
    TestVolume volume = volume_of(size, [](const glm::dvec3& p) {
        return std::clamp(32000.0 + 14000.0 * std::sin(0.35 * p.x + 0.1 * p.y) +
                              14000.0 * std::sin(0.29 * p.y - 0.2 * p.z) +
                              14000.0 * std::cos(0.4 * p.z + 0.15 * p.x + 1.0),
                          0.0, 65535.0);
    });
    volume.spacing = spacing;
    return volume;
}

std::vector<double> occlusion_values(OnDevice& device)
{
    return occlusion_values(device.renderer(), device.volume().size);
}

std::vector<double> occlusion_values(Renderer& renderer, const glm::ivec3& size)
{
    FrameGraph graph;
    const OcclusionBinding binding = renderer.scene().occlusion().bring_up_to_date(graph);
    const uint32_t back = graph.read_back(binding.values);
    const gpu::FrameResult result = renderer.executor().run(graph, {.timestamps = false});
    const std::vector<std::byte>& bytes = result.read_backs[back];
    const glm::uvec3 texels = gpu::BRICK_TEXELS * renderer.volume().atlas_slots();
    const RegionBricks bricks = *renderer.volume().region({Size3(0), Size3(size)}, true);
    std::vector<double> values;
    for (int z = 0; z < size.z; ++z)
        for (int y = 0; y < size.y; ++y)
            for (int x = 0; x < size.x; ++x) {
                const glm::uvec3 voxel(x, y, z);
                const uint32_t slot = bricks.slots[gpu::grid_index(voxel / gpu::BRICK_SIZE, bricks.counts)];
                const glm::uvec3 texel = gpu::slot_origin(slot) + gpu::BRICK_APRON + voxel % gpu::BRICK_SIZE;
                values.push_back(double(std::to_integer<uint8_t>(
                                     bytes[texel.x + size_t(texels.x) * (texel.y + size_t(texels.y) * texel.z)])) /
                                 255.0);
            }
    return values;
}

ExpectedOcclusion::ExpectedOcclusion(const TestVolume& volume, const Session& session)
    : volume_(volume),
      session_(session),
      samples_(table_range(session.transfer_function, volume.window(), false).samples),
      near_(table_of(rays().near_stretch)),
      far_(table_of(rays().stretch_of_2))
{
    for (int z = 0; z < volume.size.z; ++z)
        for (int y = 0; y < volume.size.y; ++y)
            for (int x = 0; x < volume.size.x; ++x)
                opacities_.push_back(is_kept({x, y, z}) ? opacity_of_code(code({x, y, z})) : 0.0);
}

double ExpectedOcclusion::code(const glm::ivec3& at) const
{
    const glm::ivec3 held = glm::clamp(at, glm::ivec3(0), volume_.size - 1);
    return volume_.voxels[size_t(held.x + volume_.size.x * (held.y + volume_.size.y * held.z))];
}

bool ExpectedOcclusion::is_beyond_plane(const glm::dvec3& voxel) const
{
    const CutBox& cut = session_.cut;
    if (!cut.plane_normal) return false;
    const glm::dvec3 point = cut.plane_point.value_or(0.5 * glm::dvec3(volume_.size));
    return glm::dot(*cut.plane_normal, (voxel - point) * volume_.spacing) > 0.0;
}

bool ExpectedOcclusion::is_kept(const glm::ivec3& at) const
{
    const glm::dvec3 centre = glm::dvec3(at) + 0.5;
    return glm::all(glm::greaterThanEqual(at, glm::ivec3(0))) && glm::all(glm::lessThan(at, volume_.size)) &&
           glm::all(glm::greaterThanEqual(centre, session_.cut.lower)) &&
           glm::all(glm::lessThan(centre, session_.cut.upper)) && !is_beyond_plane(centre);
}

/// The nearest of the table's entries.
double ExpectedOcclusion::opacity_of_code(double code) const
{
    const TransferFunction& function = session_.transfer_function;
    if (code < function.lower() || code > function.upper()) return 0.0;
    const double per_entry = (samples_.upper - samples_.lower) / (samples_.entries - 1);
    return function.at(samples_.lower + per_entry * std::floor((code - samples_.lower) / per_entry + 0.5)).a;
}

ExpectedOcclusion::Table ExpectedOcclusion::table_of(double stretch) const
{
    Table table{.opacities = {}, .sums = {0.0}, .squares = {0.0}};
    for (const glm::vec4& entry : bake_table(session_.transfer_function, stretch, samples_).looks) {
        const double opacity = double(entry.a);
        table.opacities.push_back(opacity);
        table.sums.push_back(table.sums.back() + opacity);
        table.squares.push_back(table.squares.back() + opacity * opacity);
    }
    return table;
}

glm::dvec3 ExpectedOcclusion::sums_at(const Table& table, double code) const
{
    const TransferFunction& function = session_.transfer_function;
    const double per_entry = (samples_.upper - samples_.lower) / (samples_.entries - 1);
    const double at = std::clamp((code - samples_.lower) / per_entry, 0.0, samples_.entries - 1.0) + 0.5;
    const auto entry = size_t(at);
    const double part = at - double(entry), opacity = table.opacities[entry];
    const bool is_inside = code >= function.lower() && code <= function.upper();
    return {is_inside ? opacity : 0.0, table.sums[entry] + part * opacity,
            table.squares[entry] + part * opacity * opacity};
}

/// As in shaders/occlusion/occlusion_ramp.glsl.
reference::OcclusionRamp ExpectedOcclusion::ramp_of(const Table& table, double middle, const glm::dvec3& slope,
                                                    double least, double most, double steepest) const
{
    const double per_entry = (samples_.upper - samples_.lower) / (samples_.entries - 1);
    const double steep = glm::length(slope), half_width = std::max(0.5 * steep, 0.5 * per_entry);
    const double lower = middle - half_width, upper = middle + half_width;
    const double from = std::clamp(lower, least, most), to = std::clamp(upper, least, most);
    const glm::dvec3 at_from = sums_at(table, from), at_to = sums_at(table, to);
    const auto mean_of = [&](double of_from, double of_to, double between) {
        return (between * per_entry + (from - lower) * of_from + (upper - to) * of_to) / (2.0 * half_width);
    };
    const double mean = mean_of(at_from.x, at_to.x, at_to.y - at_from.y);
    const double squares = mean_of(at_from.x * at_from.x, at_to.x * at_to.x, at_to.z - at_from.z);
    const double top = std::max({at_from.x, at_to.x, squares / std::max(mean, 1e-10)}), whole = std::max(top, 1e-10);
    const double up = at_to.x < at_from.x ? -1.0 : 1.0;
    return reference::occlusion_ramp(top, std::min(mean / whole, 1.0), std::min(squares / (whole * whole), 1.0),
                                     up / std::max(steep, 1e-6) * slope, steepest);
}

/// From a voxel's density and those of its six neighbours.
reference::OcclusionRamp ExpectedOcclusion::ramp_of_voxel(const glm::ivec3& at) const
{
    if (!is_kept(at)) return {};
    const double middle = code(at);
    double mean = middle, lower = middle, upper = middle;
    glm::dvec3 slope(0.0);
    for (int axis = 0; axis < 3; ++axis) {
        glm::ivec3 step(0);
        step[axis] = 1;
        const double before = code(at - step), behind = code(at + step);
        slope[axis] = 0.5 * (behind - before);
        mean += 0.125 * (before + behind - 2.0 * middle);
        lower = std::min({lower, before, behind});
        upper = std::max({upper, before, behind});
    }
    return ramp_of(near_, std::clamp(mean, lower, upper), slope, lower, upper, reference::STEEPEST_OF_VOXELS);
}

/// From the densities of its eight voxels; where not all of them are seen, from their opacities.
reference::OcclusionRamp ExpectedOcclusion::ramp_of_cell(const glm::ivec3& cell) const
{
    std::array<double, 8> opacities{}, codes{};
    bool are_kept = true;
    glm::dvec3 slope(0.0);
    for (size_t i = 0; i < 8; ++i) {
        const glm::ivec3 corner(i & 1, i >> 1 & 1, i >> 2), at = 2 * cell + corner;
        codes[i] = code(at);
        opacities[i] = is_kept(at) ? sums_at(far_, codes[i]).x : 0.0;
        are_kept = are_kept && is_kept(at);
        slope += 0.25 * codes[i] * (2.0 * glm::dvec3(corner) - 1.0);
    }
    if (!are_kept) return reference::occlusion_ramp(opacities);
    const double mean = std::accumulate(codes.begin(), codes.end(), 0.0) / 8.0;
    const auto [least, most] = std::ranges::minmax(codes);
    return ramp_of(far_, mean, 2.0 * slope, least, most, reference::STEEPEST_OF_CELLS);
}

double ExpectedOcclusion::opacity(const glm::ivec3& at) const
{
    if (glm::any(glm::lessThan(at, glm::ivec3(0))) || glm::any(glm::greaterThanEqual(at, volume_.size))) return 0.0;
    return opacities_[size_t(at.x + volume_.size.x * (at.y + volume_.size.y * at.z))];
}

reference::OcclusionAsked ExpectedOcclusion::asked() const
{
    const glm::dvec3& spacing = volume_.spacing;
    return {.radius = session_.light.occlusion.radius,
            .full_sphere = session_.light.occlusion.full_sphere,
            .voxels_per_unit = std::min({spacing.x, spacing.y, spacing.z}) / spacing};
}

reference::OcclusionSide ExpectedOcclusion::side(const glm::ivec3& at) const
{
    glm::dvec3 slope(0.0);
    for (int axis = 0; axis < 3; ++axis) {
        glm::ivec3 step(0);
        step[axis] = 1;
        slope[axis] = 0.5 * (code(at + step) - code(at - step));
    }
    const double square = glm::dot(slope, slope);
    const double fade = session_.light.gradient_fade * (volume_.maximum - volume_.minimum);
    if (square == 0.0) return {};
    return {-glm::normalize(slope * asked().voxels_per_unit), square / (square + fade * fade),
            -slope / std::sqrt(square)};
}

reference::OcclusionRays ExpectedOcclusion::rays() const
{
    const OcclusionTaps taps = occlusion_taps_of(volume_.spacing, session_.light.occlusion.radius);
    reference::OcclusionRays rays{.asked = asked(),
                                  .count = session_.light.occlusion.rays,
                                  .first = taps.first,
                                  .taps = {},
                                  .near_stretch = taps.taps.empty() ? 1.0 : taps.near_stretch,
                                  .stretch_of_2 = taps.stretches[0],
                                  .stretch_of_4 = taps.stretches[1]};
    for (uint32_t i = 0; i < taps.taps.size(); ++i)
        rays.taps.push_back({double(taps.taps[i].distance), double(taps.taps[i].stretch),
                             i < taps.end[0]   ? 1
                             : i < taps.end[1] ? 2
                                               : 4});
    return rays;
}

double ExpectedOcclusion::by_taps(const glm::ivec3& at) const
{
    const reference::OcclusionSide of_voxel = side(at);
    const glm::dvec3 centre = glm::dvec3(at) + 0.5, step = glm::abs(of_voxel.fall);
    const double reach = 1.0 / std::max({step.x, step.y, step.z});
    // Beyond a voxel's neighbours the density stays as it is there.
    const auto edge = [&](const glm::dvec3& place, const glm::dvec3& between) {
        const double along = glm::length(place - centre);
        const glm::dvec3 within = centre + (place - centre) * std::min(1.0, reach / along);
        return is_kept(glm::ivec3(glm::floor(between))) ? sums_at(near_, value_at(volume_, within)).x : 0.0;
    };
    return reference::occlusion_by_taps({.opacity = [&](const glm::ivec3& v) { return opacity(v); },
                                         .voxel = [&](const glm::ivec3& v) { return ramp_of_voxel(v); },
                                         .cell = [&](const glm::ivec3& cell) { return ramp_of_cell(cell); },
                                         .edge = edge},
                                        rays(), at, of_voxel);
}

double ExpectedOcclusion::defined(const glm::ivec3& at, uint32_t directions, int steps) const
{
    const auto opacity = [&](const glm::dvec3& p) {
        const bool is_inside = glm::all(glm::greaterThanEqual(p, glm::max(glm::dvec3(0.0), session_.cut.lower))) &&
                               glm::all(glm::lessThan(p, glm::min(glm::dvec3(volume_.size), session_.cut.upper))) &&
                               !is_beyond_plane(p);
        return is_inside ? session_.transfer_function.at(value_at(volume_, p)).a : 0.0;
    };
    return reference::occlusion_defined(opacity, asked(), at, side(at), directions, steps);
}

}  // namespace shvr::test
