// Sparse images cost what they store, not what is missing.

#include <algorithm>
#include <set>
#include <tuple>

#include <doctest/doctest.h>

#include "engine/components/components.h"
#include "engine/formats/open_volume.h"
#include "engine/formats/zarr/zarr_chunks.h"
#include "engine/volume/content_hash.h"
#include "engine/volume/levels/pyramid_source.h"
#include "tests/support/sparse_zarr.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

namespace fs = std::filesystem;
constexpr int64_t HUGE_SIDE = int64_t{1} << 20;

uint8_t noise(int level, const Size3& voxel)
{
    return uint8_t(scrambled(uint32_t(voxel.x + 1000 * voxel.y + 1000000 * voxel.z + level)) % 251);
}

std::vector<Size3> some_chunks(const Size3& counts, uint32_t seed, int in_1000)
{
    std::vector<Size3> chunks;
    for (int64_t z = 0; z < counts.z; ++z)
        for (int64_t y = 0; y < counts.y; ++y)
            for (int64_t x = 0; x < counts.x; ++x)
                if (int(scrambled(seed + uint32_t(x + 100 * y + 10000 * z)) % 1000) < in_1000)
                    chunks.emplace_back(x, y, z);
    return chunks;
}

/// The listed chunks with index 1 along the first axis.
std::set<std::vector<int64_t>> listed(const ZarrChunks& chunks, int64_t most, bool& all)
{
    const std::vector<std::optional<int64_t>> at{1, {}, {}, {}};
    std::set<std::vector<int64_t>> found;
    all = chunks.list(at, most, [&](std::span<const int64_t> numbers) {
        CHECK(found.emplace(numbers.begin(), numbers.end()).second);
    });
    return found;
}

/// The same volume, without information on which chunks are stored.
class Unknowing final : public VolumeSource {
public:
    explicit Unknowing(std::shared_ptr<const VolumeSource> source)
        : VolumeSource(source->info()), source_(std::move(source))
    {}
    void read(const VoxelBox& box, std::span<std::byte> voxels) const override { source_->read(box, voxels); }

private:
    std::shared_ptr<const VolumeSource> source_;
};

}  // namespace

TEST_CASE("zarr: chunks are listed by their names, nested and flat, and nothing else is taken for one")
{
    const TemporaryFolder folder;
    for (const char separator : {'.', '/'}) {
        CAPTURE(separator);
        const fs::path array = folder.path / (separator == '.' ? "flat" : "nested");
        ZarrMetadata metadata{.shape = {2, 4, 5, 300}, .chunks = {1, 1, 1, 1}};
        metadata.separator = separator;
        const ZarrChunks chunks(zarr_folder(array), metadata);
        bool all = false;
        CHECK(listed(chunks, 10, all).empty());  // there is no folder
        CHECK(chunks.stray().empty());
        CHECK(all);
        const auto put = [&](const std::string& name) {
            std::string path = name;
            std::ranges::replace(path, '.', separator);
            fs::create_directories((array / path).parent_path());
            std::ofstream(array / path) << "x";
        };
        for (const char* name : {"1.0.0.0", "1.3.4.299", "1.2.0.17"}) put(name);
        CHECK(chunks.stray().empty());
        // Names of another channel; outside; with other spellings of numbers; with too many and too few of them.
        for (const char* name :
             {"0.0.0.0", "1.4.0.0", "1.0.5.1", "1.0.0.300", "1.00.0.1", "1.+1.0.0", "1.1.1.x", "1.1.2.-1", "1.1.3."})
            put(std::string(name) == "1.1.3." ? "1.1.3.y" : name);
        using Numbers = std::set<std::vector<int64_t>>;
        CHECK((listed(chunks, 3, all) == Numbers{{1, 0, 0, 0}, {1, 2, 0, 17}, {1, 3, 4, 299}}));
        CHECK(all);
        CHECK(listed(chunks, 2, all).size() == 2);
        CHECK(!all);
        CHECK_FALSE(chunks.stray().empty());
    }
}

