// The integral of light along a ray, to rounding. A ray is cut where its integrand is not smooth: at every half voxel,
// where cells, voxels and the cells of central differences end; at extrema of the density ("turns"); and at points of
// the transfer function. Between two half-voxel borders (a stretch), trilinear density is a cubic along the ray, so
// these places are found exactly. Pieces in between are integrated by Gauss's formula of order 6. A piece is at most an
// optical depth long, and is halved where the normal turns. Texels are read once for each stretch.
//
// Steps (march.glsl) limit the length of pieces. Dispatches and waiting rays divide the ray between steps, and a step
// that reaches a missing brick is repeated. With SMOOTH_BORDERS, labels are constant along a stretch.
//
// Needs what march.glsl needs, and a table with points (raycast.h). Defines take_samples().

// The part of a ray that lies inside one half of a cell and inside one step.
struct Stretch {
    float begin, extent;   // lengths along the ray
    Density density;       // of its middle
    Beyond there;
    vec3 lattice;          // position at the beginning, in the lattice of voxel centres, minus the corner
    vec3 along;            // the same at the end, minus `lattice`
    vec4 cubic;            // density at x = 0 ... 1: coefficients of 1, x, x^2, x^3
    uint group;
#ifdef OCCLUDED
    vec3 corner;           // in the lattice of voxel centres
    ivec3 to_values;
    vec3 last;
#endif
};

const float SQRT_15 = 3.87298335;
const vec3 GAUSS_AT = vec3(0.5 - 0.1 * SQRT_15, 0.5, 0.5 + 0.1 * SQRT_15);
const vec3 GAUSS_WEIGHT = vec3(5.0, 8.0, 5.0) / 18.0;
// Quadrature weights of the integrals from 0 to each node.
const mat3 GAUSS_UP_TO =
    mat3(vec3(5.0 / 36.0, 2.0 / 9.0 - SQRT_15 / 15.0, 5.0 / 36.0 - SQRT_15 / 30.0),
         vec3(5.0 / 36.0 + SQRT_15 / 24.0, 2.0 / 9.0, 5.0 / 36.0 - SQRT_15 / 24.0),
         vec3(5.0 / 36.0 + SQRT_15 / 30.0, 2.0 / 9.0 + SQRT_15 / 15.0, 5.0 / 36.0));
const float MIN_THROUGH = 6e-8;   // lower bound of 1 - opacity, for densities just below an opaque density
const float MIN_PIECE = 0.002;    // reference lengths
// A piece is halved if the normal turns by more than this, or if light or highlight begins or ends within it.
const float MIN_COSINE = 0.98;
const uint HALVINGS = 6u;
const float MIN_PART = 1e-3;      // in stretches: shorter pieces are not halved, so that each piece advances

// -ln(1 - opacity), the optical depth of a reference length.
float depth_of_opacity(float opacity)
{
    const float z = opacity / (2.0 - opacity), square = z * z;
    const float series = 2.0 * z * (1.0 + square * (1.0 / 3.0 + square * (0.2 + square * (1.0 / 7.0 + square / 9.0))));
    return opacity < 0.25 ? series : -0.693147181 * log2(max(1.0 - opacity, MIN_THROUGH));
}

float cubic_at(vec4 cubic, float x)
{
    return cubic.x + x * (cubic.y + x * (cubic.z + x * cubic.w));
}

// Where the cubic has extrema between 0 and 1, in order; 1 stands for none.
vec2 turns_of(vec4 cubic)
{
    const float a = 3.0 * cubic.w, b = 2.0 * cubic.z, c = cubic.y;
    const float square = b * b - 4.0 * a * c;
    const float q = -0.5 * (b + (b < 0.0 ? -1.0 : 1.0) * sqrt(max(square, 0.0)));
    const vec2 found = vec2(q / a, c / q);
    const bvec2 are_there = bvec2(square > 0.0 && found.x > 0.0 && found.x < 1.0,
                                  square > 0.0 && found.y > 0.0 && found.y < 1.0);   // not for NaN
    const vec2 held = vec2(are_there.x ? found.x : 1.0, are_there.y ? found.y : 1.0);
    return vec2(min(held.x, held.y), max(held.x, held.y));
}

// Where a cubic that is monotonic between `from` and `to` takes a value between its values there. Uses Newton's method,
// kept inside bounds.
float crossing_of(vec4 cubic, float value, float from, float to, bool rises)
{
    float low = from, high = to;
    float x = 0.5 * (from + to);
    [[unroll]] for (uint i = 0u; i < 12u; ++i) {
        const float beyond = (cubic_at(cubic, x) - value) * (rises ? 1.0 : -1.0);
        low = beyond < 0.0 ? x : low;
        high = beyond < 0.0 ? high : x;
        const float slope = (cubic.y + x * (2.0 * cubic.z + x * 3.0 * cubic.w)) * (rises ? 1.0 : -1.0);
        const float next = x - beyond / slope;
        x = next >= low && next <= high ? next : 0.5 * (low + high);   // not for NaN
    }
    return x;
}

