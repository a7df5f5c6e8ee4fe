#include "engine/volume/phantoms/capitulum_form.h"

#include <cmath>

#include "engine/base/error.h"
#include "engine/volume/procedural/turns.h"

namespace shvr {

namespace {

enum class Sequence { fibonacci, lucas, bijugate };

Sequence sequence_of(const PhantomSpec& spec)
{
    if (spec.phyllotaxis == "fibonacci") return Sequence::fibonacci;
    if (spec.phyllotaxis == "lucas") return Sequence::lucas;
    if (spec.phyllotaxis == "bijugate") return Sequence::bijugate;
    fail("phyllotaxis is \"", spec.phyllotaxis, "\"; expected fibonacci, lucas or bijugate");
}

}  // namespace

double divergence_turns(const PhantomSpec& spec)
{
    switch (sequence_of(spec)) {
        case Sequence::fibonacci: break;
        case Sequence::lucas: return LUCAS_TURNS;
        case Sequence::bijugate: return 0.5 * GOLDEN_TURNS;
    }
    return GOLDEN_TURNS;
}

FloretPlace floret_place(const PhantomSpec& spec, int k)
{
    constexpr double OUTERMOST = 0.95;
    const double rho = OUTERMOST * std::sqrt((double(k) + 0.5) / double(spec.florets));
    double turns = 0.0;
    switch (sequence_of(spec)) {
        case Sequence::fibonacci: turns = GOLDEN_TURNS * double(k); break;
        case Sequence::lucas: turns = LUCAS_TURNS * double(k); break;
        case Sequence::bijugate: turns = 0.5 * GOLDEN_TURNS * double(k / 2) + 0.5 * double(k % 2); break;
    }
    turns -= std::floor(turns);
    return {spec.left_handed ? 1.0 - turns : turns, rho};
}

std::vector<int> parastichy_steps(const PhantomSpec& spec)
{
    const Sequence sequence = sequence_of(spec);
    const int jugacy = sequence == Sequence::bijugate ? 2 : 1;
    std::vector<int> steps;
    for (int a = 1, b = sequence == Sequence::lucas ? 3 : 2; a * jugacy < spec.florets;) {
        steps.push_back(a * jugacy);
        const int next = a + b;
        a = b;
        b = next;
    }
    return steps;
}

}  // namespace shvr
