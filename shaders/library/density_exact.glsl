// Exact sampling of the density: trilinear values, and central differences of +-0.5 voxel, by arithmetic on 16-bit
// codes. Needs `atlas`, r32ui, with two or four neighbouring codes along x in a texel (atlas.glsl), and the counter
// `density_reads`. As one load reads several codes, this is the fastest method on devices whose images are ordinary
// memory (engine/bricks/README.md).
//
// A sample touches the eight codes around it and, for the gradient, one more row on the nearer side of each axis. All
// these codes are contiguous or within the brick's apron, so one brick lookup always suffices.
#include "atlas.glsl"

// Three neighbouring codes along x: the words that contain the first and the last code, and the shifts that extract the
// codes.
struct Row {
    int first_word, last_word;
    uvec3 shifts;
    bool middle_is_in_first;
};

struct Density {
    ivec3 corner;      // lower corner, in codes
    vec3 fraction;
    Row row;           // row that begins at the corner or one code before it
    float v[8];        // codes at the corners, x fastest
    float beyond[4];   // the next code along x, on the nearer side, in the rows (y, z) = 00, 10, 01, 11
};

Row row_from(int x)
{
    ivec3 at = x + ivec3(0, 1, 2);
#ifndef PAGED
    at = clamp(at, 0, last_along_x());
#endif
    const ivec3 word = at >> WORD_SHIFT;
    return Row(word.x, word.z, uvec3(shift_to(at.x), shift_to(at.y), shift_to(at.z)), word.y == word.x);
}

uint word_at(int x, int y, int z)
{
    if (COUNT_WORK != 0u) ++density_reads;
    return atlas_word(ivec3(x, y, z));
}

vec3 codes_of(const Row row, int y, int z)
{
    const uint a = word_at(row.first_word, y, z), b = word_at(row.last_word, y, z);
    return vec3(CODE_UNIT * (uvec3(a, row.middle_is_in_first ? a : b, b) >> row.shifts & CODE_MASK));
}

void load_row(inout Density d, int i, int y, int z)
{
    const bool below = d.fraction.x < 0.5;
    const vec3 codes = codes_of(d.row, y, z);
    d.v[2 * i] = below ? codes.y : codes.x;
    d.v[2 * i + 1] = below ? codes.z : codes.y;
    d.beyond[i] = below ? codes.x : codes.z;
}

Density density_at(ivec3 corner, vec3 fraction)
{
    Density d;
    d.corner = corner;
    d.fraction = fraction;
    d.row = row_from(corner.x - int(fraction.x < 0.5));
    load_row(d, 0, corner.y, corner.z);
    load_row(d, 1, corner.y + 1, corner.z);
    load_row(d, 2, corner.y, corner.z + 1);
    load_row(d, 3, corner.y + 1, corner.z + 1);
    return d;
}

// The codes at the corner's x and at the next x, in the row that is `y` and `z` rows away from the corner.
vec2 pair_in(const Density d, int y, int z)
{
    const vec3 codes = codes_of(d.row, y, z);
    return d.fraction.x < 0.5 ? codes.yz : codes.xy;
}

float bilinear(float a, float b, float c, float d, float x, float y)
{
    const float low = a + (b - a) * x;
    const float high = c + (d - c) * x;
    return low + (high - low) * y;
}

/// A 16-bit code, with a fraction. Between equal codes the value is exact, so thresholds are exact at voxels.
float value_of(const Density d)
{
    const float low = bilinear(d.v[0], d.v[1], d.v[2], d.v[3], d.fraction.x, d.fraction.y);
    const float high = bilinear(d.v[4], d.v[5], d.v[6], d.v[7], d.fraction.x, d.fraction.y);
    return low + (high - low) * d.fraction.z;
}

// The derivative at the fraction `f` between `low` and `high`: f(p + 0.5) - f(p - 0.5), where f interpolates three
// consecutive values and `beyond` is the next value on the nearer side.
float central(float low, float high, float beyond, float f)
{
    const float inner = high - low;
    const float outer = f < 0.5 ? low - beyond : beyond - high;
    return inner + (outer - inner) * abs(f - 0.5);
}

// Pairs of codes along x in the next row on the nearer side, along y or along z.
struct Beyond {
    vec2 y0, y1, z0, z1;
};

Beyond beyond(const Density d)
{
    const vec3 f = d.fraction;
    const ivec3 c = d.corner;
    const int y = c.y + (f.y < 0.5 ? -1 : 2), z = c.z + (f.z < 0.5 ? -1 : 2);
    return Beyond(pair_in(d, y, c.z), pair_in(d, y, c.z + 1), pair_in(d, c.y, z), pair_in(d, c.y + 1, z));
}

vec3 gradient_between(const Density d, const Beyond there)
{
    const vec3 f = d.fraction;
    const vec2 y0 = there.y0, y1 = there.y1, z0 = there.z0, z1 = there.z1;
    const float along_x = central(bilinear(d.v[0], d.v[2], d.v[4], d.v[6], f.y, f.z),
                                  bilinear(d.v[1], d.v[3], d.v[5], d.v[7], f.y, f.z),
                                  bilinear(d.beyond[0], d.beyond[1], d.beyond[2], d.beyond[3], f.y, f.z), f.x);
    const float along_y = central(bilinear(d.v[0], d.v[1], d.v[4], d.v[5], f.x, f.z),
                                  bilinear(d.v[2], d.v[3], d.v[6], d.v[7], f.x, f.z),
                                  bilinear(y0.x, y0.y, y1.x, y1.y, f.x, f.z), f.y);
    const float along_z = central(bilinear(d.v[0], d.v[1], d.v[2], d.v[3], f.x, f.y),
                                  bilinear(d.v[4], d.v[5], d.v[6], d.v[7], f.x, f.y),
                                  bilinear(z0.x, z0.y, z1.x, z1.y, f.x, f.y), f.z);
    return vec3(along_x, along_y, along_z);
}

/// The derivative of value_of(), in codes per voxel along each axis: a quarter of the arithmetic, and no code but the
/// eight corners. Inside a voxel it is that of the interpolated density; across its faces it is not continuous.
vec3 analytic_gradient_of(const Density d)
{
    const vec3 f = d.fraction;
    return vec3(bilinear(d.v[1] - d.v[0], d.v[3] - d.v[2], d.v[5] - d.v[4], d.v[7] - d.v[6], f.y, f.z),
                bilinear(d.v[2] - d.v[0], d.v[3] - d.v[1], d.v[6] - d.v[4], d.v[7] - d.v[5], f.x, f.z),
                bilinear(d.v[4] - d.v[0], d.v[5] - d.v[1], d.v[6] - d.v[2], d.v[7] - d.v[3], f.x, f.y));
}

/// The gradient, in codes per voxel along each axis. The six interpolated taps of the central difference use twelve
/// codes in addition to the eight corners.
vec3 gradient_of(const Density d)
{
    return gradient_between(d, beyond(d));
}
