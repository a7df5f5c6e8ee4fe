// Masks of other programs: of any type, cut, turned, in layers, and in formats that are only read.

#include "engine/annotation/files/mask_place.h"

#include <cstring>

#include <doctest/doctest.h>

#include "engine/annotation/files/mask_import.h"
#include "engine/annotation/work/work.h"
#include "engine/session/label_looks.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

namespace fs = std::filesystem;

constexpr Size3 SCAN_SIZE(7, 6, 5);

/// The annotated volume: voxel 0 at 5, 6, 7.
VolumeInfo scan(const char* frame = "LPS")
{
    VolumeInfo info = volume_of_size(SCAN_SIZE, {1, 1, 2});
    info.unit = "mm";
    info.frame = frame;
    info.origin = {5, 6, 7};
    return info;
}

/// A group for each voxel, none like its neighbours; the outer layer is unpainted.
uint8_t group_at(const Size3& voxel)
{
    const bool is_outer = glm::any(glm::equal(voxel, Size3(0))) || glm::any(glm::equal(voxel, SCAN_SIZE - int64_t{1}));
    return is_outer ? uint8_t{0} : uint8_t(voxel.x + 7 * voxel.y + 40 * voxel.z);
}

template <class Value>
std::string bytes_of_values(const std::vector<double>& values)
{
    std::string bytes;
    for (const double value : values) {
        const auto stored = static_cast<Value>(value);
        bytes.append(reinterpret_cast<const char*>(&stored), sizeof(stored));
    }
    return bytes;
}

/// The groups of a box of `size` voxels whose voxel v is `first + sum of sign * v` in the volume.
std::vector<double> groups_from(const GridPlace& place, const Size3& size)
{
    std::vector<double> groups;
    for (int64_t z = 0; z < size.z; ++z)
        for (int64_t y = 0; y < size.y; ++y)
            for (int64_t x = 0; x < size.x; ++x) {
                const Size3 voxel(x, y, z);
                Size3 at = place.first;
                for (size_t axis = 0; axis < 3; ++axis) at[place.axis[axis]] += place.sign[axis] * voxel[int(axis)];
                const bool is_inside =
                    glm::all(glm::greaterThanEqual(at, Size3(0))) && glm::all(glm::lessThan(at, SCAN_SIZE));
                groups.push_back(is_inside ? group_at(at) : 0.0);
            }
    return groups;
}

/// An NRRD mask; `space` are the lines about its place.
std::string nrrd_of(const char* type, const Size3& size, const std::string& space, const std::string& voxels,
                    const std::string& keys = {})
{
    return sentence("NRRD0004\ntype: ", type, "\ndimension: 3\n", space, "sizes: ", size.x, " ", size.y, " ", size.z,
                    "\nspace units: \"mm\" \"mm\" \"mm\"\nencoding: raw\nendian: little\n", keys, "\n", voxels);
}

const std::string SAME_PLACE =
    "space: left-posterior-superior\nspace directions: (1,0,0) (0,1,0) (0,0,2)\nspace origin: (5,6,7)\n";

bool is_expected(const std::vector<MaskBrickChange>& changes)
{
    Mask mask(SCAN_SIZE);
    for (const MaskBrickChange& change : changes) mask.apply(change, Direction::forwards);
    const auto brick = mask.brick(0);
    for (int64_t i = 0; i < SCAN_SIZE.x * SCAN_SIZE.y * SCAN_SIZE.z; ++i) {
        const Size3 voxel(i % SCAN_SIZE.x, i / SCAN_SIZE.x % SCAN_SIZE.y, i / (SCAN_SIZE.x * SCAN_SIZE.y));
        if ((brick ? (*brick)[index_in_brick(voxel)] : 0) != group_at(voxel)) return false;
    }
    return true;
}

}  // namespace

