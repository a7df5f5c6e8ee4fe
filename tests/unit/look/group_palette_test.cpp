// The ten colours of groups, by measurement; how the measure is checked; and the search that found them (skipped:
// -ns -tc="*search*").

#include <random>
#include <vector>

#include <doctest/doctest.h>

#include "engine/look/groups.h"
#include "engine/look/session_color.h"
#include "tests/support/color_difference.h"

using namespace shvr;
using namespace shvr::test;

namespace {

constexpr size_t GROUP_COUNT = 10;

/// A colour as each kind of sight has it, in L*a*b*.
using Seen = std::array<glm::dvec3, SIGHTS.size()>;

Seen seen_of(const glm::dvec3& linear)
{
    Seen seen;
    for (size_t i = 0; i < SIGHTS.size(); ++i) seen[i] = lab_of(seen_by(SIGHTS[i], linear));
    return seen;
}

/// Difference in the type of colour vision that distinguishes them least.
double difference(const Seen& a, const Seen& b)
{
    double least = 1e9;
    for (size_t i = 0; i < SIGHTS.size(); ++i) least = std::min(least, ciede2000(a[i], b[i]));
    return least;
}

glm::dvec3 linear_of(const char* text)
{
    return glm::dvec3(color_of(text).value());
}

/// Colours around and behind groups: the default transfer function, between its points as well, and white paper.
std::vector<Seen> surroundings()
{
    const glm::dvec3 points[] = {linear_of("#5c6066"), linear_of("#e8a860"), linear_of("#fff4e0")};
    std::vector<Seen> seen{seen_of(glm::dvec3(1.0)), seen_of(points[0])};
    for (size_t segment = 0; segment < 2; ++segment)
        for (int step = 1; step <= 4; ++step)
            seen.push_back(seen_of(glm::mix(points[segment], points[segment + 1], 0.25 * step)));
    return seen;
}

/// Between one of the colours and all else.
double least_difference(const std::vector<Seen>& colors, size_t of, const std::vector<Seen>& fixed)
{
    double least = 1e9;
    for (size_t i = 0; i < colors.size(); ++i)
        if (i != of) least = std::min(least, difference(colors[i], colors[of]));
    for (const Seen& each : fixed) least = std::min(least, difference(each, colors[of]));
    return least;
}

double least_difference(const std::vector<Seen>& colors)
{
    double least = 1e9;
    for (size_t i = 0; i < colors.size(); ++i) least = std::min(least, least_difference(colors, i, surroundings()));
    return least;
}

}  // namespace

TEST_CASE("CIEDE2000 gives the published differences")
{
    // Sharma, Wu, Dalal 2005, table 1.
    struct Pair {
        glm::dvec3 one, other;
        double difference;
    };
    const Pair pairs[] = {{{50, 2.6772, -79.7751}, {50, 0, -82.7485}, 2.0425},
                          {{50, 3.1571, -77.2803}, {50, 0, -82.7485}, 2.8615},
                          {{50, 2.8361, -74.02}, {50, 0, -82.7485}, 3.4412},
                          {{50, -1.3802, -84.2814}, {50, 0, -82.7485}, 1.0},
                          {{50, 0, 0}, {50, -1, 2}, 2.3669},
                          {{50, 2.49, -0.001}, {50, -2.49, 0.0009}, 7.1792},
                          {{50, 2.49, -0.001}, {50, -2.49, 0.0011}, 7.2195},
                          {{50, -0.001, 2.49}, {50, 0.0009, -2.49}, 4.8045},
                          {{50, 2.5, 0}, {50, 0, -2.5}, 4.3065},
                          {{50, 2.5, 0}, {73, 25, -18}, 27.1492},
                          {{50, 2.5, 0}, {61, -5, 29}, 22.8977},
                          {{50, 2.5, 0}, {56, -27, -3}, 31.903},
                          {{50, 2.5, 0}, {58, 24, 15}, 19.4535},
                          {{60.2574, -34.0099, 36.2677}, {60.4626, -34.1751, 39.4387}, 1.2644},
                          {{63.0109, -31.0961, -5.8663}, {62.8187, -29.7946, -4.0864}, 1.263},
                          {{22.7233, 20.0904, -46.694}, {23.0331, 14.973, -42.5619}, 2.0373},
                          {{90.8027, -2.0831, 1.441}, {91.1528, -1.6435, 0.0447}, 1.4441},
                          {{2.0776, 0.0795, -1.135}, {0.9033, -0.0636, -0.5514}, 0.9082}};
    for (const Pair& pair : pairs) {
        CHECK(std::abs(ciede2000(pair.one, pair.other) - pair.difference) < 1e-4);
        CHECK(std::abs(ciede2000(pair.other, pair.one) - pair.difference) < 1e-4);
    }
}

