// A pixel's ray, and its section inside the drawn box. Lengths along a ray are in reference lengths (raycast.h).
#include "../library/rays.glsl"

// The oblique cutting plane. Without one, kernels are the same as if it could not exist.
layout(constant_id = 18) const uint HAS_CUT_PLANE = 0u;

struct Ray {
    vec3 origin;      // voxel space, at length 0
    vec3 direction;   // voxels per reference length
    vec3 inverse;     // 1 / direction; a large number if the direction is 0
    vec3 ahead;       // 1 if the direction is positive, else 0
    vec3 to_eye;      // unit, volume space
    vec3 half_way;    // unit vector between the directions to the eye and to the light; 0 if these are opposite
};

struct Span {
    float begin, end;   // lengths along the ray
    float to_far;       // length along the ray to the far plane
};

// Returns a pixel's ray. Kernels that compute light set `half_way`, which is 0 here.
Ray ray_of(const RaycastParams params, uvec2 pixel, out Span span)
{
    const vec2 centre = vec2(pixel) + 0.5;
    const vec3 near = on_plane(params.near_corner, params.near_dx, params.near_dy, centre);
    const vec3 far = on_plane(params.far_corner, params.far_dx, params.far_dy, centre);
    const vec3 physical = (far - near) * params.spacing;
    span.to_far = length(physical);
    Ray ray;
    ray.origin = near;
    ray.direction = (far - near) / span.to_far;
    ray.to_eye = -physical / span.to_far;
    ray.half_way = vec3(0.0);
    const bvec3 still = equal(ray.direction, vec3(0.0));
    ray.inverse = mix(1.0 / ray.direction, vec3(1e30), still);
    ray.ahead = vec3(greaterThanEqual(ray.direction, vec3(0.0)));

    // Slab test. If the ray does not move along an axis, only its origin is tested there (0 / 0 does not matter).
    const vec3 a = (params.box_lower - near) / ray.direction;
    const vec3 b = (params.box_upper - near) / ray.direction;
    const vec3 entry = mix(min(a, b), vec3(0.0), still);
    const vec3 exit = mix(max(a, b), vec3(span.to_far), still);
    const bool misses = any(bvec3(still.x && (near.x < params.box_lower.x || near.x > params.box_upper.x),
                                  still.y && (near.y < params.box_lower.y || near.y > params.box_upper.y),
                                  still.z && (near.z < params.box_lower.z || near.z > params.box_upper.z)));
    span.begin = max(max(entry.x, entry.y), max(entry.z, 0.0));
    span.end = misses ? span.begin : min(min(exit.x, exit.y), min(exit.z, span.to_far));
    if (HAS_CUT_PLANE != 0u) {
        const float above = dot(params.cut_plane.xyz, near) + params.cut_plane.w;
        const float rate = dot(params.cut_plane.xyz, ray.direction);
        if (rate > 0.0)
            span.end = max(min(span.end, -above / rate), span.begin);
        else if (rate < 0.0)
            span.begin = max(span.begin, min(-above / rate, span.end));
        else if (above > 0.0)
            span.end = span.begin;
    }
    return ray;
}

// Rounding may put a ray along a face one ulp outside the volume. A position below 0 still truncates to voxel 0; a
// position above the upper limit is clamped.
vec3 position_at(const RaycastParams params, const Ray ray, float s)
{
    return min(ray.origin + s * ray.direction, params.position_limit);
}
