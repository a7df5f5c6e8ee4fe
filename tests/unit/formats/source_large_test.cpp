// Offsets beyond 4 GiB, in sparse files that take no space on the disk; and counts beyond 2^32.

#include <doctest/doctest.h>

#include "engine/formats/open_volume.h"
#include "tests/support/bounds.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

namespace fs = std::filesystem;

constexpr int64_t BEYOND_4_GIB = (int64_t{5} << 30) + 12;

/// `head`, a hole, and `tail` from byte `at` on.
fs::path with_hole(const TemporaryFolder& folder, const std::string& name, const std::string& head, int64_t at,
                   const std::string& tail)
{
    const fs::path path = folder.write(name, head);
    fs::resize_file(path, static_cast<uintmax_t>(at));
    std::ofstream(path, std::ios::binary | std::ios::app) << tail;
    return path;
}

std::string voxels_of_box(const VolumeSource& source, const VoxelBox& box)
{
    const std::vector<uint8_t> voxels = voxels_in<uint8_t>(source, box);
    return {voxels.begin(), voxels.end()};
}

std::string little(uint64_t number, size_t bytes)
{
    std::string text;
    for (size_t i = 0; i < bytes; ++i) text += char(number >> 8 * i & 255);
    return text;
}

}  // namespace

TEST_CASE("64 bits: voxels that begin beyond 4 GiB of a file are read from there")
{
    const TemporaryFolder folder;
    const std::string voxels = "abcdefgh";
    const VoxelBox all{Size3(0), Size3(2)};
    const fs::path raw = with_hole(folder, "far.bare", "", BEYOND_4_GIB, voxels);
    const RawLayout layout{.size = Size3(2), .offset_bytes = BEYOND_4_GIB};
    CHECK(voxels_of_box(*open_raw(raw, layout), all) == voxels);

    folder.write("far.nhdr", "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 2 2\nencoding: raw\nbyte skip: " +
                                 std::to_string(BEYOND_4_GIB) + "\ndata file: far.bare\n");
    CHECK(voxels_of_box(*open_volume(folder.path / "far.nhdr"), all) == voxels);
    folder.write("far.mhd", "ObjectType = Image\nNDims = 3\nDimSize = 2 2 2\nElementType = MET_UCHAR\nHeaderSize = " +
                                std::to_string(BEYOND_4_GIB) + "\nElementDataFile = far.bare\n");
    CHECK(voxels_of_box(*open_volume(folder.path / "far.mhd"), all) == voxels);
    folder.write("far.json", R"({"size": [2, 2, 2], "type": "uint8", "offset": )" + std::to_string(BEYOND_4_GIB) + "}");
    fs::rename(raw, folder.path / "far.raw");
    CHECK(voxels_of_box(*open_volume(folder.path / "far.raw"), all) == voxels);
}

TEST_CASE("64 bits: a strip of a BigTIFF beyond 4 GiB is read from there")
{
    const TemporaryFolder folder;
    const std::string voxels = "abcdef";
    std::string head = "II" + little(43, 2) + little(8, 2) + little(0, 2) + little(16, 8) + little(9, 8);
    const std::pair<uint64_t, uint64_t> fields[] = {{256, 3}, {257, 2}, {258, 8},
                                                    {259, 1}, {262, 1}, {273, BEYOND_4_GIB},
                                                    {277, 1}, {278, 2}, {279, voxels.size()}};
    for (const auto& [tag, value] : fields) head += little(tag, 2) + little(16, 2) + little(1, 8) + little(value, 8);
    head += little(0, 8);
    const auto source = open_volume(with_hole(folder, "far.tif", head, BEYOND_4_GIB, voxels));
    CHECK(voxels_of_box(*source, {Size3(0), Size3(3, 2, 1)}) == voxels);
}

TEST_CASE("64 bits: the last voxel of more than 2^32 is read from its own place")
{
    const TemporaryFolder folder;
    const Size3 size(2048, 2048, 1200);
    const fs::path raw = with_hole(folder, "many.raw", "", size.x * size.y * size.z - 2, "yz");
    const auto source = open_raw(raw, {.size = size});
    test::check_below("differing voxels beyond 2^32",
                      voxels_of_box(*source, {size - Size3(2, 1, 1), size}) == "yz" ? 0.0 : 1.0, 0.0);
    CHECK(voxels_of_box(*source, {{2046, 2047, 175}, {2048, 2048, 176}}) == std::string(2, '\0'));
}

TEST_CASE("64 bits: one value may occur more than 2^32 times")
{
    const int64_t many = int64_t{1} << 33;
    std::vector<int64_t> counts(256);
    counts[0] = many;
    counts[255] = many / 2;
    const VolumeStatistics statistics = statistics_of(counts, 0);
    CHECK(statistics.histogram.front() == many);
    CHECK(statistics.histogram.back() == many / 2);
    CHECK(statistics.mean == doctest::Approx(85.0));
}
