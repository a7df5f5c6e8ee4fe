#include "engine/volume/phantoms/phantom.h"

#include <algorithm>
#include <cmath>

#include "engine/base/error.h"
#include "engine/volume/phantoms/phantom_flaws.h"
#include "engine/volume/phantoms/phantom_model.h"
#include "engine/volume/voxel_numbers.h"

namespace shvr {

namespace {

constexpr uint32_t GAPS = 31;  ///< purpose of random numbers

struct NamedKind {
    const char* name;
    PhantomModel (*make)(const PhantomSpec& spec);
};
constexpr NamedKind KINDS[] = {{"capitulum", make_capitulum},
                               {"section", make_section},
                               {"roots", make_roots},
                               {"stem", make_stem},
                               {"helix", make_helix}};

VolumeInfo info_of(const PhantomSpec& spec, VoxelType type)
{
    VolumeInfo info;
    info.name = spec.kind;
    info.format = "phantom";
    info.size = spec.size;
    info.type = type;
    info.spacing_from = info.unit_from = Provenance::given;
    static_cast<void>(voxel_count(info));
    return info;
}

/// Visits the centres of a box's voxels, x fastest.
template <class Visit>
void each_voxel(const VoxelBox& box, const Visit& visit)
{
    for (int64_t z = box.lower.z; z < box.upper.z; ++z)
        for (int64_t y = box.lower.y; y < box.upper.y; ++y)
            for (int64_t x = box.lower.x; x < box.upper.x; ++x) visit(glm::dvec3(x, y, z) + 0.5);
}

class PhantomVolume final : public VolumeSource {
public:
    PhantomVolume(const PhantomSpec& spec, std::shared_ptr<const TubeScene> scene,
                  std::function<Tissue(const glm::dvec3&)> tissue)
        : VolumeSource(info_of(spec, spec.type)),
          scene_(std::move(scene)),
          tissue_(std::move(tissue)),
          blur_(spec.flaws.blur),
          flawed_(spec.flaws, spec.size, spec.seed),
          factor_(bytes_of(spec.type) > 1 ? 100.0 : 1.0),
          shift_(spec.type == VoxelType::int8 ? -128.0 : 0.0)
    {}

    void read(const VoxelBox& box, std::span<std::byte> voxels) const override
    {
        std::vector<double> values(size_t(box.size().x));
        size_t at = 0;
        each_voxel(box, [&](const glm::dvec3& voxel) {
            values[at++] = factor_ * flawed_(intensity(voxel), voxel) + shift_;
            if (at < values.size()) return;
            store_voxels(info().type, values, voxels.data());
            voxels = voxels.subspan(values.size() * bytes_of(info().type));
            at = 0;
        });
    }

private:
    double intensity(const glm::dvec3& voxel) const
    {
        const double around = tissue_(voxel).intensity;
        double most = around;
        for (const uint32_t i : scene_->near(voxel)) {
            const Tube& tube = scene_->tubes()[i];
            const auto [distance, along] = distance_from(tube, voxel);
            const double cover = cover_of(distance, blur_);
            if (cover == 0.0) continue;
            const bool is_seen = along <= tube.seen || along >= 1.0 - tube.seen;
            const double inside =
                is_seen ? (1.0 - along) * tube.intensity[0] + along * tube.intensity[1] : tube.gap_intensity;
            most = std::max(most, around + (inside - around) * cover);
        }
        return most;
    }

    std::shared_ptr<const TubeScene> scene_;
    std::function<Tissue(const glm::dvec3&)> tissue_;
    double blur_;
    FlawedIntensity flawed_;
    double factor_, shift_;
};

class PhantomMask final : public VolumeSource {
public:
    PhantomMask(const PhantomSpec& spec, std::shared_ptr<const TubeScene> scene)
        : VolumeSource(info_of(spec, VoxelType::uint8)), scene_(std::move(scene))
    {}

    void read(const VoxelBox& box, std::span<std::byte> voxels) const override
    {
        size_t at = 0;
        each_voxel(box, [&](const glm::dvec3& voxel) { voxels[at++] = std::byte(scene_->group(voxel)); });
    }

private:
    std::shared_ptr<const TubeScene> scene_;
};

class PhantomTissueMask final : public VolumeSource {
public:
    PhantomTissueMask(const PhantomSpec& spec, std::shared_ptr<const TubeScene> scene,
                      std::function<Tissue(const glm::dvec3&)> tissue)
        : VolumeSource(info_of(spec, VoxelType::uint8)), scene_(std::move(scene)), tissue_(std::move(tissue))
    {}

    void read(const VoxelBox& box, std::span<std::byte> voxels) const override
    {
        size_t at = 0;
        each_voxel(box, [&](const glm::dvec3& voxel) { voxels[at++] = std::byte(group(voxel)); });
    }

private:
    uint8_t group(const glm::dvec3& voxel) const
    {
        if (scene_->group(voxel) != 0) return 0;
        for (const uint32_t i : scene_->near(voxel)) {
            const Tube& tube = scene_->tubes()[i];
            if (tube.tissue != 0 && distance_from(tube, voxel).voxels <= 0.0) return tube.tissue;
        }
        return tissue_(voxel).group;
    }