// Kind (Masks): masks of every type of number, with whole numbers up to 255
TEST_CASE("masks of any type are read if their values are groups, and refused by their first other value")
{
    const TemporaryFolder folder;
    const std::vector<double> groups = groups_from({}, SCAN_SIZE);
    const auto reads = [&](const char* type, const std::string& voxels) {
        const fs::path file = folder.write("m.nrrd", nrrd_of(type, SCAN_SIZE, SAME_PLACE, voxels));
        const ImportedMask mask = import_mask(file, space_of(scan()));
        CHECK(mask.remarks.empty());
        return is_expected(mask.changes);
    };
    CHECK(reads("uint8", bytes_of_values<uint8_t>(groups)));
    CHECK(reads("uint16", bytes_of_values<uint16_t>(groups)));
    CHECK(reads("int16", bytes_of_values<int16_t>(groups)));
    CHECK(reads("uint32", bytes_of_values<uint32_t>(groups)));
    CHECK(reads("int32", bytes_of_values<int32_t>(groups)));
    CHECK(reads("float", bytes_of_values<float>(groups)));
    CHECK(reads("double", bytes_of_values<double>(groups)));
    for (const double wrong : {-1.0, 256.0, 2.5, 1e300, double(NAN)}) {
        std::vector<double> values = groups;
        values[size_t(3 + 7 * (2 + 6 * 1))] = wrong;
        values.back() = -7.0;
        const fs::path file =
            folder.write("m.nrrd", nrrd_of("double", SCAN_SIZE, SAME_PLACE, bytes_of_values<double>(values)));
        const std::string message = error_of([&] { import_mask(file, space_of(scan())); });
        CHECK_MESSAGE(contains(message, sentence("holds ", wrong,
                                                 " in voxel 3 2 1, of type float64; expected whole "
                                                 "numbers from 0 to 255")),
                      message);
    }
}

// Kind (Masks): a mask that another program cut, turned or padded
TEST_CASE("masks are placed on the volume's grid by their own position")
{
    const TemporaryFolder folder;
    const auto import_at = [&](const Size3& size, const GridPlace& place, const std::string& space,
                               const char* frame = "LPS") {
        const std::string voxels = bytes_of_values<uint8_t>(groups_from(place, size));
        return import_mask(folder.write("m.nrrd", nrrd_of("uint8", size, space, voxels)), space_of(scan(frame)));
    };
    const std::string lps = "space: left-posterior-superior\n", ras = "space: right-anterior-superior\n";
    const std::string straight = "space directions: (1,0,0) (0,1,0) (0,0,2)\n";
    SUBCASE("cut")
    {
        const ImportedMask mask =
            import_at({5, 4, 3}, {.first = {1, 1, 1}}, lps + straight + "space origin: (6,7,9)\n");
        CHECK(is_expected(mask.changes));
        REQUIRE(mask.remarks.size() == 1);
        CHECK(contains(mask.remarks[0], "its 5 4 3 voxels are placed at 1 1 1 of this volume"));
    }
    SUBCASE("cut, in the other frame")
    {
        const std::string turned = "space directions: (-1,0,0) (0,-1,0) (0,0,2)\nspace origin: (-6,-7,9)\n";
        CHECK(is_expected(import_at({5, 4, 3}, {.first = {1, 1, 1}}, ras + turned).changes));
    }
    SUBCASE("x and y reversed, by an NRRD of RAS")
    {
        const GridPlace place{.sign = {-1, -1, 1}, .first = {6, 5, 0}};
        const ImportedMask mask = import_at(SCAN_SIZE, place, ras + straight + "space origin: (-11,-11,7)\n");
        CHECK(is_expected(mask.changes));
        REQUIRE(mask.remarks.size() == 1);
        CHECK(contains(mask.remarks[0], "in reverse order along its axis x, y"));
        // A volume without a named frame may be either.
        CHECK(is_expected(import_at(SCAN_SIZE, place, ras + straight + "space origin: (-11,-11,7)\n", "").changes));
    }
    SUBCASE("axes in another order")
    {
        const GridPlace place{.axis = {2, 0, 1}};
        const std::string space = "space directions: (0,0,2) (1,0,0) (0,1,0)\nspace origin: (5,6,7)\n";
        CHECK(is_expected(import_at({5, 7, 6}, place, lps + space).changes));
    }
    SUBCASE("padded on all sides")
    {
        const GridPlace place{.first = {-2, -1, -3}};
        CHECK(is_expected(import_at({11, 8, 11}, place, lps + straight + "space origin: (3,5,1)\n").changes));
    }
    SUBCASE("left-handed axes: z upside down")
    {
        // The reader reverses them, and so finds the volume's own order.
        const std::string space = "space directions: (1,0,0) (0,1,0) (0,0,-2)\nspace origin: (5,6,15)\n";
        CHECK(is_expected(import_at(SCAN_SIZE, {.sign = {1, 1, -1}, .first = {0, 0, 4}}, lps + space).changes));
    }
}

