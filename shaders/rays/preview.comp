// Finds the first voxel on each pixel's ray that a brush would change; stores the colour of its cube, lit, and the
// length along the ray. If the voxel lies in front of other surfaces (surfaces.comp), the ray ends there, and `seen`
// marks the pixel. In slices, stores the voxel half-way along the ray, unlit. One thread per pixel.
//   SURFACED   there are other surfaces
// variants: SURFACED
//
// Rays step from voxel to voxel (Amanatides and Woo 1987). The volume's cutting planes do not cut these voxels, since a
// brush also reaches behind the planes.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "../raycast.h"
#include "../preview.h"
#include "../surfaces.h"

layout(local_size_x = 8, local_size_y = 8, local_size_z = 1) in;
layout(constant_id = 0) const uint GROUP_WIDTH = 8u;
layout(constant_id = 1) const uint SHININESS_SQUARINGS = NOT_A_POWER_OF_TWO;
layout(constant_id = 2) const uint DISTANCE_BLEND = 0u;
layout(constant_id = 3) const uint SLICE = 0u;

layout(binding = 0, scalar) readonly buffer Params { RaycastParams data; } params_block;
layout(binding = 1, scalar) readonly buffer Preview { PreviewParams data; } preview_params;
layout(binding = 2, scalar) readonly buffer Words { uint words[]; } preview_words;
layout(binding = 3, rgba32f) uniform writeonly image2D nearest;   // linear RGB, length along the ray
layout(binding = 4, rgba32f) uniform writeonly image2D seen;      // linear RGB, 1; or 0
#ifdef SURFACED
layout(binding = 5, rgba32f) uniform readonly image2D surfaces;
#endif

#include "../library/counters.glsl"
#include "../library/rays.glsl"
#include "../library/shade.glsl"

bool is_set(const PreviewParams preview, ivec3 voxel)
{
    const ivec3 at = clamp(voxel, ivec3(0), preview.size - 1);
    const uint row = uint(at.y + preview.size.y * at.z);
    return (preview_words.words[preview.words_per_row * row + uint(at.x >> 5)] >> (uint(at.x) & 31u) & 1u) != 0u;
}

bool is_inside(const PreviewParams preview, ivec3 voxel)
{
    return all(greaterThanEqual(voxel, ivec3(0))) && all(lessThan(voxel, preview.size));
}

vec3 color_of(const PreviewParams preview, ivec3 voxel)
{
    const ivec3 at = voxel + ivec3(preview.lower);
    const bool is_dark = preview.is_striped != 0u && (uint(at.x + at.y + at.z) / PREVIEW_STRIPE & 1u) != 0u;
    return preview.color * (is_dark ? 0.12 : 1.0);
}

// A pixel's line through the box of voxels, in voxels of the box.
struct Line {
    vec3 near, direction;
    vec3 safe;          // the direction, nowhere 0
    vec3 inverse;       // 1 / safe
    float begin, end;   // lengths along the line: where it enters and leaves the box
    ivec3 face;         // axis of the face through which the line enters; 0 if it begins inside the box
};

Line line_through(const PreviewParams preview, vec3 near, vec3 far, float length_to_far)
{
    Line line;
    line.near = near;
    line.direction = (far - near) / length_to_far;
    line.safe = mix(line.direction, vec3(1e-20), lessThan(abs(line.direction), vec3(1e-20)));
    line.inverse = 1.0 / line.safe;
    const vec3 a = -near * line.inverse, b = (vec3(preview.size) - near) * line.inverse;
    const vec3 low = min(a, b), high = max(a, b);
    line.begin = max(max(low.x, low.y), max(low.z, 0.0));
    line.end = min(min(high.x, high.y), min(high.z, length_to_far));
    const bool by_x = low.x >= line.begin, by_y = !by_x && low.y >= line.begin;   // the slab entered last
    line.face = line.begin <= 0.0 ? ivec3(0) : ivec3(by_x, by_y, !by_x && !by_y);
    return line;
}