    std::shared_ptr<const TubeScene> scene_;
    std::function<Tissue(const glm::dvec3&)> tissue_;
};

void check_ranges(const PhantomSpec& spec)
{
    const PhantomFlaws& flaws = spec.flaws;
    const std::tuple<const char*, double, double, double> ranges[] = {
        {"blur", flaws.blur, 0.01, 16.0},       {"noise", flaws.noise, 0.0, 100.0},
        {"rings", flaws.rings, 0.0, 100.0},     {"streaks", flaws.streaks, 0.0, 100.0},
        {"specks", flaws.specks, 0.0, 4.0},     {"gaps", flaws.gaps, 0.0, 100.0},
        {"falling", flaws.falling, 0.0, 100.0}, {"uneven", flaws.uneven, 0.0, 100.0},
        {"florets", spec.florets, 8.0, 1000.0}};
    for (const auto& [name, value, least, most] : ranges)
        if (!(value >= least && value <= most))
            fail(spec.kind, ": ", name, " is ", value, "; expected ", least, " to ", most);
}

}  // namespace

std::vector<std::string> phantom_kinds()
{
    std::vector<std::string> names;
    for (const NamedKind& kind : KINDS) names.emplace_back(kind.name);
    for (const std::string& kind : procedural_kinds()) names.push_back(kind);
    return names;
}

bool has_flaws(const std::string& kind)
{
    return std::ranges::find(KINDS, kind, &NamedKind::name) != std::end(KINDS);
}

PhantomFlaws usual_flaws(const std::string& kind)
{
    if (kind == "roots") return {.noise = 5.0, .gaps = 15.0};
    return {};
}

bool has_double_tubes(const std::string& kind)
{
    return kind == "capitulum" || kind == "section" || kind == "stem";
}

void add_phloem(PhantomModel& model, const Tube& xylem, const glm::dvec3& middle)
{
    const glm::dvec3 along = xylem.ends[1] - xylem.ends[0];
    glm::dvec3 away = 0.5 * (xylem.ends[0] + xylem.ends[1]) - middle;
    away -= along * (glm::dot(away, along) / glm::dot(along, along));
    const double length = std::sqrt(glm::dot(away, away));
    if (!(length > 1e-9)) return;
    const double beside = 2.0 * std::min(xylem.radii[0], xylem.radii[1]);
    away *= beside / length;
    model.tubes.push_back({.ends = {xylem.ends[0] + away, xylem.ends[1] + away},
                           .radii = {0.35 * beside, 0.35 * beside},
                           .group = xylem.group,
                           .intensity = {0.85 * VEIN, 0.85 * VEIN}});
}

Phantom make_phantom(const PhantomSpec& spec)
{
    const NamedKind* kind = std::ranges::find(KINDS, spec.kind, &NamedKind::name);
    if (kind == std::end(KINDS)) return make_procedural_phantom(spec);
    check_ranges(spec);
    static_cast<void>(info_of(spec, spec.type));
    PhantomModel model = kind->make(spec);
    for (size_t i = 0; i < model.tubes.size(); ++i) {
        Tube& tube = model.tubes[i];
        const size_t run = i / model.pieces_in_gap;
        if (tube.group == 0 || 100.0 * random_unit(spec.seed, GAPS, uint32_t(run)) >= spec.flaws.gaps) continue;
        tube.seen = model.pieces_in_gap == 1 ? 0.2 : -1.0;
        tube.gap_intensity = model.gap_intensity;
    }
    std::unique_ptr<VolumeSource> partial;
    if (model.group_of_separate != 0) {
        std::vector<Tube> joined = model.tubes;
        std::erase_if(joined, [&](const Tube& tube) { return tube.group == model.group_of_separate; });
        partial = std::make_unique<PhantomMask>(
            spec, std::make_shared<const TubeScene>(std::move(joined), spec.size, 0.5 * spec.flaws.blur));
    }
    const auto scene = std::make_shared<const TubeScene>(std::move(model.tubes), spec.size, 0.5 * spec.flaws.blur);
    std::unique_ptr<VolumeSource> tissue_mask;
    if (!model.tissues.empty()) tissue_mask = std::make_unique<PhantomTissueMask>(spec, scene, model.tissue);
    return {.volume = std::make_unique<PhantomVolume>(spec, scene, std::move(model.tissue)),
            .mask = std::make_unique<PhantomMask>(spec, scene),
            .partial_mask = std::move(partial),
            .nodes = std::move(model.nodes),
            .links = std::move(model.links),
            .sections = std::move(model.sections),
            .tissue_mask = std::move(tissue_mask),
            .tissues = std::move(model.tissues),
            .facts = std::move(model.facts)};
}

}  // namespace shvr