TEST_CASE("zarr: a volume of 2^20 a side with few chunks is measured exactly, by what it stores")
{
    const TemporaryFolder folder;
    for (const char separator : {'.', '/'}) {
        CAPTURE(separator);
        const fs::path path = folder.path / (separator == '.' ? "flat" : "nested");
        const std::vector<Size3> chunks{{0, 0, 0}, {65535, 3, 40000}, {5, 65535, 65535}};
        write_sparse(
            path, {.size = Size3(HUGE_SIDE), .separator = separator, .fill = 7}, [&](int) { return chunks; }, noise);
        const auto source = open_volume(path);
        const VolumeStatistics found = measure(*source);
        std::vector<int64_t> counts(256);
        for (const Size3& chunk : chunks)
            for (int i = 0; i < 4096; ++i)
                ++counts[noise(0, chunk * int64_t{16} + Size3(i % 16, i / 16 % 16, i / 256))];
        counts[7] += (int64_t{1} << 60) - 3 * 4096;
        CHECK(found.histogram == statistics_of(counts, 0).histogram);
        CHECK(found.mean == statistics_of(counts, 0).mean);
        CHECK(found.minimum == statistics_of(counts, 0).minimum);
        CHECK(found.maximum == 250.0);
        CHECK(found.measured_level == 0);
        CHECK(found.sampled_voxels == 0);
        CHECK(measure(*source, {.exact = true}).mean == found.mean);
        const HashedSource hashed(*source);
        CHECK(measure(hashed).mean == found.mean);
        CHECK(hashed.hash().empty());
    }
}

TEST_CASE("zarr: where a store of 2^20 a side holds nothing is known at once, from the coarsest level on")
{
    const TemporaryFolder folder;
    write_sparse(
        folder.path / "a", {.size = Size3(HUGE_SIDE), .chunk = Size3(16), .levels = 4, .fill = 3},
        [](int level) { return level == 0 ? std::vector{Size3(40000, 2, 9)} : std::vector<Size3>(); }, noise);
    const auto source = open_volume(folder.path / "a");
    for (int level = 0; level < 4; ++level) {
        CAPTURE(level);
        const Size3 brick = Size3(40000 * 16, 2 * 16, 9 * 16) / (int64_t{32} << level);
        CHECK(!source->brick_range(level, brick));  // it stores something
        const auto gap = source->brick_range(level, brick + Size3(-5, 5, 0));
        REQUIRE(gap);
        CHECK(*gap == ValueRange{3.0, 3.0});
    }
    // A chunk that only a coarse level has counts, too.
    write_sparse(
        folder.path / "b", {.size = Size3(1 << 14), .chunk = Size3(16), .levels = 2},
        [](int level) { return level == 1 ? std::vector{Size3(4, 4, 4)} : std::vector<Size3>(); }, noise);
    const auto coarse = open_volume(folder.path / "b");
    CHECK(coarse->brick_range(0, {4, 4, 4}));
    CHECK(!coarse->brick_range(1, {2, 2, 2}));
}

TEST_CASE("zarr: labels of what is stored are those of the whole, whatever the chunks")
{
    const TemporaryFolder folder;
    int number = 0;
    for (const Size3 chunk : {Size3(16), Size3(7, 5, 9), Size3(64, 1, 1), Size3(1, 20, 3), Size3(70, 13, 13)})
        for (const int in_1000 : {0, 60, 400, 1000}) {
            const Size3 size(131, 42, 53);
            CAPTURE(number);
            const fs::path path = folder.path / std::to_string(number++);
            write_sparse(
                path, {.size = size, .chunk = chunk},
                [&](int) { return some_chunks((size - int64_t{1}) / chunk + int64_t{1}, uint32_t(number), in_1000); },
                noise);
            const std::shared_ptr<const VolumeSource> source = open_volume(path);
            REQUIRE(source->stored_blocks(0, 1 << 20));
            const Unknowing whole(source);
            for (const auto& [connectivity, threshold] :
                 {std::pair(Connectivity::faces, 150.0), {Connectivity::corners, 220.0}})
                for (const int threads : {1, 3}) {
                    const ComponentOptions options{.threshold = threshold,
                                                   .connectivity = connectivity,
                                                   .threads = threads,
                                                   .run_folder = folder.path};
                    const auto ours = find_components(*source, options), theirs = find_components(whole, options);
                    CHECK(ours->counts().found == theirs->counts().found);
                    CHECK(ours->counts().foreground_voxels == theirs->counts().foreground_voxels);
                    const auto labels = ours->labels();
                    CHECK(content_hash(*labels) == content_hash(*theirs->labels()));
                }
        }
}

