#include "engine/projects/import_filter.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <deque>
#include <type_traits>

#include "engine/projects/blur.h"
#include "engine/volume/voxel_dispatch.h"

namespace shvr {
namespace {

/// Memory limits: voxels as read from the source (READ_BYTES), and slices waiting to be blurred along z (PLANE_BYTES).
constexpr int64_t READ_BYTES = int64_t{32} << 20;
constexpr int64_t PLANE_BYTES = int64_t{96} << 20;
constexpr int64_t TASK_ROWS = 8;

template <class T>
using Number = std::conditional_t<std::is_integral_v<T> && sizeof(T) <= 2, float, double>;

/// Converts a row of T to a row of floating-point numbers, in blocks whose length is known at compile time.
template <class T>
void widen(const T* from, Number<T>* to, size_t length)
{
    size_t i = 0;
    for (; i + BLUR_BLOCK <= length; i += BLUR_BLOCK) {
        T in[BLUR_BLOCK];
        Number<T> out[BLUR_BLOCK];
        std::memcpy(in, from + i, sizeof(in));
        for (size_t j = 0; j < BLUR_BLOCK; ++j) out[j] = static_cast<Number<T>>(in[j]);
        std::memcpy(to + i, out, sizeof(out));
    }
    for (; i < length; ++i) to[i] = static_cast<Number<T>>(from[i]);
}

/// Rounds to nearest, ties to even, by adding and subtracting 1.5 * 2^23 in float (1.5 * 2^52 in double). This is
/// correct for all values of types of up to 16 (32) bits.
template <class T>
T to_voxel(Number<T> number)
{
    if constexpr (std::is_floating_point_v<T>) {
        return static_cast<T>(number);
    } else if constexpr (sizeof(T) <= 2) {
        constexpr float SHIFT = 12582912.0f;
        return static_cast<T>(int32_t((number + SHIFT) - SHIFT));
    } else {
        constexpr double SHIFT = 6755399441055744.0;
        return static_cast<T>(int64_t((number + SHIFT) - SHIFT));
    }
}

template <class T>
void narrow(const Number<T>* from, T* to, size_t length)
{
    size_t i = 0;
    for (; i + BLUR_BLOCK <= length; i += BLUR_BLOCK) {
        T out[BLUR_BLOCK];
        for (size_t j = 0; j < BLUR_BLOCK; ++j) out[j] = to_voxel<T>(from[i + j]);
        std::memcpy(to + i, out, sizeof(out));
    }
    for (; i < length; ++i) to[i] = to_voxel<T>(from[i]);
}

template <class T>
bool all_finite(std::span<const T> voxels)
{
    if constexpr (std::is_floating_point_v<T>) {
        return std::ranges::all_of(voxels, [](T voxel) { return std::isfinite(voxel); });
    }
    return true;
}

/// A slice blurred along x and y. Successive rows start padded_length(size.x) elements apart.
template <class T>
struct Plane {
    std::vector<Number<T>> values;
    // Used only if a voxel is not finite: the blurred fraction of finite voxels, by which values are divided, and the
    // slice before blurring.
    std::vector<Number<T>> shares;
    std::vector<T> original;
};

template <class T>
class FilteredPreparation final : public Preparation {
public:
    FilteredPreparation(VolumeInfo info, const ImportBox& box, const PreparationOptions& options)
        : Preparation(std::move(info)),
          box_(box),
          size_(box.size()),
          factor_(options.downscale),
          pitch_(padded_length(size_t(size_.x)))
    {
        for (int axis = 0; axis < 3; ++axis) {
            for (const double weight : gaussian_weights(options.blur_sigma_voxels[axis])) {
                weights_[axis].push_back(static_cast<Number<T>>(weight));
            }
        }
        ones_.assign(pitch_, Number<T>{1});
    }

