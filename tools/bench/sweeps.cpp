#include "tools/bench/sweeps.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>

#include "engine/base/text.h"
#include "engine/components/components.h"
#include "engine/projects/import_prepare.h"
#include "tests/reference/components.h"

namespace shvr::bench {

namespace {

constexpr int TIMES = 5;
constexpr double REFERENCE_REACH = 8.0;  // radius in sigmas, beyond which 1e-15 of the weights lie

/// Hash noise in 0 ... 1, a deterministic function of the position.
double noise_at(const Size3& at)
{
    auto x = uint32_t(at.x + 1009 * (at.y + 1013 * at.z)) * 0x9e3779b9u;
    x ^= x >> 16, x *= 0x7feb352du, x ^= x >> 15, x *= 0x846ca68bu, x ^= x >> 16;
    return double(x) / 4294967296.0;
}

double largest_of(VoxelType type)
{
    return type == VoxelType::uint8 ? 255.0 : type == VoxelType::uint16 ? 65535.0 : 1.0;
}

template <class T>
void store(double value, std::byte* to)
{
    const T voxel = static_cast<T>(value);
    std::memcpy(to, &voxel, sizeof(voxel));
}

template <class T>
double loaded(const std::byte* from)
{
    T voxel;
    std::memcpy(&voxel, from, sizeof(voxel));
    return double(voxel);
}

class NoiseSource final : public VolumeSource {
public:
    NoiseSource(int64_t side, VoxelType type) : VolumeSource(info_of(side, type)) {}

    double at(const Size3& voxel) const
    {
        const double value = noise_at(voxel) * largest_of(info().type);
        return is_float(info().type) ? double(float(value)) : std::floor(value);
    }
    void read(const VoxelBox& box, std::span<std::byte> voxels) const override
    {
        std::byte* to = voxels.data();
        for (int64_t z = box.lower.z; z < box.upper.z; ++z)
            for (int64_t y = box.lower.y; y < box.upper.y; ++y)
                for (int64_t x = box.lower.x; x < box.upper.x; ++x, to += bytes_of(info().type)) {
                    const double value = at({x, y, z});
                    if (info().type == VoxelType::uint8)
                        store<uint8_t>(value, to);
                    else if (info().type == VoxelType::uint16)
                        store<uint16_t>(value, to);
                    else
                        store<float>(value, to);
                }
    }

private:
    static VolumeInfo info_of(int64_t side, VoxelType type)
    {
        VolumeInfo info;
        info.size = Size3(side);
        info.type = type;
        return info;
    }
};

/// Returns the duration of a call in seconds: the median of several calls.
double median_seconds(const std::function<void()>& call)
{
    std::vector<double> seconds;
    for (int time = 0; time < TIMES; ++time) {
        const auto begun = std::chrono::steady_clock::now();
        call();
        seconds.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count());
    }
    std::ranges::nth_element(seconds, seconds.begin() + TIMES / 2);
    return seconds[TIMES / 2];
}

/// Blurs along one axis after the other, in double precision; outside the volume, its border values are repeated.
std::vector<double> blurred(std::vector<double> values, int64_t side, double sigma)
{
    const auto reach = int64_t(std::ceil(REFERENCE_REACH * sigma));
    std::vector<double> weights;
    double sum = 0.0;
    for (int64_t k = -reach; k <= reach; ++k) {
        weights.push_back(std::exp(-0.5 * double(k * k) / (sigma * sigma)));
        sum += weights.back();
    }
    const int64_t strides[] = {1, side, side * side};
    for (const int64_t stride : strides) {
        std::vector<double> next(values.size());
        for (int64_t i = 0; i < int64_t(values.size()); ++i) {
            const int64_t along = i / stride % side;
            double total = 0.0;
            for (int64_t k = -reach; k <= reach; ++k)
                total += weights[size_t(k + reach)] *
                         values[size_t(i + (std::clamp<int64_t>(along + k, 0, side - 1) - along) * stride)];
            next[size_t(i)] = total / sum;
        }
        values = std::move(next);
    }
    return values;
}

double number_at(std::span<const std::byte> voxels, size_t index, VoxelType type)
{
    const std::byte* const from = &voxels[index * bytes_of(type)];
    return type == VoxelType::uint8    ? loaded<uint8_t>(from)
           : type == VoxelType::uint16 ? loaded<uint16_t>(from)
           : type == VoxelType::uint32 ? loaded<uint32_t>(from)
                                       : loaded<float>(from);
}

SweepRow measured_blur(const NoiseSource& source, const std::vector<double>& truth, double sigma,
                       const SweepOptions& options)
{
    const VolumeInfo& info = source.info();
    const int64_t side = info.size.x;
    std::vector<std::byte> voxels(truth.size() * bytes_of(info.type));
    WorkPool pool(options.threads);
    const double seconds = median_seconds([&] {
        const auto preparation = make_preparation(source, {.blur_sigma_voxels = glm::dvec3(sigma)});
        preparation->read({0, side, 0, side}, voxels, pool);
    });
    double squares = 0.0;
    for (size_t i = 0; i < truth.size(); ++i) {
        const double off = number_at(voxels, i, info.type) - truth[i];
        squares += off * off;
    }
    return {.series = name_of(info.type),
            .setting = sentence("sigma ", digits_of(sigma)),
            .ns_per_voxel = 1e9 * seconds / double(truth.size()),
            .error = std::sqrt(squares / double(truth.size())) / largest_of(info.type)};
}

report::Plot plot_of(const std::vector<SweepRow>& rows, bool is_by_share)
{
    report::Plot plot;
    for (const SweepRow& row : rows) {
        const bool is_labelled = row.series == rows.back().series;  // one series represents all
        auto series = std::ranges::find(plot.series, row.series, &report::PlotSeries::name);
        if (series == plot.series.end()) {
            plot.series.push_back({row.series, {}, true, false});
            series = plot.series.end() - 1;
        }
        if (is_by_share)
            series->points.push_back({row.share, row.ns_per_voxel, {}, false});
        else
            series->points.push_back({row.ns_per_voxel, row.error, is_labelled ? row.setting : std::string(), false});
    }
    return plot;
}

}  // namespace

