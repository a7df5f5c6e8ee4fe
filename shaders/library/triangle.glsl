// Intersects a line with the triangles of a mesh. Corners are projected onto the plane across the line, each by itself,
// and edges are tested there with products that two triangles which share an edge evaluate to opposite values, bit for
// bit: no ray passes between them (Woop and others, Watertight ray/triangle intersection, JCGT 2013). As in
// round_cone.glsl, lengths are measured from points near the surface.

// A corner, relative to the line's origin: across the line, and along it.
struct Corner {
    vec3 across;
    float along;
};

Corner corner_at(const SurfaceParams scene, const Line line, const vec3 place)
{
    precise vec3 whole = place - scene.origin;
    precise vec3 at = whole - scene.origin_rest - line.origin;
    precise float along = at.x * line.direction.x + at.y * line.direction.y + at.z * line.direction.z;
    precise vec3 across = at - along * line.direction;
    return Corner(across, along);
}

// Twice the signed area, seen along the line, of the triangle of the line and an edge.
float edge_area(const Line line, const vec3 p, const vec3 q)
{
    precise vec3 normal = vec3(p.y * q.z - p.z * q.y, p.z * q.x - p.x * q.z, p.x * q.y - p.y * q.x);
    precise float area = normal.x * line.direction.x + normal.y * line.direction.y + normal.z * line.direction.z;
    return area;
}

// Where the line meets a triangle: `share` has the weights of its corners, whose sum is 1; `at` is the length along the
// line, or NO_SURFACE. Triangles seen from their edge are not met.
struct Met {
    float at;
    vec3 share;
};

Met met_at(const SurfaceParams scene, const Line line, const Triangle triangle)
{
    const Corner a = corner_at(scene, line, triangle.a), b = corner_at(scene, line, triangle.b);
    const Corner c = corner_at(scene, line, triangle.c);
    const vec3 areas =
        vec3(edge_area(line, b.across, c.across), edge_area(line, c.across, a.across),
             edge_area(line, a.across, b.across));
    const float sum = areas.x + areas.y + areas.z;
    const bool is_met = (all(greaterThanEqual(areas, vec3(0.0))) || all(lessThanEqual(areas, vec3(0.0)))) && sum != 0.0;
    const vec3 share = areas / (is_met ? sum : 1.0);
    return Met(is_met ? dot(share, vec3(a.along, b.along, c.along)) : NO_SURFACE, share);
}

vec3 unpacked_normal(uint packed)
{
    const vec2 at = unpackSnorm2x16(packed);
    const vec3 up = vec3(at, 1.0 - abs(at.x) - abs(at.y));
    const vec2 turned = (1.0 - abs(at.yx)) * vec2(at.x < 0.0 ? -1.0 : 1.0, at.y < 0.0 ? -1.0 : 1.0);
    return normalize(up.z < 0.0 ? vec3(turned, up.z) : up);
}

// The normal at a point of the triangle, towards the eye, interpolated between corners.
vec3 triangle_normal(const Triangle triangle, const Line line, const vec3 share)
{
    const vec3 flat_normal = cross(triangle.b - triangle.a, triangle.c - triangle.a);
    const vec3 normal = share.x * unpacked_normal(triangle.normal_a) + share.y * unpacked_normal(triangle.normal_b) +
                        share.z * unpacked_normal(triangle.normal_c);
    const bool is_back = dot(flat_normal, line.direction) > 0.0;
    return is_back ? -normal : normal;
}
