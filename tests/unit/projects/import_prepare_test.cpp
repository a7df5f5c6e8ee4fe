// Processing of voxels before they are stored, compared with direct convolution and averaging in double.

#include "engine/projects/import_prepare.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

#include <doctest/doctest.h>

#include "tests/support/bounds.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

template <class T>
constexpr VoxelType TYPE = VoxelType::uint8;
template <>
constexpr VoxelType TYPE<int8_t> = VoxelType::int8;
template <>
constexpr VoxelType TYPE<uint16_t> = VoxelType::uint16;
template <>
constexpr VoxelType TYPE<int16_t> = VoxelType::int16;
template <>
constexpr VoxelType TYPE<int32_t> = VoxelType::int32;
template <>
constexpr VoxelType TYPE<float> = VoxelType::float32;
template <>
constexpr VoxelType TYPE<double> = VoxelType::float64;

/// A block of numbers, x fastest; its border is repeated outwards.
struct Block {
    Size3 size{0};
    std::vector<double> values;

    size_t index(int64_t x, int64_t y, int64_t z) const { return size_t(x + size.x * (y + size.y * z)); }
    double at(int64_t x, int64_t y, int64_t z) const
    {
        return values[index(std::clamp<int64_t>(x, 0, size.x - 1), std::clamp<int64_t>(y, 0, size.y - 1),
                            std::clamp<int64_t>(z, 0, size.z - 1))];
    }
    template <class Function>
    void for_each(const Function& function) const
    {
        for (int64_t z = 0; z < size.z; ++z)
            for (int64_t y = 0; y < size.y; ++y)
                for (int64_t x = 0; x < size.x; ++x) function(x, y, z);
    }
};

template <class T>
Block random_block(const Size3& size, uint32_t seed)
{
    std::mt19937 numbers(seed);
    Block block{size, {}};
    block.values.resize(size_t(size.x * size.y * size.z));
    for (double& value : block.values) {
        const double share = double(numbers()) / 4294967296.0;
        if constexpr (std::is_integral_v<T>) {
            using Limits = std::numeric_limits<T>;
            value = std::floor(double{Limits::min()} + share * (double{Limits::max()} - double{Limits::min()} + 1.0));
        } else {
            value = double(static_cast<T>(share));
        }
    }
    return block;
}

template <class T>
MemorySource source_of(const Block& block)
{
    std::vector<T> voxels;
    for (const double value : block.values) voxels.push_back(static_cast<T>(value));
    return memory_source<T>(block.size, TYPE<T>, voxels);
}

/// The whole result, in slabs of `slices` and bands of `rows` (0: all).
template <class T>
Block prepared(const VolumeSource& source, const PreparationOptions& options, int64_t slices = 0, int64_t rows = 0,
               int threads = 2)
{
    const auto preparation = make_preparation(source, options);
    const Size3 size = preparation->info().size;
    if (slices == 0) slices = size.z;
    if (rows == 0) rows = size.y;
    Block result{size, std::vector<double>(size_t(size.x * size.y * size.z))};
    WorkPool pool(threads);
    for (int64_t y = 0; y < size.y; y += rows) {
        for (int64_t z = 0; z < size.z; z += slices) {
            const Preparation::Slab slab{z, std::min(size.z, z + slices), y, std::min(size.y, y + rows)};
            const Size3 extent(size.x, slab.upper_row - slab.lower_row, slab.upper - slab.lower);
            std::vector<T> voxels(size_t(extent.x * extent.y * extent.z));
            preparation->read(slab, std::as_writable_bytes(std::span(voxels)), pool);
            const Block part{extent, {voxels.begin(), voxels.end()}};
            part.for_each([&](int64_t i, int64_t j, int64_t k) {
                result.values[result.index(i, y + j, z + k)] = part.values[part.index(i, j, k)];
            });
        }
    }
    return result;
}

