// Imports of what is stored alone, against imports that go through all voxels.

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include <doctest/doctest.h>

#include "engine/formats/open_volume.h"
#include "engine/formats/zarr/project.h"
#include "engine/projects/import_volume.h"
#include "engine/session/session.h"
#include "engine/volume/content_hash.h"
#include "engine/volume/grid.h"
#include "tests/support/slow.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

/// Noise in some blocks, and the fill value elsewhere. `listed`: what it says that it stores.
template <class T>
class Noise final : public VolumeSource {
public:
    Noise(const Size3& size, VoxelType type, T fill, StoredBlocks stored, StoredBlocks listed)
        : VolumeSource(volume(size, type)), fill_(fill), stored_(std::move(stored)), listed_(std::move(listed))
    {
        listed_.fill = double(fill);
        for (const glm::ivec3& block : stored_.blocks) is_stored_.insert(index_of(Size3(block)));
    }
    void read(const VoxelBox& box, std::span<std::byte> voxels) const override
    {
        ++reads;
        if (reads == fails_at) fail("noise: cannot be read");
        T* to = reinterpret_cast<T*>(voxels.data());
        for (int64_t z = box.lower.z; z < box.upper.z; ++z)
            for (int64_t y = box.lower.y; y < box.upper.y; ++y)
                for (int64_t x = box.lower.x; x < box.upper.x;) {
                    const int64_t end = std::min(box.upper.x, (x / stored_.block.x + 1) * stored_.block.x);
                    if (!is_stored_.contains(index_of(Size3(x, y, z) / stored_.block)))
                        to = std::fill_n(to, end - x, fill_);
                    else
                        for (int64_t i = x; i < end; ++i) *to++ = noise_at({i, y, z});
                    x = end;
                }
    }
    Size3 block() const override { return stored_.block; }
    std::optional<StoredBlocks> stored_blocks(int level, int64_t) const override
    {
        return level == 0 ? std::optional(listed_) : std::nullopt;
    }
    mutable std::atomic<int> reads = 0;
    int fails_at = -1;

private:
    static VolumeInfo volume(const Size3& size, VoxelType type)
    {
        VolumeInfo info = volume_of_size(size, {0.5, 1.0, 2.0});
        info.type = type;
        info.unit = "um";
        return info;
    }
    static int64_t index_of(const Size3& block) { return block.x + (block.y << 20) + (block.z << 40); }
    T noise_at(const Size3& voxel) const
    {
        const auto number = uint32_t(voxel.x / 3 + 31 * (voxel.y / 2) + 977 * voxel.z) * 2654435761U;
        if (std::is_floating_point_v<T> && number % 11 == 0) return std::numeric_limits<T>::quiet_NaN();
        return static_cast<T>(number >> 22);
    }
    T fill_;
    StoredBlocks stored_, listed_;
    std::set<int64_t> is_stored_;
};

std::map<std::string, std::string> import_files(const std::filesystem::path& folder)
{
    std::map<std::string, std::string> files;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
        if (entry.is_regular_file())
            files[entry.path().lexically_relative(folder).string()] = bytes_of_file(entry.path());
    return files;
}

/// All blocks that do not meet one chunk, in which nothing is stored below.
StoredBlocks all_but_one_chunk(const Size3& size, const Size3& block)
{
    const VoxelBox chunk{{128, 0, 128}, {192, 64, 192}};
    StoredBlocks all{.block = block};
    const Size3 counts = (size - int64_t{1}) / block + int64_t{1};
    for (int64_t z = 0; z < counts.z; ++z)
        for (int64_t y = 0; y < counts.y; ++y)
            for (int64_t x = 0; x < counts.x; ++x) {
                const Size3 at(x, y, z);
                if (!meet({at * block, (at + int64_t{1}) * block}, chunk)) all.blocks.emplace_back(x, y, z);
            }
    return all;
}

template <class T>
void compare_ways(const Size3& size, VoxelType type, T fill, const StoredBlocks& stored, ImportOptions options = {})
{
    CAPTURE(std::string(name_of(type)));
    CAPTURE(double(fill));
    const Noise<T> told(size, type, fill, stored, stored);
    const Noise<T> padded(size, type, fill, stored, all_but_one_chunk(size, stored.block));
    const TemporaryFolder folder;
    const std::filesystem::path origin = folder.path / "noise";
    for (const char* const name : {"a", "b"}) std::filesystem::create_directory(folder.path / name);
    double fraction = 0.0;
    options.progress = [&](const ImportProgress& progress) { fraction = progress.fraction; };
    const ImportReport of_stored = import_volume(told, origin, folder.path / "a" / "p", options);
    const ImportReport of_all = import_volume(padded, origin, folder.path / "b" / "p", options);
    CHECK(told.reads < padded.reads);
    CHECK(import_files(folder.path / "a") == import_files(folder.path / "b"));
    CHECK(of_stored.levels == of_all.levels);
    CHECK(of_stored.bricks == of_all.bricks);
    CHECK(of_stored.bricks_stored == of_all.bricks_stored);
    CHECK(of_stored.bytes == of_all.bytes);
    CHECK(fraction <= 1.0);
}

