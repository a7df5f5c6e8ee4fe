#include "engine/annotation/patterns/lattice.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "engine/annotation/patterns/lattice_fit.h"
#include "engine/annotation/patterns/neighbours.h"
#include "engine/base/error.h"

namespace shvr {

namespace {

constexpr size_t MIN_FLORETS = 20;
constexpr double MIN_AGREEMENT = 0.5;  ///< minimum; florets at random reach 0.05
constexpr double RIVAL_SHARE = 0.05;   ///< a lattice of another angle that agrees only this much less may be right
constexpr double PLAY = 0.2;           ///< largest error of a pair that counts as in line, relative to its length

double azimuth(const glm::dvec3& place)
{
    return std::atan2(place.y, place.x);
}

/// Returns, for each floret, the nearest neighbour further from the axis on either side, if there is one.
std::vector<FloretPair> pairs_of(const std::vector<glm::dvec3>& places)
{
    const size_t count = places.size();
    std::vector<double> rho(count), order(count);
    std::vector<uint32_t> sorted(count);
    TraceIndex index;
    for (uint32_t i = 0; i < count; ++i) {
        rho[i] = std::hypot(places[i].x, places[i].y);
        sorted[i] = i;
        index.set(i, places[i]);
    }
    std::ranges::stable_sort(sorted, {}, [&](uint32_t i) { return rho[i]; });
    for (size_t i = 0; i < count; ++i) order[sorted[i]] = double(i);
    std::vector<FloretPair> pairs;
    for (uint32_t i = 0; i < count; ++i) {
        std::optional<FloretPair> sides[2];
        for (const uint32_t j : neighbours_of(index, places, i, 14)) {
            if (order[j] <= order[i]) continue;
            const double turn = std::remainder(azimuth(places[j]) - azimuth(places[i]), TURN);
            const double length = glm::length(places[j] - places[i]);
            std::optional<FloretPair>& side = sides[turn > 0.0];
            if (turn == 0.0 || std::abs(turn) > 2.0 || (side && side->length <= length)) continue;
            side = FloretPair{i, j, turn, order[j] - order[i], length, 0.5 * (rho[i] + rho[j])};
        }
        for (const auto& side : sides)
            if (side) pairs.push_back(*side);
    }
    return pairs;
}

/// Mean azimuth and order (difference of ranks) of pairs to one side; ignores outliers, which are of another family.
std::optional<glm::dvec2> mean_vector(const std::vector<const FloretPair*>& pairs)
{
    if (pairs.size() < 5) return {};
    std::vector<double> orders;
    for (const FloretPair* pair : pairs) orders.push_back(pair->order);
    std::ranges::nth_element(orders, orders.begin() + ptrdiff_t(orders.size() / 2));
    const double median = orders[orders.size() / 2];
    glm::dvec2 sum(0.0);
    double count = 0.0;
    for (const FloretPair* pair : pairs) {
        if (pair->order < median / 1.5 || pair->order > median * 1.5) continue;
        sum += glm::dvec2(pair->azimuth, pair->order);
        count += 1.0;
    }
    return sum / count;
}

struct Estimate {
    int jugacy;
    double divergence, kept;  ///< kept: share of the lattice's florets that are present
};

/// The divergence d of a lattice with m parastichies along `a` (to the left) and n along `b`: with m' = m / g, n' = n /
/// g and integers r and s such that s m' - r n' = 1, m' d = a + r (2 pi / g) and n' d = b + s (2 pi / g).
Estimate estimate_of(int m, int n, const glm::dvec2& a, const glm::dvec2& b)
{
    const int g = std::gcd(m, n), left = m / g, right = n / g;
    int r = 0;
    while ((1 + r * right) % left != 0) ++r;
    const int s = (1 + r * right) / left;
    const double part = TURN / g;
    const double d =
        (left * (a.x + r * part) + right * (b.x + s * part)) / (double(left) * left + double(right) * right);
    return {g, d - part * std::floor(d / part), 0.5 * (a.y / m + b.y / n)};
}

/// Makes estimates from rings around the axis: in a narrow ring, the vectors to neighbours are nearly equal.
std::vector<Estimate> estimates_of(const std::vector<FloretPair>& pairs)
{
    constexpr glm::dvec2 WINDOWS[] = {{0.2, 0.45}, {0.1, 0.3}, {0.35, 0.65}, {0.03, 0.2}, {0.5, 0.8}, {0.65, 1.0}};
    std::vector<Estimate> estimates;
    std::vector<double> rhos;
    for (const FloretPair& pair : pairs) rhos.push_back(pair.rho);
    std::ranges::sort(rhos);
    for (const glm::dvec2& window : WINDOWS) {
        if (rhos.empty()) break;
        const auto at = [&](double share) {
            return rhos[std::min(size_t(share * double(rhos.size())), rhos.size() - 1)];
        };
        std::vector<const FloretPair*> left, right;
        for (const FloretPair& pair : pairs)
            if (pair.rho >= at(window.x) && pair.rho <= at(window.y))
                (pair.azimuth > 0.0 ? left : right).push_back(&pair);
        const auto a = mean_vector(left), b = mean_vector(right);
        if (!a || !b) continue;
        const double area = a->x * b->y - b->x * a->y;
        const double m = TURN * a->y / area, n = TURN * b->y / area;
        if (!(m > 0.5 && n > 0.5 && m < 1e4 && n < 1e4)) continue;
        // Disturbed florets have other neighbours, which turns the mean vectors: m and n may be off by more than one.
        for (double m_of = std::floor(m) - 1.0; m_of <= std::floor(m) + 2.0; ++m_of)
            for (double n_of = std::floor(n) - 1.0; n_of <= std::floor(n) + 2.0; ++n_of) {
                if (m_of < 1.0 || n_of < 1.0) continue;
                const Estimate estimate = estimate_of(int(m_of), int(n_of), *a, *b);
                // Outside these limits, the numbers of florets and lattice points do not match: it is another lattice.
                if (estimate.jugacy <= 12 && estimate.kept > 0.33 && estimate.kept < 1.5) estimates.push_back(estimate);
            }
    }
    return estimates;
}

/// Sets each pair's most likely step, whether the pair is in line, and the probability that it is in line by chance.
void assign_steps(const Estimate& estimate, std::vector<FloretPair>& pairs)
{
    const double part = TURN / estimate.jugacy;
    for (FloretPair& pair : pairs) {
        const double middle = pair.order / (estimate.jugacy * estimate.kept);
        const int from = std::max(1, int(0.6 * middle - 1.0)), to = int(std::min(1.4 * middle + 1.0, 1e6));
        double least = 1e300;
        pair.step = 0;
        for (int step = from; step <= to; ++step) {
            const double off = std::abs(std::remainder(pair.azimuth - step * estimate.divergence, part));
            if (off >= least) continue;
            least = off;
            pair.step = step;
        }
        pair.chance = std::min(1.0, (to - from + 1) * 2.0 * PLAY * pair.length / (pair.rho * part));
        pair.is_in_line = pair.step > 0 && least * pair.rho < PLAY * pair.length;
    }
}

/// Fits the divergence to the pairs in line by least squares, with errors proportional to the pairs' lengths.
void refine(Estimate& estimate, std::vector<FloretPair>& pairs)
{
    const double part = TURN / estimate.jugacy;
    for (int round = 0; round < 6; ++round) {
        assign_steps(estimate, pairs);
        double along = 0.0, all = 0.0;
        for (const FloretPair& pair : pairs) {
            if (!pair.is_in_line) continue;
            const double weight = pair.rho * pair.rho / (pair.length * pair.length) * pair.step;
            along += weight * std::remainder(pair.azimuth - pair.step * estimate.divergence, part);
            all += weight * pair.step;
        }
        if (!(all > 0.0)) return;
        estimate.divergence += along / all;
    }
    estimate.divergence -= part * std::floor(estimate.divergence / part);
    assign_steps(estimate, pairs);
}

/// Agreement beyond chance (as in Cohen's kappa), times the share of florets that have a number: with whorls of two,
/// half the true divergence also fits all pairs, but numbers only half of the florets.
double agreement_of(const FloretLattice& lattice)
{
    double chance = 0.0, agreeing = 0.0;
    for (const FloretPair& pair : lattice.pairs) {
        chance += pair.chance;
        agreeing += pair.is_in_line;
    }
    const auto count = double(lattice.pairs.size());
    if (!(chance < count)) return 0.0;
    const auto numbered = std::ranges::count_if(lattice.whorls, [](const auto& one) { return one.has_value(); });
    return (agreeing - chance) / (count - chance) * double(numbered) / double(lattice.whorls.size());
}

double tenths_of_degrees(double radians)
{
    return std::round(radians * 3600.0 / TURN) / 10.0;
}

}  // namespace

double FloretLattice::azimuth_of(int step) const
{
    return std::remainder(step * divergence, TURN / jugacy);
}

FoundLattice find_lattice(const std::vector<glm::dvec3>& all_places)
{
    std::vector<glm::dvec3> places = all_places;
    const auto less = [](const glm::dvec3& p, const glm::dvec3& q) {
        return std::tie(p.x, p.y, p.z) < std::tie(q.x, q.y, q.z);
    };
    std::ranges::sort(places, less);
    places.erase(std::unique(places.begin(), places.end()), places.end());
    if (places.size() < MIN_FLORETS)
        return {.reason = sentence("there are ", places.size(), " florets; expected ", MIN_FLORETS, " or more")};
    std::vector<FloretPair> pairs = pairs_of(places);
    FloretLattice lattice;
    double most = -1.0;
    std::vector<std::pair<double, Estimate>> tries;  // with their scores
    for (Estimate estimate : estimates_of(pairs)) {
        refine(estimate, pairs);
        FloretLattice tried{.jugacy = estimate.jugacy, .divergence = estimate.divergence, .pairs = pairs};
        number_whorls(places.size(), tried);
        const double in_place = fit_lattice(places, tried);
        const double score = agreement_of(tried) * in_place - 0.03 * (tried.jugacy - 1);
        tries.push_back({score, {tried.jugacy, tried.divergence, estimate.kept}});
        if (score <= most) continue;
        most = score;
        lattice = std::move(tried);
    }
    if (lattice.pairs.empty()) return {.reason = "the florets have no neighbours on two sides in a lattice"};
    if (!(most >= MIN_AGREEMENT))
        return {.reason = sentence("the florets are in no regular lattice: ", int(100.0 * std::max(0.0, most)),
                                   " % of neighbours agree with the best, beyond chance; expected ",
                                   int(100.0 * MIN_AGREEMENT), " % or more")};
    for (const auto& [score, estimate] : tries) {
        if (score < most - RIVAL_SHARE) continue;
        const double off = std::abs(std::remainder(estimate.divergence - lattice.divergence, TURN / lattice.jugacy));
        if (estimate.jugacy != lattice.jugacy || off > 0.01)
            return {.reason = sentence("the florets fit lattices of ", tenths_of_degrees(lattice.divergence),
                                       " and of ", tenths_of_degrees(estimate.divergence), " degrees equally well")};
    }
    add_interval(places, lattice);
    return {.lattice = std::move(lattice)};
}

std::optional<Parastichies> parastichies_at(const FloretLattice& lattice, double rho, double stretch)
{
    const double density = lattice.density(rho);
    if (!(density > 0.0) || !(rho > 0.0)) return {};
    Parastichies found{0, 0};
    double left = 1e300, right = 1e300;
    for (int step = 1; step * stretch / density < std::max(left, right) && step < 100000; ++step) {
        const double around = lattice.azimuth_of(step), length = std::hypot(rho * around, step * stretch / density);
        double& least = around > 0.0 ? left : right;
        if (length >= least) continue;
        least = length;
        (around > 0.0 ? found.left : found.right) = step;
    }
    if (found.left == 0 || found.right == 0) return {};
    return found;
}

}  // namespace shvr
