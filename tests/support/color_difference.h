#pragma once
// How different two colours look: CIEDE2000, also as people with colour-vision deficiencies see them.
//
// CIEDE2000: Sharma, Wu, Dalal, "The CIEDE2000 color-difference formula", Color Research & Application 30 (2005), with
// all weights 1. L*a*b* for D65. Deficiencies: Machado, Oliveira, Fernandes, "A Physiologically-based Model for
// Simulation of Color Vision Deficiency", IEEE TVCG 15 (2009), severity 1, applied to linear light.

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <glm/glm.hpp>

namespace shvr::test {

enum class Sight { normal, protanopia, deuteranopia, tritanopia };
inline constexpr std::array SIGHTS = {Sight::normal, Sight::protanopia, Sight::deuteranopia, Sight::tritanopia};

/// Linear light of sRGB's primaries, clipped to what a screen shows.
inline glm::dvec3 seen_by(Sight sight, const glm::dvec3& linear)
{
    // Rows: red, green and blue as seen.
    constexpr double MATRICES[3][9] = {
        {0.152286, 1.052583, -0.204868, 0.114503, 0.786281, 0.099216, -0.003882, -0.048116, 1.051998},
        {0.367322, 0.860646, -0.227968, 0.280085, 0.672501, 0.047413, -0.011820, 0.042940, 0.968881},
        {1.255528, -0.076749, -0.178779, -0.078411, 0.930809, 0.147602, 0.004733, 0.691367, 0.303900}};
    if (sight == Sight::normal) return linear;
    const double(&m)[9] = MATRICES[size_t(sight) - 1];
    const glm::dvec3 seen(m[0] * linear.r + m[1] * linear.g + m[2] * linear.b,
                          m[3] * linear.r + m[4] * linear.g + m[5] * linear.b,
                          m[6] * linear.r + m[7] * linear.g + m[8] * linear.b);
    return glm::clamp(seen, glm::dvec3(0.0), glm::dvec3(1.0));
}

/// L*, a*, b* of linear light.
inline glm::dvec3 lab_of(const glm::dvec3& linear)
{
    const glm::dvec3 xyz(0.4124564 * linear.r + 0.3575761 * linear.g + 0.1804375 * linear.b,
                         0.2126729 * linear.r + 0.7151522 * linear.g + 0.0721750 * linear.b,
                         0.0193339 * linear.r + 0.1191920 * linear.g + 0.9503041 * linear.b);
    const glm::dvec3 white(0.95047, 1.0, 1.08883);
    const auto root = [](double t) { return t > 216.0 / 24389.0 ? std::cbrt(t) : (24389.0 / 27.0 * t + 16.0) / 116.0; };
    const double x = root(xyz.x / white.x), y = root(xyz.y / white.y), z = root(xyz.z / white.z);
    return {116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)};
}

inline double ciede2000(const glm::dvec3& one, const glm::dvec3& other)
{
    constexpr double DEGREE = std::numbers::pi / 180.0;
    const auto seventh = [](double c) {
        return std::sqrt(std::pow(c, 7.0) / (std::pow(c, 7.0) + std::pow(25.0, 7.0)));
    };
    const double mean_ab = 0.5 * (std::hypot(one.y, one.z) + std::hypot(other.y, other.z));
    const double stretch = 1.5 - 0.5 * seventh(mean_ab);
    const double a1 = stretch * one.y, a2 = stretch * other.y;
    const double c1 = std::hypot(a1, one.z), c2 = std::hypot(a2, other.z);
    const auto hue = [&](double a, double b) {
        if (a == 0.0 && b == 0.0) return 0.0;
        const double degrees = std::atan2(b, a) / DEGREE;
        return degrees < 0.0 ? degrees + 360.0 : degrees;
    };
    const double h1 = hue(a1, one.z), h2 = hue(a2, other.z);
    double turn = c1 * c2 == 0.0 ? 0.0 : h2 - h1;
    if (turn > 180.0) turn -= 360.0;
    if (turn < -180.0) turn += 360.0;
    double mean_h = h1 + h2;
    if (c1 * c2 != 0.0) {
        const bool is_near = std::abs(h1 - h2) <= 180.0;
        mean_h = is_near ? 0.5 * (h1 + h2) : 0.5 * (h1 + h2 + (h1 + h2 < 360.0 ? 360.0 : -360.0));
    }
    const double dl = other.x - one.x, dc = c2 - c1, dh = 2.0 * std::sqrt(c1 * c2) * std::sin(0.5 * turn * DEGREE);
    const double mean_l = 0.5 * (one.x + other.x), mean_c = 0.5 * (c1 + c2);
    const double t = 1.0 - 0.17 * std::cos((mean_h - 30.0) * DEGREE) + 0.24 * std::cos(2.0 * mean_h * DEGREE) +
                     0.32 * std::cos((3.0 * mean_h + 6.0) * DEGREE) - 0.20 * std::cos((4.0 * mean_h - 63.0) * DEGREE);
    const double off = (mean_l - 50.0) * (mean_l - 50.0);
    const double sl = 1.0 + 0.015 * off / std::sqrt(20.0 + off), sc = 1.0 + 0.045 * mean_c,
                 sh = 1.0 + 0.015 * mean_c * t;
    const double bump = (mean_h - 275.0) / 25.0;
    const double rotation = -std::sin(60.0 * std::exp(-bump * bump) * DEGREE) * 2.0 * seventh(mean_c);
    const double l = dl / sl, c = dc / sc, h = dh / sh;
    return std::sqrt(l * l + c * c + h * h + rotation * c * h);
}

}  // namespace shvr::test