Sweep sweep_blur(const SweepOptions& options)
{
    const int64_t side = options.quick ? 24 : 64;
    Sweep sweep{.name = "blur",
                .what = sentence("Blurring noise of ", side,
                                 "^3 voxels before an import, to 4 sigma, against a direct "
                                 "sum in double to 8 sigma. Integers are rounded, which is most of their error."),
                .error = "RMS error, of the range of values",
                .rows = {},
                .plot = {}};
    for (const VoxelType type : {VoxelType::uint8, VoxelType::uint16, VoxelType::float32}) {
        const NoiseSource source(side, type);
        std::vector<double> values;
        for (int64_t i = 0; i < side * side * side; ++i)
            values.push_back(source.at({i % side, i / side % side, i / side / side}));
        for (const double sigma : options.quick ? std::vector{0.5, 2.0} : std::vector{0.5, 1.0, 2.0, 4.0}) {
            if (options.poll) options.poll();
            sweep.rows.push_back(measured_blur(source, blurred(values, side, sigma), sigma, options));
        }
    }
    sweep.plot = plot_of(sweep.rows, false);
    sweep.plot.title = "blur before an import";
    sweep.plot.x_label = "median time of a voxel, ns";
    sweep.plot.y_label = sweep.error;
    return sweep;
}

Sweep sweep_labelling(const SweepOptions& options)
{
    const int64_t side = options.quick ? 32 : 96;
    const NoiseSource source(side, VoxelType::uint8);
    const size_t count = size_t(side * side * side);
    Sweep sweep{.name = "labelling",
                .what = sentence("Labelling noise of ", side,
                                 "^3 voxels, against breadth-first labelling. It is exact, "
                                 "so what it costs is set against how many voxels are open; joined over faces, most "
                                 "of them belong to one component from 31 % on."),
                .error = "voxels with another label",
                .rows = {},
                .plot = {}};
    for (const Connectivity connectivity : {Connectivity::faces, Connectivity::corners})
        for (const double share : {1.0, 3.0, 10.0, 31.0, 50.0, 80.0}) {
            if (options.poll) options.poll();
            const double threshold = std::ceil(256.0 * (1.0 - share / 100.0));
            std::unique_ptr<Components> found;
            const double seconds = median_seconds([&] {
                found = find_components(source, {.threshold = threshold,
                                                 .connectivity = connectivity,
                                                 .threads = options.threads,
                                                 .run_folder = options.scratch});
            });
            const std::unique_ptr<VolumeSource> labels = found->labels();
            std::vector<std::byte> voxels(count * bytes_of(labels->info().type));
            labels->read({Size3(0), Size3(side)}, voxels);
            const std::vector<uint32_t> truth = reference::component_labels(
                Size3(side), [&](Size3 voxel) { return source.at(voxel) >= threshold; }, int(connectivity));
            size_t others = 0;
            for (size_t i = 0; i < count; ++i)
                others += number_at(voxels, i, labels->info().type) != double(truth[i]) ? 1 : 0;
            sweep.rows.push_back({.series = connectivity == Connectivity::faces ? "over faces" : "over corners",
                                  .setting = sentence(digits_of(share), " % open"),
                                  .share = share,
                                  .ns_per_voxel = 1e9 * seconds / double(count),
                                  .error = double(others)});
        }
    sweep.plot = plot_of(sweep.rows, true);
    sweep.plot.title = "labelling of noise";
    sweep.plot.x_label = "open voxels, percent";
    sweep.plot.y_label = "median time of a voxel, ns";
    return sweep;
}

std::string csv_of(const Sweep& sweep)
{
    if (!sweep.table.empty()) return sweep.table;
    std::string text = "series,setting,ns_per_voxel,error\n";
    for (const SweepRow& row : sweep.rows)
        text += sentence("\"", row.series, "\",\"", row.setting, "\",", digits_of(row.ns_per_voxel), ",",
                         digits_of(row.error), "\n");
    return text;
}

}  // namespace shvr::bench
