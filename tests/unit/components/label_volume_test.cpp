#include "engine/components/components.h"

#include <algorithm>
#include <atomic>
#include <functional>
#include <limits>
#include <random>

#include "engine/components/label_forest.h"
#include "engine/components/threshold_bits.h"
#include "tests/reference/components.h"
#include "tests/support/bounds.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

using Labels = std::vector<uint32_t>;

/// Voxels of 100 where `open`, else of 99; hands out blocks as it is told.
class BitSource final : public VolumeSource {
public:
    BitSource(const Size3& size, const reference::OpenVoxel& open, const Size3& block = Size3(1),
              std::optional<StoredBlocks> stored = {})
        : VolumeSource({.name = "bits", .format = "memory", .size = size}), block_(block), stored_(std::move(stored))
    {
        for (int64_t z = 0; z < size.z; ++z)
            for (int64_t y = 0; y < size.y; ++y)
                for (int64_t x = 0; x < size.x; ++x) voxels_.push_back(open({x, y, z}) ? 100 : 99);
    }
    Size3 block() const override { return block_; }
    std::optional<StoredBlocks> stored_blocks(int, int64_t) const override { return stored_; }
    bool is_open(const Size3& at) const { return voxels_[index(at)] == 100; }
    void read(const VoxelBox& box, std::span<std::byte> voxels) const override
    {
        auto* to = voxels.data();
        for (int64_t z = box.lower.z; z < box.upper.z; ++z)
            for (int64_t y = box.lower.y; y < box.upper.y; ++y, to += box.size().x)
                std::memcpy(to, voxels_.data() + index({box.lower.x, y, z}), size_t(box.size().x));
    }

private:
    size_t index(const Size3& at) const { return size_t(at.x + info().size.x * (at.y + info().size.y * at.z)); }
    std::vector<uint8_t> voxels_;
    Size3 block_;
    std::optional<StoredBlocks> stored_;
};

ComponentOptions options_of(int connectivity, int threads)
{
    return {.threshold = 100.0,
            .connectivity = connectivity == 6 ? Connectivity::faces : Connectivity::corners,
            .threads = threads,
            .run_folder = std::filesystem::temp_directory_path()};
}

template <class T>
Labels labels_in(const VolumeSource& source, const VoxelBox& box)
{
    const Size3 size = box.size();
    std::vector<T> voxels(size_t(size.x * size.y * size.z));
    source.read(box, std::as_writable_bytes(std::span(voxels)));
    return {voxels.begin(), voxels.end()};
}

Labels labels_of(const VolumeSource& source, const VoxelBox& box)
{
    if (source.info().type == VoxelType::uint8) return labels_in<uint8_t>(source, box);
    if (source.info().type == VoxelType::uint16) return labels_in<uint16_t>(source, box);
    return labels_in<uint32_t>(source, box);
}

/// Exactly what a breadth-first search finds, with one thread and with several, with whole blocks and without.
void check_against_search(const Size3& size, const reference::OpenVoxel& open, int connectivity)
{
    const BitSource voxels(size, open);
    const auto is_open = [&](const Size3& at) { return voxels.is_open(at); };
    const Labels expected = reference::component_labels(size, is_open, connectivity);
    const uint32_t count = expected.empty() ? 0 : *std::ranges::max_element(expected);
    for (const int threads : {1, 3})
        for (const int64_t block : {1, 5}) {
            CAPTURE(threads);
            CAPTURE(block);
            const BitSource source(size, is_open, Size3(block));
            const auto components = find_components(source, options_of(connectivity, threads));
            CHECK(components->counts().found == count);
            CHECK(components->counts().kept == count);
            CHECK(components->counts().foreground_voxels ==
                  int64_t(expected.size()) - std::ranges::count(expected, 0u));
            const Labels found = labels_of(*components->labels(), {Size3(0), size});
            REQUIRE(found.size() == expected.size());
            size_t differing = 0;
            for (size_t i = 0; i < found.size(); ++i) differing += found[i] != expected[i];
            check_below("differing voxels", double(differing), 0.0);
        }
}

