#pragma once
// Processes a volume's voxels before they are stored, slab by slab: crops to a box, reverses, blurs, downscales.
//
// A reversed voxel is (smallest + largest finite value of the whole volume before cropping) - voxel. So for every type
// the range of values stays the same, and parts of one volume stay comparable.
//
// The blur is a Gaussian sampled at voxel centres, up to int(4 sigma + 0.5) voxels on each side, normalised in double,
// and applied along x, then y, then z. At the faces of the cropped box, the outermost voxels are repeated. Intermediate
// sums are float for types of 8 and 16 bits and double for all others; integers are rounded to nearest, ties to even.
// NaN and infinite voxels stay as they are and do not spread: their neighbours are weighted means of finite voxels
// only.
//
// A voxel of a volume downscaled by N is the mean of N^3 voxels. Sizes are rounded up: at the volume's far faces, a
// voxel is the mean of those of its N^3 voxels that exist. Rounding and NaN are handled as in the blur.

#include <memory>
#include <optional>
#include <span>

#include "engine/base/waits/work_pool.h"
#include "engine/volume/source.h"

namespace shvr {

struct PreparationOptions {
    std::optional<VoxelBox> crop{};
    bool reverse = false;
    glm::dvec3 blur_sigma_voxels{0.0};  ///< sigma along x, y and z; 0: no blur along this axis
    int downscale = 1;
    bool operator==(const PreparationOptions&) const = default;
};
inline constexpr double MAX_SIGMA = 100.0;
inline constexpr int MAX_DOWNSCALE = 64;

/// Describes `options`, as in "cropped to ..., reversed"; empty if they change nothing.
std::string to_text(const PreparationOptions& options);

/// Returns the weights of a Gaussian from its centre outwards. The weights on both sides sum to 1. For sigma 0: {1}.
std::vector<double> gaussian_weights(double sigma_voxels);

class Preparation {
public:
    virtual ~Preparation() = default;

    /// Describes the result: its size, spacing and origin.
    const VolumeInfo& info() const { return info_; }

    /// `read` returns voxels of the result, x fastest: rows `lower_row` to `upper_row` (all rows if memory allows) of
    /// slices `lower` to `upper`. Fastest if slices are requested once, in order, and with the same rows. Only the
    /// thread that owns the pool may call this.
    struct Slab {
        int64_t lower = 0, upper = 0;          ///< z
        int64_t lower_row = 0, upper_row = 0;  ///< y
    };
    virtual void read(const Slab& slab, std::span<std::byte> voxels, WorkPool& pool) = 0;
    /// Returns an upper bound, in bytes, of the memory to read slabs of this size, without the slabs' own voxels.
    virtual double bytes(int64_t rows, int64_t slices, int workers) const = 0;

protected:
    explicit Preparation(VolumeInfo info) : info_(std::move(info)) {}

private:
    VolumeInfo info_;
};

/// Fails if the box does not lie inside the volume. `source` must outlive the result. Reversal needs a pass over all
/// voxels, which happens in this call.
std::unique_ptr<Preparation> make_preparation(const VolumeSource& source, const PreparationOptions& options);

}  // namespace shvr