vec4 point_look(const RaycastParams params, int point)
{
    return imageLoad(table, table_texel(params.points + uint(point)));
}

float point_density(const RaycastParams params, int point)
{
    return imageLoad(table, table_texel(params.points + params.point_count + uint(point))).x;
}

// A line between two successive points of the function. It is outside if `first` is -1 or the last point.
struct Line {
    int first;
    float lower, upper;   // densities
    vec4 from, to;        // looks there
    bool is_inside;
};

// The line that contains a density. At a point, the line ahead: above the point if the density rises, else below.
Line line_at(const RaycastParams params, float density, bool rises, bool is_constant)
{
    const int last = max(int(params.point_count) - 1, 0);
    int before = 0;   // number of points below (or at) the density
    for (uint bit = 1u << uint(findMSB(max(params.point_count, 1u))); bit > 0u; bit >>= 1u) {
        const int next = before + int(bit);
        const float there = point_density(params, clamp(next - 1, 0, last));
        const bool is_below = next <= int(params.point_count) && (rises ? there <= density : there < density);
        before = is_below ? next : before;
    }
    Line line;
    line.first = before - 1;
    // A density at the last point belongs to the line that ends at this point.
    if (is_constant && line.first == last && density == point_density(params, last)) line.first = last - 1;
    line.is_inside = line.first >= 0 && line.first < last;
    const int first = clamp(line.first, 0, last), second = clamp(line.first + 1, 0, last);
    line.lower = line.first >= 0 ? point_density(params, first) : -OUT_OF_REACH;
    line.upper = line.first < last ? point_density(params, second) : OUT_OF_REACH;
    line.from = point_look(params, first);
    line.to = point_look(params, second);
    return line;
}

vec4 look_on(const Line line, float density)
{
    const float width = line.upper - line.lower;
    return mix(line.from, line.to, width > 0.0 ? clamp((density - line.lower) / width, 0.0, 1.0) : 1.0);
}

vec3 slope_at(const RaycastParams params, const Stretch stretch, float x)
{
    Density there = stretch.density;
    there.fraction = stretch.lattice + x * stretch.along;
    return gradient_between(there, stretch.there) * params.inverse_spacing;
}

// Whether lighting at two gradients is so different that the piece between them must be halved.
bool turns_much(const RaycastParams params, const Ray ray, vec3 a, vec3 b)
{
    const float both = dot(a, b);
    return both * abs(both) < MIN_COSINE * MIN_COSINE * dot(a, a) * dot(b, b) ||
           dot(a, params.light) * dot(b, params.light) < 0.0 || dot(a, ray.half_way) * dot(b, ray.half_way) < 0.0;
}

vec3 shaded_at(const RaycastParams params, const Ray ray, const Stretch stretch, float x, vec3 color)
{
    if (SHADED != 0u) {
        float ambient = params.ambient;
#ifdef OCCLUDED
        ambient *= ambient_share(stretch.corner + stretch.lattice + x * stretch.along, stretch.to_values, stretch.last);
#endif
        color = shade(params, ambient, color, slope_at(params, stretch, x), ray.half_way);
    }
    if (DISTANCE_BLEND != 0u)
        color = blended(params, color, position_at(params, ray, stretch.begin + x * stretch.extent));
    return color;
}

// Light of the piece from x to x + width, on one line; in a group, both ends of `line` are the group's look.
vec4 light_of(const RaycastParams params, const Ray ray, const Stretch stretch, const Line line, float x, float width,
              float group_depth)
{
    vec3 depths;
    mat3 colors;
    [[unroll]] for (uint i = 0u; i < 3u; ++i) {
        const float at = x + width * GAUSS_AT[i];
        const vec4 look = look_on(line, cubic_at(stretch.cubic, at));
        depths[i] = stretch.group == 0u ? depth_of_opacity(look.a) : group_depth;
        colors[i] = shaded_at(params, ray, stretch, at, look.rgb);
    }
    depths *= width * stretch.extent;
    const vec3 before = depths * GAUSS_UP_TO;
    vec3 weights = GAUSS_WEIGHT * depths;
    [[unroll]] for (uint i = 0u; i < 3u; ++i) weights[i] *= exp2(-1.44269504 * min(before[i], 100.0));
    const float sum = weights.x + weights.y + weights.z;
    return vec4(colors * weights / max(sum, 1e-30), opacity_of_depth(dot(GAUSS_WEIGHT, depths)));
}

