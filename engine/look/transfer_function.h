#pragma once
// The 1-D transfer function: control points (intensity, colour, opacity), linear in between, nothing outside.
//
// The interpolated quantity is opacity, per reference length (one voxel along the finest axis); the extinction is then
// sigma = -ln(1 - opacity) / reference length. Colours are sRGB in files and are decoded once, before interpolation:
// everything after is linear light. Opacities of steps of other lengths are corrected here, in double, as -expm1(step *
// log1p(-opacity)), and baked into a float table, because pow() in a shader loses all relative accuracy for small
// opacities.

#include <span>
#include <vector>

#include <glm/glm.hpp>

namespace shvr {

struct ControlPoint {
    double intensity = 0.0;  ///< in the file's units
    glm::dvec3 color{1.0};   ///< linear light, 0 ... 1
    double opacity = 0.0;    ///< per reference length, 0 ... 1
    bool operator==(const ControlPoint&) const = default;
};

class TransferFunction {
public:
    TransferFunction() = default;
    /// Sorts by intensity. Points at the same intensity keep their order and form a step; the last one applies at the
    /// intensity itself. Fails if a number is not finite, if an opacity or colour lies outside [0, 1], or if an
    /// intensity lies outside the range of float32 (no voxel has such a value).
    explicit TransferFunction(std::vector<ControlPoint> points);

    std::span<const ControlPoint> points() const { return points_; }
    /// True if there are fewer than two points, if all lie at one intensity, or if no opacity is above 0.
    bool draws_nothing() const;
    double lower() const { return points_.empty() ? 0.0 : points_.front().intensity; }
    double upper() const { return points_.empty() ? 0.0 : points_.back().intensity; }

    /// Returns linear RGB, and opacity per reference length; all 0 outside [lower, upper].
    glm::dvec4 at(double intensity) const;
    bool operator==(const TransferFunction&) const = default;

private:
    std::vector<ControlPoint> points_;
};

/// Returns the opacity of a step `step_voxels` (0 or more) reference lengths long. Opacities 0 and 1 are kept exactly;
/// a step of length 0 has opacity 0.
double opacity_of_step(double opacity, double step_voxels);

/// Returns the optical depth, sigma times length, of a step `step_voxels` reference lengths long; infinite if opaque.
double depth_of_step(double opacity, double step_voxels);

/// Intensities at which a function is sampled: `entries` of them (2 or more), evenly spaced from `lower` to `upper`,
/// both included.
struct Samples {
    double lower = 0.0, upper = 0.0;
    uint32_t entries = 2;
    bool operator==(const Samples&) const = default;
    double at(uint32_t entry) const;
};
/// Samples from function.lower() to function.upper().
Samples whole_range(const TransferFunction& function, uint32_t entries);

/// Samples of the function: linear RGB and the opacity of one step. The samples are no averages, so a spike between two
/// of them is lost.
struct BakedTable {
    std::vector<glm::vec4> looks;
    std::vector<float> depths;  ///< optical depth of one step, at most gpu::OPAQUE_DEPTH
};
BakedTable bake_table(const TransferFunction& function, double step_voxels, const Samples& samples);

/// An interval of intensities, or a single one, with opacity 1. Rays that meet such an intensity end there.
struct OpaqueInterval {
    double lower = 0.0, upper = 0.0;
    glm::dvec3 lower_color{0.0}, upper_color{0.0};  ///< linear light
};
/// All opaque intervals, sorted by intensity.
std::vector<OpaqueInterval> opaque_intervals(const TransferFunction& function);

/// For each k, returns the number of table intervals [j, j+1] with j < k in which the table's opacity is above 0. So
/// the range j..k is visible exactly if result[k+1] - result[j] > 0. Counts are integers, so the difference is exact.
/// The result has `entries` elements.
std::vector<uint32_t> visible_intervals(std::span<const glm::vec4> table);
/// Like visible_intervals() above, but computed from the function itself, including peaks between two samples. An
/// intensity on the border of two intervals counts in both.
std::vector<uint32_t> visible_intervals(const TransferFunction& function, const Samples& samples);

}  // namespace shvr