    void read(const Slab& slab, std::span<std::byte> voxels, WorkPool& pool) override
    {
        scratch_.resize(size_t(pool.workers()));
        const int64_t lower_row = slab.lower_row * factor_;
        const int64_t upper_row = std::min(slab.upper_row * factor_, size_.y);
        if (lower_row != lower_row_ || upper_row != upper_row_) planes_.clear();
        lower_row_ = lower_row;
        upper_row_ = upper_row;
        const auto plane_bytes = int64_t(pitch_ * sizeof(Number<T>)) * (upper_row - lower_row);
        const int64_t at_once = (PLANE_BYTES / plane_bytes - 2 * reach(2)) / factor_;
        const int64_t step = std::clamp<int64_t>(at_once, 1, slab.upper - slab.lower);
        const auto slice_bytes = size_t(info().size.x * (slab.upper_row - slab.lower_row)) * sizeof(T);
        for (int64_t z = slab.lower; z < slab.upper; z += step) {
            const Slab part{z, std::min(slab.upper, z + step), slab.lower_row, slab.upper_row};
            const std::span<std::byte> out =
                voxels.subspan(size_t(z - slab.lower) * slice_bytes, size_t(part.upper - z) * slice_bytes);
            make_planes(std::max<int64_t>(0, part.lower * factor_ - reach(2)),
                        std::min(size_.z, part.upper * factor_ + reach(2)), pool);
            const int64_t rows = slab.upper_row - slab.lower_row;
            pool.run((rows + TASK_ROWS - 1) / TASK_ROWS, [&](int64_t task, int /*worker*/) {
                const int64_t first = task * TASK_ROWS;
                make_rows(part, first, std::min(rows, first + TASK_ROWS), out);
            });
        }
    }

    double bytes(int64_t rows, int64_t slices, int workers) const override
    {
        const int64_t rows_held = std::min(rows * factor_, size_.y);
        const int64_t rows_read = std::min(rows_held + 2 * reach(1), size_.y);
        const double numbers = double(pitch_) * sizeof(Number<T>);
        const double plane = numbers * double(rows_held);
        const double slice = double(size_.x) * double(rows_read) * sizeof(T);
        const double most = std::min(double(slices * factor_), std::max(1.0, double(PLANE_BYTES) / plane));
        // Also counts spare planes, which the blur along z has passed. If values may be non-finite, a plane also has
        // the blurred fraction of finite values, and the original values.
        const double planes = most + double(factor_ + 4 * reach(2) + 1);
        const double kinds = std::is_floating_point_v<T> ? 2.0 * plane + slice : plane;
        const auto at_once = double(std::max<int64_t>(1, box_.block().z));
        const double read = std::max({double(READ_BYTES), slice, at_once * slice});
        const double scratch = numbers * double(rows_read) + (std::is_floating_point_v<T> ? slice : 0.0);
        return planes * kinds + read + double(workers) * scratch +
               box_.bytes({size_.x, rows_read, std::max<int64_t>(1, box_.block().z)}, workers);
    }

private:
    int64_t reach(size_t axis) const { return int64_t(weights_[axis].size()) - 1; }

    // ---- Along x and y, slice by slice ----

    /// Makes those planes from `lower` to `upper` that do not exist yet.
    void make_planes(int64_t lower, int64_t upper, WorkPool& pool)
    {
        const int64_t end = first_plane_ + int64_t(planes_.size());
        if (planes_.empty() || lower < first_plane_ || lower > end) {
            planes_.clear();
            first_plane_ = lower;
        }
        for (; first_plane_ < lower && !planes_.empty(); ++first_plane_) {
            spare_.push_back(std::move(planes_.front()));
            planes_.pop_front();
        }
        first_plane_ = lower;
        const int64_t row_bytes = size_.x * int64_t(sizeof(T));
        const int64_t lower_row = std::max<int64_t>(0, lower_row_ - reach(1));
        const int64_t upper_row = std::min(size_.y, upper_row_ + reach(1));
        const int64_t slice_bytes = row_bytes * (upper_row - lower_row);
        const int64_t at_once = std::max<int64_t>({1, READ_BYTES / slice_bytes, box_.block().z});
        for (int64_t z = first_plane_ + int64_t(planes_.size()); z < upper;) {
            const int64_t slices = std::min(at_once, upper - z);
            read_.resize(size_t(slices * slice_bytes));
            box_.read({{0, lower_row, z}, {size_.x, upper_row, z + slices}}, read_, pool);
            const size_t first_new = planes_.size();
            for (int64_t slice = 0; slice < slices; ++slice) planes_.push_back(take_spare());
            pool.run(slices, [&](int64_t slice, int worker) {
                const T* const voxels = reinterpret_cast<const T*>(read_.data() + slice * slice_bytes);
                make_plane(voxels, lower_row, upper_row, planes_[first_new + size_t(slice)], scratch_[size_t(worker)]);
            });
            z += slices;
        }
    }

