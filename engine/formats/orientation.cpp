#include "engine/formats/orientation.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <numbers>
#include <utility>

#include "engine/base/error.h"

namespace shvr {
namespace {

/// Rotations and shears below these angles are considered rounding errors in the file's numbers.
constexpr double MIN_TURN_DEGREES = 0.05;
constexpr double MIN_SHEAR_DEGREES = 0.1;

double degrees_of(double radians)
{
    return radians * 180.0 / std::numbers::pi;
}

std::string with_one_decimal(double number)
{
    return sentence(std::fixed, std::setprecision(1), number);
}

/// Returns the axis of the frame that is nearest to `direction`.
int nearest_axis(const glm::dvec3& direction)
{
    const glm::dvec3 size = glm::abs(direction);
    return size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
}

void warn_of_turn(VolumeInfo& info)
{
    double most = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
        const glm::dvec3& direction = info.directions[axis];
        // Uses atan2, because acos is inaccurate for small angles.
        const double along = std::abs(direction[nearest_axis(direction)]);
        const double across = std::sqrt(std::max(0.0, glm::dot(direction, direction) - along * along));
        most = std::max(most, degrees_of(std::atan2(across, along)));
    }
    if (most < MIN_TURN_DEGREES) return;
    info.warnings.push_back(sentence("axes are turned by up to ", with_one_decimal(most), " degrees against those of ",
                                     info.frame.empty() ? "their space" : "the scanner (" + info.frame + ")",
                                     "; the volume is drawn along its own axes"));
}

void warn_of_shear(VolumeInfo& info)
{
    constexpr std::pair<int, int> PAIRS[] = {{0, 1}, {0, 2}, {1, 2}};
    for (const auto& [a, b] : PAIRS) {
        const double cosine = std::clamp(glm::dot(info.directions[a], info.directions[b]), -1.0, 1.0);
        const double angle = degrees_of(std::acos(cosine));
        if (std::abs(angle - 90.0) < MIN_SHEAR_DEGREES) continue;
        info.warnings.push_back(sentence("axes ", "xyz"[a], " and ", "xyz"[b], " meet at ", with_one_decimal(angle),
                                         " degrees; the volume is drawn as if they met at right angles"));
    }
}

int axis_to_reverse(const glm::dmat3& directions)
{
    for (int axis = 2; axis >= 0; --axis) {
        const glm::dvec3& direction = directions[axis];
        if (direction[nearest_axis(direction)] < 0.0) return axis;
    }
    return 2;
}

VolumeInfo reversed(VolumeInfo info, int axis)
{
    info.origin += info.directions[axis] * (info.spacing[axis] * double(info.size[axis] - 1));
    info.directions[axis] = -info.directions[axis];
    info.warnings.push_back(sentence("axes are left-handed; voxels are taken in reverse order along ", "xyz"[axis],
                                     ", so that the volume is not shown as its mirror image"));
    return info;
}

class ReversedSource final : public VolumeSource {
public:
    ReversedSource(std::unique_ptr<VolumeSource> source, int axis)
        : VolumeSource(reversed(source->info(), axis)), source_(std::move(source)), axis_(axis)
    {
        SHVR_CHECK(source_->levels() == 1, source_->levels());
    }

    void read(const VoxelBox& box, std::span<std::byte> voxels) const override
    {
        VoxelBox mirrored = box;
        mirrored.lower[axis_] = info().size[axis_] - box.upper[axis_];
        mirrored.upper[axis_] = info().size[axis_] - box.lower[axis_];
        source_->read(mirrored, voxels);
        // Reverses the runs of `run_bytes` bytes along the axis: swaps the first run with the last, and so on.
        const Size3 extent = box.size();
        auto run_bytes = int64_t(bytes_of(info().type));
        for (int axis = 0; axis < axis_; ++axis) run_bytes *= extent[axis];
        const int64_t runs = extent[axis_];
        const auto block_bytes = size_t(run_bytes * runs);
        for (size_t begin = 0; begin < voxels.size(); begin += block_bytes) {
            std::byte* const block = voxels.data() + begin;
            for (int64_t front = 0, back = runs - 1; front < back; ++front, --back) {
                std::swap_ranges(block + front * run_bytes, block + (front + 1) * run_bytes, block + back * run_bytes);
            }
        }
    }

    std::optional<VolumeStatistics> statistics() const override { return source_->statistics(); }

private:
    std::unique_ptr<VolumeSource> source_;
    int axis_;
};

}  // namespace

glm::dvec3 place(VolumeInfo& info, const glm::dmat3& steps, const glm::dvec3& origin, const std::string& frame)
{
    const glm::dvec3 spacing(glm::length(steps[0]), glm::length(steps[1]), glm::length(steps[2]));
    for (int axis = 0; axis < 3; ++axis) {
        SHVR_CHECK(std::isfinite(spacing[axis]) && spacing[axis] > 0.0, spacing[axis]);
        info.directions[axis] = steps[axis] / spacing[axis];
    }
    constexpr double FLATTEST = 1e-6;
    if (std::abs(glm::determinant(info.directions)) < FLATTEST) {
        info.directions = glm::dmat3(1.0);
        info.warnings.emplace_back("axes span no volume; orientation was left out");
        return spacing;
    }
    info.origin = origin;
    info.frame = frame;
    warn_of_turn(info);
    warn_of_shear(info);
    return spacing;
}

std::unique_ptr<VolumeSource> right_handed(std::unique_ptr<VolumeSource> source)
{
    if (source == nullptr || glm::determinant(source->info().directions) >= 0.0) return source;
    const int axis = axis_to_reverse(source->info().directions);
    return std::make_unique<ReversedSource>(std::move(source), axis);
}

}  // namespace shvr
