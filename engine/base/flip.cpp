#include "engine/base/flip.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <glm/glm.hpp>

#include "engine/base/error.h"
#include "engine/base/plane.h"

// The short names of constants are those used in the paper (see flip.h).

namespace shvr {
namespace {

using Planes = std::array<Plane, 3>;

// ---- Colour spaces --------------------------------------------------------------------------------------------------

/// Linear sRGB to CIE XYZ, from the chromaticities of the primaries and of D65.
glm::dmat3 make_rgb_to_xyz()
{
    const auto xyz_of = [](double x, double y) { return glm::dvec3(x / y, 1.0, (1.0 - x - y) / y); };
    const glm::dmat3 primaries(xyz_of(0.64, 0.33), xyz_of(0.30, 0.60), xyz_of(0.15, 0.06));
    const glm::dvec3 shares = glm::inverse(primaries) * xyz_of(0.3127, 0.3290);
    return {primaries[0] * shares[0], primaries[1] * shares[1], primaries[2] * shares[2]};
}

const glm::dmat3 RGB_TO_XYZ = make_rgb_to_xyz();
const glm::dmat3 XYZ_TO_RGB = glm::inverse(RGB_TO_XYZ);
const glm::dvec3 WHITE = RGB_TO_XYZ * glm::dvec3(1.0);

/// Converts to the linear opponent colour space in which contrast sensitivity was measured.
glm::dvec3 ycxcz_of_rgb(const glm::dvec3& rgb)
{
    const glm::dvec3 xyz = RGB_TO_XYZ * rgb / WHITE;
    return {116.0 * xyz.y - 16.0, 500.0 * (xyz.x - xyz.y), 200.0 * (xyz.y - xyz.z)};
}

glm::dvec3 rgb_of_ycxcz(const glm::dvec3& color)
{
    const double y = (color.x + 16.0) / 116.0;
    return XYZ_TO_RGB * (glm::dvec3(y + color.y / 500.0, y, y - color.z / 200.0) * WHITE);
}

/// Converts to CIELab, and scales a and b by the lightness, since colours look more vivid when lighter (Hunt effect).
glm::dvec3 hunt_lab_of_rgb(const glm::dvec3& rgb)
{
    const auto curve = [](double t) {
        constexpr double DELTA = 6.0 / 29.0;
        return t > DELTA * DELTA * DELTA ? std::cbrt(t) : t / (3.0 * DELTA * DELTA) + 4.0 / 29.0;
    };
    const glm::dvec3 xyz = RGB_TO_XYZ * rgb / WHITE;
    const double fy = curve(xyz.y), lightness = 116.0 * fy - 16.0;
    const double a = 500.0 * (curve(xyz.x) - fy), b = 200.0 * (fy - curve(xyz.z));
    return {lightness, 0.01 * lightness * a, 0.01 * lightness * b};
}

Planes ycxcz_planes(const Image8& image)
{
    std::array<double, 256> decoded{};
    for (size_t level = 0; level < decoded.size(); ++level) {
        decoded[level] = srgb_decode(double(level) / 255.0);
    }
    const Plane empty(image.width, image.height);
    Planes planes{empty, empty, empty};
    for (size_t pixel = 0; pixel < empty.values.size(); ++pixel) {
        const uint8_t* const rgba = image.rgba.data() + 4 * pixel;
        const glm::dvec3 color = ycxcz_of_rgb({decoded[rgba[0]], decoded[rgba[1]], decoded[rgba[2]]});
        for (int channel = 0; channel < 3; ++channel) {
            planes[size_t(channel)].values[pixel] = color[channel];
        }
    }
    return planes;
}

// ---- Colour difference ----------------------------------------------------------------------------------------------

/// The eye's contrast sensitivity in one channel, as a sum of Gaussians a sqrt(pi/b) exp(-pi^2 d^2 / b) of the distance
/// d in degrees.
struct Sensitivity {
    double a1, b1, a2, b2;
};
constexpr Sensitivity ACHROMATIC{1.0, 0.0047, 0.0, 1e-5};
constexpr Sensitivity RED_GREEN{1.0, 0.0053, 0.0, 1e-5};
constexpr Sensitivity BLUE_YELLOW{34.1, 0.04, 13.5, 0.025};

/// Blurs with a sum of Gaussians, normalised so that all weights in the plane add up to 1. Each Gaussian is separable.
Plane blurred_as_seen(const Plane& plane, const Sensitivity& sensitivity, double pixels_per_degree,
                      FilterProgress& progress)
{
    const auto sigma_of = [&](double b) { return std::sqrt(b / 2.0) / std::numbers::pi * pixels_per_degree; };
    // One radius for all channels: 3 sigma of the widest Gaussian.
    const int radius = int(std::ceil(3.0 * sigma_of(BLUE_YELLOW.b1)));
    const auto weights1 = gaussian_weights(sigma_of(sensitivity.b1), radius);
    Plane result = filtered(plane, weights1, weights1, progress);
    if (sensitivity.a2 == 0.0) return result;
    const auto weights2 = gaussian_weights(sigma_of(sensitivity.b2), radius);
    const Plane second = filtered(plane, weights2, weights2, progress);
    // In a 1D kernel normalised to a sum of 1, the middle weight is 1 / the unscaled kernel's sum; squared for 2D.
    const auto volume_of = [&](double a, double b, const std::vector<double>& weights) {
        const double middle = weights[size_t(radius)];
        return a * std::sqrt(std::numbers::pi / b) / (middle * middle);
    };
    const double volume1 = volume_of(sensitivity.a1, sensitivity.b1, weights1);
    const double volume2 = volume_of(sensitivity.a2, sensitivity.b2, weights2);
    for (size_t pixel = 0; pixel < result.values.size(); ++pixel) {
        result.values[pixel] = (volume1 * result.values[pixel] + volume2 * second.values[pixel]) / (volume1 + volume2);
    }
    return result;
}

Planes seen(const Planes& ycxcz, double pixels_per_degree, FilterProgress& progress)
{
    return {blurred_as_seen(ycxcz[0], ACHROMATIC, pixels_per_degree, progress),
            blurred_as_seen(ycxcz[1], RED_GREEN, pixels_per_degree, progress),
            blurred_as_seen(ycxcz[2], BLUE_YELLOW, pixels_per_degree, progress)};
}

glm::dvec3 hunt_lab_at(const Planes& ycxcz, size_t pixel)
{
    const glm::dvec3 color(ycxcz[0].values[pixel], ycxcz[1].values[pixel], ycxcz[2].values[pixel]);
    return hunt_lab_of_rgb(glm::clamp(rgb_of_ycxcz(color), 0.0, 1.0));
}

/// Returns the HyAB distance of two colours, compressed: large distances grow less than proportionally.
double color_distance(const glm::dvec3& a, const glm::dvec3& b)
{
    constexpr double QC = 0.7;
    return std::pow(std::abs(a.x - b.x) + std::hypot(a.y - b.y, a.z - b.z), QC);
}

/// Maps 0..largest to 0..1: distances below PC * largest to 0..PT, the others to PT..1.
double remapped(double distance, double largest)
{
    constexpr double PC = 0.4, PT = 0.95;
    const double knee = PC * largest;
    return distance < knee ? PT / knee * distance : PT + (distance - knee) / (largest - knee) * (1.0 - PT);
}

// ---- Feature difference ---------------------------------------------------------------------------------------------

/// Strength of edges and of points (thin lines, dots) in the unblurred brightness.
struct Features {
    Plane edges, points;
};

/// Scales positive weights to a sum of 1 and negative ones to a sum of -1.
void balance(std::vector<double>& weights)
{
    double above = 0.0, below = 0.0;
    for (const double weight : weights) (weight > 0.0 ? above : below) += std::abs(weight);
    for (double& weight : weights) weight /= weight > 0.0 ? above : below;
}

/// Magnitude of the gradient from two filters: `derivative` along x with `smooth` along y, and vice versa.
Plane magnitude(const Plane& plane, const std::vector<double>& derivative, const std::vector<double>& smooth,
                FilterProgress& progress)
{
    Plane result = filtered(plane, derivative, smooth, progress);
    const Plane vertical = filtered(plane, smooth, derivative, progress);
    for (size_t pixel = 0; pixel < result.values.size(); ++pixel) {
        result.values[pixel] = std::hypot(result.values[pixel], vertical.values[pixel]);
    }
    return result;
}

Features features_of(Plane brightness, double pixels_per_degree, FilterProgress& progress)
{
    constexpr double WIDTH_DEGREES = 0.082;
    const double sigma = 0.5 * WIDTH_DEGREES * pixels_per_degree;
    const int radius = int(std::ceil(3.0 * sigma));
    const std::vector<double> smooth = gaussian_weights(sigma, radius);
    std::vector<double> first = smooth, second = smooth;
    for (size_t tap = 0; tap < smooth.size(); ++tap) {
        const int x = int(tap) - radius;
        first[tap] *= -x;
        second[tap] *= x * x / (sigma * sigma) - 1.0;
    }
    balance(first);
    balance(second);
    for (double& y : brightness.values) y = (y + 16.0) / 116.0;
    return {magnitude(brightness, first, smooth, progress), magnitude(brightness, second, smooth, progress)};
}

double feature_distance(const Features& a, const Features& b, size_t pixel)
{
    const double edges = std::abs(a.edges.values[pixel] - b.edges.values[pixel]);
    const double points = std::abs(a.points.values[pixel] - b.points.values[pixel]);
    constexpr double QF = 0.5;
    return std::pow(std::max(edges, points) / std::numbers::sqrt2, QF);
}

}  // namespace

std::vector<double> flip_map(const Image8& a, const Image8& b, double pixels_per_degree, const Progress& progress)
{
    SHVR_CHECK(a.width == b.width && a.height == b.height && a.rgba.size() == b.rgba.size());
    SHVR_CHECK(pixels_per_degree > 0.0, pixels_per_degree);
    constexpr size_t PIXELS_TOLD = 1 << 16;
    const Planes ycxcz_a = ycxcz_planes(a), ycxcz_b = ycxcz_planes(b);
    // Progress counts eight filters per picture. They take half of the time; the rest of the work takes the other half.
    FilterProgress filters(part_of(progress, 0.0, 0.5), 16.0);
    const Planes seen_a = seen(ycxcz_a, pixels_per_degree, filters), seen_b = seen(ycxcz_b, pixels_per_degree, filters);
    const Features features_a = features_of(ycxcz_a[0], pixels_per_degree, filters);
    const Features features_b = features_of(ycxcz_b[0], pixels_per_degree, filters);
    const double largest = color_distance(hunt_lab_of_rgb({0.0, 1.0, 0.0}), hunt_lab_of_rgb({0.0, 0.0, 1.0}));
    std::vector<double> map(ycxcz_a[0].values.size());
    for (size_t pixel = 0; pixel < map.size(); ++pixel) {
        if (pixel % PIXELS_TOLD == 0) tell(progress, 0.5 + 0.5 * double(pixel) / double(map.size()));
        const double distance = color_distance(hunt_lab_at(seen_a, pixel), hunt_lab_at(seen_b, pixel));
        map[pixel] = std::pow(remapped(distance, largest), 1.0 - feature_distance(features_a, features_b, pixel));
    }
    return map;
}

}  // namespace shvr