/// Of 36 chunks up to four have something stored.
const Size3 ODD{210, 151, 141};
const StoredBlocks FEW{.block = Size3(32), .blocks = {{6, 4, 0}, {3, 3, 2}, {3, 3, 3}, {6, 4, 4}}};
const StoredBlocks SKEW{.block = Size3(48, 60, 20), .blocks = {{1, 0, 1}, {4, 2, 5}}};

}  // namespace

// Kind (Sparse volumes): fills other than 0 and NaN, cut chunks, blocks across chunks
TEST_CASE("a project made of what is stored has the bytes of one made of everything")
{
    const StoredBlocks& few = FEW;
    compare_ways<uint8_t>(ODD, VoxelType::uint8, 0, few);
    compare_ways<int16_t>(ODD, VoxelType::int16, -7, SKEW);
    compare_ways<float>(ODD, VoxelType::float32, std::numeric_limits<float>::quiet_NaN(), few);
    if (!is_slow()) return;
    compare_ways<uint16_t>(ODD, VoxelType::uint16, 700, few, {.halving = Halving::label});
    compare_ways<float>(ODD, VoxelType::float32, -0.1f, SKEW);
    compare_ways<double>(ODD, VoxelType::float64, 0.5, few);
    compare_ways<int32_t>(ODD, VoxelType::int32, -100000, SKEW, {.version = OmeZarrVersion::v0_5, .has_shards = true});
    // Large enough to be hashed in chunks, with lists instead of tables.
    compare_ways<uint8_t>({8200, 520, 260}, VoxelType::uint8, 9, few);
}

TEST_CASE("of a cropped volume the stored part is imported, and shards hold what is stored")
{
    compare_ways<uint16_t>(ODD, VoxelType::uint16, 3, SKEW,
                           {.preparation = {.crop = VoxelBox{{0, 1, 7}, {209, 151, 140}}},
                            .version = OmeZarrVersion::v0_5,
                            .has_shards = true});
}

TEST_CASE("an import of what is stored goes on where it failed")
{
    const TemporaryFolder folder;
    const std::filesystem::path origin = folder.path / "noise";
    const ImportOptions options{.threads = 1};
    Noise<uint8_t> source(ODD, VoxelType::uint8, 0, FEW, FEW);
    std::filesystem::create_directory(folder.path / "whole");
    import_volume(source, origin, folder.path / "whole" / "p", options);
    const int reads = source.reads;
    bool was_resumed = false;
    for (int at = 2; at < reads; at += 3) {
        source.reads = 0;
        source.fails_at = at;
        const std::filesystem::path project = folder.path / std::to_string(at) / "p";
        std::filesystem::create_directories(project.parent_path());
        CHECK(contains(error_of([&] { import_volume(source, origin, project, options); }), "what is done is kept in"));
        source.reads = 0;
        source.fails_at = -1;
        was_resumed = import_volume(source, origin, project, options).was_resumed || was_resumed;
        CHECK(source.reads <= reads);
        CHECK(import_files(project) == import_files(folder.path / "whole" / "p"));
    }
    CHECK(was_resumed);
}

// Kind (Sparse volumes): 2^20 voxels a side
TEST_CASE("of 2^20 voxels a side what is stored is imported, with exact numbers")
{
    constexpr int64_t SIDE = 1 << 20;
    const StoredBlocks one{.block = Size3(64), .blocks = {{5, 6, SIDE / 64 - 1}}};
    const Noise<uint16_t> source(Size3(SIDE), VoxelType::uint16, 40, one, one);
    const TemporaryFolder folder;
    const ImportReport report = import_volume(source, folder.path / "noise", folder.path / "p", {});
    CHECK(report.levels == 16);
    CHECK(import_files(report.project).size() < 80);
    const auto project = open_volume(report.project);
    CHECK(project->info().warnings.empty());
    REQUIRE(project->levels() == 16);
    const Size3 lower(5 * 64, 6 * 64, SIDE - 64);
    std::vector<uint16_t> expected(64 * 64 * 64), found(expected.size());
    source.read({lower, lower + int64_t{64}}, std::as_writable_bytes(std::span(expected)));
    project->read({lower, lower + int64_t{64}}, std::as_writable_bytes(std::span(found)));
    CHECK(found == expected);
    const auto [least, most] = std::ranges::minmax(expected);
    CHECK(project->brick_range(0, {0, 0, 0}) == ValueRange{40.0, 40.0});
    CHECK(project->brick_range(15, {0, 0, 0}) == ValueRange{double(std::min<uint16_t>(least, 40)), double(most)});
    CHECK(project->brick_range(0, {10, 12, SIDE / 32 - 2}).value().upper <= double(most));
    const VolumeStatistics statistics = project->statistics().value();
    CHECK(statistics.minimum == double(std::min<uint16_t>(least, 40)));
    CHECK(statistics.maximum == double(most));
    const std::string hash = read_project_record(report.project / PROJECT_RECORD).content_hash;
    CHECK(hash.starts_with("xxh3-128-chunks:"));
    CHECK(content_hash(source, HashKind::chunks) == hash);
    CHECK(content_hash(*project, HashKind::chunks) == hash);
    CHECK(!content_hash(*project, HashKind::slices));  // 2^40 voxels a slice
}

