#include "tests/reference/quadrature.h"

#include <array>
#include <cmath>
#include <numbers>

namespace shvr::reference {

namespace {

constexpr size_t NODES = 8;

// Nodes and weights on [0, 1]; partial[i][j] weighs value j in the integral from 0 to node i of the polynomial through
// all eight values, so one set of samples yields the transparency at each of them.
struct GaussRule {
    std::array<double, NODES> node{}, weight{};
    std::array<std::array<double, NODES>, NODES> partial{};
};

using Legendre = std::array<double, NODES + 1>;

Legendre legendre(double x)
{
    Legendre p{1.0, x};
    for (size_t k = 1; k < NODES; ++k) {
        const double n = double(k);
        p[k + 1] = ((2.0 * n + 1.0) * x * p[k] - n * p[k - 1]) / (n + 1.0);
    }
    return p;
}

GaussRule make_rule()
{
    GaussRule rule;
    std::array<Legendre, NODES> p{};
    const double n = double(NODES);
    for (size_t i = 0; i < NODES; ++i) {
        double x = -std::cos(std::numbers::pi * (double(i) + 0.75) / (n + 0.5));
        double slope = 1.0;
        for (int newton = 0; newton < 10; ++newton) {
            p[i] = legendre(x);
            slope = n * (x * p[i][NODES] - p[i][NODES - 1]) / (x * x - 1.0);
            x -= p[i][NODES] / slope;
        }
        rule.node[i] = 0.5 * (x + 1.0);
        rule.weight[i] = 1.0 / ((1.0 - x * x) * slope * slope);
    }
    // The Lagrange polynomials in Legendre form; the integral of P_k is (P_{k+1} - P_{k-1}) / (2 k + 1).
    for (size_t i = 0; i < NODES; ++i) {
        for (size_t j = 0; j < NODES; ++j) {
            double sum = 2.0 * rule.node[i];
            for (size_t k = 1; k < NODES; ++k) sum += p[j][k] * (p[i][k + 1] - p[i][k - 1]);
            rule.partial[i][j] = 0.5 * rule.weight[j] * sum;
        }
    }
    return rule;
}

struct Estimate {
    Stretch stretch;
    unsigned formula = 0;  ///< formula of the first node
    bool is_one_formula = true;
};

Estimate one_rule(const std::function<Medium(double)>& medium, double lower, double upper)
{
    static const GaussRule rule = make_rule();
    const double width = upper - lower;
    std::array<Medium, NODES> samples;
    for (size_t i = 0; i < NODES; ++i) samples[i] = medium(lower + width * rule.node[i]);
    Estimate estimate{.stretch = {}, .formula = samples[0].formula};
    for (size_t i = 0; i < NODES; ++i) {
        double depth = 0.0;
        for (size_t j = 0; j < NODES; ++j) depth += rule.partial[i][j] * samples[j].extinction;
        const double mass = width * rule.weight[i] * samples[i].extinction;
        estimate.stretch.depth += mass;
        estimate.stretch.light += samples[i].color * (mass * std::exp(-width * depth));
        estimate.is_one_formula = estimate.is_one_formula && samples[i].formula == estimate.formula;
    }
    return estimate;
}

bool agree(const Stretch& a, const Stretch& b, double tolerance)
{
    const glm::dvec3 light = glm::abs(a.light - b.light);
    return std::abs(a.depth - b.depth) <= tolerance && light.x <= tolerance && light.y <= tolerance &&
           light.z <= tolerance;
}

struct Ends {
    double lower = 0.0, upper = 0.0;
    unsigned lower_formula = 0, upper_formula = 0;
};

struct Halving {
    const std::function<Medium(double)>& medium;
    double tolerance;

    Stretch refine(const Ends& ends, const Estimate& whole, int levels_left) const
    {
        const double middle = 0.5 * (ends.lower + ends.upper);
        const Estimate front = one_rule(medium, ends.lower, middle), back = one_rule(medium, middle, ends.upper);
        const Stretch both = joined(front.stretch, back.stretch);
        const bool is_smooth = front.is_one_formula && back.is_one_formula && front.formula == back.formula &&
                               front.formula == ends.lower_formula && front.formula == ends.upper_formula;
        const bool is_fine = whole.stretch.depth <= 0.5 && agree(whole.stretch, both, tolerance) &&
                             (is_smooth || ends.upper - ends.lower < 1e-7);
        if (is_fine || levels_left == 0) return both;
        const unsigned formula = medium(middle).formula;
        return joined(refine({ends.lower, middle, ends.lower_formula, formula}, front, levels_left - 1),
                      refine({middle, ends.upper, formula, ends.upper_formula}, back, levels_left - 1));
    }
};

}  // namespace

Stretch joined(const Stretch& front, const Stretch& back)
{
    return {front.depth + back.depth, front.light + std::exp(-front.depth) * back.light};
}

Stretch integrate(const std::function<Medium(double)>& medium, double lower, double upper, double tolerance)
{
    const Ends ends{lower, upper, medium(lower).formula, medium(upper).formula};
    return Halving{medium, tolerance}.refine(ends, one_rule(medium, lower, upper), 48);
}

}  // namespace shvr::reference
