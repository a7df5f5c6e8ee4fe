// Masks and offsets in sparse OME-Zarr: equal to dense ones, at a cost of what is painted, on volumes of any size.

#include <map>
#include <random>

#include <doctest/doctest.h>

#include "engine/annotation/files/brick_boxes.h"
#include "engine/annotation/files/mask_import.h"
#include "engine/annotation/files/mask_source.h"
#include "engine/annotation/files/offset_import.h"
#include "engine/formats/open_volume.h"
#include "engine/projects/import_sparse.h"
#include "tests/support/slow.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

namespace fs = std::filesystem;

constexpr int64_t HUGE_SIDE = int64_t{1} << 20;

VolumeInfo volume_of(const Size3& size, VoxelType type = VoxelType::uint8)
{
    VolumeInfo info = volume_of_size(size, {0.5, 0.25, 1.5});
    info.type = type;
    info.unit = "um";
    return info;
}

/// Random runs of groups in about `share` of the bricks.
Mask random_mask(const Size3& size, double share, std::mt19937& random)
{
    Mask mask(size);
    const Size3 counts = mask.brick_counts();
    for (int64_t brick = 0; brick < counts.x * counts.y * counts.z; ++brick) {
        if (std::uniform_real_distribution<double>()(random) >= share) continue;
        const Size3 extent = mask.box_of(brick).size();
        MaskBrickChange change{brick, {}};
        for (int64_t z = 0; z < extent.z; ++z)
            for (int64_t y = 0; y < extent.y; ++y)
                for (int64_t x = 0; x < extent.x; ++x)
                    if (const auto group = uint8_t(random() % 4); group > 0) {
                        const auto at = size_t(x + BRICK_SIDE * (y + BRICK_SIDE * z));
                        append_run<uint8_t>(change.runs, at, at, 0, group);
                    }
        if (!change.runs.empty()) mask.apply(change, Direction::forwards);
    }
    return mask;
}

/// Paints a cube of 8 voxels a side at each position, which is a multiple of 8.
Mask mask_with_cubes(const Size3& size, const std::vector<Size3>& positions)
{
    Mask mask(size);
    for (const Size3& position : positions) {
        MaskBrickChange change{index_of(position / BRICK_SIDE, mask.brick_counts()), {}};
        for (int64_t z = 0; z < 8; ++z)
            for (int64_t y = 0; y < 8; ++y) {
                const size_t first = index_in_brick(position + Size3(0, y, z));
                append_run<uint8_t>(change.runs, first, first + 7, 0, 3);
            }
        mask.apply(change, Direction::forwards);
    }
    return mask;
}

Mask read_mask(const fs::path& path, const VolumeInfo& volume)
{
    Mask mask(volume.size);
    for (const MaskBrickChange& change : import_mask(path, space_of(volume)).changes)
        mask.apply(change, Direction::forwards);
    return mask;
}

template <class Value>
bool is_same(const SparseBricks<Value>& a, const SparseBricks<Value>& b)
{
    if (a.painted_bricks() != b.painted_bricks()) return false;
    return std::ranges::all_of(a.painted_bricks(), [&](int64_t brick) { return *a.brick(brick) == *b.brick(brick); });
}

std::map<std::string, std::string> files_below(const fs::path& folder)
{
    std::map<std::string, std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator(folder))
        if (entry.is_regular_file()) files[entry.path().lexically_relative(folder)] = bytes_of_file(entry.path());
    return files;
}

size_t bytes_in(const std::map<std::string, std::string>& files)
{
    size_t bytes = 0;
    for (const auto& [name, content] : files) bytes += content.size();
    return bytes;
}

/// Counts the voxels that are read; hides what is stored on demand.
class CountedSource final : public VolumeSource {
public:
    explicit CountedSource(const VolumeSource& source, bool hides = false)
        : VolumeSource(source.info()), source_(source), hides_(hides)
    {}
    void read(const VoxelBox& box, std::span<std::byte> voxels) const override
    {
        read_voxels += box.size().x * box.size().y * box.size().z;
        source_.read(box, voxels);
    }
    Size3 block() const override { return source_.block(); }
    std::optional<StoredBlocks> stored_blocks(int level, int64_t most) const override
    {
        return hides_ ? std::nullopt : source_.stored_blocks(level, most);
    }
    mutable int64_t read_voxels = 0;

private:
    const VolumeSource& source_;
    bool hides_;
};

}  // namespace

