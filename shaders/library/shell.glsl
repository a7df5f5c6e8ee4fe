// Thin-shell iso-surface in the region around the probe, where the trilinear field crosses a threshold. Crossings are
// solved per cell instead of at samples, so shells thinner than a step are not missed. Along a ray the field in a cell
// is a cubic; it is split where its derivative is 0, and each piece has at most one crossing (Marmitt and others 2004,
// "Fast and accurate ray-voxel intersection techniques for iso-surface ray tracing"). Cells of 4^3 voxels whose range
// shows that the field stays on the ray's side of the threshold are skipped at once.
//
// A flag that is carried from cell to cell tells whether the ray is inside. If rounding loses a crossing at a border,
// the next cell finds the crossing at its start, so there are neither holes nor duplicates. Variables needed after the
// loop are carried through it, since lanes that leave the loop early lose all other variables.
#include "to_int.glsl"
#include "voxel_code.glsl"

// A tolerance in reference lengths. A piece of the ray shorter than the tolerance belongs to the neighbouring cell; a
// thinner shell is ignored. Far along a ray, the tolerance is at least two ulps, so that every search advances.
float hair_at(float s)
{
    const float HAIR = 1e-3, TWO_ULPS = 2.384185791015625e-7;
    return max(HAIR, s * TWO_ULPS);
}

// A cell is always searched as a whole, even if a block of the ray's steps ends in the cell, so that crossings do not
// depend on how rays are divided into blocks.
struct Shell {
    float next;       // length along the ray of the next crossing
    float from;       // length where the search continues; below 0: not begun
    float known;      // all crossings before this length are known
    float limit;      // cells from this length on are left to later dispatches
    float end;
    bool is_inside;   // at `from`
    bool waits;       // for a brick
    uint turns;       // iterations of both loops; MAX_TURNS is more than a ray with finite coordinates needs
};

// The cell of the lattice around a position, within the position's brick.
struct Cell {
    bool is_there;
    bool is_missing;  // the ray waits
    vec3 corner;      // lower corner, on the lattice of the brick's level
    ivec3 to_atlas;
    float scale;      // side of a cell, in voxels of level 0
    float exit;       // length along the ray where it leaves this cell
};

Cell cell_at(const RaycastParams params, const Ray ray, vec3 position)
{
    const Place place = place_at(params, position);
#ifdef PAGED
    if (FEEDBACK != 0u && (KEPT != KEPT_ALL || place.is_missing)) note_reached(place);
#endif
    Cell cell;
    cell.is_missing = place.is_missing;
    cell.is_there = place.slot != NO_SLOT;
#ifdef PAGED
    const uint level = place.level;
#else
    const uint level = 0u;
#endif
    cell.scale = float(1u << level);
    cell.corner = floor(position / cell.scale - 0.5);
    const uvec3 brick = to_uint(position) >> level + 5u;
#ifdef PAGED
    cell.to_atlas = place_in_slot(place.slot) - ivec3(brick * BRICK_SIZE);
#else
    cell.to_atlas = place_of_first();
#endif
    // A brick ends in the middle of a cell, and the next brick may have another level.
    const float brick_size = cell.scale * float(BRICK_SIZE);
    const vec3 of_cell = ((cell.corner + 0.5 + ray.ahead) * cell.scale - ray.origin) * ray.inverse;
    const vec3 of_brick = ((vec3(brick) + ray.ahead) * brick_size - ray.origin) * ray.inverse;
    const vec3 exits = min(of_cell, of_brick);
    cell.exit = min(exits.x, min(exits.y, exits.z));
    return cell;
}

vec3 fraction_in(const Cell cell, vec3 position)
{
    return clamp(position / cell.scale - 0.5 - cell.corner, 0.0, 1.0);
}

// The codes at a cell's corners, x fastest, loaded once for the four values that a cubic needs. Never read by a
// sampler: samplers round their weights, commonly to 8 bits, and a cubic through such values has extrema that the field
// does not have.
struct Corners {
    float v[8];
};