    /// Reuses a spare plane if there is one, to avoid an allocation.
    Plane<T> take_spare()
    {
        if (spare_.empty()) return {};
        Plane<T> plane = std::move(spare_.back());
        spare_.pop_back();
        plane.shares.clear();
        plane.original.clear();
        return plane;
    }

    struct Scratch {
        std::vector<Number<T>> line, rows;
        std::vector<T> finite;
    };

    void make_plane(const T* voxels, int64_t lower_row, int64_t upper_row, Plane<T>& plane, Scratch& scratch) const
    {
        const auto count = size_t(size_.x * (upper_row - lower_row));
        if (all_finite(std::span(voxels, count))) {
            blur_slice(voxels, lower_row, upper_row, plane.values, scratch);
            return;
        }
        const auto kept = size_t(size_.x * (lower_row_ - lower_row));
        plane.original.assign(voxels + kept, voxels + kept + size_.x * (upper_row_ - lower_row_));
        std::vector<T>& finite = scratch.finite;
        finite.assign(voxels, voxels + count);
        for (T& voxel : finite) voxel = std::isfinite(double(voxel)) ? voxel : T{0};
        blur_slice(finite.data(), lower_row, upper_row, plane.values, scratch);
        for (size_t i = 0; i < count; ++i) finite[i] = std::isfinite(double(voxels[i])) ? T{1} : T{0};
        blur_slice(finite.data(), lower_row, upper_row, plane.shares, scratch);
    }

    void blur_slice(const T* voxels, int64_t lower_row, int64_t upper_row, std::vector<Number<T>>& out,
                    Scratch& scratch) const
    {
        const auto length = size_t(size_.x);
        const auto around = size_t(reach(0));
        const auto rows_in = size_t(upper_row - lower_row);
        out.resize(pitch_ * size_t(upper_row_ - lower_row_));
        // Without a blur along y, the rows are written directly into the plane.
        std::vector<Number<T>>& rows = reach(1) > 0 ? scratch.rows : out;
        rows.resize(pitch_ * rows_in);
        scratch.line.resize(2 * around + pitch_ + BLUR_BLOCK);
        Number<T>* const line = scratch.line.data() + around;
        for (size_t y = 0; y < rows_in; ++y) {
            const T* const row = voxels + y * length;
            if (around == 0) {
                widen(row, rows.data() + y * pitch_, length);
                continue;
            }
            widen(row, line, length);
            std::fill(scratch.line.data(), line, line[0]);
            std::fill(line + length, line + length + around, line[length - 1]);
            filter_row<Number<T>>(weights_[0], line, rows.data() + y * pitch_, length);
        }
        if (reach(1) == 0) return;
        const auto row_at = [&](int64_t y) {
            return rows.data() + pitch_ * size_t(std::clamp<int64_t>(y, 0, size_.y - 1) - lower_row);
        };
        std::vector<const Number<T>*> before(weights_[1].size() - 1), after(before.size());
        for (int64_t y = lower_row_; y < upper_row_; ++y) {
            for (int64_t k = 1; k <= reach(1); ++k) {
                before[size_t(k - 1)] = row_at(y - k);
                after[size_t(k - 1)] = row_at(y + k);
            }
            filter_rows<Number<T>>(weights_[1], row_at(y), before.data(), after.data(),
                                   out.data() + pitch_ * size_t(y - lower_row_), pitch_);
        }
    }

    // ---- Along z, and combined ----

    const Plane<T>& plane_at(int64_t z) const
    {
        return planes_[size_t(std::clamp<int64_t>(z, 0, size_.z - 1) - first_plane_)];
    }

    /// Filters a row of a slice along z; row 0 is the first row that the planes contain. `of` selects the member of the
    /// planes to filter. If a plane lacks that member (`shares`), its values count as 1.
    void filter_z(int64_t z, int64_t row, std::vector<Number<T>> Plane<T>::*of, Number<T>* out) const
    {
        const auto row_of = [&](int64_t at) {
            const std::vector<Number<T>>& numbers = plane_at(at).*of;
            return numbers.empty() ? ones_.data() : numbers.data() + pitch_ * size_t(row);
        };
        const size_t pairs = weights_[2].size() - 1;
        constexpr size_t MOST = 4 * size_t(MAX_SIGMA) + 1;
        const Number<T>* before[MOST];
        const Number<T>* after[MOST];
        for (size_t k = 0; k < pairs; ++k) {
            before[k] = row_of(z - int64_t(k) - 1);
            after[k] = row_of(z + int64_t(k) + 1);
        }
        filter_rows<Number<T>>(weights_[2], row_of(z), before, after, out, pitch_);
    }