reference::OpenVoxel noise(double density, uint32_t seed)
{
    auto random = std::make_shared<std::mt19937>(seed);
    return [=](const Size3&) { return double((*random)()) < density * 4294967296.0; };
}

}  // namespace

TEST_CASE("labels of noise at the percolation thresholds are those of a breadth-first search")
{
    for (uint32_t seed = 0; seed < 20; ++seed) {
        CAPTURE(seed);
        const Size3 size(48 + seed % 3 * 17, 40, 37 + seed % 2);
        check_against_search(size, noise(0.3116, seed), 6);
        check_against_search(size, noise(0.0976, seed), 26);
        check_against_search(size, noise(0.5, seed), seed % 2 == 0 ? 6 : 26);
    }
}

TEST_CASE("labels of shapes that are hard to follow are those of a breadth-first search")
{
    const Size3 size(67, 21, 35);
    const auto in_xz_spiral = [](const Size3& v) {
        const int64_t ring = std::min({v.x, v.z, 66 - v.x, 34 - v.z});
        return ring % 2 == 0 || (v.x == ring && v.z == ring + 1);
    };
    const std::pair<const char*, reference::OpenVoxel> shapes[] = {
        {"empty", [](const Size3&) { return false; }},
        {"full", [](const Size3&) { return true; }},
        {"one voxel, the last", [](const Size3& v) { return v == Size3(66, 20, 34); }},
        {"checkerboard", [](const Size3& v) { return (v.x + v.y + v.z) % 2 == 0; }},
        {"comb along x", [](const Size3& v) { return v.x % 2 == 0 || v.z == 34; }},
        {"comb along y", [](const Size3& v) { return v.y % 2 == 0 || (v.x == 66 && v.z == 0); }},
        {"comb along z", [](const Size3& v) { return v.z % 2 == 0 || (v.x == 0 && v.y == 20); }},
        {"comb turned round", [](const Size3& v) { return v.x % 2 == 0 || (v.z == 0 && v.y == 3); }},
        {"spiral", in_xz_spiral},
        {"the other side of a spiral", [&](const Size3& v) { return !in_xz_spiral(v); }},
        {"diagonal", [](const Size3& v) { return v.x == v.y && v.y == v.z; }},
        {"diagonal the other way", [](const Size3& v) { return v.x == 20 - v.y && v.y == v.z; }},
        {"all six faces", [](const Size3& v) { return v.x == 33 || v.y == 10 || v.z == 17; }},
        {"hull", [](const Size3& v) { return v.x % 66 == 0 || v.y % 20 == 0 || v.z % 34 == 0; }}};
    for (const auto& [name, open] : shapes)
        for (const int connectivity : {6, 26}) {
            CAPTURE(std::string(name));
            CAPTURE(connectivity);
            check_against_search(size, open, connectivity);
        }
}

TEST_CASE("components join wherever ranges and slabs of slices meet")
{
    // Threads take ranges of 16 slices or more, so that every z is the seam of some volume.
    for (int64_t depth = 1; depth < 70; ++depth) {
        CAPTURE(depth);
        check_against_search({9, 7, depth}, noise(0.35, uint32_t(depth)), 6);
        check_against_search({9, 7, depth}, noise(0.12, uint32_t(depth)), 26);
        // Two columns that meet in the last slice alone.
        check_against_search(
            {3, 1, depth}, [=](const Size3& v) { return v.x != 1 || v.z == depth - 1; }, 6);
    }
}

TEST_CASE("runs and gaps of any length, across words of bits and up to the ends of rows")
{
    for (const int64_t width : {63, 64, 65, 128, 700}) {
        CAPTURE(width);
        for (const int64_t length : {1, 2, 63, 64, 65, 254, 255, 256, 300}) {
            CAPTURE(length);
            const auto bars = [=](const Size3& v) { return (v.x + 13 * v.y + 7 * v.z) / length % 2 == 0; };
            check_against_search({width, 4, 5}, bars, 6);
            check_against_search({width, 4, 5}, bars, 26);
        }
        check_against_search({width, 9, 9}, noise(0.3, uint32_t(width)), 6);
        check_against_search({width, 9, 9}, noise(0.1, uint32_t(width)), 26);
    }
}

