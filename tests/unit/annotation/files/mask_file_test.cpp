#include "engine/annotation/files/mask_file.h"

#include <sys/stat.h>

#include <iterator>
#include <random>

#include <doctest/doctest.h>

#include "engine/annotation/files/mask_source.h"
#include "engine/base/file.h"
#include "engine/formats/open_volume.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

/// Groups in runs of random length, x fastest, mostly unpainted.
std::string random_groups(const Size3& size, uint32_t seed)
{
    std::mt19937 random(seed);
    const auto count = size_t(size.x * size.y * size.z);
    std::string groups;
    while (groups.size() < count) groups.append(1 + random() % 50, random() % 2 == 0 ? '\0' : char(random() % 256));
    groups.resize(count);
    return groups;
}

Mask loaded(const std::filesystem::path& path, const Size3& size)
{
    Mask mask(size);
    for (const MaskBrickChange& change : load_mask(path, size)) mask.apply(change, Direction::forwards);
    return mask;
}

int64_t differing(const Mask& mask, const std::string& groups)
{
    int64_t wrong = 0;
    size_t index = 0;
    for (int64_t z = 0; z < mask.size().z; ++z)
        for (int64_t y = 0; y < mask.size().y; ++y)
            for (int64_t x = 0; x < mask.size().x; ++x) wrong += mask.at({x, y, z}) != uint8_t(groups[index++]);
    return wrong;
}

auto entries(const TemporaryFolder& folder)
{
    return std::distance(std::filesystem::directory_iterator(folder.path), std::filesystem::directory_iterator());
}

}  // namespace

TEST_CASE("a mask file is one byte per voxel, x fastest, in and out, whatever the volume's size")
{
    const TemporaryFolder folder;
    for (const Size3& size : {Size3(1, 1, 1), Size3(32, 32, 32), Size3(33, 31, 65), Size3(70, 5, 40), Size3(5, 70, 3),
                              Size3(64, 64, 33), Size3(31, 33, 1)}) {
        CAPTURE(size.x);
        CAPTURE(size.y);
        CAPTURE(size.z);
        const std::string groups = random_groups(size, 3);
        const Mask mask = loaded(folder.write("in.mask", groups), size);
        CHECK(differing(mask, groups) == 0);
        save_mask(folder.path / "out.mask", mask);
        CHECK(read_text(folder.path / "out.mask", 1 << 24) == groups);
    }
    CHECK(entries(folder) == 2);
}

TEST_CASE("loading makes ascending records, none for unpainted bricks, and joins what hangs together")
{
    const TemporaryFolder folder;
    const Size3 size(64, 32, 64);
    std::string groups(size_t(size.x * size.y * size.z), '\0');
    CHECK(load_mask(folder.write("a.mask", groups), size).empty());
    for (size_t z = 32; z < 64; ++z)
        for (size_t y = 0; y < 32; ++y)
            for (size_t x = 32; x < 64; ++x) groups[x + 64 * (y + 32 * z)] = 9;
    groups[0] = 1;
    const std::vector<MaskBrickChange> changes = load_mask(folder.write("a.mask", groups), size);
    REQUIRE(changes.size() == 2);
    CHECK(changes[0] == MaskBrickChange{.brick = 0, .runs = {{0, 0, 0, 1}}});
    CHECK(changes[1] == MaskBrickChange{.brick = 3, .runs = {{0, 32767, 0, 9}}});
}

TEST_CASE("a mask of another volume is refused, naming both sizes")
{
    const TemporaryFolder folder;
    const std::filesystem::path path = folder.write("a.mask", std::string(63, '\0'));
    CHECK(error_of([&] {
              load_mask(path, {4, 4, 4});
          }) == path.string() + ": holds 63 bytes; expected 64, one for each voxel of 4 x 4 x 4");
    CHECK_FALSE(error_of([&] { load_mask(path, {1, 1, 62}); }).empty());
    CHECK(contains(error_of([&] { load_mask(path, Size3(int64_t{1} << 20)); }), "expected 1152921504606846976"));
}