struct Hit {
    bool is_hit;
    ivec3 voxel;
    ivec3 face;   // signed axis along which the line enters the voxel; 0: it begins in the voxel
    float at;     // length along the line
};

// Finds the first set voxel. Every variable used after an iteration is assigned in every iteration, without a branch,
// because devices may run the loop until its last lane is done.
Hit first_hit(const PreviewParams preview, const Line line)
{
    const ivec3 towards = ivec3(mix(vec3(-1.0), vec3(1.0), greaterThanEqual(line.safe, vec3(0.0))));
    const vec3 apart = abs(line.inverse);
    Hit hit = Hit(false, clamp(ivec3(floor(line.near + line.begin * line.direction)), ivec3(0), preview.size - 1),
                  line.face, line.begin);
    vec3 next = (vec3(hit.voxel + max(towards, ivec3(0))) - line.near) * line.inverse;
    bool goes_on = line.begin < line.end;
    if (goes_on) do {
        hit.is_hit = hit.is_hit || (goes_on && is_set(preview, hit.voxel));
        const ivec3 axis = next.x <= next.y && next.x <= next.z ? ivec3(1, 0, 0)
                           : next.y <= next.z                  ? ivec3(0, 1, 0)
                                                                : ivec3(0, 0, 1);
        const float to = min(next.x, min(next.y, next.z));
        hit.at = hit.is_hit ? hit.at : to;
        hit.face = hit.is_hit ? hit.face : axis;
        hit.voxel = hit.is_hit ? hit.voxel : hit.voxel + axis * towards;
        next = hit.is_hit ? next : next + vec3(axis) * apart;
        // same again: a lane that has left has hit a voxel, or moves farther beyond the end
        goes_on = !hit.is_hit && to < line.end && is_inside(preview, hit.voxel);
    } while (goes_on);
    count(COUNTER_CUT_SHORT, uint(goes_on));   // if a device aborts loops
    hit.face *= towards;
    return hit;
}

void main()
{
    const RaycastParams params = params_block.data;
    const PreviewParams preview = preview_params.data;
    const uvec2 in_part = thread_in_part();
    const uvec2 pixel = params.pixel_begin + in_part;
    if (any(greaterThanEqual(pixel, params.pixel_end))) return;

    const vec2 centre = vec2(pixel) + 0.5;
    const vec3 near = on_plane(preview.near_corner, preview.near_dx, preview.near_dy, centre);
    const vec3 far = on_plane(preview.far_corner, preview.far_dx, preview.far_dy, centre);
    if (SLICE != 0u) {
        const ivec3 voxel = ivec3(floor(0.5 * (near + far)));
        const bool is_hit = is_inside(preview, voxel) && is_set(preview, voxel);
        imageStore(seen, ivec2(in_part), is_hit ? vec4(color_of(preview, voxel), 1.0) : vec4(0.0));
        return;
    }

    const vec3 physical = (far - near) * params.spacing;
    const float length_to_far = length(physical);
    const Line line = line_through(preview, near, far, length_to_far);
    const Hit hit = first_hit(preview, line);
#ifdef SURFACED
    const vec4 behind = imageLoad(surfaces, ivec2(in_part));
#else
    const vec4 behind = vec4(0.0, 0.0, 0.0, NO_SURFACE);
#endif
    if (!hit.is_hit || hit.at >= behind.a) {
        imageStore(nearest, ivec2(in_part), behind);
        imageStore(seen, ivec2(in_part), vec4(0.0));
        return;
    }
    const vec3 to_eye = -physical / length_to_far;
    const vec3 normal = hit.face == ivec3(0) ? to_eye : -vec3(hit.face);
    vec3 color =
        lit(params, params.ambient, color_of(preview, hit.voxel), normal, 1.0, half_way(params.light, to_eye));
    if (DISTANCE_BLEND != 0u) color = blended(params, color, near + hit.at * line.direction + preview.lower);
    imageStore(nearest, ivec2(in_part), vec4(color, hit.at));
    imageStore(seen, ivec2(in_part), vec4(color, 1.0));
}
