// Label images of sparse volumes, made from the stored chunks alone, against those made by a pass over all voxels.

#include "engine/projects/import_sparse.h"

#include <algorithm>
#include <map>
#include <random>
#include <set>

#include <doctest/doctest.h>

#include "engine/projects/import_volume.h"
#include "tests/support/slow.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

/// Random labels in some blocks, and 0 elsewhere; says so, unless it hides it.
template <class T>
class SparseLabels final : public VolumeSource {
public:
    SparseLabels(const Size3& size, VoxelType type, StoredBlocks stored, uint32_t labels, bool hides)
        : VolumeSource(volume(size, type)), stored_(std::move(stored)), labels_(labels), hides_(hides)
    {
        for (const glm::ivec3& block : stored_.blocks) is_stored_.insert(index_of(block));
    }
    void read(const VoxelBox& box, std::span<std::byte> voxels) const override
    {
        T* to = reinterpret_cast<T*>(voxels.data());
        const int64_t width = stored_.block.x;
        for (int64_t z = box.lower.z; z < box.upper.z; ++z)
            for (int64_t y = box.lower.y; y < box.upper.y; ++y)
                for (int64_t x = box.lower.x; x < box.upper.x;) {
                    const int64_t end = std::min(box.upper.x, (x / width + 1) * width);
                    if (!is_stored_.contains(index_of(Size3(x, y, z) / stored_.block)))
                        to = std::fill_n(to, end - x, T(0));
                    else
                        for (int64_t i = x; i < end; ++i) *to++ = label_at({i, y, z});
                    x = end;
                }
    }
    std::optional<StoredBlocks> stored_blocks(int level, int64_t) const override
    {
        return level == 0 && !hides_ ? std::optional(stored_) : std::nullopt;
    }

private:
    static VolumeInfo volume(const Size3& size, VoxelType type)
    {
        VolumeInfo info = volume_of_size(size, {0.5, 1.0, 2.0});
        info.type = type;
        info.unit = "um";
        return info;
    }
    static int64_t index_of(const Size3& block) { return block.x + 4096 * (block.y + 4096 * block.z); }
    T label_at(const Size3& voxel) const
    {
        const auto number = uint32_t(voxel.x / 3 + 31 * (voxel.y / 2) + 977 * voxel.z) * 2654435761U;
        return static_cast<T>(number >> 20) % static_cast<T>(labels_);
    }
    StoredBlocks stored_;
    std::set<int64_t> is_stored_;
    uint32_t labels_;
    bool hides_;
};

std::map<std::string, std::string> files_in(const std::filesystem::path& folder)
{
    std::map<std::string, std::string> files;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
        if (entry.is_regular_file())
            files[entry.path().lexically_relative(folder).string()] = bytes_of_file(entry.path());
    return files;
}

template <class T>
void compare(const Size3& size, VoxelType type, const StoredBlocks& stored, OmeZarrVersion version)
{
    const SparseLabels<T> told(size, type, stored, 100, false), hidden(size, type, stored, 100, true);
    const std::optional<std::vector<Size3>> chunks = stored_chunks(told);
    REQUIRE(chunks);
    REQUIRE(are_few(*chunks, size));  // else both are made of everything
    REQUIRE(!stored_chunks(hidden));
    const TemporaryFolder folder;
    const std::filesystem::path a = folder.path / "a" / "labels.zarr", b = folder.path / "b" / "labels.zarr";
    double fraction = 0.0;
    const ImportOptions options{.version = version,
                                .progress = [&](const ImportProgress& progress) { fraction = progress.fraction; }};
    const ImportReport of_stored = export_label_image(told, a, {}, options);
    const ImportReport of_all = export_label_image(hidden, b, {}, {.version = version});
    CHECK(files_in(a) == files_in(b));
    CHECK(of_stored.levels == of_all.levels);
    CHECK(of_stored.bricks == of_all.bricks);
    CHECK(of_stored.bricks_stored == of_all.bricks_stored);
    CHECK(of_stored.bytes == of_all.bytes);
    CHECK(fraction <= 1.0);
}

}  // namespace

TEST_CASE("a label image made of what is stored has the bytes of one made of everything")
{
    std::mt19937 random(7);
    for (int round = 0; round < 4; ++round) {
        CAPTURE(round);
        const uint32_t more = repeats(80u, 200u);
        const Size3 size(300 + random() % more, 300 + random() % more, 300 + random() % more);
        StoredBlocks stored{.block = round % 2 == 0 ? Size3(32) : Size3(48, 80, 20)};
        std::set<std::array<int, 3>> blocks;
        const Size3 last = (size - int64_t{1}) / stored.block;
        blocks.insert({int(last.z), int(last.y), int(last.x)});  // cut by the volume's end
        for (int i = 0; i < repeats(2, 5); ++i)
            blocks.insert({int(random() % uint64_t(last.z + 1)), int(random() % uint64_t(last.y + 1)),
                           int(random() % uint64_t(last.x + 1))});
        for (const auto& [z, y, x] : blocks) stored.blocks.emplace_back(x, y, z);
        const OmeZarrVersion version = round < 2 ? OmeZarrVersion::v0_4 : OmeZarrVersion::v0_5;
        // Every day any two of block, version and type meet.
        const bool is_wide = round == 1 || round == 2;
        if (!is_wide || is_slow()) compare<uint8_t>(size, VoxelType::uint8, stored, version);
        if (is_wide || is_slow()) compare<uint32_t>(size, VoxelType::uint32, stored, version);
    }
}

TEST_CASE("nothing stored makes the metadata alone")
{
    compare<uint16_t>(Size3(200, 100, 70), VoxelType::uint16, {.block = Size3(32)}, OmeZarrVersion::v0_4);
}

TEST_CASE("of 2^20 voxels a side a chunk of each level is written, and a chunk at each corner ends in one")
{
    constexpr int64_t SIDE = 1 << 20;
    const TemporaryFolder folder;
    StoredBlocks stored{.block = Size3(64), .blocks = {{5, 6, 7}}};
    const SparseLabels<uint8_t> one(Size3(SIDE), VoxelType::uint8, stored, 2, false);
    const ImportReport report = export_label_image(one, folder.path / "one.zarr", {});
    CHECK(report.levels == 16);
    CHECK(report.bricks_stored >= 6);  // half of its voxels are labelled, so that coarser levels keep some of them
    CHECK(report.bricks_stored <= 16);
    stored.blocks.clear();
    constexpr int LAST = SIDE / 64 - 1;
    for (int corner = 0; corner < 8; ++corner)
        stored.blocks.emplace_back(corner & 1 ? LAST : 0, corner & 2 ? LAST : 0, corner & 4 ? LAST : 0);
    const SparseLabels<uint8_t> eight(Size3(SIDE), VoxelType::uint8, stored, 2, false);
    CHECK(stored_chunks(eight)->size() == 8);
    CHECK(export_label_image(eight, folder.path / "eight.zarr", {}).bricks_stored >= 8 * 6);
}

TEST_CASE("a sparse label image that is stopped leaves what was there before")
{
    const TemporaryFolder folder;
    const std::filesystem::path path = folder.path / "labels.zarr";
    const StoredBlocks stored{.block = Size3(64), .blocks = {{5, 6, 7}}};
    const SparseLabels<uint8_t> labels(Size3(4096), VoxelType::uint8, stored, 2, false);
    export_label_image(labels, path, {});
    const auto before = files_in(folder.path);
    const std::atomic<bool> stops = true;
    CHECK_THROWS_AS(export_label_image(labels, path, {}, {.cancel = &stops}), ImportStopped);
    CHECK(files_in(folder.path) == before);
}
