#include "engine/annotation/patterns/lattice_fit.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "engine/volume/split_mix.h"

namespace shvr {

namespace {

/// Union-find over florets, with the number of whorls from each floret to its root.
class Numbers {
public:
    explicit Numbers(size_t count) : root_(count), from_root_(count) { std::iota(root_.begin(), root_.end(), 0U); }
    std::pair<uint32_t, int> find(uint32_t floret) const
    {
        int whorls = 0;
        for (; root_[floret] != floret; floret = root_[floret]) whorls += from_root_[floret];
        return {floret, whorls};
    }
    /// Returns whether `step` agrees with the known difference of the two florets; if none is known, makes it `step`.
    bool join(uint32_t inner, uint32_t outer, int step)
    {
        const auto [a, from_a] = find(inner);
        const auto [b, from_b] = find(outer);
        if (a == b) return from_b - from_a == step;
        const bool is_a_larger = size_[a] >= size_[b];  // keeps ways to roots short
        const uint32_t to = is_a_larger ? a : b, moved = is_a_larger ? b : a;
        root_[moved] = to;
        from_root_[moved] = is_a_larger ? from_a + step - from_b : from_b - step - from_a;
        size_[to] += size_[moved];
        return true;
    }
    uint32_t largest() const { return uint32_t(std::ranges::max_element(size_) - size_.begin()); }

private:
    std::vector<uint32_t> root_;
    std::vector<int> from_root_;
    std::vector<size_t> size_ = std::vector<size_t>(root_.size(), 1);
};

/// One equation; the unknowns are the phase, the correction of the divergence, and the centre (2).
struct Equation {
    glm::dvec4 terms;
    double right;
    double whorl;
};

std::vector<Equation> equations_of(const std::vector<glm::dvec3>& places, const FloretLattice& lattice)
{
    const double part = TURN / lattice.jugacy;
    glm::dvec2 phase(0.0);
    double middle = 0.0, count = 0.0;
    const auto off = [&](size_t i) {
        const glm::dvec2 p = glm::dvec2(places[i]) - lattice.centre;
        return std::atan2(p.y, p.x) - lattice.divergence * *lattice.whorls[i];
    };
    for (size_t i = 0; i < places.size(); ++i) {
        if (!lattice.whorls[i]) continue;
        phase += glm::dvec2(std::cos(lattice.jugacy * off(i)), std::sin(lattice.jugacy * off(i)));
        middle += *lattice.whorls[i];
        count += 1.0;
    }
    const double mean = std::atan2(phase.y, phase.x) / lattice.jugacy;
    std::vector<Equation> equations;
    for (size_t i = 0; i < places.size(); ++i) {
        if (!lattice.whorls[i]) continue;
        const glm::dvec2 p = glm::dvec2(places[i]) - lattice.centre;
        const double rho = glm::length(p);
        if (!(rho > 1e-6)) continue;
        // Counting whorls from their mean makes phase and divergence nearly independent.
        equations.push_back({{rho, rho * (*lattice.whorls[i] - middle / count), -p.y / rho, p.x / rho},
                             rho * std::remainder(off(i) - mean, part),
                             double(*lattice.whorls[i])});
    }
    return equations;
}

/// Sums up the normal equations and solves them. Damping keeps the centre if the florets do not determine it.
class Normal {
public:
    void add(const Equation& equation)
    {
        matrix_ += glm::outerProduct(equation.terms, equation.terms);
        right_ += equation.right * equation.terms;
        count_ += 1.0;
    }
    glm::dvec4 solution() const
    {
        glm::dmat4 damped = matrix_;
        damped[2][2] += 1e-3 * count_;
        damped[3][3] += 1e-3 * count_;
        damped[0][0] += 1e-12 * count_;
        damped[1][1] += 1e-12 * count_;
        return glm::inverse(damped) * right_;
    }

private:
    glm::dmat4 matrix_{0.0};
    glm::dvec4 right_{0.0};
    double count_ = 0.0;
};

void bootstrap(const std::vector<Equation>& equations, FloretLattice& lattice)
{
    // Limits the cost to 2e7 equations, except above 200000 florets, since 100 rounds are the minimum.
    const size_t rounds = std::clamp<size_t>(20000000 / equations.size(), 100, 1000);
    std::vector<double> found;
    SplitMix64 random(0);
    for (size_t round = 0; round < rounds; ++round) {
        Normal normal;
        for (size_t i = 0; i < equations.size(); ++i) normal.add(equations[random.below(uint32_t(equations.size()))]);
        const double by = normal.solution().y;
        if (std::isfinite(by)) found.push_back(lattice.divergence + by);
    }
    std::ranges::sort(found);
    if (found.empty()) found.push_back(lattice.divergence);
    const auto at = [&](double share) { return found[size_t(share * double(found.size() - 1) + 0.5)]; };
    lattice.divergence_low = at(0.025);
    lattice.divergence_high = at(0.975);
}

/// Fits whorls by least squares as a polynomial in 1, rho^2 and rho^4. Returns its constant.
double fit_density(const std::vector<glm::dvec3>& places, FloretLattice& lattice)
{
    glm::dmat3 matrix(0.0);
    glm::dvec3 right(0.0);
    for (size_t i = 0; i < places.size(); ++i) {
        if (!lattice.whorls[i]) continue;
        const glm::dvec2 p = glm::dvec2(places[i]) - lattice.centre;
        const double square = glm::dot(p, p);
        const glm::dvec3 terms(1.0, square, square * square);
        matrix += glm::outerProduct(terms, terms);
        right += double(*lattice.whorls[i]) * terms;
    }
    const glm::dvec3 found = glm::inverse(matrix) * right;
    if (!(std::abs(found.y) < 1e9 && std::abs(found.z) < 1e9)) return 0.0;
    lattice.square = found.y;
    lattice.fourth = found.z;
    return found.x;
}

/// Share of florets at most 0.3 median pair lengths from their lattice points, both around the axis and outwards.
double share_in_place(const std::vector<glm::dvec3>& places, double constant, const FloretLattice& lattice)
{
    std::vector<double> lengths;
    for (const FloretPair& pair : lattice.pairs) lengths.push_back(pair.length);
    if (lengths.empty()) return 0.0;
    std::ranges::nth_element(lengths, lengths.begin() + ptrdiff_t(lengths.size() / 2));
    const double play = 0.3 * lengths[lengths.size() / 2];
    const std::vector<Equation> equations = equations_of(places, lattice);
    size_t in_place = 0;
    for (const Equation& equation : equations) {
        const double rho = equation.terms.x, square = rho * rho;
        const double whorls = constant + lattice.square * square + lattice.fourth * square * square;
        const bool is_around = std::abs(equation.right) <= play;
        in_place += is_around && std::abs(equation.whorl - whorls) <= play * std::abs(lattice.density(rho)) + 0.5;
    }
    return double(in_place) / double(places.size());
}

}  // namespace

void number_whorls(size_t florets, FloretLattice& lattice)
{
    const double part = TURN / lattice.jugacy;
    std::vector<std::pair<double, size_t>> sorted;
    for (size_t i = 0; i < lattice.pairs.size(); ++i) {
        const FloretPair& pair = lattice.pairs[i];
        if (!pair.is_in_line) continue;
        const double off = std::remainder(pair.azimuth - pair.step * lattice.divergence, part);
        sorted.emplace_back(std::abs(off) * pair.rho / pair.length, i);
    }
    std::ranges::sort(sorted);
    Numbers numbers(florets);
    double agreeing = 0.0;
    for (const auto& [error, i] : sorted) {
        FloretPair& pair = lattice.pairs[i];
        pair.is_in_line = numbers.join(pair.inner, pair.outer, pair.step);
        agreeing += pair.is_in_line;
    }
    lattice.share = lattice.pairs.empty() ? 0.0 : agreeing / double(lattice.pairs.size());
    const uint32_t largest = numbers.find(numbers.largest()).first;
    lattice.whorls.assign(florets, {});
    for (uint32_t i = 0; i < florets; ++i)
        if (const auto [root, whorls] = numbers.find(i); root == largest) lattice.whorls[i] = whorls;
}

double fit_lattice(const std::vector<glm::dvec3>& places, FloretLattice& lattice)
{
    for (int round = 0; round < 8; ++round) {
        Normal normal;
        for (const Equation& equation : equations_of(places, lattice)) normal.add(equation);
        const glm::dvec4 by = normal.solution();
        if (!(glm::length(by) < 0.2)) break;
        lattice.divergence += by.y;
        lattice.centre += glm::dvec2(by.z, by.w);
    }
    return share_in_place(places, fit_density(places, lattice), lattice);
}

void add_interval(const std::vector<glm::dvec3>& places, FloretLattice& lattice)
{
    bootstrap(equations_of(places, lattice), lattice);
}

}  // namespace shvr