    /// Computes a blurred row of a slice. Where the source has NaN, the result has NaN.
    void blurred_row(int64_t z, int64_t row, std::vector<Number<T>>& out, std::vector<Number<T>>& shares) const
    {
        filter_z(z, row, &Plane<T>::values, out.data());
        if constexpr (std::is_floating_point_v<T>) {
            bool is_whole = true;
            for (int64_t at = z - reach(2); at <= z + reach(2); ++at)
                is_whole = is_whole && plane_at(at).shares.empty();
            if (is_whole) return;
            filter_z(z, row, &Plane<T>::shares, shares.data());
            const std::vector<T>& original = plane_at(z).original;
            for (int64_t x = 0; x < size_.x; ++x) {
                const auto i = size_t(x);
                const T voxel = original.empty() ? T{0} : original[size_t(x + size_.x * row)];
                out[i] = std::isfinite(voxel) ? out[i] / shares[i] : static_cast<Number<T>>(voxel);
            }
        }
    }

    void make_rows(const Slab& slab, int64_t first_row, int64_t end_row, std::span<std::byte> out) const
    {
        std::vector<Number<T>> row(pitch_), shares(pitch_);
        const int64_t rows = slab.upper_row - slab.lower_row;
        T* const voxels = reinterpret_cast<T*>(out.data());
        for (int64_t z = slab.lower; z < slab.upper; ++z) {
            for (int64_t y = first_row; y < end_row; ++y) {
                T* const to = voxels + info().size.x * (y + rows * (z - slab.lower));
                if (factor_ == 1) {
                    blurred_row(z, y, row, shares);
                    narrow<T>(row.data(), to, size_t(size_.x));
                } else {
                    make_small_row(z, y, row, shares, to);
                }
            }
        }
    }

    void make_small_row(int64_t z, int64_t y, std::vector<Number<T>>& row, std::vector<Number<T>>& shares, T* out) const
    {
        const auto length = size_t(info().size.x);
        std::vector<double> sums(length);
        std::vector<int64_t> counts(length);
        for (int64_t from_z = z * factor_; from_z < std::min(size_.z, (z + 1) * factor_); ++from_z) {
            const int64_t end = std::min(upper_row_ - lower_row_, (y + 1) * factor_);
            for (int64_t from_y = y * factor_; from_y < end; ++from_y) {
                blurred_row(from_z, from_y, row, shares);
                for (int64_t x = 0; x < size_.x; ++x) {
                    const auto number = double(row[size_t(x)]);
                    if (std::is_floating_point_v<T> && !std::isfinite(number)) continue;
                    sums[size_t(x / factor_)] += number;
                    ++counts[size_t(x / factor_)];
                }
            }
        }
        for (size_t x = 0; x < sums.size(); ++x) {
            const double mean = sums[x] / double(counts[x]);  // 0 / 0 gives NaN, as intended
            if constexpr (std::is_floating_point_v<T>) {
                out[x] = static_cast<T>(mean);
            } else {
                out[x] = to_voxel<T>(static_cast<Number<T>>(std::nearbyint(mean)));
            }
        }
    }

    ImportBox box_;
    Size3 size_;  ///< size of the box
    int64_t factor_;
    size_t pitch_;
    std::array<std::vector<Number<T>>, 3> weights_;
    std::vector<Number<T>> ones_;

    int64_t lower_row_ = 0, upper_row_ = 0;  ///< range of the box's rows that planes contain
    int64_t first_plane_ = 0;
    std::deque<Plane<T>> planes_;
    std::vector<Plane<T>> spare_;
    std::vector<std::byte> read_;
    std::vector<Scratch> scratch_;
};

}  // namespace

std::unique_ptr<Preparation> make_filter(VolumeInfo info, const ImportBox& box, const PreparationOptions& options)
{
    return with_voxel_type(box.type(), [&]<class T>(T) -> std::unique_ptr<Preparation> {
        return std::make_unique<FilteredPreparation<T>>(std::move(info), box, options);
    });
}

}  // namespace shvr
