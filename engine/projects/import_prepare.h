#pragma once
// Processing of a volume's voxels before they are stored, slab by slab, in this order: crop to a box, reverse
// intensities, blur, shrink.
//
// A reversed voxel is the smallest plus the largest finite value of the whole volume, before cropping, minus the voxel;
// so the range of values stays the same, whatever their type, and parts of one volume stay comparable.
//
// The blur is a Gaussian sampled at voxel centres, to int(4 sigma + 0.5) voxels on each side, normalised in double,
// along x, then y, then z. The outermost voxels of the cropped box are repeated outwards. Intermediate sums are float
// for types of 8 and 16 bits and double for all others; integers are rounded to nearest, ties to even. NaN and infinite
// voxels stay as they are and do not spread: their neighbours are the weighted mean of the finite ones.
//
// A voxel of a volume downscaled by N is the mean of N^3 voxels, or of those that exist at the volume's end; rounding
// and NaN as above. So the size is rounded up.

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

/// "cropped to ..., reversed": describes `options`; empty if they change nothing.
std::string to_text(const PreparationOptions& options);

/// The weights of a Gaussian from its centre outwards; both sides together sum to 1. {1} for a sigma of 0.
std::vector<double> gaussian_weights(double sigma_voxels);

class Preparation {
public:
    virtual ~Preparation() = default;

    /// The result: its size, spacing and origin.
    const VolumeInfo& info() const { return info_; }

    /// Voxels of the result, x fastest: the rows `rows` (all of them if memory allows) of the slices from `lower` to
    /// `upper`. Fastest if slices are requested once and in order, with the same rows. One thread at a time, the one
    /// that owns the pool.
    struct Slab {
        int64_t lower = 0, upper = 0;          ///< z
        int64_t lower_row = 0, upper_row = 0;  ///< y
    };
    virtual void read(const Slab& slab, std::span<std::byte> voxels, WorkPool& pool) = 0;
    /// An upper bound of the memory, in bytes, that reading slabs of that size takes in addition to their voxels.
    virtual double bytes(int64_t rows, int64_t slices, int workers) const = 0;

protected:
    explicit Preparation(VolumeInfo info) : info_(std::move(info)) {}

private:
    VolumeInfo info_;
};

/// Fails if the box does not lie inside the volume. `source` must outlive the result. Reversing needs an additional
/// pass over the voxels first.
std::unique_ptr<Preparation> make_preparation(const VolumeSource& source, const PreparationOptions& options);

}  // namespace shvr
