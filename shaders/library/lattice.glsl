// The positions of samples along a ray. Needs sample.glsl.

// Maximum step number; a leap can be added to it without overflow.
const float MAX_STEPS = 2147483648.0;

// A ray's steps: whole steps of equal length, then the rest, which is a shorter and thus more transparent step.
struct Lattice {
    float begin, end;    // lengths along the ray
    uint whole;          // number of whole steps, which is also the index of the rest
    float part;          // length of the rest as a fraction of a whole step; 0: no rest
    float rest_middle;   // length along the ray
};

Lattice lattice_of(const RaycastParams params, float begin, float end)
{
    const float extent = end > begin ? end - begin : 0.0;   // 0 also for NaN
    const float steps = extent / params.step;
    const uint whole = steps > 0.0 ? uint(min(steps, MAX_STEPS)) : 0u;   // also 0 for NaN
    const float whole_end = begin + float(whole) * params.step;
    const float rest = extent - float(whole) * params.step;
    return Lattice(begin, end, whole, max(rest / params.step, 0.0), whole_end + 0.5 * rest);
}

// Number of steps including the rest.
uint step_count(const Lattice lattice)
{
    return lattice.whole + uint(lattice.part > 0.0);
}

float step_begin(const RaycastParams params, float begin, uint step)
{
    return begin + float(step) * params.step;
}

float step_middle(const RaycastParams params, float begin, uint step)
{
    return begin + (float(step) + 0.5) * params.step;
}

vec3 sample_position(const RaycastParams params, const Ray ray, float begin, uint step)
{
    return position_at(params, ray, step_middle(params, begin, step));
}

// The middle of a whole step, or of the shorter rest.
float middle_of(const RaycastParams params, const Lattice lattice, uint step)
{
    return step < lattice.whole ? step_middle(params, lattice.begin, step) : lattice.rest_middle;
}

float end_of(const RaycastParams params, const Lattice lattice, uint step)
{
    return step < lattice.whole ? step_begin(params, lattice.begin, step + 1u) : lattice.end;
}
