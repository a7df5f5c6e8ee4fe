#include "engine/volume/procedural/source_procedural.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "engine/base/error.h"
#include "engine/volume/procedural/procedural_kind.h"
#include "engine/volume/voxel_numbers.h"
#include "shaders/bricks.h"

namespace shvr {
namespace {

struct NamedKind {
    const char* name;
    std::unique_ptr<ProceduralKind> (*make)(const Size3& size, uint32_t seed);
};

constexpr NamedKind KINDS[] = {
    {"constant", make_constant},
    {"ramp", make_ramp},
    {"sphere", make_sphere},
    {"marschner_lobb", make_marschner_lobb},
    {"tubes", make_tubes},
    {"speckles", make_speckles},
    {"fog", make_fog},
    {"checker", make_checker},
    {"chirality", make_chirality},
};

VolumeInfo info_of(const ProceduralSpec& spec)
{
    VolumeInfo info;
    info.name = spec.kind;
    info.format = "procedural";
    info.size = spec.size;
    info.type = spec.type;
    info.spacing = spec.spacing;
    info.unit = spec.unit;
    info.spacing_from = info.unit_from = Provenance::given;
    static_cast<void>(voxel_count(info));
    for (int axis = 0; axis < 3; ++axis) {
        if (!std::isfinite(spec.spacing[axis]) || !(spec.spacing[axis] > 0.0)) {
            fail(spec.kind, ": spacing along ", "xyz"[axis], " is ", spec.spacing[axis],
                 "; expected a finite number above 0");
        }
    }
    return info;
}

std::unique_ptr<ProceduralKind> make_kind(const ProceduralSpec& spec)
{
    std::string known;
    for (const NamedKind& kind : KINDS) {
        if (spec.kind == kind.name) {
            static_cast<void>(info_of(spec));
            return kind.make(spec.size, spec.seed);
        }
        known += (known.empty() ? "" : ", ") + std::string(kind.name);
    }
    fail("procedural volume is \"", spec.kind, "\"; expected one of ", known);
}

/// For int8, with a range of -128 ... 127, intensities are lowered by 128.
double shift_of(VoxelType type)
{
    return type == VoxelType::int8 ? -128.0 : 0.0;
}

/// Stores `values`, which are 0 ... 250 for every kind, as voxels of `type`.
void store(VoxelType type, std::span<double> values, std::byte* voxels)
{
    const double shift = shift_of(type);
    if (shift != 0.0) {
        for (double& value : values) value += shift;
    }
    store_voxels(type, values, voxels);
}

class ProceduralSource final : public VolumeSource {
public:
    explicit ProceduralSource(const ProceduralSpec& spec)
        : VolumeSource(info_of(spec)), kind_(make_kind(spec)), levels_(spec.levels)
    {
        if (levels_ > 0) return;
        levels_ = 1;
        if (voxel_count(info()) <= int64_t{1} << 33) return;
        const int64_t longest = std::max({info().size.x, info().size.y, info().size.z});
        while ((longest - 1) >> (levels_ - 1) >= int64_t{gpu::BRICK_SIZE}) ++levels_;
    }

    int levels() const override { return levels_; }

    /// Measures a coarser level of huge volumes, since measuring level 0 would take too long.
    std::optional<VolumeStatistics> statistics() const override
    {
        if (voxel_count(info()) <= int64_t{1} << 33) return std::nullopt;
        VolumeStatistics statistics = measure_level(*this, std::max(0, levels_ - 3));
        statistics.minimum = shift_of(info().type);
        statistics.maximum = 250.0 + shift_of(info().type);
        return statistics;
    }

    void read_level(int level, const VoxelBox& box, std::span<std::byte> voxels) const override
    {
        if (level == 0) return read(box, voxels);
        check_box(level, box, voxels);
        const std::unique_ptr<ProceduralKind::Rows> rows = kind_->coarse_rows(std::ldexp(1.0, level), info().size, box);
        std::vector<double> values(size_t(box.size().x));
        std::byte* row = voxels.data();
        for (int64_t z = box.lower.z; z < box.upper.z; ++z)
            for (int64_t y = box.lower.y; y < box.upper.y; ++y) {
                rows->evaluate(y, z, values);
                store(info().type, values, row);
                row += values.size() * bytes_of(info().type);
            }
    }

