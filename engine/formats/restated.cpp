#include "engine/formats/restated.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "engine/base/error.h"
#include "engine/volume/unit.h"

namespace shvr {

namespace {

class RestatedSource final : public VolumeSource {
public:
    RestatedSource(std::unique_ptr<VolumeSource> source, VolumeInfo info)
        : VolumeSource(std::move(info)), source_(std::move(source))
    {}
    void read(const VoxelBox& box, std::span<std::byte> voxels) const override { source_->read(box, voxels); }
    Size3 block() const override { return source_->block(); }
    int levels() const override { return source_->levels(); }
    void read_level(int level, const VoxelBox& box, std::span<std::byte> voxels) const override
    {
        source_->read_level(level, box, voxels);
    }
    std::optional<ValueRange> brick_range(int level, const Size3& brick) const override
    {
        return source_->brick_range(level, brick);
    }
    std::optional<StoredBlocks> stored_blocks(int level, int64_t most) const override
    {
        return source_->stored_blocks(level, most);
    }
    std::optional<VolumeStatistics> statistics() const override
    {
        // With another fill value, the source's statistics no longer apply.
        return info().nodata ? std::nullopt : source_->statistics();
    }

private:
    std::unique_ptr<VolumeSource> source_;
};

/// "0.5 x 0.5 x 2 µm"
std::string in_words(const VolumeInfo& info)
{
    return info.unit_from == Provenance::assumed ? spacing_in_words(info.spacing, "") + " without a unit"
                                                 : spacing_in_words(info.spacing, info.unit);
}

void drop_warnings(std::vector<std::string>& warnings, std::initializer_list<const char*> parts)
{
    std::erase_if(warnings, [&](const std::string& warning) {
        return std::ranges::any_of(parts, [&](const char* part) { return warning.find(part) != std::string::npos; });
    });
}

bool is_same(const VolumeInfo& a, const VolumeInfo& b)
{
    constexpr double TOLERANCE = 1e-6;
    const std::optional<double> from = micrometres_in(a.unit), to = micrometres_in(b.unit);
    const double factor = from && to ? *from / *to : 1.0;
    const glm::dvec3 apart = glm::abs(factor * a.spacing - b.spacing);
    return ((from && to) || a.unit == b.unit) && glm::all(glm::lessThanEqual(apart, TOLERANCE * b.spacing));
}

/// Returns the value as voxels of `type` hold it: -3.4e38, for instance, is rounded in float32.
double as_voxel(VoxelType type, double value)
{
    constexpr double MOST = std::numeric_limits<float>::max();
    return type == VoxelType::float32 && std::isfinite(value) ? double(float(std::clamp(value, -MOST, MOST))) : value;
}

}  // namespace

std::unique_ptr<VolumeSource> with_nodata(std::unique_ptr<VolumeSource> source, std::optional<double> nodata)
{
    if (!nodata) return source;
    VolumeInfo info = source->info();
    info.nodata = as_voxel(info.type, *nodata);
    return std::make_unique<RestatedSource>(std::move(source), std::move(info));
}

std::unique_ptr<VolumeSource> restated(std::unique_ptr<VolumeSource> source, const std::filesystem::path& path,
                                       const OpenOptions& options)
{
    source = with_nodata(std::move(source), options.nodata);
    if (!options.spacing && options.unit.empty()) return source;
    const VolumeInfo& stated = source->info();
    VolumeInfo info = stated;
    if (options.spacing) {
        info.spacing = *options.spacing;
        info.spacing_from = Provenance::given;
        drop_warnings(info.warnings, {"no spacing stated", "no distance of ", "no distance between "});
    }
    if (!options.unit.empty()) {
        info.unit = plain_unit(options.unit);
        info.unit_from = Provenance::given;
    }
    if (info.unit_from == Provenance::assumed)
        fail(path.string(),
             ": states no unit, and a spacing is given without one; expected a unit, too, as in --unit um");
    if (info.spacing_from == Provenance::assumed)
        fail(path.string(), ": states no spacing, and a unit is given without one; expected a spacing, too, as in ",
             "--spacing 0.8,0.8,1.2");
    drop_warnings(info.warnings, {"spacing is stated without a unit"});
    if (stated.spacing_from == Provenance::file && !is_same(stated, info))
        info.warnings.push_back(
            sentence("a spacing of ", in_words(info), " is given; the file says ", in_words(stated)));
    const std::optional<double> from = micrometres_in(stated.unit), to = micrometres_in(info.unit);
    if (options.spacing && stated.unit_from == Provenance::file && from && to) info.origin *= *from / *to;
    return std::make_unique<RestatedSource>(std::move(source), std::move(info));
}

}  // namespace shvr
