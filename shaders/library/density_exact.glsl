// Exact sampling of the density: trilinear values, and central differences of +-0.5 voxel, by arithmetic on 16-bit
// codes. Needs `atlas`, r32ui: two neighbouring codes along x per texel, the lower one in the low half; and
// `density_reads`, which counts. One load in place of two makes this the fastest way on devices whose images are
// ordinary memory (DECISIONS.md).
//
// A sample touches the eight codes around it and, for the gradient, one more row on the nearer side of each axis. All
// lie within the brick's apron, so no second lookup is ever needed.
#include "atlas.glsl"

struct Density {
    ivec3 corner;      // lower corner, in codes
    vec3 fraction;
    float v[8];        // codes at the corners, x fastest
    float beyond[4];   // the next code along x on the nearer side, in the rows (y, z) = 00, 10, 01, 11
};

uint pair_at(int x, int y, int z)
{
    if (COUNT_WORK != 0u) ++density_reads;
    return atlas_pair(ivec3(x, y, z));
}

float lower_of(uint pair)
{
    return float(pair & 0xffffu);
}

float upper_of(uint pair)
{
    return float(pair >> 16);
}

// Two neighbouring pairs hold the corners x, x + 1 and the code beyond:
//   x odd           (x-1, x) (x+1, x+2)
//   x even, below   (x-2, x-1) (x, x+1)
//   x even, above   (x, x+1) (x+2, x+3)
void load_row(inout Density d, int row, int first_pair, int y, int z, bool odd, bool below)
{
    const uint a = pair_at(first_pair, y, z), b = pair_at(first_pair + 1, y, z);
    d.v[2 * row] = odd ? upper_of(a) : below ? lower_of(b) : lower_of(a);
    d.v[2 * row + 1] = odd ? lower_of(b) : below ? upper_of(b) : upper_of(a);
    d.beyond[row] = below ? (odd ? lower_of(a) : upper_of(a)) : (odd ? upper_of(b) : lower_of(b));
}

Density density_at(ivec3 corner, vec3 fraction)
{
    Density d;
    d.corner = corner;
    d.fraction = fraction;
    const bool odd = (corner.x & 1) != 0;
    const bool below = fraction.x < 0.5;
    const int first_pair = (corner.x >> 1) - int(!odd && below);
    load_row(d, 0, first_pair, corner.y, corner.z, odd, below);
    load_row(d, 1, first_pair, corner.y + 1, corner.z, odd, below);
    load_row(d, 2, first_pair, corner.y, corner.z + 1, odd, below);
    load_row(d, 3, first_pair, corner.y + 1, corner.z + 1, odd, below);
    return d;
}

// The codes at x and x + 1.
vec2 codes_at(int x, int y, int z)
{
    const uint a = pair_at(x >> 1, y, z), b = pair_at((x + 1) >> 1, y, z);
    return (x & 1) != 0 ? vec2(upper_of(a), lower_of(b)) : vec2(lower_of(a), upper_of(a));
}

float bilinear(float a, float b, float c, float d, float x, float y)
{
    const float low = a + (b - a) * x;
    const float high = c + (d - c) * x;
    return low + (high - low) * y;
}

/// A 16-bit code, with a fraction. Between equal codes it is exactly that code, so thresholds hold at voxels.
float value_of(const Density d)
{
    const float low = bilinear(d.v[0], d.v[1], d.v[2], d.v[3], d.fraction.x, d.fraction.y);
    const float high = bilinear(d.v[4], d.v[5], d.v[6], d.v[7], d.fraction.x, d.fraction.y);
    return low + (high - low) * d.fraction.z;
}

// The derivative for three values in a row, `f` between the first two: f(p + 0.5) - f(p - 0.5) of their interpolant.
float central(float low, float high, float beyond, float f)
{
    const float inner = high - low;
    const float outer = f < 0.5 ? low - beyond : beyond - high;
    return inner + (outer - inner) * abs(f - 0.5);
}

/// Codes per voxel along each axis. The six taps of a central difference share all but twelve codes with the eight
/// corners.
vec3 gradient_of(const Density d)
{
    const vec3 f = d.fraction;
    const ivec3 c = d.corner;
    const int y = c.y + (f.y < 0.5 ? -1 : 2), z = c.z + (f.z < 0.5 ? -1 : 2);
    const vec2 y0 = codes_at(c.x, y, c.z), y1 = codes_at(c.x, y, c.z + 1);
    const vec2 z0 = codes_at(c.x, c.y, z), z1 = codes_at(c.x, c.y + 1, z);
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