/// Direct convolution in three dimensions, in double.
Block convolved(const Block& block, const glm::dvec3& sigma)
{
    std::array<std::vector<double>, 3> weights;
    for (int axis = 0; axis < 3; ++axis) {
        const auto reach = int64_t(4.0 * sigma[axis] + 0.5);
        double sum = 0.0;
        for (int64_t k = -reach; k <= reach; ++k) {
            const double distance = k == 0 ? 0.0 : double(k) / sigma[axis];
            weights[size_t(axis)].push_back(std::exp(-0.5 * distance * distance));
            sum += weights[size_t(axis)].back();
        }
        for (double& weight : weights[size_t(axis)]) weight /= sum;
    }
    const auto reach = [&](size_t axis) { return int64_t(weights[axis].size() / 2); };
    Block result = block;
    block.for_each([&](int64_t x, int64_t y, int64_t z) {
        double sum = 0.0;
        for (int64_t k = -reach(2); k <= reach(2); ++k)
            for (int64_t j = -reach(1); j <= reach(1); ++j)
                for (int64_t i = -reach(0); i <= reach(0); ++i)
                    sum += weights[0][size_t(i + reach(0))] * weights[1][size_t(j + reach(1))] *
                           weights[2][size_t(k + reach(2))] * block.at(x + i, y + j, z + k);
        result.values[block.index(x, y, z)] = sum;
    });
    return result;
}

double largest_difference(const Block& a, const Block& b)
{
    REQUIRE(a.size == b.size);
    double largest = 0.0;
    for (size_t i = 0; i < a.values.size(); ++i) largest = std::max(largest, std::abs(a.values[i] - b.values[i]));
    return largest;
}

PreparationOptions blur(double x, double y, double z)
{
    return {.blur_sigma_voxels = {x, y, z}};
}

template <class T>
void check_integers()
{
    const Block block = random_block<T>(Size3(17), 5);
    for (const double sigma : {0.5, 1.0, 1.5, 2.3}) {
        const Block exact = convolved(block, glm::dvec3(sigma));
        const Block found = prepared<T>(source_of<T>(block), blur(sigma, sigma, sigma));
        CAPTURE(sizeof(T));
        CAPTURE(sigma);
        test::check_below(sizeof(T) == 1 ? "8 bits, levels" : "16 bits, levels", largest_difference(exact, found),
                          0.5 + (sizeof(T) == 1 ? 1e-4 : 2e-2));
    }
    for (const double constant : {double{std::numeric_limits<T>::min()}, double{std::numeric_limits<T>::max()}, 7.0}) {
        const Block flat{Size3(9, 8, 7), std::vector<double>(9 * 8 * 7, constant)};
        CHECK(prepared<T>(source_of<T>(flat), blur(2.0, 1.0, 0.7)).values == flat.values);
    }
}

}  // namespace

TEST_CASE("blur: weights are a sampled Gaussian that sums to 1")
{
    for (const double sigma : {0.3, 0.5, 1.0, 1.5, 2.0, 5.0, 100.0}) {
        const std::vector<double> weights = gaussian_weights(sigma);
        REQUIRE(weights.size() == size_t(4.0 * sigma + 0.5) + 1);
        double sum = weights[0], variance = 0.0;
        float sum_of_floats = float(weights[0]);
        for (size_t k = 1; k < weights.size(); ++k) {
            sum += 2.0 * weights[k];
            sum_of_floats += 2.0f * float(weights[k]);
            variance += 2.0 * weights[k] * double(k * k);
        }
        CAPTURE(sigma);
        test::check_below("sum of weights", std::abs(sum - 1.0), 1e-15);
        if (sigma <= 5.0) test::check_below("sum of floats", std::abs(double(sum_of_floats) - 1.0), 1.3e-7);
        if (sigma >= 1.0) test::check_below("width", std::abs(std::sqrt(variance) / sigma - 1.0), 1e-3);
    }
    CHECK(gaussian_weights(0.0) == std::vector<double>{1.0});
}

