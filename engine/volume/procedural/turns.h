#pragma once
// Sine and cosine with equal bits on every machine: they use only sums and products, in a fixed order. Results of the
// standard library depend on the processor's instructions.

#include <glm/glm.hpp>

namespace shvr {

/// Divergence angles of leaves and florets, in turns. With (3 - sqrt 5) / 2, the numbers of parastichies are Fibonacci
/// numbers; with (5 - sqrt 5) / 10, they are the Lucas numbers 1, 3, 4, 7, 11.
inline constexpr double GOLDEN_TURNS = 0.38196601125010515;
inline constexpr double LUCAS_TURNS = 0.27639320225002103;

/// Returns cosine and sine of an angle in turns, with errors below 1e-15 (Taylor polynomials of degree 16 and 17 within
/// 1/8 turn; exact for multiples of 1/4 turn). Requires |turns| < 2^40.
inline glm::dvec2 direction_of(double turns)
{
    constexpr double FULL_TURN = 6.283185307179586;
    const double quarters = glm::floor(4.0 * turns + 0.5);
    const double x = (turns - 0.25 * quarters) * FULL_TURN;
    const double square = x * x;
    double cosine = 1.0, sine = 1.0;
    for (int i = 16; i >= 2; i -= 2) {
        cosine = 1.0 - cosine * square / double(i * (i - 1));
        sine = 1.0 - sine * square / double(i * (i + 1));
    }
    sine *= x;
    switch (int64_t(quarters) & 3) {
        case 0: return {cosine, sine};
        case 1: return {-sine, cosine};
        case 2: return {-cosine, -sine};
        default: return {sine, -cosine};
    }
}

}  // namespace shvr