TEST_CASE("what is no file is refused with the reason")
{
    const TemporaryFolder folder;
    const std::filesystem::path missing = folder.path / "missing.mask", pipe = folder.path / "pipe.mask";
    CHECK(error_of([&] {
              load_mask(missing, {4, 4, 4});
          }) == missing.string() + ": cannot be opened: No such file or directory");
    CHECK(contains(error_of([&] { load_mask(folder.path, {4, 4, 4}); }), "expected a .mask file"));
    REQUIRE(::mkfifo(pipe.c_str(), 0600) == 0);
    CHECK(contains(error_of([&] { load_mask(pipe, {4, 4, 4}); }), "expected a .mask file"));
}

TEST_CASE("a failed save is refused with the reason and leaves nothing behind")
{
    const TemporaryFolder folder;
    const Mask mask({40, 40, 40});
    const std::filesystem::path nowhere = folder.path / "missing" / "a.mask";
    CHECK(error_of([&] { save_mask(nowhere, mask); }) ==
          nowhere.string() + ": cannot be written: No such file or directory");
    CHECK(contains(error_of([&] { save_mask(folder.path, mask); }), "Is a directory"));
    CHECK(entries(folder) == 0);
}

TEST_CASE("saving replaces the old file, whose permissions stay")
{
    const TemporaryFolder folder;
    const std::filesystem::path path = folder.write("a.mask", "old");
    REQUIRE(::chmod(path.c_str(), 0640) == 0);
    save_mask(path, Mask({40, 3, 2}));
    CHECK(read_text(path, 1000) == std::string(240, '\0'));
    CHECK(std::filesystem::status(path).permissions() == std::filesystem::perms(0640));
    CHECK(entries(folder) == 1);
}

TEST_CASE("a mask as a volume holds the same voxels, in any box, and makes the same records again")
{
    const TemporaryFolder folder;
    // In the last one, slices are too large to read a layer of bricks at once.
    for (const Size3& size :
         {Size3(1, 1, 1), Size3(32, 32, 32), Size3(70, 45, 40), Size3(31, 33, 1), Size3(2500, 900, 2)}) {
        CAPTURE(size.x);
        const std::string groups = random_groups(size, 7);
        const auto path = folder.write("a.mask", groups);
        const Mask mask = loaded(path, size);
        const MaskSource source(mask, {.size = size});
        std::string voxels(groups.size(), '?');
        source.read({Size3(0), size}, std::as_writable_bytes(std::span(voxels)));
        CHECK(voxels == groups);
        const VoxelBox box{size / int64_t{3}, size - size / int64_t{4}};
        std::string part(size_t(box.size().x * box.size().y * box.size().z), '?'), expected;
        source.read(box, std::as_writable_bytes(std::span(part)));
        for (int64_t z = box.lower.z; z < box.upper.z; ++z)
            for (int64_t y = box.lower.y; y < box.upper.y; ++y)
                expected += groups.substr(size_t(box.lower.x + size.x * (y + size.y * z)), size_t(box.size().x));
        CHECK(part == expected);
        const std::vector<MaskBrickChange> again = mask_changes(source, "a"), before = load_mask(path, size);
        CHECK((again == before));
    }
}

TEST_CASE("a mask with labels above 255 is refused with their number and the highest")
{
    const TemporaryFolder folder;
    std::string voxels;
    for (int i = 0; i < 400; ++i)  // labels 0 to 299, one of them far above
        for (const int byte : {i % 300 == 299 ? 0x10 : i % 300 & 255, i % 300 == 299 ? 0x27 : i % 300 >> 8})
            voxels += char(byte);
    const auto source = open_volume(folder.write(
        "labels.nrrd",
        "NRRD0004\ntype: uint16\ndimension: 3\nsizes: 20 20 1\nencoding: raw\nendian: little\n\n" + voxels));
    std::string said;
    try {
        static_cast<void>(mask_changes(*source, "labels.nrrd"));
    } catch (const Error& error) {
        said = error.what();
    }
    CHECK(said ==
          "labels.nrrd: holds 299 labels, the highest 10000, of type uint16; expected at most 255 labels, from 1 to "
          "255: choose up to 255 and renumber them in the program that wrote the file");
}