TEST_CASE("blocks of a sparse volume, next to each other or not, have the components of the whole")
{
    // Blocks of 64 voxels: the bits of blocks that do not touch lie next to each other.
    const Size3 size(330, 20, 30), block(64, 6, 7), counts = (size + block - int64_t{1}) / block;
    for (uint32_t seed = 0; seed < 12; ++seed) {
        CAPTURE(seed);
        std::mt19937 random(seed);
        StoredBlocks stored{.block = block};
        std::vector<bool> is_stored(size_t(counts.x * counts.y * counts.z));
        const auto place = [&](const Size3& at) { return size_t(at.x + counts.x * (at.y + counts.y * at.z)); };
        for (Size3 at(0); at.z < counts.z; ++at.z)
            for (at.y = 0; at.y < counts.y; ++at.y)
                for (at.x = 0; at.x < counts.x; ++at.x) {
                    is_stored[place(at)] = random() % 3 > 0;
                    if (is_stored[place(at)]) stored.blocks.emplace_back(at);
                }
        const reference::OpenVoxel full = noise(seed % 2 == 0 ? 0.9 : 0.3, seed);
        const BitSource source(
            size, [&](const Size3& v) { return full(v) && is_stored[place(v / block)]; }, block, stored);
        for (const int connectivity : {6, 26})
            for (const int threads : {1, 3}) {
                const auto is_open = [&](const Size3& at) { return source.is_open(at); };
                const Labels expected = reference::component_labels(size, is_open, connectivity);
                const auto components = find_components(source, options_of(connectivity, threads));
                CHECK(components->counts().found == *std::ranges::max_element(expected));
                CHECK((labels_of(*components->labels(), {Size3(0), size}) == expected));
            }
    }
}

TEST_CASE("a label counts more voxels than 32 bits hold")
{
    LabelForest one;
    const uint32_t first = one.add(), second = one.add();
    constexpr int64_t MANY = int64_t{3} << 31;
    for (int i = 0; i < 5; ++i) one.add_voxels(second, MANY + i);
    one.add_voxels(first, 7);
    CHECK(one.voxels(first) == 7);
    CHECK(one.voxels(second) == 5 * MANY + 10);
    LabelForest both;
    both.add_voxels(both.add(), MANY);
    const auto base = uint32_t(both.append(std::move(one)));
    CHECK(both.voxels(0) == MANY);
    CHECK(both.voxels(base + second) == 5 * MANY + 10);
    CHECK(both.take_voxels(base + second) == 5 * MANY + 10);
    CHECK(both.voxels(base + second) == 0);
    CHECK(both.voxels(base + first) == 7);
}

TEST_CASE("boxes of labels are parts of the whole")
{
    const Size3 size(100, 30, 40);
    const BitSource source(size, noise(0.3, 5));
    const auto labels = find_components(source, options_of(6, 2))->labels();  // which outlives what it came from
    const Labels whole = labels_of(*labels, {Size3(0), size});
    std::mt19937 random(1);
    for (int i = 0; i < 50; ++i) {
        VoxelBox box;
        for (int axis = 0; axis < 3; ++axis) {
            box.lower[axis] = int64_t(random() % uint32_t(size[axis]));
            box.upper[axis] = box.lower[axis] + 1 + int64_t(random() % uint32_t(size[axis] - box.lower[axis]));
        }
        Labels expected;
        for (int64_t z = box.lower.z; z < box.upper.z; ++z)
            for (int64_t y = box.lower.y; y < box.upper.y; ++y)
                for (int64_t x = box.lower.x; x < box.upper.x; ++x)
                    expected.push_back(whole[size_t(x + size.x * (y + size.y * z))]);
        CHECK((labels_of(*labels, box) == expected));
    }
}