void end_at(const RaycastParams params, const Ray ray, const Stretch stretch, float x, vec3 color, inout March march)
{
    add(vec4(shaded_at(params, ray, stretch, x, color), 1.0), 0.0, march);
    march.sum.a = max(march.sum.a, 1.0);
}

// The next half-voxel border along the ray. Rounding may put a border just reached slightly ahead of or behind `s`.
float next_border(const Ray ray, float s)
{
    const vec3 at = 2.0 * (ray.origin + s * ray.direction);
    const vec3 slack = max(vec3(1e-4), 4e-7 * abs(at));
    const vec3 border = mix(ceil(at - slack) - 1.0, floor(at + slack) + 1.0, ray.ahead);
    const vec3 lengths = (0.5 * border - ray.origin) * ray.inverse;
    return max(min(lengths.x, min(lengths.y, lengths.z)), s + max(1e-6, 2.4e-7 * s));
}

Stretch stretch_of(const RaycastParams params, const Ray ray, float begin, float end, const Place place)
{
    const vec3 middle = position_at(params, ray, 0.5 * (begin + end));
    const Texels texels = texels_at(middle, place);
    Stretch stretch;
    stretch.begin = begin;
    stretch.extent = end - begin;
    stretch.density = density_at(texels.corner + texels.to_atlas, texels.fraction);
    if (SHADED != 0u) stretch.there = beyond(stretch.density);
#ifdef PAGED
    const float scale = uintBitsToFloat(127u - place.level << 23);
#else
    const float scale = 1.0;
#endif
    stretch.lattice = position_at(params, ray, begin) * scale - 0.5 - vec3(texels.corner);
    stretch.along = (position_at(params, ray, end) - position_at(params, ray, begin)) * scale;
    vec4 values;
    [[unroll]] for (uint i = 0u; i < 4u; ++i) {
        Density there = stretch.density;
        there.fraction = stretch.lattice + float(i) / 3.0 * stretch.along;
        values[i] = value_of(there);
    }
    const vec3 d = values.yzw - values.x;   // exactly 0 where the density is constant
    stretch.cubic = vec4(values.x, 9.0 * d.x - 4.5 * d.y + d.z, -22.5 * d.x + 18.0 * d.y - 4.5 * d.z,
                         13.5 * d.x - 13.5 * d.y + 4.5 * d.z);
    stretch.group = 0u;
#ifdef MASKED
    if (place.is_painted) stretch.group = group_at(params, middle);
#endif
#ifdef OCCLUDED
#ifdef PAGED
    stretch.last = vec3(to_uint(params.position_limit) >> place.level);
#else
    stretch.last = vec3(to_uint(params.position_limit));
#endif
    stretch.corner = vec3(texels.corner);
    stretch.to_values = ivec3(slot_origin(texels.slot)) - ivec3(texels.brick * BRICK_SIZE) + int(BRICK_APRON);
#endif
    return stretch;
}