TEST_CASE("masks that are not on the volume's grid are refused with the reason")
{
    const TemporaryFolder folder;
    const auto refusal = [&](const std::string& space, const Size3& size, const std::string& voxels) {
        const fs::path file = folder.write("m.nrrd", nrrd_of("uint8", size, space, voxels));
        return error_of([&] { import_mask(file, space_of(scan())); });
    };
    const std::string none(60, '\0'), lps = "space: left-posterior-superior\nspace directions: ";
    const auto expect = [&](const std::string& message, const char* part) {
        CHECK_MESSAGE(contains(message, part), message);
        CHECK_MESSAGE(contains(message, "is a mask of 5 4 3 voxels for this volume of 7 6 5, but "), message);
    };
    const Size3 size(5, 4, 3);
    expect(refusal(lps + "(1,0,0) (0,1,0) (0,0,2)\nspace origin: (6.5,7,9)\n", size, none),
           "its first voxel lies at 1.5 1 1 of this volume's voxels; expected whole numbers");
    expect(refusal(lps + "(1,0,0) (0,1,0) (0,0,1)\nspace origin: (6,7,9)\n", size, none),
           "its axis z steps by 0 0 0.5 of this volume's voxels; expected one voxel along one axis");
    expect(refusal(lps + "(0.8,0.6,0) (-0.6,0.8,0) (0,0,2)\nspace origin: (6,7,9)\n", size, none),
           "its axis x steps by 0.8 0.6 0 of this volume's voxels");
    expect(refusal(lps + "(1,0,0) (0,1,0) (0,0,2)\nspace origin: (60,7,9)\n", size, none),
           "its first voxel lies at 55 1 1, outside; expected a mask that has voxels in common with it");
    expect(refusal("spacings: 1 1 2\n", size, none), "it states no position; expected the size of this volume");
    std::string painted = none;
    painted.back() = 3;
    const std::string outside = refusal(lps + "(1,0,0) (0,1,0) (0,0,2)\nspace origin: (9,7,9)\n", size, painted);
    CHECK_MESSAGE(contains(outside,
                           "holds 3 in its voxel 4 3 2, which lies at 8 4 3 of this volume of 7 6 5 voxels; "
                           "expected nothing painted outside it"),
                  outside);
}

// Kind (Masks): overlapping segments of 3D Slicer, in several layers of one file
TEST_CASE("layers of segments become one mask, and what it cannot hold is told")
{
    const TemporaryFolder folder;
    std::string voxels(2 * 210, '\0');
    const auto put = [&](size_t voxel, size_t layer, char value) { voxels[2 * voxel + layer] = value; };
    put(60, 0, 1);
    put(61, 0, 2);
    put(61, 1, 1);  // overlaps the second segment
    put(62, 1, 1);
    const fs::path file = folder.write(
        "s.seg.nrrd",
        "NRRD0004\ntype: uint8\ndimension: 4\nspace: left-posterior-superior\nsizes: 2 7 6 5\nspace directions: none "
        "(1,0,0) (0,1,0) (0,0,2)\nkinds: list domain domain domain\nencoding: raw\nspace origin: (5,6,7)\n"
        "Segment0_LabelValue:=1\nSegment0_Layer:=0\nSegment0_Name:=xylem\nSegment1_LabelValue:=2\nSegment1_Layer:=0\n"
        "Segment1_Name:=phloem\nSegment2_Color:=1 0 0\nSegment2_LabelValue:=1\nSegment2_Layer:=1\n"
        "Segment2_Name:=bundle\nSegment2_Tags:=Anatomy^SCT^1|\n\n" +
            voxels);
    const ImportedMask read = import_mask(file, space_of(scan()));
    Mask mask(SCAN_SIZE);
    for (const MaskBrickChange& change : read.changes) mask.apply(change, Direction::forwards);
    CHECK(mask.voxels_by_group()[1] == 1);
    CHECK(mask.voxels_by_group()[2] == 0);
    CHECK(mask.voxels_by_group()[3] == 2);
    REQUIRE(read.losses.size() == 1);
    CHECK(contains(read.losses[0], "1 voxel lies in several segments; a mask holds one group for each voxel"));
    REQUIRE(read.remarks.size() == 1);
    CHECK(contains(read.remarks[0],
                   "its segments lie in 2 layers, which become one mask; \"bundle\" of value 1 "
                   "becomes group 3"));
    Groups groups;
    CHECK(take_label_looks(file, groups).empty());
    CHECK(groups.at(3).name == "bundle");
    CHECK(groups.at(1).name == "xylem");

    // The next save keeps this file, and writes one of a single layer.
    Work work(SCAN_SIZE, VoxelType::uint8);
    const auto notices = work.open({.mask = file, .volume = scan()});
    CHECK(std::ranges::any_of(notices, [](const Notice& notice) {
        return notice.is_loss && contains(notice.text, "; the next save keeps this file as");
    }));
    work.save(label_looks(groups, work.document().mask));
    CHECK(fs::exists(folder.path / "s.seg.nrrd.old"));
    const std::string saved = bytes_of_file(file);
    for (const char* line : {"dimension: 3\n", "Segment2_LabelValue:=3\n", "Segment2_Layer:=0\n",
                             "Segment2_Name:=bundle\n", "Segment2_Tags:=Anatomy^SCT^1|\n"})
        CHECK_MESSAGE(contains(saved, line), line);
    const ImportedMask again = import_mask(file, space_of(scan()));
    CHECK(again.losses.empty());
    CHECK(again.remarks.empty());
}

