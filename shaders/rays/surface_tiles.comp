// Lists the surfaces that the rays of a tile may meet (surfaces.h): one thread per tile of SURFACE_TILE^2 pixels. The
// rays of neighbouring pixels meet nearly the same surfaces, so boxes are tested once per tile instead of once per
// ray.
//
// All rays of a tile lie between the four planes through the tile's edges, whether the rays are parallel or come from
// one point. A surface is omitted only if all of it is behind one of these planes by more than the rounding error.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "../raycast.h"
#include "../surfaces.h"

layout(local_size_x = 8, local_size_y = 8, local_size_z = 1) in;

layout(binding = 0, scalar) readonly buffer Params { RaycastParams data; } params_block;
layout(binding = 1, scalar) readonly buffer Scene { SurfaceParams data; } surface_params;
layout(binding = 5, r32ui) uniform uimage2D surface_tiles;

layout(constant_id = 0) const uint TRIANGLES = 0u;  // 1: the list holds triangles

const uint GROUP_WIDTH = 8u;   // tiles
#include "../library/rays.glsl"
#include "../library/surface_list.glsl"

// Factor for the slack of boxes. Covers normals that are off by a few ulps, over distances that the slack covers, and
// tiles that extend half a pixel beyond their rays.
const float SLACKS = 8.0;

struct Side {
    vec3 point;    // relative to the scene's origin
    vec3 normal;   // unit, inwards
};

// `corner`: in pixels. `to_middle`: from corner to centre of the tile. `edge`: direction of the tile's edge.
Side side_of(const SurfaceParams scene, vec2 corner, vec2 to_middle, vec3 edge)
{
    const vec3 along = scene.along_corner + corner.x * scene.along_dx + corner.y * scene.along_dy;
    const vec3 across = cross(along / length(along), edge / max(length(edge), 1e-30));
    const vec3 normal = across / max(length(across), 1e-30);
    const float middle = dot(normal, to_middle.x * scene.middle_dx + to_middle.y * scene.middle_dy);
    return Side(scene.middle_corner + corner.x * scene.middle_dx + corner.y * scene.middle_dy,
                middle < 0.0 ? -normal : normal);
}

// `middle` relative to the scene's origin.
bool box_may_be_met(const Side sides[4], vec3 middle, vec3 half_size, float slack)
{
    bool may = true;
    for (uint i = 0u; i < 4u; ++i)
        may = may && dot(sides[i].normal, middle - sides[i].point) + dot(abs(sides[i].normal), half_size) >= -slack;
    return may;
}

// A surface as two balls, or a triangle: a corner, the ways from it to two others, and the radii at the first two.
struct Extent {
    vec3 from, along, other;
    float radius_from, radius_to;
};

Extent extent_at(const SurfaceParams scene, uint index)
{
    if (TRIANGLES != 0u) {
        const Triangle triangle = triangle_at(index);
        return Extent(triangle.a - scene.origin, triangle.b - triangle.a, triangle.c - triangle.a, 0.0, 0.0);
    }
    const Surface surface = surface_at(index);
    return Extent(surface.from - scene.origin, surface.along, vec3(0.0), surface.radius_from, surface.radius_to);
}

bool surface_may_be_met(const Side sides[4], const Extent surface, float slack)
{
    bool may = true;
    for (uint i = 0u; i < 4u; ++i) {
        const float first = dot(sides[i].normal, surface.from - sides[i].point);
        const float second = first + dot(sides[i].normal, surface.along);
        float inmost = max(first + surface.radius_from, second + surface.radius_to);
        if (TRIANGLES != 0u) inmost = max(inmost, first + dot(sides[i].normal, surface.other));
        may = may && inmost >= -slack;
    }
    return may;
}