TEST_CASE("blur: floats agree with direct convolution to 1e-6 of their range, at borders too")
{
    const Block block = random_block<float>(Size3(17), 1);
    for (const double sigma : {0.5, 1.0, 1.5, 2.3}) {
        CAPTURE(sigma);
        test::check_below("floats",
                          largest_difference(convolved(block, glm::dvec3(sigma)),
                                             prepared<float>(source_of<float>(block), blur(sigma, sigma, sigma))),
                          1e-6);
    }
    const Block doubles = random_block<double>(Size3(17, 16, 5), 2);
    test::check_below("doubles",
                      largest_difference(convolved(doubles, {1.0, 2.0, 0.0}),
                                         prepared<double>(source_of<double>(doubles), blur(1.0, 2.0, 0.0))),
                      1e-14);
}

TEST_CASE("blur: integers are rounded to nearest, and what is constant stays so exactly")
{
    check_integers<uint8_t>();
    check_integers<int8_t>();
    check_integers<uint16_t>();
    check_integers<int16_t>();
    const Block block = random_block<int32_t>(Size3(11), 6);
    CHECK(largest_difference(convolved(block, glm::dvec3(1.5)),
                             prepared<int32_t>(source_of<int32_t>(block), blur(1.5, 1.5, 1.5))) <= 0.5 + 1e-5);
}

TEST_CASE("blur: each axis has its own sigma, also where it reaches beyond the volume")
{
    const Block block = random_block<float>(Size3(7, 5, 3), 3);
    for (const glm::dvec3& sigma :
         {glm::dvec3(2, 0, 0), glm::dvec3(0, 2, 0), glm::dvec3(0, 0, 2), glm::dvec3(0.8, 3, 5)}) {
        CAPTURE(sigma.x);
        test::check_below("floats",
                          largest_difference(convolved(block, sigma),
                                             prepared<float>(source_of<float>(block), blur(sigma.x, sigma.y, sigma.z))),
                          1e-6);
    }
    const Block one{Size3(1), {0.25}};
    CHECK(prepared<float>(source_of<float>(one), blur(2, 2, 2)).values == one.values);
}

TEST_CASE("blur: a sigma of 0 changes nothing")
{
    const Block block = random_block<uint16_t>(Size3(20, 9, 8), 4);
    for (const double sigma : {0.0, 0.1}) {
        CAPTURE(sigma);
        const Block blurred = prepared<uint16_t>(source_of<uint16_t>(block), blur(sigma, sigma, sigma));
        test::check_below("levels", largest_difference(block, blurred), 0.0);
    }
}

TEST_CASE("blur: the response to one voxel is symmetric bit for bit under mirrors and exchanges of axes")
{
    Block impulse{Size3(13), std::vector<double>(13 * 13 * 13)};
    impulse.values[impulse.index(6, 6, 6)] = 1.0;
    const Block response = prepared<float>(source_of<float>(impulse), blur(1.2, 1.2, 1.2));
    int64_t differing = 0;
    impulse.for_each([&](int64_t x, int64_t y, int64_t z) {
        for (const double other : {response.at(12 - x, y, z), response.at(x, 12 - y, z), response.at(x, y, 12 - z),
                                   response.at(y, x, z), response.at(x, z, y)})
            differing += other != response.at(x, y, z);
    });
    test::check_below("differing voxels", double(differing), 0.0);
}

TEST_CASE("blur: away from borders, two in a row are one of the root of the sum of squares")
{
    const Block block = random_block<float>(Size3(30), 7);
    const Block once = prepared<float>(source_of<float>(block), blur(1.0, 1.0, 1.0));
    const Block twice = prepared<float>(source_of<float>(once), blur(1.5, 1.5, 1.5));
    const double together = std::sqrt(1.0 + 2.25);
    const Block direct = prepared<float>(source_of<float>(block), blur(together, together, together));
    double most = 0.0;
    block.for_each([&](int64_t x, int64_t y, int64_t z) {
        const int64_t to_border = std::min({x, y, z, 29 - x, 29 - y, 29 - z});
        if (to_border >= 10) most = std::max(most, std::abs(twice.at(x, y, z) - direct.at(x, y, z)));
    });
    test::check_below("of the range", most, 2e-3);
}

