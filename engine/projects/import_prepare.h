#pragma once
// Processing of a volume's voxels before they are stored, slab by slab, in this order: crop to a box, reverse
// intensities, blur, shrink.
//
// A reversed voxel is the smallest plus the largest finite value of the whole volume, before cropping, minus the voxel.
// So the range of values stays the same for every type, and parts of one volume stay comparable.
//
// The blur is a Gaussian sampled at voxel centres, up to int(4 sigma + 0.5) voxels on each side, normalised in double,
// and applied along x, then y, then z. The outermost voxels of the cropped box are repeated outwards. Intermediate sums
// are float for types of 8 and 16 bits and double for all others; integers are rounded to nearest, ties to even. NaN
// and infinite voxels stay as they are and do not spread: their neighbours are weighted means of finite voxels only.
//
// A voxel of a volume downscaled by N is the mean of N^3 voxels. The size is rounded up: at the volume's end, a voxel
// is the mean of those of the N^3 voxels that exist. Rounding and NaN are handled as in the blur.

#include <memory>
#include <optional>
#include <span>

#include "engine/base/work_pool.h"
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

/// The weights of a Gaussian from its centre outwards; the weights of both sides sum to 1. {1} for a sigma of 0.
std::vector<double> gaussian_weights(double sigma_voxels);

class Preparation {
public:
    virtual ~Preparation() = default;

    /// Describes the result: its size, spacing and origin.
    const VolumeInfo& info() const { return info_; }

    /// Voxels of the result, x fastest: rows `lower_row` to `upper_row` (all rows if memory allows) of the slices
    /// `lower` to `upper`. Fastest if slices are requested once and in order, with the same rows. One thread at a time,
    /// the one that owns the pool.
    struct Slab {
        int64_t lower = 0, upper = 0;          ///< z
        int64_t lower_row = 0, upper_row = 0;  ///< y
    };
    virtual void read(const Slab& slab, std::span<std::byte> voxels, WorkPool& pool) = 0;
    /// An upper bound of the memory, in bytes, for reading slabs of this size, in addition to the slabs' voxels.
    virtual double bytes(int64_t rows, int64_t slices, int workers) const = 0;

protected:
    explicit Preparation(VolumeInfo info) : info_(std::move(info)) {}

private:
    VolumeInfo info_;
};

/// Fails if the box does not lie inside the volume. `source` must outlive the result. Reversing first takes an
/// additional pass over the voxels.
std::unique_ptr<Preparation> make_preparation(const VolumeSource& source, const PreparationOptions& options);

}  // namespace shvr