TEST_CASE("zarr: components of 2^20 a side join over chunks and are found in what is stored alone")
{
    const TemporaryFolder folder;
    // Two chunks that touch, and one far away.
    write_sparse(
        folder.path / "a", {.size = Size3(HUGE_SIDE), .chunk = Size3(32)},
        [](int) {
            return std::vector{Size3(100, 200, 300), Size3(101, 200, 300), Size3(32767, 32767, 32767)};
        },
        [](int, const Size3&) { return uint8_t{200}; });
    const auto source = open_volume(folder.path / "a");
    ComponentOptions options{.threshold = 100.0, .threads = 2, .run_folder = folder.path};
    const auto components = find_components(*source, options);
    CHECK(components->counts().found == 2);
    CHECK(components->counts().largest_voxels == 2 * 32768);
    CHECK(components->counts().foreground_voxels == 3 * 32768);
    const auto labels = components->labels();
    CHECK(voxels_in<uint8_t>(*labels, {{3231, 6400, 9600}, {3233, 6401, 9601}}) == std::vector<uint8_t>{1, 1});
    CHECK(voxels_in<uint8_t>(*labels, {Size3(HUGE_SIDE - 1), Size3(HUGE_SIDE)}) == std::vector<uint8_t>{2});

    // All of the background would be one component.
    options.threshold = 0.0;
    CHECK(error_of([&] { find_components(*source, options); }) ==
          "a: holds 0 wherever nothing is stored, and the threshold is 0; expected one above that, or a volume whose "
          "slices have at most 8589934592 voxels");
}

TEST_CASE("levels of a sparse volume are those of a whole one, bit for bit, and its gaps are known")
{
    const TemporaryFolder folder;
    const Size3 size(323, 200, 131), chunk(16, 9, 20);
    write_sparse(
        folder.path / "a", {.size = size, .chunk = chunk, .fill = 5},
        [&](int) { return some_chunks((size - int64_t{1}) / chunk + int64_t{1}, 3, 30); }, noise);
    const std::shared_ptr<const VolumeSource> source = open_volume(folder.path / "a");
    const auto sparse = with_levels(source, uint64_t{1} << 30);
    const auto whole = with_levels(std::make_shared<Unknowing>(source), uint64_t{1} << 30);
    REQUIRE(sparse->levels() == whole->levels());
    int gaps = 0;
    for (int level = 0; level < sparse->levels(); ++level) {
        CAPTURE(level);
        const Size3 of_level = size_of_level(size, level);
        const VoxelBox all{Size3(0), of_level};
        std::vector<std::byte> ours(size_t(of_level.x * of_level.y * of_level.z)), theirs(ours.size());
        sparse->read_level(level, all, ours);
        whole->read_level(level, all, theirs);
        CHECK(ours == theirs);
        const Size3 bricks = size_of_level(of_level, 5);
        for (int64_t i = 0; i < bricks.x * bricks.y * bricks.z; ++i) {
            const Size3 brick(i % bricks.x, i / bricks.x % bricks.y, i / (bricks.x * bricks.y));
            const auto range = sparse->brick_range(level, brick);
            if (!range) continue;
            ++gaps;
            CHECK(*range == ValueRange{5.0, 5.0});
            const VoxelBox seen{glm::max(brick * int64_t{32} - int64_t{1}, Size3(0)),
                                glm::min((brick + int64_t{1}) * int64_t{32} + int64_t{1}, of_level)};
            std::vector<std::byte> voxels(size_t(seen.size().x * seen.size().y * seen.size().z));
            sparse->read_level(level, seen, voxels);
            CHECK(std::ranges::all_of(voxels, [](std::byte voxel) { return voxel == std::byte{5}; }));
        }
    }
    CHECK(gaps > 20);
}

TEST_CASE("levels of 2^20 a side take what is stored, also above levels that end too fine")
{
    const TemporaryFolder folder;
    for (const int levels : {1, 3}) {
        CAPTURE(levels);
        const fs::path path = folder.path / std::to_string(levels);
        write_sparse(
            path, {.size = Size3(HUGE_SIDE), .levels = levels},
            [](int level) {
                return std::vector{Size3(0), Size3(65535) / (int64_t{1} << level)};
            },
            [](int, const Size3&) { return uint8_t{200}; });
        const auto source = with_levels(open_volume(path), uint64_t{16} << 20);
        REQUIRE(source->levels() == 16);
        // All of the coarsest level is one brick: one of its voxels stands for 2^15 a side, of which 16 are not 0.
        std::vector<std::byte> voxels(32 * 32 * 32);
        source->read_level(15, {Size3(0), Size3(32)}, voxels);
        CHECK(std::ranges::all_of(voxels, [](std::byte voxel) { return voxel == std::byte{0}; }));
        std::vector<std::byte> fine(8);
        source->read_level(3, {Size3(131070), Size3(131072)}, fine);
        CHECK(std::ranges::all_of(fine, [](std::byte voxel) { return voxel == std::byte{200}; }));
        CHECK(!source->brick_range(15, Size3(0)));
        CHECK(source->brick_range(14, {1, 0, 0}) == std::optional(ValueRange{0.0, 0.0}));
        CHECK(!source->brick_range(14, {1, 1, 1}));
    }
}