TEST_CASE("a hash in chunks depends on the voxels alone, and hashes of both kinds name the same volume")
{
    const Noise<uint16_t> told(ODD, VoxelType::uint16, 3, FEW, FEW);
    const Noise<uint16_t> padded(ODD, VoxelType::uint16, 3, FEW, all_but_one_chunk(ODD, FEW.block));
    const std::string chunks = content_hash(told, HashKind::chunks).value();
    const std::string slices = content_hash(told, HashKind::slices).value();
    CHECK(content_hash(padded, HashKind::chunks) == chunks);
    CHECK(slices == content_hash(padded));
    CHECK(kind_of(chunks) == HashKind::chunks);
    CHECK(kind_of(slices) == HashKind::slices);
    CHECK(!kind_of("md5:0"));
    CHECK(is_same_content(chunks, slices, &told));
    CHECK(is_same_content(slices, chunks, &told));
    CHECK(!is_same_content(slices, chunks, nullptr));
    StoredBlocks moved = FEW;
    moved.blocks[1].x = 5;
    const Noise<uint16_t> other(ODD, VoxelType::uint16, 3, moved, moved);
    CHECK(content_hash(other, HashKind::chunks) != chunks);
    CHECK(!is_same_content(chunks, content_hash(other), &other));
    const Noise<uint16_t> filled(ODD, VoxelType::uint16, 4, FEW, FEW);
    CHECK(content_hash(filled, HashKind::chunks) != chunks);
    VolumeInfo large = told.info();
    CHECK(kind_for(large, 0) == HashKind::slices);
    large.size = Size3(2048);
    CHECK(kind_for(large, 4096) == HashKind::chunks);
    CHECK(kind_for(large, 4097) == HashKind::slices);
}

TEST_CASE("an import that would take more memory than its budget is refused before anything is written")
{
    const TemporaryFolder folder;
    const Noise<uint16_t> dense(Size3(4096, 4096, 512), VoxelType::uint16, 0, {.block = Size3(64)},
                                all_but_one_chunk(Size3(4096, 4096, 512), Size3(64)));
    const std::string refusal = error_of([&] {
        import_volume(dense, folder.path / "noise", folder.path / "p", {.threads = 2, .budget_host_bytes = 256 << 20});
    });
    CHECK(contains(refusal, "p: importing 4096 x 4096 x 512 voxels of uint16 takes up to "));
    CHECK(contains(refusal,
                   " MiB of memory; expected at most 256 MiB, which --budget-host states: use --crop or "
                   "--downscale, or a larger --budget-host"));
    CHECK(!std::filesystem::exists(folder.path / "p.part"));
}

TEST_CASE("lists of a project that are out of order, too long or of no whole length are refused")
{
    const TemporaryFolder folder;
    const ProjectTable shape{.kind = "ranges", .level = 0, .element_bytes = 2, .counts = Size3(4, 2, 1)};
    ProjectTable list = shape;
    list.is_sparse = true;
    list.keys = {1, 5};
    for (const int byte : {7, 7, 1, 2, 3, 4}) list.elements.push_back(std::byte(byte));
    const auto written = [&](const ProjectTable& table) {
        const std::vector<std::byte> bytes = to_bytes(table);
        return folder.write("table", {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    };
    const ProjectTable read = read_project_table(written(list), shape);
    CHECK(read.keys == list.keys);
    CHECK(read.at(0)[0] == std::byte{7});
    CHECK(read.at(5)[1] == std::byte{4});
    CHECK(stored_form(list, true).elements.size() == 16);
    CHECK(!stored_form(list, false).is_sparse);  // eight elements are shorter than two with their numbers
    list.keys = {5, 1};
    CHECK(contains(error_of([&] { read_project_table(written(list), shape); }), "out of order or outside the volume"));
    list.keys = {5, 5};
    CHECK(contains(error_of([&] { read_project_table(written(list), shape); }), "out of order or outside the volume"));
    list.keys = {5, 8};
    CHECK(contains(error_of([&] { read_project_table(written(list), shape); }), "out of order or outside the volume"));
    list.keys = {1};
    CHECK(contains(error_of([&] { read_project_table(written(list), shape); }), "states no possible length"));
}
