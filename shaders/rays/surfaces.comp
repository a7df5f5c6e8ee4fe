// The nearest opaque surface of each pixel's ray: rgb is its lit colour in linear light, a is the length along the ray
// from the near plane, as in raycast.comp, in reference lengths; NO_SURFACE if there is none. One thread per pixel.
//   LISTED   there is a list of surfaces, in addition to the probe
// variants: LISTED
//
// If a tile meets few surfaces, its rays test the surfaces that surface_tiles.comp has listed for the tile; other rays
// search the boxes. The result is the same, since the nearest surface counts, regardless of the order of the tests.
//
// A dispatch visits a limited number of nodes for each ray, because some devices silently abort a thread's loops after
// 65535 iterations. Between these rounds the target holds what a ray has met: its length, the surface's index, whether
// the ray begins inside, and the node at which the search goes on. Listed surfaces are tested in the last round.
//
// Surfaces are solid: if a ray starts inside one (the near plane cuts the surface, or the eye is in it), the ray hits
// it at its start, facing the eye. Triangles have no inside: those before the start are not met. The volume's cutting
// planes do not cut surfaces.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "../raycast.h"
#include "../surfaces.h"

layout(local_size_x = 8, local_size_y = 8, local_size_z = 1) in;
layout(constant_id = 0) const uint GROUP_WIDTH = 8u;
layout(constant_id = 1) const uint SHININESS_SQUARINGS = NOT_A_POWER_OF_TWO;
layout(constant_id = 2) const uint DISTANCE_BLEND = 0u;
layout(constant_id = 3) const uint PROBE = 0u;
layout(constant_id = 4) const uint TRIANGLES = 0u;  // 1: the list holds triangles, which have no inside

layout(binding = 0, scalar) readonly buffer Params { RaycastParams data; } params_block;
layout(binding = 1, scalar) readonly buffer Scene { SurfaceParams data; } surface_params;
layout(binding = 2, rgba32f) uniform image2D surfaces;
#ifdef LISTED
layout(binding = 5, r32ui) uniform readonly uimage2D surface_tiles;
#include "../library/surface_list.glsl"
#endif

#include "../library/counters.glsl"
#include "../library/rays.glsl"
#include "../library/round_cone.glsl"
#include "../library/shade.glsl"
#ifdef LISTED
#include "../library/triangle.glsl"
#endif

struct Hit {
    float at;       // length along the line
    bool is_inside; // the line begins in the surface
    uint number;
    uint index;     // in the list; PROBE_INDEX
};
const uint PROBE_INDEX = 0xffffffu;   // the largest index that a float holds exactly, with all below it

vec4 packed_hit(const Hit hit, uint node)
{
    return vec4(hit.at, float(hit.index), float(hit.is_inside), float(node));
}

// Replaces the hit by this surface if its range begins earlier or, at equal length, if its number is lower. The result
// thus does not depend on the search order.
void consider(vec2 range, float begin, uint number, uint index, inout Hit hit)
{
    const float at = max(range.x, begin);
    const bool is_nearer = range.y >= begin && range.x <= range.y &&
                               (at < hit.at || (at == hit.at && number < hit.number));
    hit.at = is_nearer ? at : hit.at;
    hit.is_inside = is_nearer ? range.x < begin : hit.is_inside;
    hit.number = is_nearer ? number : hit.number;
    hit.index = is_nearer ? index : hit.index;
}

#ifdef LISTED
// Subtracts whole parts and rests separately: the first difference is exact near the origin, the second small.
vec3 from_origin(const SurfaceParams scene, const Surface surface)
{
    precise vec3 whole = surface.from - scene.origin;
    precise vec3 rest = surface.from_rest - scene.origin_rest;
    precise vec3 sum = whole + rest;
    return sum;
}

void meet(const SurfaceParams scene, const Line line, float begin, uint index, inout Hit hit)
{
    if (TRIANGLES != 0u) {
        const Triangle triangle = triangle_at(index);
        const float at = met_at(scene, line, triangle).at;
        consider(at < begin ? NOTHING : vec2(at), begin, triangle.number, index, hit);
        return;
    }
    const Surface surface = surface_at(index);
    const vec3 from = from_origin(scene, surface) - line.origin;
    consider(surface_range(surface, from, line.direction), begin, surface.number, index, hit);
}

// Every variable used after the loop is carried through it, because devices that run the loop until its last lane is
// done keep only such variables of lanes that have finished.
void search(const SurfaceParams scene, const Line line, float begin, inout uint node, inout Hit hit)
{
    const vec3 safe = mix(line.direction, vec3(1e-20), lessThan(abs(line.direction), vec3(1e-20)));
    const vec3 inverse = 1.0 / safe;
    const vec3 origin = scene.origin + line.origin;
    uint visits = 0u;
    if (node < scene.end_node) do {
        const SurfaceNode box = surface_node(node);
        const vec3 a = (box.lower - scene.slack - origin) * inverse;
        const vec3 b = (box.upper + scene.slack - origin) * inverse;
        const vec3 low = min(a, b), high = max(a, b);
        const float entry = max(max(low.x, low.y), max(low.z, begin)) - scene.slack;
        const float exit = min(min(high.x, high.y), min(high.z, hit.at)) + scene.slack;
        const bool is_met = entry <= exit;
        const uint end = is_met ? box.end : box.begin;
        uint i = box.begin;
        if (i < end) do meet(scene, line, begin, i, hit); while (++i < end);
        node = is_met ? node + 1u : box.skip;
    } while (node < scene.end_node && ++visits < scene.nodes_in_round);
}