Corners corners_of(const Cell cell)
{
    if (COUNT_WORK != 0u) density_reads += 8u;
    const ivec3 lower = ivec3(cell.corner) + cell.to_atlas;
    Corners corners;
    for (int i = 0; i < 8; ++i)
        corners.v[i] = code_at(lower + ivec3(i & 1, i >> 1 & 1, i >> 2));
    return corners;
}

float plane_value(float a, float b, float c, float d, vec2 fraction)
{
    const float low = a + (b - a) * fraction.x;
    const float high = c + (d - c) * fraction.x;
    return low + (high - low) * fraction.y;
}

float above_threshold(const RaycastParams params, const Ray ray, const Cell cell, const Corners corners, float s)
{
    const vec3 f = fraction_in(cell, position_at(params, ray, s));
    const float v[8] = corners.v;
    const float low = plane_value(v[0], v[1], v[2], v[3], f.xy), high = plane_value(v[4], v[5], v[6], v[7], f.xy);
    return low + (high - low) * f.z - params.shell_code;
}

float cubic(vec4 c, float u)
{
    return c.x + u * (c.y + u * (c.z + u * c.w));
}

// The zeros of the cubic's derivative, ascending. Zeros outside 0 ... 1, and missing ones, become 0 or 1.
vec2 turning_points(vec4 c)
{
    const float discriminant = c.z * c.z - 3.0 * c.y * c.w;
    if (!(discriminant > 0.0)) return vec2(1.0);
    // The form of the quadratic formula without cancellation (Press and others, Numerical Recipes, 5.6).
    const float q = -(c.z + (c.z < 0.0 ? -1.0 : 1.0) * sqrt(discriminant));
    const float a = c.w != 0.0 ? q / (3.0 * c.w) : 1.0, b = q != 0.0 ? c.y / q : 1.0;
    return clamp(vec2(min(a, b), max(a, b)), 0.0, 1.0);
}

// The crossing between two points on different sides of the threshold.
float crossing(vec4 c, float low, float high, bool low_is_inside)
{
    for (int i = 0; i < 10; ++i) {
        const float middle = 0.5 * (low + high);
        const bool is_like_low = (cubic(c, middle) >= 0.0) == low_is_inside;
        low = is_like_low ? middle : low;
        high = is_like_low ? high : middle;
    }
    const float a = cubic(c, low), b = cubic(c, high);
    return mix(low, high, a != b ? clamp(a / (a - b), 0.0, 1.0) : 0.5);
}

// Advances to a cell of 4^3 voxels (leap.h) that may contain a crossing, or to the end of the searched range.
void pass_clear_cells(const RaycastParams params, const Ray ray, inout Shell shell)
{
    bool is_clear;
    do {
        ++shell.turns;
        const float hair = hair_at(shell.from);
        const vec3 position = position_at(params, ray, shell.from + hair);
#ifdef PAGED
        const Place place = place_at(params, position);
        if (FEEDBACK != 0u && (KEPT != KEPT_ALL || place.is_missing)) note_reached(place);
        const uint shift = place.level + 2u;
        const uvec3 cell = to_uint(position) >> shift, in_slot = cell & BRICK_CELLS - 1u;
        const bool has_range = !place.is_missing && place.slot != NO_SLOT;
        const uint range = imageLoad(cell_ranges, ivec3(BRICK_CELLS * unpack_slot(place.slot) + in_slot)).x;
#else
        const uint shift = 2u;
        const uvec3 cell = to_uint(position) / CELL_SIZE;
        const bool has_range = true;
        const uint range = imageLoad(cell_ranges, ivec3(cell)).x;
#endif
        const float least = float(range & 0xffffu) - GUARD_EXACT, most = float(range >> 16u) + GUARD_EXACT;
        const bool is_on_side = shell.is_inside ? least >= params.shell_code : most < params.shell_code;
        is_clear = has_range && is_on_side && shell.from < shell.limit && shell.turns < MAX_TURNS;
        const vec3 lengths = (float(1u << shift) * (vec3(cell) + ray.ahead) - ray.origin) * ray.inverse;
        const float exit = min(lengths.x, min(lengths.y, lengths.z));
        shell.from = is_clear ? min(max(exit, shell.from + 2.0 * hair), shell.end) : shell.from;
    } while (is_clear);
}