// Adds the light of a stretch, piece by piece.
void add_stretch(const RaycastParams params, const Ray ray, const Stretch stretch, const Place place,
                 inout March march, inout Work work)
{
    const vec2 turns = turns_of(stretch.cubic);
    const float last = stretch.cubic.x + (stretch.cubic.y + stretch.cubic.z + stretch.cubic.w);
    float x = 0.0, value = stretch.cubic.x;
    float group_depth = 0.0;
    vec4 group_look = vec4(0.0);
#ifdef MASKED
    if (stretch.group != 0u) {
        group_look = imageLoad(groups, ivec2(stretch.group, 0));
        group_depth = imageLoad(groups, ivec2(stretch.group, 1)).x / params.step;
    }
#endif
    bool goes_on;
    do {
        const bool is_flat = all(equal(stretch.cubic.yzw, vec3(0.0)));
        const float turn = x < turns.x ? turns.x : x < turns.y ? turns.y : 1.0;
        const float value_there = turn < 1.0 ? cubic_at(stretch.cubic, turn) : last;
        const bool rises = value_there >= value;
        Line line;
        if (stretch.group == 0u) {
            line = line_at(params, value, rises, is_flat);
        } else {
            const vec4 look = vec4(group_look.rgb, group_depth >= OPAQUE_DEPTH / params.step ? 1.0 : 0.0);
            line = Line(0, -OUT_OF_REACH, OUT_OF_REACH, look, look, true);
        }
        const float ahead = rises ? line.upper : line.lower;
        const bool crosses = rises ? ahead <= value_there : ahead >= value_there;
        float next = crosses ? crossing_of(stretch.cubic, ahead, x, turn, rises) : turn;
        const vec4 from = look_on(line, value), to = look_on(line, crosses ? ahead : value_there);
        const bool is_opaque = line.is_inside && from.a >= 1.0;
        const float depth = stretch.group != 0u ? group_depth : depth_of_opacity(max(from.a, to.a));
        const bool is_seen = !is_opaque && line.is_inside && depth > 0.0;
        const float longest = max(1.0 / max(depth, 1e-10), MIN_PIECE) / max(stretch.extent, 1e-10);
        bool is_whole = !is_seen || next - x <= longest;
        next = is_whole ? next : x + longest;
        if (SHADED != 0u && is_seen) {
            const vec3 slope = slope_at(params, stretch, x);
            [[unroll]] for (uint i = 0u; i < HALVINGS; ++i) {
                const bool is_turning = next - x > MIN_PART &&
                                        turns_much(params, ray, slope, slope_at(params, stretch, next));
                next = is_turning ? 0.5 * (x + next) : next;
                is_whole = is_whole && !is_turning;
            }
        }
        if (is_opaque) end_at(params, ray, stretch, x, from.rgb, march);
        if (is_seen && next > x) add(light_of(params, ray, stretch, line, x, next - x, group_depth), 0.0, march);
        if (COUNT_WORK != 0u && (is_opaque || is_seen)) {
            note_taken(place, work);
            work.samples += is_seen ? 2u : 0u;
            work.shaded += is_seen && SHADED != 0u ? 2u : 0u;
        }
        if (!is_opaque && is_whole && crosses) {
            // If several points have the same density, the last of them applies.
            const Line met = line_at(params, ahead, true, false);
            if (met.first >= 0 && met.from.a >= 1.0) end_at(params, ray, stretch, next, met.from.rgb, march);
        }
        value = !is_whole ? cubic_at(stretch.cubic, next) : crosses ? ahead : value_there;
        x = next;
        if (COUNT_WORK != 0u) ++work.turns;
        goes_on = x < 1.0 && march.sum.a < params.opacity_limit;
    } while (goes_on);
}

// The number of whole steps, from the step beginning at `position`, inside the empty cube around the cell.
uint whole_steps_inside(const RaycastParams params, const Ray ray, vec3 position, const Place place)
{
    return place.distance > 0u ? steps_to_leave(params, ray, position, place) - 1u : 0u;
}

// Adds the light of the steps from `march.i` on, up to length `until` along the ray or to step `end_step`.
void take_samples(const RaycastParams params, const Ray ray, const Lattice lattice, uint end_step, float until,
                  inout March march, inout Work work)
{
    const uint first = march.i;
    vec4 sum = march.sum, above = march.above;   // when the step began
    float s = step_begin(params, lattice.begin, march.i);
    bool is_new = true;   // at the beginning of a step
    bool goes_on = march.i < end_step && march.sum.a < params.opacity_limit && !march.waits;
    if (goes_on) do {
        const vec3 position = position_at(params, ray, s);
        const Place here = place_at(params, position);
        const uint inside = is_new ? whole_steps_inside(params, ray, position, here) : 0u;
        const float step_end = end_of(params, lattice, march.i);
        const float end = min(next_border(ray, s), step_end);
        const Place place = place_at(params, position_at(params, ray, 0.5 * (s + end)));
        if (inside == 0u)
            note(place, work);
        else
            note(here, work);
        march.waits = march.waits || (inside == 0u && place.is_missing);
        if (inside == 0u && place.distance == 0u && !march.waits)
            add_stretch(params, ray, stretch_of(params, ray, s, end, place), place, march, work);
        march.sum = march.waits ? sum : march.sum;
        march.above = march.waits ? above : march.above;
        const bool ends_step = inside > 0u || end >= step_end;
        march.i += march.waits ? 0u : inside > 0u ? inside : uint(ends_step && march.sum.a < params.opacity_limit);
        if (COUNT_WORK != 0u) {
            ++work.turns;
            work.leaps += uint(inside > 0u);
        }
        s = ends_step ? step_begin(params, lattice.begin, march.i) : end;
        is_new = ends_step;
        sum = is_new ? march.sum : sum;
        above = is_new ? march.above : above;
        goes_on = march.i < end_step && march.sum.a < params.opacity_limit && !march.waits;
#ifdef SHELLED
        goes_on = goes_on && !(is_new && march.i != first && middle_of(params, lattice, march.i) > until);
#endif
    } while (goes_on);
}
