// Phyllotaxis of florets, and alignment of adaxial veins with their parastichies (thesis 5.2).

#include <algorithm>
#include <array>
#include <numbers>

#include "engine/annotation/patterns/head.h"
#include "engine/annotation/patterns/lattice.h"
#include "engine/base/error.h"

namespace shvr {

namespace {

/// Across a wider gap parastichies cannot be counted: lattices with one more or one less fit as well.
constexpr double WIDEST_GAP = 45.0;
/// Least share of neighbours along two families that are called visible. Rims of a few rows have 0.18 to 0.36, since
/// nothing tells how the receptacle slopes there; complete heads have 0.69 and more.
constexpr double MIN_VISIBLE_SHARE = 0.5;
constexpr std::pair<double, const char*> RHOS[] = {{0.3, "0.3"}, {0.5, "0.5"}, {0.7, "0.7"}, {0.9, "0.9"}};

/// Length along the receptacle's surface per unit of distance from the axis.
double stretch_at(const Head& head, double rho)
{
    return head.receptacle ? std::hypot(1.0, head.receptacle->slope(rho)) : 1.0;
}

void add_divergence(const Head& head, const FloretLattice& lattice, PatternRows& rows)
{
    // For clockwise spirals, the angle is 2 pi / jugacy minus the divergence.
    const double part = TURN / lattice.jugacy;
    const bool is_counterclockwise = lattice.divergence <= 0.5 * part;
    const auto angle = [&](double radians) { return DEGREES * (is_counterclockwise ? radians : part - radians); };
    const double low = angle(lattice.divergence_low), high = angle(lattice.divergence_high);
    rows.add("divergence_angle", angle(lattice.divergence));
    rows.add("divergence_angle_low", std::min(low, high));
    rows.add("divergence_angle_high", std::max(low, high));
    if (head.frame.knows_up)
        rows.add("handedness", is_counterclockwise ? 1.0 : -1.0);
    else
        rows.miss("handedness", "nothing in the trace tells above from below");
    rows.add("jugacy", lattice.jugacy);
    rows.add("lattice_share", lattice.share);
    rows.add("floret_centre_offset", glm::length(lattice.centre));
}

void add_parastichies(const Head& head, const FloretLattice& lattice, const glm::dvec2& range, PatternRows& rows)
{
    for (const auto& [rho, name] : RHOS) {
        const auto row = [&, name = name](const char* measure) { return sentence(measure, "_rho_", name); };
        const auto found =
            rho >= range.x && rho <= range.y ? parastichies_at(lattice, rho, stretch_at(head, rho)) : std::nullopt;
        if (!found) {
            rows.miss("parastichies_M_rho_R", row("parastichies_M"), "no florets of the lattice are there");
            continue;
        }
        double all = 0.0, along = 0.0;
        for (const FloretPair& pair : lattice.pairs) {
            if (std::abs(pair.rho - rho) > 0.1) continue;
            all += 1.0;
            along += pair.is_in_line && (pair.step == found->left || pair.step == found->right);
        }
        const auto [least, most] = std::minmax(found->left, found->right);
        if (all > 0.0 && along < MIN_VISIBLE_SHARE * all) {
            rows.miss("parastichies_M_rho_R", row("parastichies_M"),
                      sentence("only ", int(100.0 * along / all),
                               " % of neighbours lie along the shortest families of "
                               "the lattice, ",
                               least * lattice.jugacy, " and ", most * lattice.jugacy, "; expected ",
                               int(100.0 * MIN_VISIBLE_SHARE), " % or more, as where florets cover more than the rim"));
            continue;
        }
        rows.add("parastichies_M_rho_R", row("parastichies_M"), double(least) * lattice.jugacy);
        rows.add("parastichies_N_rho_R", row("parastichies_N"), double(most) * lattice.jugacy);
        if (all > 0.0) rows.add("parastichies_share_rho_R", row("parastichies_share"), along / all);
    }
}

void add_alignment(const Head& head, const FloretLattice& lattice, const glm::dvec2& range, PatternRows& rows)
{
    double aligned = 0.0, all = 0.0;
    bool has_veins = false;
    for (const VeinLink& vein : head.graph.links()) {
        if (!vein.is_vein_of(HeadPart::adaxial)) continue;
        has_veins = true;
        const glm::dvec3 middle = head.middle(vein), way = head.places[vein.b] - head.places[vein.a];
        const double rho = std::hypot(middle.x, middle.y);
        if (rho < range.x || rho > range.y || !(rho > 0.0)) continue;
        const double stretch = stretch_at(head, rho), density = lattice.density(rho);
        const auto found = parastichies_at(lattice, rho, stretch);
        if (!found) continue;
        const double slope = head.receptacle ? head.receptacle->slope(rho) : 0.0;
        const double radial = (way.x * middle.x + way.y * middle.y) / rho;
        const glm::dvec2 course((way.y * middle.x - way.x * middle.y) / rho, (radial + way.z * slope) / stretch);
        double most = 0.0;
        for (const int step : {found->left, found->right}) {
            const glm::dvec2 spiral(rho * lattice.azimuth_of(step), step * stretch / density);
            most = std::max(most, std::abs(glm::dot(course, spiral)) / glm::length(spiral));
        }
        aligned += most;
        all += glm::length(course);
    }
    if (all > 0.0)
        rows.add("parastichy_alignment", aligned / all);
    else
        rows.miss("parastichy_alignment",
                  has_veins ? "no adaxial vein lies below the florets" : "the trace has no adaxial veins");
}

/// The widest gap of azimuth between florets, in degrees, except near the axis.
double gap_of(const Head& head)
{
    std::vector<double> azimuths;
    for (const uint32_t floret : head.florets)
        if (head.rho(floret) > 0.3)
            azimuths.push_back(DEGREES * std::atan2(head.places[floret].y, head.places[floret].x));
    if (azimuths.empty()) return 360.0;
    std::ranges::sort(azimuths);
    double widest = azimuths.front() + 360.0 - azimuths.back();
    for (size_t i = 1; i < azimuths.size(); ++i) widest = std::max(widest, azimuths[i] - azimuths[i - 1]);
    return widest;
}

}  // namespace

void measure_phyllotaxis(const Head& head, PatternRows& rows)
{
    std::vector<glm::dvec3> places;
    for (const uint32_t floret : head.florets) places.push_back(head.places[floret]);
    FoundLattice found = find_lattice(places);
    if (found.lattice && gap_of(head) > WIDEST_GAP)
        found = {.reason = sentence("the florets leave a gap of ", int(gap_of(head)),
                                    " degrees around the axis, so parastichies cannot be counted around the head; "
                                    "expected ",
                                    int(WIDEST_GAP), " degrees at most")};
    if (!found.lattice) {
        for (const char* measure : {"divergence_angle", "handedness", "jugacy", "parastichy_alignment"})
            rows.miss(measure, found.reason);
        return;
    }
    glm::dvec2 range(2.0, 0.0);
    for (const uint32_t floret : head.florets)
        range = {std::min(range.x, head.rho(floret)), std::max(range.y, head.rho(floret))};
    add_divergence(head, *found.lattice, rows);
    add_parastichies(head, *found.lattice, range, rows);
    add_alignment(head, *found.lattice, range, rows);
}

}  // namespace shvr
