#include "tests/reference/exact.h"

#include <algorithm>
#include <cmath>

#include "tests/reference/cubic.h"
#include "tests/reference/field.h"
#include "tests/reference/quadrature.h"
#include "tests/reference/shading.h"

namespace shvr::reference {

namespace {

// Planes closer together than this (a diagonal ray meets three at once) count as one.
constexpr double SAME_PLANE = 1e-13;

// s of every plane x, y or z = k/2. Cells end at half-integers; voxels, and the cells half a voxel aside from which
// gradients are made, end at integers.
std::vector<double> plane_crossings(const Span& span)
{
    std::vector<double> all;
    for (int axis = 0; axis < 3; ++axis) {
        if (span.step[axis] == 0.0) continue;
        const auto [lower, upper] = std::minmax({span.entry[axis], span.at(span.length)[axis]});
        for (double plane = std::ceil(2.0 * lower); plane <= 2.0 * upper; plane += 1.0) {
            all.push_back((0.5 * plane - span.entry[axis]) / span.step[axis]);
        }
    }
    std::sort(all.begin(), all.end());
    std::vector<double> distinct{0.0};
    for (const double s : all) {
        if (s > distinct.back() + SAME_PLANE && s < span.length - SAME_PLANE) distinct.push_back(s);
    }
    distinct.push_back(span.length);
    return distinct;
}

// Lit and unlit sides meet where the gradient is perpendicular to L, or to H; the gradient along a ray is cubic too.
std::vector<double> with_shading_kinks(const std::vector<double>& borders, const Scene& scene, const Span& span)
{
    const glm::dvec3 to_light = glm::normalize(scene.shading->to_light);
    const std::array<double, 1> zero{0.0};
    std::vector<double> refined{0.0};
    for (size_t i = 0; i + 1 < borders.size(); ++i) {
        const double lower = borders[i], width = borders[i + 1] - lower;
        std::vector<double> inner;
        for (const glm::dvec3& direction : {to_light, to_light + span.to_eye}) {
            const auto slope = [&](double t) {
                return glm::dot(gradient_at(scene, span.at(lower + width * t)), direction);
            };
            const Cubic cubic = cubic_through({slope(0.0), slope(1.0 / 3.0), slope(2.0 / 3.0), slope(1.0)});
            for (const double t : split_at_levels(cubic, zero)) inner.push_back(lower + width * t);
        }
        std::sort(inner.begin(), inner.end());
        for (const double s : inner) {
            if (s > refined.back() + SAME_PLANE && s < borders[i + 1] - SAME_PLANE) refined.push_back(s);
        }
        refined.push_back(borders[i + 1]);
    }
    return refined;
}

double extinction_of(double opacity)
{
    // Next to an opaque surface a node may round to opacity 1; the integral there is finite.
    return -std::log1p(-std::min(opacity, 1.0 - 0x1p-53));
}

// Walks one ray from front to back.
class Walk {
public:
    Walk(const Scene& scene, const Transfer& transfer, const Span& span, double tolerance)
        : scene_(scene), transfer_(transfer), span_(span), tolerance_(tolerance)
    {}

    glm::dvec4 run()
    {
        std::vector<double> borders = plane_crossings(span_);
        if (scene_.shading) borders = with_shading_kinks(borders, scene_, span_);
        for (size_t i = 0; i + 1 < borders.size() && !is_opaque_; ++i) {
            const uint8_t label = label_at(scene_, span_.at(0.5 * (borders[i] + borders[i + 1])));
            if (label == 0) {
                cross_density(borders[i], borders[i + 1]);
            } else if (scene_.groups[label].visible) {
                const Group& group = scene_.groups[label];
                const glm::dvec4 material(group.color, group.opacity);
                if (group.opacity == 1.0)
                    end_at(borders[i], group.color);
                else if (group.opacity > 0.0)
                    add(borders[i], borders[i + 1], [&](double) { return material; });
            }
        }
        return {so_far_.light, is_opaque_ ? 1.0 : -std::expm1(-so_far_.depth)};
    }

private:
    // Both ends lie in one cell and one voxel.
    void cross_density(double lower, double upper)
    {
        const Cell cell = cell_at(scene_, span_.at(0.5 * (lower + upper)));
        const auto s_of = [&](double t) { return lower + (upper - lower) * t; };
        const auto density = [&](double t) { return value_in(cell, span_.at(s_of(t))); };
        const Cubic cubic = cubic_through({density(0.0), density(1.0 / 3.0), density(2.0 / 3.0), density(1.0)});
        const std::vector<double> splits = split_at_levels(cubic, transfer_.knots());
        for (size_t i = 0; i + 1 < splits.size() && !is_opaque_; ++i) {
            const double start = splits[i], end = splits[i + 1];
            if (!(end > start)) continue;
            const TransferPiece piece = transfer_.piece_at(cubic.at(0.5 * (start + end)));
            if (end_if_opaque(cubic.at(start), s_of(start))) return;
            if (piece.value0.a == 1.0 && piece.value1.a == 1.0) return end_at(s_of(start), piece.at(cubic.at(start)));
            if (!piece.is_empty()) {
                add(s_of(start), s_of(end),
                    [&](double s) { return piece.at(cubic.at((s - lower) / (upper - lower))); });
            }
            if (end_if_opaque(cubic.at(end), s_of(end))) return;
        }
    }

    bool end_if_opaque(double density, double s)
    {
        const glm::dvec4 material = transfer_.at(transfer_.snapped(density));
        if (material.a == 1.0) end_at(s, material);
        return is_opaque_;
    }

    void end_at(double s, const glm::dvec3& color)
    {
        so_far_ = joined(so_far_, {0.0, shaded(scene_, span_.at(s), span_.to_eye, color)});
        is_opaque_ = true;
    }

    template <class Material>
    void add(double lower, double upper, const Material& material_at)
    {
        const auto medium = [&](double s) {
            const glm::dvec4 material = material_at(s);
            const double sigma = extinction_of(material.a);
            if (!scene_.shading) return Medium{sigma, material};
            const glm::dvec3 color = lit(scene_, span_.at(s), span_.to_eye, material);
            const unsigned clamped = (color.r > 1.0 ? 1u : 0u) | (color.g > 1.0 ? 2u : 0u) | (color.b > 1.0 ? 4u : 0u);
            return Medium{sigma, glm::min(color, 1.0), clamped};
        };
        // Dense matter in front attenuates light on its way to the pixel, and its error with it.
        const double tolerance = tolerance_ * std::exp(std::min(so_far_.depth, 300.0));
        so_far_ = joined(so_far_, reference::integrate(medium, lower, upper, tolerance));
    }

    const Scene& scene_;
    const Transfer& transfer_;
    const Span& span_;
    double tolerance_;
    Stretch so_far_;
    bool is_opaque_ = false;
};

}  // namespace

ExactModel::ExactModel(const Scene& scene, const ExactOptions& options)
    : scene_(scene), transfer_(scene.points), options_(options)
{}

glm::dvec4 ExactModel::integrate(const Ray& ray) const
{
    const std::optional<Span> span = span_of(scene_, ray);
    if (!span || !(span->length > 0.0)) return glm::dvec4(0.0);
    return Walk(scene_, transfer_, *span, options_.tolerance).run();
}

glm::dvec4 integrate_exact(const Scene& scene, const Ray& ray, const ExactOptions& options)
{
    return ExactModel(scene, options).integrate(ray);
}

}  // namespace shvr::reference
