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
    /// Sorts by intensity; points at the same intensity keep their order and make a step (the last of them applies at
    /// the intensity itself). Fails if a number is not finite, an opacity or colour lies outside [0, 1], or an
    /// intensity lies outside the range of float32 (no voxel has such a value).
    explicit TransferFunction(std::vector<ControlPoint> points);

    std::span<const ControlPoint> points() const { return points_; }
    /// True if there are fewer than two points, all lie at one intensity, or no opacity is above 0.
    bool draws_nothing() const;
    double lower() const { return points_.empty() ? 0.0 : points_.front().intensity; }
    double upper() const { return points_.empty() ? 0.0 : points_.back().intensity; }

    /// Linear RGB and opacity per reference length; all 0 outside [lower, upper].
    glm::dvec4 at(double intensity) const;
    bool operator==(const TransferFunction&) const = default;

private:
    std::vector<ControlPoint> points_;
};

/// Opacity of a step `step_voxels` reference lengths long (0 or more). Opacities 0 and 1 are exact; a step of length 0
/// has opacity 0.
double opacity_of_step(double opacity, double step_voxels);

/// Optical depth of a step `step_voxels` reference lengths long, sigma times length; infinite for opacity 1.
double depth_of_step(double opacity, double step_voxels);

/// Intensities at which a function is sampled: `entries` (2 or more) intensities, evenly spaced from `lower` to
/// `upper`, both included.
struct Samples {
    double lower = 0.0, upper = 0.0;
    uint32_t entries = 2;
    bool operator==(const Samples&) const = default;
    double at(uint32_t entry) const;
};
/// Samples from function.lower() to function.upper().
Samples whole_range(const TransferFunction& function, uint32_t entries);

/// Samples of the function: linear RGB and the opacity of one step. These are not averages: a spike between two samples
/// is lost.
struct BakedTable {
    std::vector<glm::vec4> looks;
    std::vector<float> depths;  ///< optical depth of one step, at most gpu::OPAQUE_DEPTH
};
BakedTable bake_table(const TransferFunction& function, double step_voxels, const Samples& samples);

/// An interval of intensities, or a single intensity, at which opacity is 1: rays that pass through it end there.
struct OpaqueInterval {
    double lower = 0.0, upper = 0.0;
    glm::dvec3 lower_color{0.0}, upper_color{0.0};  ///< linear light
};
/// All opaque intervals, sorted by intensity.
std::vector<OpaqueInterval> opaque_intervals(const TransferFunction& function);

/// For each k, counts the table intervals [j, j+1] with j < k in which the table's opacity is above 0; the result has
/// `entries` elements. Interval j..k contains something visible exactly if result[k+1] - result[j] > 0. The counts are
/// integers, so nothing cancels.
std::vector<uint32_t> visible_intervals(std::span<const glm::vec4> table);
/// Counts the visible intervals of the function itself, whose peaks may lie between two samples; an intensity on the
/// border of two intervals counts in both.
std::vector<uint32_t> visible_intervals(const TransferFunction& function, const Samples& samples);

}  // namespace shvr