// Returns the bits of those blocks of the tile whose rays may meet a surface. `borders`: the first is between left and
// right blocks, the others are between rows of blocks.
uint blocks_of(const Side borders[4], const Extent surface, float slack)
{
    vec4 first, along, third;
    for (uint i = 0u; i < 4u; ++i) {
        first[i] = dot(borders[i].normal, surface.from - borders[i].point);
        along[i] = dot(borders[i].normal, surface.along);
        third[i] = first[i] + (TRIANGLES != 0u ? dot(borders[i].normal, surface.other) : 0.0);
    }
    const vec4 second = first + along;
    vec4 least = min(first - surface.radius_from, second - surface.radius_to);
    vec4 most = max(first + surface.radius_from, second + surface.radius_to);
    if (TRIANGLES != 0u) {
        least = min(least, third);
        most = max(most, third);
    }
    const bvec4 before = lessThanEqual(least, vec4(slack)), beyond = greaterThanEqual(most, vec4(-slack));
    const uint row = uint(before.x) | uint(beyond.x) << 1u;
    return (before.y ? row : 0u) | (beyond.y && before.z ? row << 2u : 0u) |
           (beyond.z && before.w ? row << 4u : 0u) | (beyond.w ? row << 6u : 0u);
}

void main()
{
    const RaycastParams params = params_block.data;
    const SurfaceParams scene = surface_params.data;
    const uvec2 tiles = surface_tiles_of(params.pixel_end - params.pixel_begin);
    const uvec2 tile = thread_in_part();   // here: the index of a tile
    if (any(greaterThanEqual(tile, tiles))) return;

    const vec2 lower = vec2(params.pixel_begin + SURFACE_TILE * tile), upper = lower + float(SURFACE_TILE);
    const vec2 half_tile = vec2(0.5 * float(SURFACE_TILE));
    const Side sides[4] = Side[4](side_of(scene, lower, half_tile, scene.middle_dx),
                                  side_of(scene, lower, half_tile, scene.middle_dy),
                                  side_of(scene, upper, -half_tile, scene.middle_dx),
                                  side_of(scene, upper, -half_tile, scene.middle_dy));
    const vec2 to_right = vec2(half_tile.x, 0.0), below = vec2(0.0, half_tile.y);
    const Side borders[4] = Side[4](side_of(scene, lower + half_tile, to_right, scene.middle_dy),
                                    side_of(scene, lower + vec2(half_tile.x, 2.0), below, scene.middle_dx),
                                    side_of(scene, lower + half_tile, below, scene.middle_dx),
                                    side_of(scene, lower + vec2(half_tile.x, 6.0), below, scene.middle_dx));
    const float slack = SLACKS * scene.slack;

    const ivec2 counted = ivec2(surface_tile_texel(tile, 0u));
    uint count = scene.first_node > 0u ? imageLoad(surface_tiles, counted).x : 0u;
    uint node = scene.first_node;
    bool goes_on = node < scene.end_node && count <= SURFACES_IN_TILE;
    if (goes_on) do {
        const SurfaceNode box = surface_node(node);
        const bool is_met = box_may_be_met(sides, 0.5 * (box.lower + box.upper) - scene.origin,
                                           0.5 * (box.upper - box.lower), slack);
        const uint end = is_met ? box.end : box.begin;
        uint i = box.begin;
        if (i < end) do {
            const Extent surface = extent_at(scene, i);
            const bool may_be_met = surface_may_be_met(sides, surface, slack);
            if (may_be_met && count < SURFACES_IN_TILE) {
                const uint blocks = blocks_of(borders, surface, slack);
                imageStore(surface_tiles, ivec2(surface_tile_texel(tile, 1u + count)),
                           uvec4(i | blocks << SURFACE_BLOCK));
            }
            count += uint(may_be_met);
        } while (++i < end);
        node = is_met ? node + 1u : box.skip;
        goes_on = node < scene.end_node && count <= SURFACES_IN_TILE;
    } while (goes_on);
    // If the device aborted the loop, marks the list as too long, so that rays search the boxes.
    imageStore(surface_tiles, counted, uvec4(node < scene.end_node ? SURFACES_IN_TILE + 1u : count));
}