TEST_CASE("Simulated sight leaves greys as they are, and makes red and green alike")
{
    for (const Sight sight : SIGHTS) {
        CHECK(glm::distance(seen_by(sight, glm::dvec3(0.4)), glm::dvec3(0.4)) < 1e-5);
        CHECK(ciede2000(lab_of(glm::dvec3(1.0)), lab_of(seen_by(sight, glm::dvec3(1.0)))) < 0.02);
    }
    const glm::dvec3 red = linear_of("#d62728"), green = linear_of("#7f7f00");
    const auto apart = [&](Sight sight) {
        return ciede2000(lab_of(seen_by(sight, red)), lab_of(seen_by(sight, green)));
    };
    CHECK(apart(Sight::deuteranopia) < 0.5 * apart(Sight::normal));
}

TEST_CASE("The colours of the first ten groups can be told apart, and from the default look, with any sight")
{
    std::vector<Seen> colors;
    for (size_t group = 1; group <= GROUP_COUNT; ++group)
        colors.push_back(seen_of(default_group(uint8_t(group)).color));
    CHECK(least_difference(colors) >= MIN_GROUP_DIFFERENCE);
    CHECK(default_group(11).color == default_group(1).color);

    // The ten earlier default colours, for comparison.
    std::vector<Seen> before;
    for (const char* color :
         {"#d62728", "#1f77b4", "#2ca02c", "#ff7f0e", "#9467bd", "#17becf", "#e377c2", "#bcbd22", "#8c564b", "#ffdd44"})
        before.push_back(seen_of(linear_of(color)));
    MESSAGE("before: ", least_difference(before), ", now: ", least_difference(colors));
    CHECK(least_difference(before) < 0.5 * least_difference(colors));
    for (const Seen& color : colors) CHECK(std::hypot(color[0].y, color[0].z) <= 60.0);  // calm: chroma in normal sight
}

TEST_CASE("The search for the colours of groups" * doctest::skip())
{
    constexpr double MIN_LIGHTNESS = 34.0, MAX_LIGHTNESS = 90.0, MIN_CHROMA = 30.0, MAX_CHROMA = 60.0;
    constexpr int STARTS = 40, TRIALS = 6000;
    const std::vector<Seen> fixed = surroundings();
    const auto coded = [](uint32_t code) {
        return linear_of(
            sentence('#', std::string(6 - std::min<size_t>(6, sentence(std::hex, code).size()), '0'), std::hex, code)
                .c_str());
    };
    double best = 0.0;
    for (uint32_t start = 1; start <= STARTS; ++start) {
        std::mt19937 random(start);
        const auto is_allowed = [&](const Seen& seen) {
            const glm::dvec3& lab = seen[0];
            const double chroma = std::hypot(lab.y, lab.z);
            return lab.x >= MIN_LIGHTNESS && lab.x <= MAX_LIGHTNESS && chroma >= MIN_CHROMA && chroma <= MAX_CHROMA;
        };
        std::vector<uint32_t> codes;
        std::vector<Seen> colors;
        while (codes.size() < GROUP_COUNT) {
            const uint32_t code = random() & 0xffffff;
            const Seen seen = seen_of(coded(code));
            if (!is_allowed(seen)) continue;
            codes.push_back(code);
            colors.push_back(seen);
        }
        for (int trial = 0; trial < TRIALS; ++trial) {
            size_t worst = random() % GROUP_COUNT;
            if (random() % 4 != 0)
                for (size_t i = 0; i < GROUP_COUNT; ++i)
                    if (least_difference(colors, i, fixed) < least_difference(colors, worst, fixed)) worst = i;
            const int reach = trial < TRIALS / 3 ? 60 : trial < 2 * TRIALS / 3 ? 20 : 6;
            uint32_t code = 0;
            for (uint32_t shift = 0; shift < 24; shift += 8) {
                const int step = int(random() % uint32_t(2 * reach + 1)) - reach;
                code |= uint32_t(std::clamp(int(codes[worst] >> shift & 255) + step, 0, 255)) << shift;
            }
            const Seen seen = seen_of(coded(code)), was = colors[worst];
            if (!is_allowed(seen)) continue;
            const double before = least_difference(colors, worst, fixed);
            colors[worst] = seen;
            if (least_difference(colors, worst, fixed) < before)
                colors[worst] = was;
            else
                codes[worst] = code;
        }
        if (const double reached = least_difference(colors); reached > best) {
            best = reached;
            std::string text;
            for (const uint32_t code : codes) text += sentence(' ', std::hex, code);
            MESSAGE(best, ':', text);
        }
    }
}