TEST_CASE("blur: slabs, bands, threads and blocks of the source do not matter, bit for bit")
{
    /// Voxels that are best read in blocks.
    class Blocked final : public VolumeSource {
    public:
        explicit Blocked(MemorySource source) : VolumeSource(source.info()), source_(std::move(source)) {}
        void read(const VoxelBox& box, std::span<std::byte> voxels) const override { source_.read(box, voxels); }
        Size3 block() const override { return {8, 4, 5}; }

    private:
        MemorySource source_;
    };
    const Block block = random_block<uint16_t>(Size3(37, 29, 23), 8);
    for (const PreparationOptions& options :
         {blur(1.4, 0.9, 1.1), PreparationOptions{.reverse = true, .downscale = 3},
          PreparationOptions{
              .crop = VoxelBox{{3, 2, 1}, {36, 25, 22}}, .blur_sigma_voxels = {0.7, 0.7, 2.0}, .downscale = 2},
          PreparationOptions{.crop = VoxelBox{{1, 2, 3}, {30, 20, 21}}, .reverse = true}}) {
        const Block whole = prepared<uint16_t>(source_of<uint16_t>(block), options);
        for (const int64_t slices : {1, 2, 7}) {
            for (const int64_t rows : {0, 1, 5}) {
                const int threads = 1 + int(rows);
                CHECK(prepared<uint16_t>(source_of<uint16_t>(block), options, slices, rows, threads).values ==
                      whole.values);
                CHECK(prepared<uint16_t>(Blocked(source_of<uint16_t>(block)), options, slices, rows, threads).values ==
                      whole.values);
            }
        }
    }
}

TEST_CASE("blur: voxels that are no numbers stay, and their neighbours are the mean of the finite ones")
{
    Block block = random_block<float>(Size3(12, 11, 10), 9);
    std::vector<float> voxels(block.values.begin(), block.values.end());
    const size_t nan = block.index(3, 4, 5);
    const size_t infinity = block.index(7, 0, 2);
    voxels[nan] = std::numeric_limits<float>::quiet_NaN();
    voxels[infinity] = -std::numeric_limits<float>::infinity();
    const Block found = prepared<float>(memory_source<float>(block.size, VoxelType::float32, voxels), blur(1, 1, 1), 3);

    Block values = block;
    Block shares{block.size, std::vector<double>(block.values.size(), 1.0)};
    for (const size_t hole : {nan, infinity}) values.values[hole] = shares.values[hole] = 0.0;
    const Block sums = convolved(values, glm::dvec3(1.0));
    const Block weights = convolved(shares, glm::dvec3(1.0));
    CHECK(std::isnan(found.values[nan]));
    CHECK(found.values[infinity] == -std::numeric_limits<double>::infinity());
    for (size_t i = 0; i < found.values.size(); ++i) {
        if (i != nan && i != infinity) REQUIRE(std::abs(found.values[i] - sums.values[i] / weights.values[i]) < 1e-6);
    }
}

TEST_CASE("making a volume smaller averages the voxels there are, ties to even")
{
    const Block block = random_block<int16_t>(Size3(11, 10, 7), 10);
    for (const int factor : {1, 2, 3, 5, 12}) {
        const Block found = prepared<int16_t>(source_of<int16_t>(block), {.downscale = factor}, 2);
        REQUIRE(found.size == (block.size + int64_t{factor - 1}) / int64_t{factor});
        found.for_each([&](int64_t x, int64_t y, int64_t z) {
            double sum = 0.0;
            int count = 0;
            for (int64_t k = z * factor; k < std::min(block.size.z, (z + 1) * factor); ++k)
                for (int64_t j = y * factor; j < std::min(block.size.y, (y + 1) * factor); ++j)
                    for (int64_t i = x * factor; i < std::min(block.size.x, (x + 1) * factor); ++i, ++count)
                        sum += block.at(i, j, k);
            REQUIRE(found.at(x, y, z) == std::nearbyint(sum / count));
        });
    }
    const Block ties{Size3(4, 1, 1), {0, 1, 2, 3}};
    CHECK(prepared<uint8_t>(source_of<uint8_t>(ties), {.downscale = 2}).values == std::vector<double>{0, 2});
}