TEST_CASE("a mask in a label image is read back bit for bit, and its files are those of a pass over all voxels")
{
    std::mt19937 random(5);
    const std::vector<Size3> sizes{{1, 1, 1}, {64, 64, 64}, {70, 45, 130}, {31, 33, 1}, {129, 2, 65}};
    for (int round = 0; round < repeats(1, 20); ++round)
        for (const Size3& size : sizes)
            for (const double share : {0.0, 0.1, 1.0}) {
                CAPTURE(size.x);
                CAPTURE(share);
                const TemporaryFolder folder;
                const VolumeInfo volume = volume_of(size);
                const Mask mask = random_mask(size, share, random);
                const LabelImage image{.colors = {{3, {1, 2, 3, 4}, "three"}}, .painted_on = "xxh3-128:00"};
                save_mask_as(folder.path / "a" / "m.zarr", mask, volume, image);
                CHECK(is_same(read_mask(folder.path / "a" / "m.zarr", volume), mask));
                const MaskSource all(mask, volume);
                const CountedSource hidden(all, true);
                export_label_image(hidden, folder.path / "b" / "m.zarr", image);
                CHECK(files_below(folder.path / "a") == files_below(folder.path / "b"));
            }
}

TEST_CASE("offsets in an OME-Zarr image are read back bit for bit, whatever the volume's type")
{
    std::mt19937 random(6);
    for (const VoxelType type : {VoxelType::uint8, VoxelType::int16, VoxelType::uint32, VoxelType::float32}) {
        CAPTURE(name_of(type));
        const TemporaryFolder folder;
        const VolumeInfo volume = volume_of({70, 45, 130}, type);
        DensityField field(volume.size, type);
        for (const int64_t brick : {0, 5, 29}) {
            OffsetBrick offsets{};
            for (uint32_t& bits : offsets)
                if (random() % 5 == 0) bits = offset_bits(type, double(random() % 400) - 200.0);
            offsets[1] = offset_bits(type, offset_limit(type));
            offsets[2] = offset_bits(type, -offset_limit(type));
            field.put(brick, offsets);
        }
        const fs::path path = folder.path / "o.zarr";
        save_offsets_as(path, field, volume);
        CHECK(is_same(import_offsets(path, space_of(volume), type), field));
        CHECK(name_of(open_volume(path)->info().type) == std::string(is_float(type) ? "float32" : "int32"));
        CHECK(bytes_in(files_below(path)) < 400000);  // dense: 1.6 MB
        // Saved again, and without anything
        save_offsets_as(path, DensityField(volume.size, type), volume);
        CHECK(import_offsets(path, space_of(volume), type).voxels() == 0);
    }
}

TEST_CASE("anything but an image of offsets is not replaced by offsets")
{
    const TemporaryFolder folder;
    const VolumeInfo volume = volume_of({5, 4, 3});
    save_mask_as(folder.path / "m.zarr", Mask(volume.size), volume);
    folder.write("file.zarr", "text");
    const DensityField field(volume.size, volume.type);
    for (const char* const name : {"m.zarr", "file.zarr"}) {
        const auto before = files_below(folder.path);
        CHECK(contains(error_of([&] { save_offsets_as(folder.path / name, field, volume); }),
                       "already exists and is no image of offsets; expected a new name"));
        CHECK(files_below(folder.path) == before);
    }
}

TEST_CASE("a file of other programs in a label image is not deleted with it: an export is refused")
{
    const TemporaryFolder folder;
    const VolumeInfo volume = volume_of({5, 4, 3});
    const fs::path path = folder.path / "m.zarr";
    save_mask_as(path, Mask(volume.size), volume);
    folder.write("m.zarr/notes.txt", "mine");
    CHECK(contains(error_of([&] { save_mask_as(path, Mask(volume.size), volume); }),
                   "m.zarr: holds notes.txt of another program"));
    CHECK(bytes_of_file(path / "notes.txt") == "mine");
}

TEST_CASE("what is written and read does not grow with the volume, up to 2^20 voxels a side")
{
    const std::vector<Size3> cubes{{8, 16, 24}, {96, 64, 40}};
    std::map<int64_t, std::pair<size_t, size_t>> costs;  // files and bytes, by side
    for (const int64_t side : {int64_t{128}, int64_t{2048}, HUGE_SIDE}) {
        CAPTURE(side);
        const TemporaryFolder folder;
        const VolumeInfo volume = volume_of(Size3(side));
        const Mask mask = mask_with_cubes(volume.size, cubes);
        const fs::path path = folder.path / "m.zarr";
        save_mask_as(path, mask, volume);
        const auto files = files_below(path);
        costs[side] = {files.size(), bytes_in(files)};
        CHECK(is_same(read_mask(path, volume), mask));
        const auto source = open_volume(path);
        const CountedSource counted(*source);
        CHECK(mask_changes(counted, "m.zarr").size() == 2);
        CHECK(counted.read_voxels <= 2 * 64 * 64 * 64);
    }
    CHECK(costs[128].first == 3 + 2 + 2 + 1 + 1);  // metadata of a group and 3 levels, 2 chunks, 1 above, 1 above
    CHECK(costs[2048].second < costs[128].second + 5000);
    CHECK(costs[HUGE_SIDE].first < costs[128].first + 2 * 13);  // 13 more levels
    CHECK(costs[HUGE_SIDE].second < costs[128].second + 20000);
}