// Finds the next crossing. Sets `next` to NO_SHELL if the region or the searched range ends first.
void search_shell(const RaycastParams params, const Ray ray, inout Shell shell)
{
    shell.next = shell.waits ? shell.next : NO_SHELL;
    bool searches = shell.from < shell.limit && !shell.waits && shell.turns < MAX_TURNS;
    if (searches) do {
        ++shell.turns;
        pass_clear_cells(params, ray, shell);
        const bool goes_on = shell.from < shell.limit;
        const Cell cell = cell_at(params, ray, position_at(params, ray, shell.from + hair_at(shell.from)));
        const float to = min(max(cell.exit, shell.from + 2.0 * hair_at(shell.from)), shell.end);
        const float extent = to - shell.from;
        bool is_inside = false;
        float found = NO_SHELL;
        if (cell.is_there) {
            const Corners corners = corners_of(cell);
            const float g0 = above_threshold(params, ray, cell, corners, shell.from);
            const float g1 = above_threshold(params, ray, cell, corners, shell.from + extent / 3.0);
            const float g2 = above_threshold(params, ray, cell, corners, shell.from + extent * (2.0 / 3.0));
            const float g3 = above_threshold(params, ray, cell, corners, to);
            const vec4 c = vec4(g0, -5.5 * g0 + 9.0 * g1 - 4.5 * g2 + g3, 9.0 * g0 - 22.5 * g1 + 18.0 * g2 - 4.5 * g3,
                                -4.5 * g0 + 13.5 * g1 - 13.5 * g2 + 4.5 * g3);
            const vec2 turns = turning_points(c);
            const bool at_low = cubic(c, turns.x) >= 0.0, at_high = cubic(c, turns.y) >= 0.0;
            is_inside = g3 >= 0.0;
            const bool was = shell.is_inside;
            // Selects the first piece whose ends are on different sides; SIMD devices would otherwise search all three.
            const bool in_first = at_low != was, in_middle = !in_first && at_high != was;
            const vec2 piece = in_first    ? vec2(0.0, turns.x)
                               : in_middle ? turns
                                           : vec2(turns.y, 1.0);
            const float root = crossing(c, piece.x, piece.y, was);
            found = (g0 >= 0.0) != was                             ? 0.0
                    : in_first || in_middle || is_inside != was    ? root
                                                                   : NO_SHELL;
        } else {
            found = shell.is_inside ? 0.0 : NO_SHELL;
        }
        const bool is_found = goes_on && found != NO_SHELL && !cell.is_missing;
        const float at = shell.from + found * extent;
        shell.next = is_found ? at : shell.next;
        shell.is_inside = is_found ? !shell.is_inside : shell.is_inside;
        shell.from = !goes_on || cell.is_missing ? shell.from : is_found ? at + hair_at(at) : to;
        shell.known = shell.from;
        shell.waits = shell.waits || (goes_on && cell.is_missing);
        searches = !is_found && shell.from < shell.limit && !shell.waits && shell.turns < MAX_TURNS;
    } while (searches);
}

// The part of the ray inside the region: the probe's ball or box.
vec2 shell_range(const RaycastParams params, const Ray ray)
{
    if (SHELL == SHELL_BOX) {
        const vec3 a = (params.shell_center - params.shell_reach - ray.origin) * ray.inverse;
        const vec3 b = (params.shell_center + params.shell_reach - ray.origin) * ray.inverse;
        const vec3 low = min(a, b), high = max(a, b);
        return vec2(max(low.x, max(low.y, low.z)), min(high.x, min(high.y, high.z)));
    }
    const vec3 direction = ray.direction * params.spacing;  // of length 1
    const vec3 from_center = (ray.origin - params.shell_center) * params.spacing;
    const float middle = -dot(from_center, direction);
    // Computes from the ray's nearest point: at its origin, b^2 - c cancels (Haines and others, Ray Tracing Gems, 7).
    const vec3 nearest = from_center + middle * direction;
    const float reach = params.shell_reach.x * params.spacing.x;
    const float half_chord = sqrt(max(reach * reach - dot(nearest, nearest), 0.0));
    return middle + vec2(-half_chord, half_chord);
}