TEST_CASE("reversed intensities are the volume's smallest plus largest less the voxel, of every type, before it is cut")
{
    const auto reversed = [](auto zero, const Block& block, const PreparationOptions& options = {.reverse = true}) {
        using T = decltype(zero);
        return prepared<T>(source_of<T>(block), options);
    };
    const auto check_every_type = [&](const std::vector<double>& values, const std::vector<double>& expected) {
        const Block block{Size3(int64_t(values.size()), 1, 1), values};
        CHECK(reversed(uint8_t{}, block).values == expected);
        CHECK(reversed(int8_t{}, block).values == expected);
        CHECK(reversed(uint16_t{}, block).values == expected);
        CHECK(reversed(int16_t{}, block).values == expected);
        CHECK(reversed(int32_t{}, block).values == expected);
        CHECK(reversed(float{}, block).values == expected);
        CHECK(reversed(double{}, block).values == expected);
    };
    check_every_type({5, 1, 127, 127}, {123, 127, 1, 1});
    check_every_type({7}, {7});
    const Block lowest{Size3(3, 1, 1), {-2147483648.0, 2147483647.0, 5.0}};
    CHECK(reversed(int32_t{}, lowest).values == std::vector<double>{2147483647.0, -2147483648.0, -6.0});
    const Block odd{Size3(4, 1, 1), {1.5, NAN, INFINITY, 4.0}};
    const std::vector<double> floats = reversed(float{}, odd).values;
    CHECK((floats[0] == 4.0 && std::isnan(floats[1]) && floats[2] == -INFINITY && floats[3] == 1.5));
    // A part is reversed as the whole is.
    const PreparationOptions part{.crop = VoxelBox{{0, 0, 0}, {2, 1, 1}}, .reverse = true};
    CHECK(reversed(uint8_t{}, Block{Size3(4, 1, 1), {5, 1, 127, 127}}, part).values == std::vector<double>{123, 127});
    const Block block = random_block<uint16_t>(Size3(9), 11);
    CHECK(reversed(uint16_t{}, reversed(uint16_t{}, block)).values == block.values);
}

TEST_CASE("a box is cut out, and where it lies is kept")
{
    const Block block = random_block<uint8_t>(Size3(9, 8, 7), 12);
    std::vector<uint8_t> voxels(block.values.begin(), block.values.end());
    const auto bytes = std::as_bytes(std::span(voxels));
    VolumeInfo info{.name = "memory", .size = block.size, .type = VoxelType::uint8, .spacing = {0.5, 1.0, 2.0}};
    info.origin = {100.0, 200.0, 300.0};
    info.directions = glm::dmat3(glm::dvec3(0, 1, 0), glm::dvec3(-1, 0, 0), glm::dvec3(0, 0, 1));
    const MemorySource source(info, {bytes.begin(), bytes.end()});
    const PreparationOptions options{.crop = VoxelBox{{2, 3, 1}, {8, 7, 7}}, .downscale = 2};
    const VolumeInfo after = make_preparation(source, options)->info();
    CHECK(after.size == Size3(3, 2, 3));
    CHECK(after.spacing == glm::dvec3(1.0, 2.0, 4.0));
    // The centre of its first voxel lies between voxels 2 and 3 along x, 3 and 4 along y, 1 and 2 along z.
    CHECK(after.origin == glm::dvec3(100.0 - 3.5 * 1.0, 200.0 + 2.5 * 0.5, 300.0 + 1.5 * 2.0));
    const Block cut = prepared<uint8_t>(source, {.crop = options.crop});
    cut.for_each([&](int64_t x, int64_t y, int64_t z) { REQUIRE(cut.at(x, y, z) == block.at(x + 2, y + 3, z + 1)); });
    for (const VoxelBox& box :
         {VoxelBox{{0, 0, 0}, {10, 8, 7}}, VoxelBox{{-1, 0, 0}, {9, 8, 7}}, VoxelBox{{4, 0, 0}, {4, 8, 7}}}) {
        CHECK(
            contains(error_of([&] { make_preparation(source, {.crop = box}); }), "expected one within 0,0,0 to 9,8,7"));
    }
    CHECK(to_text(options) == "cropped to voxels 2,3,1 to 8,7,7, made 2 times smaller");
    CHECK(to_text(PreparationOptions{}).empty());
}
