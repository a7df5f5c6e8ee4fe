// shvr haptics bench --sweep: compares cost and accuracy of exact integration with those of sample points.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <random>
#include <sstream>

#include "engine/base/atomic_file.h"
#include "haptics/proxy.h"
#include "tools/cli/haptics_report.h"

namespace shvr::cli {

namespace {

constexpr int32_t SIDE = 64;
constexpr int PLACES = 40;  ///< positions of the ball
constexpr int DRAWS = 12;   ///< draws of random points
constexpr double RADII[] = {6.0, 12.0, 24.0};
constexpr int COUNTS[] = {300, 1000, 3000, 10'000};

struct Row {
    std::string method;
    double radius = 0.0;        ///< voxels
    int points = 0;             ///< 0: exact
    double error = 0.0;         ///< RMS difference from `slow_mean`, relative to the ball's radius
    double microseconds = 0.0;  ///< median of all positions
};

/// Makes a slanted tube through the middle of the patch, half as wide as the ball, with 1 % noise.
void make_scene(double radius, RelevancePatch& patch)
{
    std::mt19937 random(5);
    patch.sequence = 1;
    patch.size = patch.volume_size = glm::ivec3(SIDE);
    patch.words_per_row = SIDE / 32;
    std::fill_n(patch.words.begin(), patch.word_count(), 0u);
    const glm::dvec3 along = glm::normalize(glm::dvec3(1.0, 0.31, 0.17));
    for (int32_t z = 0; z < SIDE; ++z)
        for (int32_t y = 0; y < SIDE; ++y)
            for (int32_t x = 0; x < SIDE; ++x) {
                const glm::dvec3 p = glm::dvec3(x, y, z) + 0.5 - 32.0;
                const glm::dvec3 away = p - along * glm::dot(p, along);
                if (glm::length(away) > 0.5 * radius && random() % 100 != 0) continue;
                patch.words[size_t(x / 32 + patch.words_per_row * (y + SIDE * z))] |= 1u << (x % 32);
            }
}

/// Returns the mean of the relevant part of the ball, relative to its centre: 36 lines per voxel row, with exact ends.
glm::dvec3 slow_mean(const RelevancePatch& patch, const glm::dvec3& centre, double radius)
{
    constexpr int LINES = 6;
    double volume = 0.0;
    glm::dvec3 first(0.0);
    for (int32_t z = 0; z < SIDE; ++z)
        for (int32_t y = 0; y < SIDE; ++y)
            for (int line = 0; line < LINES * LINES; ++line) {
                const double dy = y + (line % LINES + 0.5) / LINES - centre.y;
                const double dz = z + (line / LINES + 0.5) / LINES - centre.z;
                const double rest = radius * radius - dy * dy - dz * dz;
                if (rest <= 0.0) continue;
                const double half = std::sqrt(rest);
                for (int32_t x = 0; x < SIDE; ++x) {
                    const double a = std::max(x - centre.x, -half), b = std::min(x + 1.0 - centre.x, half);
                    if (a >= b || !(patch.row_word(x / 32, y, z) >> (x % 32) & 1u)) continue;
                    volume += b - a;
                    first += (b - a) * glm::dvec3(0.5 * (a + b), dy, dz);
                }
            }
    return volume > 0.0 ? first / volume : glm::dvec3(0.0);
}

std::vector<glm::dvec3> places()
{
    std::mt19937 random(6);
    const auto share = [&] { return double(random()) / 4294967296.0 - 0.5; };
    std::vector<glm::dvec3> all;
    for (int i = 0; i < PLACES; ++i) all.push_back(32.0 + 6.0 * glm::dvec3(share(), share(), share()));
    return all;
}

template <class Find>
Row measured(const std::string& method, double radius, int points, const std::vector<glm::dvec3>& truth,
             const Find& find)
{
    using Clock = std::chrono::steady_clock;
    constexpr int TIMES = 9;
    const std::vector<glm::dvec3> where = places();
    std::vector<double> times;
    double squares = 0.0;
    for (size_t i = 0; i < where.size(); ++i) {
        Proxy proxy;
        for (int time = 0; time < TIMES; ++time) {
            const Clock::time_point begin = Clock::now();
            proxy = find(where[i]);
            times.push_back(std::chrono::duration<double, std::micro>(Clock::now() - begin).count());
        }
        const glm::dvec3 off = proxy.offset - truth[i];
        squares += glm::dot(off, off);
    }
    std::ranges::nth_element(times, times.begin() + int64_t(times.size() / 2));
    return {method, radius, points, std::sqrt(squares / double(where.size())) / radius, times[times.size() / 2]};
}

std::vector<Row> sweep(LongWork& work)
{
    std::vector<Row> rows;
    const auto patch = std::make_unique<RelevancePatch>();
    for (const double radius : RADII) {
        make_scene(radius, *patch);
        std::vector<glm::dvec3> truth;
        for (const glm::dvec3& place : places()) {
            work.stop_if_asked();
            truth.push_back(slow_mean(*patch, place, radius));
        }
        rows.push_back(measured("exact", radius, 0, truth,
                                [&](const glm::dvec3& at) { return find_proxy(*patch, at, radius, ProxyLaw::mean); }));
        for (const int count : COUNTS) {
            const std::vector<glm::dvec3> even = even_points(count), random = random_points(DRAWS * count);
            rows.push_back(measured("even", radius, count, truth, [&](const glm::dvec3& at) {
                return find_sampled_proxy(*patch, at, radius, even);
            }));
            // Averages the squares of several draws, since a single draw may be better than usual by chance.
            Row all{"random", radius, count};
            for (int draw = 0; draw < DRAWS; ++draw) {
                const auto drawn = std::span(random).subspan(size_t(draw * count), size_t(count));
                const Row one = measured("random", radius, count, truth, [&](const glm::dvec3& at) {
                    return find_sampled_proxy(*patch, at, radius, drawn);
                });
                all.error += one.error * one.error / DRAWS;
                all.microseconds += one.microseconds / DRAWS;
            }
            all.error = std::sqrt(all.error);
            rows.push_back(all);
        }
    }
    return rows;
}

/// Plots error over time on logarithmic axes: a mark per row, a colour per method, a mark size per radius.
std::string plot_of(const std::vector<Row>& rows)
{
    constexpr double WIDTH = 640.0, HEIGHT = 440.0, LEFT = 70.0, BOTTOM = 60.0, TOP = 20.0, RIGHT = 150.0;
    constexpr double MIN_US = 1.0, MAX_US = 1000.0, LEAST = 1e-5, MOST = 1e-1;
    const auto share = [](double value, double least, double most) {
        return std::log(std::clamp(value, least, most) / least) / std::log(most / least);
    };
    const auto x_of = [&](double us) { return LEFT + (WIDTH - LEFT - RIGHT) * share(us, MIN_US, MAX_US); };
    const auto y_of = [&](double error) {
        return HEIGHT - BOTTOM - (HEIGHT - BOTTOM - TOP) * share(error, LEAST, MOST);
    };
    const auto color_of = [](const std::string& method) {
        return method == "exact" ? "#0072b2" : method == "even" ? "#009e73" : "#d55e00";
    };
    std::ostringstream svg;
    svg << "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"640\" height=\"440\" font-family=\"sans-serif\" "
           "font-size=\"12\">\n<rect width=\"640\" height=\"440\" fill=\"white\"/>\n";
    const auto line = [&](double x0, double y0, double x1, double y1) {
        svg << "<line x1=\"" << x0 << "\" y1=\"" << y0 << "\" x2=\"" << x1 << "\" y2=\"" << y1
            << "\" stroke=\"#cccccc\"/>\n";
    };
    const auto text = [&](double x, double y, const char* anchor, const std::string& words) {
        svg << "<text x=\"" << x << "\" y=\"" << y << "\" text-anchor=\"" << anchor << "\">" << words << "</text>\n";
    };
    for (double us = MIN_US; us <= MAX_US; us *= 10.0) {
        line(x_of(us), TOP, x_of(us), HEIGHT - BOTTOM);
        text(x_of(us), HEIGHT - BOTTOM + 18.0, "middle", std::to_string(int(std::lround(us))));
    }
    const char* const percents[] = {"0.001", "0.01", "0.1", "1", "10"};
    for (int i = 0; i < 5; ++i) {
        const double y = y_of(LEAST * std::pow(10.0, i));
        line(LEFT, y, WIDTH - RIGHT, y);
        text(LEFT - 8.0, y + 4.0, "end", percents[i]);
    }
    text(0.5 * (LEFT + WIDTH - RIGHT), HEIGHT - 18.0, "middle", "microseconds a proxy");
    svg << "<text x=\"18\" y=\"200\" text-anchor=\"middle\" transform=\"rotate(-90 18 200)\">RMS error, % of the "
           "radius</text>\n";
    for (const Row& row : rows)
        svg << "<circle cx=\"" << x_of(row.microseconds) << "\" cy=\"" << y_of(row.error) << "\" r=\""
            << 2.0 + row.radius / 6.0 << "\" fill=\"" << color_of(row.method) << "\" fill-opacity=\"0.7\"/>\n";
    // The three methods' marks for the same number of points are close together, so they share one label.
    for (const Row& row : rows)
        if (row.points > 0 && row.radius == RADII[std::size(RADII) - 1])
            text(x_of(row.microseconds) + 9.0, y_of(row.error) - 6.0, "start", std::to_string(row.points));
    const std::pair<const char*, const char*> methods[] = {
        {"exact", "exact"}, {"random", "points at random"}, {"even", "even points"}};
    double y = 60.0;
    for (const auto& [method, words] : methods) {
        svg << "<circle cx=\"510\" cy=\"" << y - 4.0 << "\" r=\"5\" fill=\"" << color_of(method) << "\"/>\n";
        text(522.0, y, "start", words);
        y += 20.0;
    }
    for (const double radius : RADII) {
        y += 20.0;
        svg << "<circle cx=\"510\" cy=\"" << y - 4.0 << "\" r=\"" << 2.0 + radius / 6.0 << "\" fill=\"#888888\"/>\n";
        text(522.0, y, "start", std::to_string(int(radius)) + " voxels");
    }
    svg << "</svg>\n";
    return svg.str();
}

}  // namespace

std::vector<std::string> sweep_proxy(const std::string& csv, const std::string& svg, LongWork& work)
{
    const std::vector<Row> rows = sweep(work);
    std::string text = "method,radius_voxels,points,error_percent_of_radius,microseconds\n";
    std::vector<std::string> sentences;
    for (const Row& row : rows) {
        char line[128];
        std::snprintf(line, sizeof(line), "%s,%g,%d,%.4f,%.2f\n", row.method.c_str(), row.radius, row.points,
                      100.0 * row.error, row.microseconds);
        text += line;
        char words[160];
        std::snprintf(words, sizeof(words), "%s%s, ball of %g voxels: error %.3f %% of the radius, %.1f us",
                      row.method.c_str(), row.points > 0 ? (", " + std::to_string(row.points) + " points").c_str() : "",
                      row.radius, 100.0 * row.error, row.microseconds);
        sentences.emplace_back(words);
    }
    write_file_atomically(csv, std::as_bytes(std::span(text)));
    if (!svg.empty()) {
        const std::string plot = plot_of(rows);
        write_file_atomically(svg, std::as_bytes(std::span(plot)));
    }
    return sentences;
}

}  // namespace shvr::cli