// `limit`: end of the part of the ray for this dispatch. `kept`, `is_inside`: state left by an earlier dispatch
// (raycast.h).
Shell begin_shell(const RaycastParams params, const Ray ray, const Lattice lattice, float limit, vec2 kept,
                  bool is_inside)
{
    const vec2 range = shell_range(params, ray);
    const float start = max(lattice.begin, range.x);
    Shell shell;
    shell.next = kept.x;
    shell.from = kept.y;
    shell.known = kept.y < 0.0 ? start : kept.y;
    shell.end = min(lattice.end, range.y);
    shell.limit = min(limit, shell.end);
    shell.is_inside = is_inside;
    shell.waits = false;
    shell.turns = 0u;
    if (shell.from < 0.0 && start < shell.limit) {
        const Cell cell = cell_at(params, ray, position_at(params, ray, start + hair_at(start)));
        shell.is_inside = cell.is_there && above_threshold(params, ray, cell, corners_of(cell), start) >= 0.0;
        shell.waits = cell.is_missing;
        shell.from = cell.is_missing ? -1.0 : start;
    }
    return shell;
}

// The length along the ray up to which no crossing is left to be found.
float known_until(const Shell shell)
{
    return shell.next == NO_SHELL && shell.waits ? shell.known : shell.next;
}

// Whether the ray must wait for a brick: a crossing before `s` may still be unknown, or cannot be drawn yet.
bool shell_waits(const RaycastParams params, const Shell shell, float s, vec4 sum)
{
    return shell.waits && sum.a < params.opacity_limit && known_until(shell) < s;
}

// Colour and opacity of a crossing in a cell, lit from both sides.
vec4 shell_look(const RaycastParams params, const Ray ray, const Cell cell, vec3 position)
{
    const Density density = density_at(ivec3(cell.corner) + cell.to_atlas, fraction_in(cell, position));
    const vec3 slope = gradient_of(density) * params.inverse_spacing;
    const vec3 along = ray.direction * params.spacing;
    const float square = dot(slope, slope);
    const vec3 normal = square > 0.0 ? slope * (inversesqrt(square) * (dot(slope, along) > 0.0 ? -1.0 : 1.0)) : -along;
    vec3 color = lit(params, params.ambient, params.shell_color, normal, 1.0, ray.half_way);
    if (DISTANCE_BLEND != 0u) color = blended(params, color, position);
    return vec4(color, params.shell_opacity);
}

// Whether a crossing before `s` has to be added, or the next crossing has to be searched for.
bool has_more_shells(const RaycastParams params, const Shell shell, float s, vec4 sum)
{
    const bool is_unknown = shell.next == NO_SHELL && shell.from >= 0.0 && shell.from < shell.limit;
    return (is_unknown || shell.next < s) && sum.a < params.opacity_limit && !shell.waits && shell.turns < MAX_TURNS;
}

// Adds the crossings before `s`, and finds the next crossing.
void add_shells(const RaycastParams params, const Ray ray, float s, inout Shell shell, inout vec4 sum)
{
    bool goes_on = has_more_shells(params, shell, s, sum);
    if (goes_on) do {
        ++shell.turns;
        if (shell.next != NO_SHELL) {
            const vec3 position = position_at(params, ray, shell.next);
            const Cell cell = cell_at(params, ray, position);
            shell.waits = shell.waits || cell.is_missing;
            if (!cell.is_missing) accumulate(sum, shell_look(params, ray, cell, position));
        }
        if (!shell.waits) search_shell(params, ray, shell);
        goes_on = has_more_shells(params, shell, s, sum);
    } while (goes_on);
}