uint listed_word(uvec2 tile, uint number)
{
    return imageLoad(surface_tiles, ivec2(surface_tile_texel(tile, 1u + number))).x;
}

// Returns the next entry of a tile's list, from `next` on, that rays of the pixel's block may meet. This is a separate
// loop because SIMD devices run a test in full even if no ray needs it, but skip iterations of a loop that all lanes
// have left. Lanes that run together belong to one block (library/rays.glsl).
uint next_in_block(uvec2 tile, uint block, uint next, uint count)
{
    while (next < count && (listed_word(tile, next) >> block & 1u) == 0u) ++next;
    return next;
}

// The result of earlier rounds.
Hit unpacked_hit(const vec4 packed)
{
    const uint index = uint(packed.y);
    uint number = PROBE_INDEX;
    if (index != PROBE_INDEX) number = TRIANGLES != 0u ? triangle_at(index).number : surface_at(index).number;
    return Hit(packed.x, packed.z != 0.0, number, index);
}
#endif

#ifdef LISTED
// Tests the line against the surfaces of a tile's list.
void meet_listed(const SurfaceParams scene, const Line line, float begin, uvec2 in_part, uint end_of_tile,
                 inout Hit hit)
{
    const uvec2 tile = in_part / SURFACE_TILE;
    const uint block = surface_block(in_part);
    uint next = next_in_block(tile, block, 0u, end_of_tile);
    if (next < end_of_tile) do {
        meet(scene, line, begin, listed_word(tile, next) & (1u << SURFACE_BLOCK) - 1u, hit);
        next = next_in_block(tile, block, next + 1u, end_of_tile);
    } while (next < end_of_tile);
}
#endif

// Returns the lit colour of the surface that a line meets.
vec3 look_of(const RaycastParams params, const SurfaceParams scene, const Line line, const Hit hit)
{
    const vec3 at = line.origin + hit.at * line.direction;
    vec3 normal = at - scene.probe_center;
    vec3 color = scene.probe_color;
#ifdef LISTED
    if (hit.index != PROBE_INDEX && TRIANGLES != 0u) {
        const Triangle triangle = triangle_at(hit.index);
        normal = triangle_normal(triangle, line, met_at(scene, line, triangle).share);
        color = triangle.color;
    } else if (hit.index != PROBE_INDEX) {
        const Surface surface = surface_at(hit.index);
        // Computed from the line's point nearest to the surface, as in surface_range.
        const vec3 from = from_origin(scene, surface) - line.origin;
        const float shift = dot(from + 0.5 * surface.along, line.direction);
        const vec3 point = (hit.at - shift) * line.direction - (from - shift * line.direction);
        normal = surface_normal(surface, point);
        color = surface.color;
    }
#endif
    normal = hit.is_inside ? -line.direction : normalize(normal);
    const vec3 seen = lit(params, params.ambient, color, normal, 1.0, half_way(params.light, -line.direction));
    return DISTANCE_BLEND != 0u ? blended(params, seen, (at + scene.origin) * params.inverse_spacing) : seen;
}

void main()
{
    const RaycastParams params = params_block.data;
    const SurfaceParams scene = surface_params.data;
    const uvec2 in_part = thread_in_part();
    const uvec2 pixel = params.pixel_begin + in_part;
    if (any(greaterThanEqual(in_part, params.pixel_end - params.pixel_begin))) return;

    const vec2 centre = vec2(pixel) + 0.5;
    const vec3 along = on_plane(scene.along_corner, scene.along_dx, scene.along_dy, centre);
    const float length_to_far = length(along);
    Line line;
    line.origin = on_plane(scene.middle_corner, scene.middle_dx, scene.middle_dy, centre);
    line.direction = along / length_to_far;
    const float begin = (scene.begin - scene.middle) * length_to_far;
    const float end = (scene.end - scene.middle) * length_to_far;

    Hit hit = Hit(end, false, 0u, PROBE_INDEX);  // initial hit: the far plane, which only nearer surfaces replace
#ifdef LISTED
    const uint listed = imageLoad(surface_tiles, ivec2(surface_tile_texel(in_part / SURFACE_TILE, 0u))).x;
    const bool is_listed = listed <= SURFACES_IN_TILE;
    if (is_listed && scene.is_last_round == 0u) return;
    const bool is_first = is_listed || scene.is_first_round != 0u;
    uint node = is_listed ? scene.end_node : 0u;
    if (!is_first) {
        const vec4 packed = imageLoad(surfaces, ivec2(in_part));
        node = uint(packed.w);
        if (node >= scene.end_node && scene.is_last_round == 0u) return;
        hit = unpacked_hit(packed);
    }
#else
    const bool is_first = true;
#endif
    if (PROBE != 0u && is_first)
        consider(ball_range(scene.probe_center - line.origin, line.direction, scene.probe_radius), begin, PROBE_INDEX,
                 PROBE_INDEX, hit);
#ifdef LISTED
    meet_listed(scene, line, begin, in_part, is_listed ? listed : 0u, hit);
    search(scene, line, begin, node, hit);
    if (scene.is_last_round == 0u) {
        imageStore(surfaces, ivec2(in_part), packed_hit(hit, node));
        return;
    }
    count(COUNTER_CUT_SHORT, uint(node < scene.end_node));
#endif
    if (!(hit.at < end)) {
        imageStore(surfaces, ivec2(in_part), vec4(0.0, 0.0, 0.0, NO_SURFACE));
        return;
    }

    const vec3 seen = look_of(params, scene, line, hit);
    imageStore(surfaces, ivec2(in_part), vec4(seen, hit.at + scene.middle * length_to_far));
}