// Kind (Masks): a mask in a format that can be read, but not written
TEST_CASE("work on a mask that is only read goes to a label image next to it, which is told at opening")
{
    const TemporaryFolder folder;
    const std::vector<double> groups = groups_from({}, SCAN_SIZE);
    const fs::path voxels = folder.write("m.raw", bytes_of_values<int32_t>(groups));
    const fs::path file =
        folder.write("m.mhd",
                     "ObjectType = Image\nNDims = 3\nDimSize = 7 6 5\nElementType = MET_INT\nElementSpacing = 1 1 "
                     "2\nOffset = 5 6 7\n"
                     "TransformMatrix = 1 0 0 0 1 0 0 0 1\nElementByteOrderMSB = False\nElementDataFile = m.raw\n");
    const std::string before = bytes_of_file(file);
    const fs::path labels = folder.path / "m.labels.zarr";
    CHECK(saved_mask_path(file) == labels);
    folder.write("scan.ozx", "an archive");
    const fs::path in_archive = folder.path / "scan.ozx" / "labels" / "cells";
    CHECK(saved_mask_path(in_archive) == in_archive);
    CHECK(saved_mask_path(folder.path / "m.nii.gz") == folder.path / "m.labels.zarr");
    for (const char* kept : {"m.mask", "m.nrrd", "m.seg.nrrd", "m.tif", "m.zarr", "m.anything"})
        CHECK(saved_mask_path(folder.path / kept) == folder.path / kept);

    VolumeInfo info = scan();
    const auto said = [](const std::vector<Notice>& notices, const char* words) {
        return std::ranges::any_of(notices, [&](const Notice& notice) { return contains(notice.text, words); });
    };
    {
        Work work(SCAN_SIZE, VoxelType::uint8);
        const auto notices = work.open({.mask = file, .volume = info});
        CHECK(said(notices, "m.mhd: has a format in which masks are only read; what is painted will be kept in"));
        CHECK(work.document().mask.voxels_by_group()[1 + 7 + 40] == 1);
        MaskBrickChange erased{0, {}};
        append_run<uint8_t>(erased.runs, index_in_brick({1, 1, 1}), index_in_brick({1, 1, 1}), 1 + 7 + 40, 0);
        REQUIRE(work.perform({"erase", {erased}}));
        CHECK(work.save().files == std::vector<fs::path>{labels});
    }
    CHECK(bytes_of_file(file) == before);
    CHECK(bytes_of_file(voxels) == bytes_of_values<int32_t>(groups));
    Work work(SCAN_SIZE, VoxelType::uint8);
    CHECK(
        said(work.open({.mask = file, .volume = info}), "m.labels.zarr next to it, where the mask is kept, is taken"));
    CHECK(work.document().mask.voxels_by_group()[1 + 7 + 40] == 0);
}
