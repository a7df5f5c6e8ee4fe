// Intersects a line with balls and rods. A rod is the convex hull of two balls: their common tangent cone, and a part
// of each ball. All lengths are measured from the line's point nearest to the surface, so that a far origin causes no
// cancellation (Haines and others, Precision improvements for ray/sphere intersection, Ray Tracing Gems, ch. 7).

struct Line {
    vec3 origin;
    vec3 direction;  // unit
};

// The part x ... y of a line that is inside a surface; empty if x > y, as here.
const vec2 NOTHING = vec2(1e30, -1e30);

// `center` relative to the line's origin.
vec2 ball_range(const vec3 center, const vec3 direction, float radius)
{
    const float middle = dot(center, direction);
    const vec3 nearest = center - middle * direction;
    const float half_chord_squared = radius * radius - dot(nearest, nearest);
    const float half_chord = sqrt(max(half_chord_squared, 0.0));
    return half_chord_squared < 0.0 ? NOTHING : vec2(middle - half_chord, middle + half_chord);
}

// A rod along the unit vector `axis`. At x along the axis, the tangent cone has the radius (radius_from - x * sine) /
// cosine; it ends at the circles where it touches the balls.
struct Rod {
    vec3 axis;
    float sine;
    float cosine_squared;
    float first, last;   // x of those circles
};

Rod rod_of(const Surface surface)
{
    const float axis_length = length(surface.along);
    Rod rod;
    rod.axis = surface.along / max(axis_length, 1e-30);
    rod.sine = (surface.radius_from - surface.radius_to) / max(axis_length, 1e-30);
    rod.cosine_squared = (1.0 - rod.sine) * (1.0 + rod.sine);
    rod.first = surface.radius_from * rod.sine;
    rod.last = axis_length + surface.radius_to * rod.sine;
    return rod;
}

// The line's point at `from` + shift * direction + s * direction lies on the cone if the equation below holds, where w
// and u are the parts of offset and direction perpendicular to the axis, and x and v the parts along it:
//   cosine^2 |w + s u|^2 = (radius - (x + s v) sine)^2.
// The discriminant is arranged so that only terms as small as the radii are subtracted: |w x u| / |u| is the distance
// from the axis. |w|^2 - radius^2 alone would lose a thin rod's radius in its length.
vec2 cone_range(const Rod rod, float radius, const vec3 offset, const vec3 direction)
{
    const float x = dot(offset, rod.axis), v = dot(direction, rod.axis);
    const vec3 w = offset - x * rod.axis, u = direction - v * rod.axis;
    const vec3 across = cross(w, u);
    const float here = radius - x * rod.sine;
    const float uu = dot(u, u), wu = dot(w, u), ww = dot(w, w), sine_squared = rod.sine * rod.sine;
    const float discriminant = uu * here * here - dot(across, across) + sine_squared * (ww - wu * wu) +
                               2.0 * wu * rod.sine * v * here;
    const float a = uu - sine_squared;
    const float b = rod.cosine_squared * wu + rod.sine * v * here;
    const float c = rod.cosine_squared * ww - here * here;
    const float root = sqrt(max(rod.cosine_squared * discriminant, 0.0));
    const float q = -(b + (b < 0.0 ? -root : root));
    const vec2 roots = vec2(q / (a == 0.0 ? 1.0 : a), c / (q == 0.0 ? 1.0 : q));
    const vec2 places = x + roots * v;
    const bool first = discriminant >= 0.0 && a != 0.0 && places.x >= rod.first && places.x <= rod.last;
    const bool second = discriminant >= 0.0 && q != 0.0 && places.y >= rod.first && places.y <= rod.last;
    return vec2(min(first ? roots.x : NOTHING.x, second ? roots.y : NOTHING.x),
                max(first ? roots.x : NOTHING.y, second ? roots.y : NOTHING.y));
}

// Lengths along the line where it enters and leaves a surface. `from` is relative to the line's origin. The rod is
// convex, so all points where the line meets a ball or the cone lie between these two lengths.
vec2 surface_range(const Surface surface, const vec3 from, const vec3 direction)
{
    const float shift = dot(from + 0.5 * surface.along, direction);
    const vec3 to_from = from - shift * direction;
    vec2 range = ball_range(to_from, direction, surface.radius_from);
    if (surface.along != vec3(0.0)) {
        const vec2 other = ball_range(to_from + surface.along, direction, surface.radius_to);
        const vec2 cone = cone_range(rod_of(surface), surface.radius_from, -to_from, direction);
        range = vec2(min(range.x, min(other.x, cone.x)), max(range.y, max(other.y, cone.y)));
    }
    return range.x <= range.y ? range + shift : NOTHING;
}

// The outward unit normal at a point of the surface. The point is relative to `from`.
vec3 surface_normal(const Surface surface, const vec3 point)
{
    if (surface.along == vec3(0.0)) return normalize(point);
    const Rod rod = rod_of(surface);
    const float x = dot(point, rod.axis);
    if (x <= rod.first) return normalize(point);
    if (x >= rod.last) return normalize(point - surface.along);
    return normalize(sqrt(rod.cosine_squared) * normalize(point - x * rod.axis) + rod.sine * rod.axis);
}
