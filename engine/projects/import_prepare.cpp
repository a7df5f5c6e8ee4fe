#include "engine/projects/import_prepare.h"

#include <cmath>

#include "engine/base/error.h"
#include "engine/projects/import_box.h"
#include "engine/projects/import_filter.h"

namespace shvr {
namespace {

VolumeInfo info_after(const VolumeSource& source, const PreparationOptions& options, const VoxelBox& box)
{
    VolumeInfo info = source.info();
    const int64_t factor = options.downscale;
    info.size = (box.size() + (factor - 1)) / factor;
    // Offset of the new voxel 0's centre from the centre of the source's voxel 0, in voxels of the source.
    const glm::dvec3 first = glm::dvec3(box.lower) + 0.5 * double(factor - 1);
    info.origin += info.directions * (info.spacing * first);
    info.spacing *= double(factor);
    return info;
}

/// Only crops and reverses.
class DirectPreparation final : public Preparation {
public:
    DirectPreparation(VolumeInfo info, const ImportBox& box) : Preparation(std::move(info)), box_(box) {}

    void read(const Slab& slab, std::span<std::byte> voxels, WorkPool& pool) override
    {
        box_.read({{0, slab.lower_row, slab.lower}, {info().size.x, slab.upper_row, slab.upper}}, voxels, pool);
    }
    double bytes(int64_t rows, int64_t slices, int workers) const override
    {
        return box_.bytes({info().size.x, rows, slices}, workers);
    }

private:
    ImportBox box_;
};

}  // namespace

std::string to_text(const PreparationOptions& options)
{
    std::string text;
    const auto add = [&](const std::string& what) { text += (text.empty() ? "" : ", ") + what; };
    if (options.crop) {
        const auto& [lower, upper] = *options.crop;
        add(sentence("cropped to voxels ", lower.x, ",", lower.y, ",", lower.z, " to ", upper.x, ",", upper.y, ",",
                     upper.z));
    }
    if (options.reverse) add("intensities reversed");
    if (options.blur_sigma_voxels != glm::dvec3(0.0)) {
        const glm::dvec3& sigma = options.blur_sigma_voxels;
        add(sentence("blurred with a sigma of ", sigma.x, ",", sigma.y, ",", sigma.z, " voxels"));
    }
    if (options.downscale != 1) add(sentence("made ", options.downscale, " times smaller"));
    return text;
}

std::vector<double> gaussian_weights(double sigma_voxels)
{
    const auto reach = int(4.0 * sigma_voxels + 0.5);
    std::vector<double> weights(size_t(reach) + 1, 1.0);
    double sum = 1.0;
    for (int k = 1; k <= reach; ++k) {
        const double distance = k / sigma_voxels;
        weights[size_t(k)] = std::exp(-0.5 * distance * distance);
        sum += 2.0 * weights[size_t(k)];
    }
    for (double& weight : weights) weight /= sum;
    return weights;
}

std::unique_ptr<Preparation> make_preparation(const VolumeSource& source, const PreparationOptions& options)
{
    return make_preparation(source, options, {});
}

std::unique_ptr<Preparation> make_preparation(const VolumeSource& source, const PreparationOptions& options,
                                              const Progress& progress)
{
    const VolumeInfo& info = source.info();
    const VoxelBox box = options.crop.value_or(VoxelBox{Size3(0), info.size});
    if (!glm::all(glm::greaterThanEqual(box.lower, Size3(0))) || !glm::all(glm::lessThanEqual(box.upper, info.size)) ||
        !glm::all(glm::lessThan(box.lower, box.upper))) {
        fail("crop: the box from ", box.lower.x, ",", box.lower.y, ",", box.lower.z, " to ", box.upper.x, ",",
             box.upper.y, ",", box.upper.z, " is empty or reaches outside the volume; expected one within 0,0,0 to ",
             info.size.x, ",", info.size.y, ",", info.size.z);
    }
    const glm::dvec3& sigma = options.blur_sigma_voxels;
    SHVR_CHECK(options.downscale >= 1 && options.downscale <= MAX_DOWNSCALE, options.downscale);
    SHVR_CHECK(glm::all(glm::greaterThanEqual(sigma, glm::dvec3(0.0))) &&
               glm::all(glm::lessThanEqual(sigma, glm::dvec3(MAX_SIGMA))));
    VolumeInfo after = info_after(source, options, box);
    const ImportBox taken(source, box, options.reverse, progress);
    if (sigma != glm::dvec3(0.0) || options.downscale != 1) return make_filter(std::move(after), taken, options);
    return std::make_unique<DirectPreparation>(std::move(after), taken);
}

}  // namespace shvr