    void read(const VoxelBox& box, std::span<std::byte> voxels) const override
    {
        check_box(0, box, voxels);
        const Size3 extent = box.size();
        const auto row_bytes = extent.x * int64_t(bytes_of(info().type));
        const std::unique_ptr<ProceduralKind::Rows> rows = kind_->rows(box);
        std::vector<double> values(size_t(extent.x));
        for (int64_t y = 0; y < extent.y; ++y) {
            for (int64_t z = 0; z < extent.z; ++z) {
                rows->evaluate(box.lower.y + y, box.lower.z + z, values);
                store(info().type, values, voxels.data() + row_bytes * (y + extent.y * z));
            }
        }
    }

private:
    void check_box(int level, const VoxelBox& box, std::span<std::byte> voxels) const
    {
        const Size3 extent = box.size();
        SHVR_CHECK(level >= 0 && level < levels_, level);
        SHVR_CHECK(glm::all(glm::greaterThanEqual(box.lower, Size3(0))) &&
                   glm::all(glm::lessThanEqual(box.upper, size_of_level(info().size, level))) &&
                   glm::all(glm::greaterThan(extent, Size3(0))));
        SHVR_CHECK(voxels.size() == size_t(extent.x * extent.y * extent.z) * bytes_of(info().type), voxels.size());
    }

    std::unique_ptr<ProceduralKind> kind_;
    int levels_;
};

/// Evaluates each value separately, for kinds whose values are cheap.
class PointRows final : public ProceduralKind::Rows {
public:
    PointRows(const ProceduralKind& kind, int64_t first_x) : kind_(kind), first_x_(first_x) {}

    void evaluate(int64_t y, int64_t z, std::span<double> values) override
    {
        glm::dvec3 voxel(double(first_x_) + 0.5, double(y) + 0.5, double(z) + 0.5);
        for (double& value : values) {
            value = kind_.value(voxel);
            voxel.x += 1.0;
        }
    }

private:
    const ProceduralKind& kind_;
    int64_t first_x_;
};

/// The same on a coarser level.
class CoarsePointRows final : public ProceduralKind::Rows {
public:
    CoarsePointRows(const ProceduralKind& kind, double side, const Size3& size, int64_t first_x)
        : kind_(kind), side_(side), size_(size), first_x_(first_x)
    {}

    void evaluate(int64_t y, int64_t z, std::span<double> values) override
    {
        for (size_t x = 0; x < values.size(); ++x)
            values[x] = kind_.value(glm::min(side_ * (glm::dvec3(first_x_ + int64_t(x), y, z) + 0.5), size_));
    }

private:
    const ProceduralKind& kind_;
    double side_;
    glm::dvec3 size_;
    int64_t first_x_;
};

}  // namespace

std::unique_ptr<ProceduralKind::Rows> ProceduralKind::coarse_rows(double side, const Size3& size,
                                                                  const VoxelBox& box) const
{
    return std::make_unique<CoarsePointRows>(*this, side, size, box.lower.x);
}

std::unique_ptr<ProceduralKind::Rows> ProceduralKind::rows(const VoxelBox& box) const
{
    return std::make_unique<PointRows>(*this, box.lower.x);
}

std::vector<std::string> procedural_kinds()
{
    std::vector<std::string> names;
    for (const NamedKind& kind : KINDS) names.emplace_back(kind.name);
    return names;
}

ScalarField procedural_field(const ProceduralSpec& spec)
{
    const std::shared_ptr<const ProceduralKind> kind = make_kind(spec);
    ScalarField field;
    field.value = [kind, shift = shift_of(spec.type)](const glm::dvec3& voxel) { return kind->value(voxel) + shift; };
    if (kind->has_gradient()) field.gradient = [kind](const glm::dvec3& voxel) { return kind->gradient(voxel); };
    return field;
}

std::optional<ProceduralTruth> procedural_truth(const ProceduralSpec& spec)
{
    return make_kind(spec)->truth();
}

std::unique_ptr<VolumeSource> open_procedural(const ProceduralSpec& spec)
{
    return std::make_unique<ProceduralSource>(spec);
}

}  // namespace shvr