TEST_CASE("the type of labels is the smallest that holds them")
{
    for (const auto& [count, type] : {std::pair(255, VoxelType::uint8),
                                      {256, VoxelType::uint16},
                                      {65535, VoxelType::uint16},
                                      {65536, VoxelType::uint32}}) {
        const int64_t wanted = count;
        const BitSource source({512, 512, 1}, [=](const Size3& v) {
            return v.x % 2 == 0 && v.y % 2 == 0 && v.x / 2 + 256 * (v.y / 2) < wanted;
        });
        const auto components = find_components(source, options_of(26, 1));
        CHECK(components->counts().found == count);
        const auto labels = components->labels();
        CHECK(labels->info().type == type);
        const Labels voxels = labels_of(*labels, {Size3(0), source.info().size});
        CHECK(*std::ranges::max_element(voxels) == uint32_t(count));
    }
}

TEST_CASE("small components are left out, and all but the largest; the others keep their order")
{
    // Rods of 3, 1, 4, 1, 5, 4 and 2 voxels.
    const std::vector<int64_t> rods{3, 1, 4, 1, 5, 4, 2};
    const BitSource source({8, 14, 2},
                           [&](const Size3& v) { return v.z == 1 && v.y % 2 == 0 && v.x < rods[size_t(v.y / 2)]; });
    const auto sizes = [&](int64_t fewest, int64_t most) {
        ComponentOptions options = options_of(6, 1);
        options.fewest_voxels = fewest;
        options.max_components = most;
        const auto components = find_components(source, options);
        const Components::Counts& counts = components->counts();
        CHECK(counts.found == 7);
        CHECK(counts.foreground_voxels == 20);
        CHECK(counts.largest_voxels == 5);
        const Labels labels = labels_of(*components->labels(), {Size3(0), source.info().size});
        std::vector<int64_t> found(size_t(counts.kept));
        for (const uint32_t label : labels)
            if (label > 0) ++found.at(label - 1);
        int64_t sum = 0;
        for (const Components::Component& component : counts.largest) {
            CHECK(found.at(component.label - 1) == component.voxels);
            sum += component.voxels;
        }
        CHECK(sum == counts.kept_voxels);
        CHECK(int64_t(counts.largest.size()) == counts.kept);
        CHECK(std::ranges::is_sorted(counts.largest, [](const auto& a, const auto& b) {
            return a.voxels != b.voxels ? a.voxels > b.voxels : a.label < b.label;
        }));
        return found;
    };
    using Sizes = std::vector<int64_t>;
    CHECK((sizes(1, 0) == rods));
    CHECK((sizes(2, 0) == Sizes{3, 4, 5, 4, 2}));
    CHECK((sizes(1, 1) == Sizes{5}));
    CHECK((sizes(1, 2) == Sizes{4, 5}));  // the first of equal ones
    CHECK((sizes(1, 3) == Sizes{4, 5, 4}));
    CHECK((sizes(4, 100) == Sizes{4, 5, 4}));
    CHECK((sizes(5, 2) == Sizes{5}));
    CHECK((sizes(6, 0) == Sizes{}));
}