TEST_CASE("voxels in all corners of 2^20 a side, and of flat and long volumes, are saved and read")
{
    for (const Size3& size :
         {Size3(HUGE_SIDE), Size3(HUGE_SIDE, 40, 8), Size3(8, HUGE_SIDE, 40), Size3(40, 8, HUGE_SIDE)}) {
        CAPTURE(size.x);
        CAPTURE(size.y);
        const TemporaryFolder folder;
        const VolumeInfo volume = volume_of(size);
        std::vector<Size3> corners;
        const Size3 last = size - int64_t{8};
        for (int corner = 0; corner < 8; ++corner) {
            const Size3 at(corner & 1 ? last.x : 0, corner & 2 ? last.y : 0, corner & 4 ? last.z : 0);
            if (std::ranges::find(corners, at) == corners.end()) corners.push_back(at);
        }
        const Mask mask = mask_with_cubes(size, corners);
        save_mask_as(folder.path / "m.zarr", mask, volume);
        CHECK(is_same(read_mask(folder.path / "m.zarr", volume), mask));
        DensityField field(size, VoxelType::uint8);
        for (const int64_t brick : mask.painted_bricks()) {
            OffsetBrick offsets{};
            offsets[0] = offset_bits(VoxelType::uint8, 7.0);
            field.put(brick, offsets);
        }
        save_offsets_as(folder.path / "o.zarr", field, volume);
        CHECK(is_same(import_offsets(folder.path / "o.zarr", space_of(volume), VoxelType::uint8), field));
    }
}

TEST_CASE("the boxes of a volume cover what is stored, each voxel once")
{
    class Blocks final : public VolumeSource {
    public:
        Blocks(const Size3& size, const Size3& block, std::vector<glm::ivec3> stored)
            : VolumeSource(volume_of(size)), block_(block), stored_(std::move(stored))
        {}
        void read(const VoxelBox&, std::span<std::byte>) const override {}
        Size3 block() const override { return block_; }
        std::optional<StoredBlocks> stored_blocks(int, int64_t) const override
        {
            return StoredBlocks{.block = block_, .blocks = stored_};
        }

    private:
        Size3 block_;
        std::vector<glm::ivec3> stored_;
    };
    const Size3 size(150, 100, 90);
    for (const Size3& block : {Size3(64), Size3(32), Size3(50, 50, 1), Size3(7, 100, 33)}) {
        CAPTURE(block.x);
        const Size3 counts = (size - int64_t{1}) / block + int64_t{1};
        const std::vector<glm::ivec3> stored{{0, 0, 0}, {1, 0, 1}, glm::ivec3(counts) - 1};
        const Blocks source(size, block, stored);
        std::map<int64_t, int> visits;  // by brick
        for_each_brick_box(source, [&](const VoxelBox& box) {
            for_each_brick(box, size, [&](const BrickOfBox& brick) { ++visits[brick.index]; });
        });
        for (const auto& [brick, times] : visits) CHECK(times == 1);
        for (const glm::ivec3& at : stored) {
            const VoxelBox box{Size3(at) * block, glm::min(Size3(at) * block + block, size)};
            for (const Size3& voxel : {box.lower, box.upper - int64_t{1}})
                CHECK(visits.contains(index_of(voxel / BRICK_SIDE, brick_grid(size))));
        }
    }
}

TEST_CASE("files of all voxels that do not fit on the disk are refused with both sizes, before anything is written")
{
    const TemporaryFolder folder;
    const VolumeInfo volume = volume_of(Size3(HUGE_SIDE));
    const Mask mask = mask_with_cubes(volume.size, {{8, 8, 8}});
    const DensityField field(volume.size, volume.type);
    for (const char* const name : {"m.mask", "m.nrrd", "m.tif"}) {
        const std::string refused = error_of([&] { save_mask_as(folder.path / name, mask, volume); });
        CHECK(contains(refused, sentence(name, ": would take ")));
        CHECK(contains(refused, "the free space of its disk: free some of it, or choose .zarr"));
        CHECK(contains(refused, std::string(name) == "m.tif" ? "1117172000588030 bytes" : "1152921504606846976 bytes"));
    }
    CHECK(contains(error_of([&] { save_offsets_as(folder.path / "o.offset", field, volume); }),
                   "would take 2305843009213693952 bytes; expected at most "));
    CHECK(contains(error_of([&] { save_offsets_as(folder.path / "o.nrrd", field, volume); }),
                   "would take 4611686018427387904 bytes"));
    CHECK(fs::is_empty(folder.path));
}
