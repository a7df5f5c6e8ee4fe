#include "tests/reference/discrete.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "tests/reference/field.h"
#include "tests/reference/shading.h"

namespace shvr::reference {

DiscreteModel::DiscreteModel(const Scene& scene, const DiscreteOptions& options)
    : scene_(scene), options_(options), transfer_(scene.points)
{
    if (!(options.step > 0.0)) throw std::invalid_argument("the step of the discrete model must be above 0");
    if (options.table_entries == 1) throw std::invalid_argument("a transfer table needs at least two entries");
    if (options.table_entries == 0 || transfer_.knots().empty()) return;
    first_ = std::clamp(transfer_.knots().front(), 0.0, 1.0);
    last_ = std::clamp(transfer_.knots().back(), 0.0, 1.0);
    for (uint32_t k = 0; k < options.table_entries; ++k) {
        // The last entry is exactly at `last_`, which the product below could miss by one bit.
        const bool is_last = k + 1 == options.table_entries;
        table_.push_back(transfer_.at(is_last ? last_ : first_ + k * (last_ - first_) / (options.table_entries - 1)));
    }
}

glm::dvec4 DiscreteModel::looked_up(double density, double length) const
{
    if (table_.empty()) {
        glm::dvec4 material = transfer_.at(density);
        material.a = opacity_of_length(material.a, length);
        return material;
    }
    if (!(density >= first_ && density <= last_)) return glm::dvec4(0.0);
    const double position = last_ > first_ ? (density - first_) / (last_ - first_) * double(table_.size() - 1) : 0.0;
    const size_t low = std::min(size_t(position), table_.size() - 2);
    glm::dvec4 before = table_[low], after = table_[low + 1];
    before.a = opacity_of_length(before.a, length);
    after.a = opacity_of_length(after.a, length);
    return before + (after - before) * (position - double(low));
}

glm::dvec3 DiscreteModel::blended(const glm::dvec3& voxel, const glm::dvec3& color) const
{
    if (!scene_.blend) return color;
    const DistanceBlend& blend = *scene_.blend;
    const double along = glm::dot(voxel * scene_.spacing, blend.forward);
    const double depth = std::clamp((along - blend.begin) / (blend.end - blend.begin), 0.0, 1.0);
    // std::pow(0, 0) is 1.
    return glm::mix(color, blend.color, std::clamp(blend.size * std::pow(depth, blend.rate), 0.0, 1.0));
}

glm::dvec4 DiscreteModel::sample(const glm::dvec3& voxel, const glm::dvec3& to_eye, double length) const
{
    const uint8_t label = label_at(scene_, voxel);
    glm::dvec4 material(0.0);
    if (label == 0) {
        material = looked_up(density_at(scene_, voxel), length);
    } else if (scene_.groups[label].visible) {
        const Group& group = scene_.groups[label];
        material = glm::dvec4(group.color, opacity_of_length(group.opacity, length));
    }
    if (material.a == 0.0) return glm::dvec4(0.0);
    return glm::dvec4(blended(voxel, shaded(scene_, voxel, to_eye, material)), material.a);
}

glm::dvec4 DiscreteModel::integrate(const Ray& ray) const
{
    const std::optional<Span> span = span_of(scene_, ray);
    if (!span) return glm::dvec4(0.0);
    const double step = options_.step;
    const auto full_steps = int64_t(std::floor(span->length / step));
    const double rest = span->length - double(full_steps) * step;
    glm::dvec3 light(0.0);
    double transparency = 1.0;
    for (int64_t i = 0; i <= full_steps && 1.0 - transparency < options_.stop_opacity; ++i) {
        const double length = i < full_steps ? step : rest;
        if (!(length > 0.0)) break;
        const double s = double(i) * step + options_.sample_at * length;
        const glm::dvec4 material = sample(span->at(s), span->to_eye, length);
        light += transparency * material.a * glm::dvec3(material);
        transparency *= 1.0 - material.a;
    }
    return {light, 1.0 - transparency};
}

glm::dvec4 integrate_discrete(const Scene& scene, const Ray& ray, const DiscreteOptions& options)
{
    return DiscreteModel(scene, options).integrate(ray);
}

}  // namespace shvr::reference