TEST_CASE_TEMPLATE("a voxel is in where it is at or above the threshold, whatever its type", T, uint8_t, int8_t,
                   uint16_t, int16_t, uint32_t, int32_t, float, double)
{
    constexpr VoxelType TYPE = std::is_same_v<T, uint8_t>    ? VoxelType::uint8
                               : std::is_same_v<T, int8_t>   ? VoxelType::int8
                               : std::is_same_v<T, uint16_t> ? VoxelType::uint16
                               : std::is_same_v<T, int16_t>  ? VoxelType::int16
                               : std::is_same_v<T, uint32_t> ? VoxelType::uint32
                               : std::is_same_v<T, int32_t>  ? VoxelType::int32
                               : std::is_same_v<T, float>    ? VoxelType::float32
                                                             : VoxelType::float64;
    using Limits = std::numeric_limits<T>;
    std::vector<T> row{0, 1, 2, 99, 100, 101, 127, Limits::lowest(), Limits::max()};
    if constexpr (std::is_signed_v<T>) row.insert(row.end(), {T(-1), T(-100)});
    if constexpr (!std::is_integral_v<T>)
        row.insert(row.end(), {T(99.5), T(0.1), Limits::infinity(), -Limits::infinity(), Limits::quiet_NaN()});
    for (size_t i = 0; row.size() < 150; ++i) row.push_back(row[i * 7 % 9]);
    constexpr double INFINITE = std::numeric_limits<double>::infinity();
    for (const double threshold : {0.0, 0.1, 99.0, 99.5, 100.0, 100.5, 255.0, 256.0, -1.0, -0.5, -1e300, 1e300, 65535.5,
                                   4294967295.0, 4294967296.0, -2147483648.5, INFINITE, -INFINITE}) {
        CAPTURE(threshold);
        for (const size_t count : {row.size(), size_t{64}, size_t{63}, size_t{1}, size_t{128}}) {
            std::vector<uint64_t> words((count + 63) / 64, ~uint64_t{0});
            ThresholdBits(TYPE, threshold).convert(std::as_bytes(std::span(row).first(count)), words);
            size_t wrong = 0;
            for (size_t i = 0; i < words.size() * 64; ++i)
                wrong += (words[i / 64] >> i % 64 & 1) != (i < count && double(row[i]) >= threshold);
            CHECK(wrong == 0);
        }
    }
}

TEST_CASE("what is held while labelling depends on a slice and on the labels, not on the depth")
{
    const auto held = [](int64_t depth, int threads) {
        const BitSource source({256, 64, depth}, [](const Size3& v) { return v.x % 2 == 0 && v.y % 2 == 0; });
        return find_components(source, options_of(6, threads))->counts();
    };
    const Components::Counts shallow = held(128, 1), deep = held(1024, 1);  // both in several slabs
    CHECK(shallow.found == 128 * 32);
    CHECK(deep.found == 128 * 32);
    CHECK(deep.peak_bytes == shallow.peak_bytes);
    // Four slices of runs (a range's first, the last two, and how vectors grow), and a strip of voxels with its bits.
    CHECK(deep.peak_bytes <= deep.forest_bytes + 2 * (4 * 128 * 32 * 12) + (1 << 20) + (1 << 20) / 8 + (1 << 14));
    CHECK(deep.forest_bytes <= 16384 * 8 + 64);
    CHECK(deep.run_file_bytes == 1024 * (128 * 32 * 6 + 32 * 16));
    // Two threads take eight ranges, of which each has a forest and some slices of its own.
    CHECK(held(1024, 2).peak_bytes <= 8 * (16384 * 8 + 64 + 2 * (4 * 128 * 32 * 12)) + 2 * ((1 << 20) + (1 << 18)));
}

TEST_CASE("voxels that are known to be below the threshold are not read")
{
    class Ranged final : public VolumeSource {
    public:
        Ranged() : VolumeSource({.name = "ranged", .format = "memory", .size = {200, 64, 64}}) {}
        void read(const VoxelBox& box, std::span<std::byte> voxels) const override
        {
            read_voxels += box.size().x * box.size().y * box.size().z;
            for (int64_t x = 0, i = 0; i < int64_t(voxels.size()); ++i, x = i % box.size().x)
                voxels[size_t(i)] = std::byte{box.lower.x + x == 100 ? uint8_t{200} : uint8_t{0}};
        }
        std::optional<ValueRange> brick_range(int, const Size3& brick) const override
        {
            return ValueRange{0.0, brick.x == 3 ? 200.0 : 0.0};
        }
        mutable std::atomic<int64_t> read_voxels = 0;
    };
    const Ranged source;
    CHECK(find_components(source, options_of(6, 1))->counts().foreground_voxels == 64 * 64);
    CHECK(source.read_voxels == 64 * 64 * 64);
    source.read_voxels = 0;
    ComponentOptions options = options_of(6, 1);
    options.threshold = 201.0;
    CHECK(find_components(source, options)->counts().found == 0);
    CHECK(source.read_voxels == 0);
}
