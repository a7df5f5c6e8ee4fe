// Round trips of density offsets through other programs' formats.

#include "engine/annotation/files/offset_import.h"

#include <bit>
#include <limits>
#include <random>

#include <doctest/doctest.h>

#include "engine/formats/export/volume_export.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

VolumeInfo volume_of(const Size3& size, VoxelType type)
{
    return {.name = "scan", .format = "test", .size = size, .type = type, .spacing = {0.5, 0.25, 1.5}, .unit = "um"};
}

/// Random offsets. One brick in three has none; the others begin with the largest, the most negative and the smallest
/// positive offset.
DensityField random_field(const Size3& size, VoxelType type, uint32_t seed)
{
    std::mt19937 random(seed);
    const double limit = offset_limit(type);
    DensityField field(size, type);
    const Size3 counts = field.brick_counts();
    for (int64_t index = 0; index < counts.x * counts.y * counts.z; ++index) {
        if (index % 3 == 1) continue;
        OffsetBrick brick{};
        for (uint32_t& bits : brick)
            if (random() % 7 == 0)
                bits = offset_bits(type, std::uniform_real_distribution<double>(-1.0, 1.0)(random) * limit);
        brick[0] = offset_bits(type, limit);
        brick[1] = offset_bits(type, -limit);
        brick[2] = offset_bits(type, is_float(type) ? std::numeric_limits<float>::denorm_min() : 1.0);
        field.put(index, brick);
    }
    return field;
}

bool is_same(const DensityField& a, const DensityField& b)
{
    if (a.size() != b.size() || a.type() != b.type() || a.painted_bricks() != b.painted_bricks()) return false;
    for (const int64_t brick : a.painted_bricks())
        if (*a.brick(brick) != *b.brick(brick)) return false;
    return a.voxels() == b.voxels();
}

/// The message that refuses a file with these voxels as offsets of a volume of `type`.
template <class T>
std::string refusal(VoxelType held, const std::vector<T>& voxels, VoxelType type)
{
    const TemporaryFolder folder;
    const MemorySource source = memory_source({2, 2, 1}, held, voxels);
    export_volume(folder.path / "a.nrrd", source);
    return error_of([&] { import_offsets(folder.path / "a.nrrd", space_of(volume_of({2, 2, 1}, type)), type); });
}

}  // namespace

TEST_CASE("offsets come back bit for bit from every form that is written, for volumes of every type")
{
    const TemporaryFolder folder;
    for (const VoxelType type : {VoxelType::uint8, VoxelType::int8, VoxelType::uint16, VoxelType::int16,
                                 VoxelType::uint32, VoxelType::int32, VoxelType::float32, VoxelType::float64})
        for (const Size3& size : {Size3(1, 1, 1), Size3(70, 33, 40)}) {
            const VolumeInfo volume = volume_of(size, type);
            const DensityField field = random_field(size, type, 5);
            for (const char* name : {"a.offset", "a.nrrd", "a.tif", "a.numbers"}) {
                CAPTURE(name_of(type));
                CAPTURE(name);
                save_offsets_as(folder.path / name, field, volume);
                CHECK(is_same(import_offsets(folder.path / name, space_of(volume), type), field));
            }
        }
}

TEST_CASE("a volume whose layers of bricks are too large to be read at once gives the same offsets")
{
    const TemporaryFolder folder;
    const Size3 size(2100, 300, 3);  // 32 layers of floats take more than 64 MiB
    const VolumeInfo volume = volume_of(size, VoxelType::uint16);
    const DensityField field = random_field(size, VoxelType::uint16, 6);
    save_offsets_as(folder.path / "a.nrrd", field, volume);
    CHECK(is_same(import_offsets(folder.path / "a.nrrd", space_of(volume), VoxelType::uint16), field));
}

TEST_CASE("offsets of another volume are refused with both named; the same spacing in another unit is the same")
{
    const TemporaryFolder folder;
    const VolumeInfo volume = volume_of({5, 4, 3}, VoxelType::uint8);
    for (const char* name : {"a.nrrd", "a.tif"}) {
        CAPTURE(name);
        const auto path = folder.path / name;
        const DensityField field = random_field(volume.size, volume.type, 1);
        save_offsets_as(path, field, volume);
        const auto told = [&](const TraceSpace& space) {
            return error_of([&] { import_offsets(path, space, volume.type); });
        };
        CHECK(contains(told({{5, 4, 4}, volume.spacing, "um"}),
                       "is a volume of offsets of 5 4 3 voxels; expected 5 4 4, the size of this volume"));
        CHECK(contains(
            told({volume.size, {0.5, 0.25, 1.0}, "um"}),
            "is a volume of offsets with voxels of 0.5 x 0.25 x 1.5 \u00b5m; expected 0.5 x 0.25 x 1 \u00b5m"));
        CHECK(contains(told({volume.size, volume.spacing, "mm"}), "expected 0.5 x 0.25 x 1.5 mm"));
        CHECK(is_same(import_offsets(path, {volume.size, {0.0005, 0.00025, 0.0015}, "mm"}, volume.type), field));
        CHECK(is_same(import_offsets(path, {volume.size, {1, 1, 1}, "voxel"}, volume.type), field));
    }
}

TEST_CASE("offsets that no stroke makes are refused in words")
{
    using enum VoxelType;
    CHECK(
        contains(refusal<float>(float32, {0, 0, 256, 0}, uint8),
                 "a.nrrd: the offset of voxel 0, 1, 0 is 256; expected a whole number from -255 to 255 for a volume of "
                 "uint8"));
    CHECK(contains(refusal<float>(float32, {0, 0.5, 0, 0}, int16), "voxel 1, 0, 0 is 0.5; expected a whole number"));
    CHECK(contains(refusal<float>(float32, {NAN, 0, 0, 0}, uint16), "voxel 0, 0, 0 is nan"));
    CHECK(contains(refusal<float>(float32, {0, 0, 0, INFINITY}, float32), "voxel 1, 1, 0 is inf; expected -3.4"));
    CHECK(contains(refusal<double>(float64, {0, 0, 0, -1e39}, float64), "voxel 1, 1, 0 is -1e+39; expected -3.4"));
    CHECK(contains(refusal<uint32_t>(uint32, {0, 4294967295u, 0, 0}, int32), "voxel 1, 0, 0 is 4.29497e+09"));
    // Other types can hold offsets too; -0 is no offset.
    CHECK(refusal<int16_t>(int16, {-255, 3, 255, 0}, uint8).empty());
    CHECK(refusal<float>(float32, {-0.0f, 0.5f, 0, 0}, float64).empty());
}

TEST_CASE("files that are no offsets, or cannot be written, are refused in one sentence")
{
    const TemporaryFolder folder;
    const VolumeInfo volume = volume_of({4, 4, 4}, VoxelType::uint8);
    const DensityField field(volume.size, volume.type);
    save_offsets_as(folder.path / "a.nrrd", field, volume);
    const std::string whole = bytes_of_file(folder.path / "a.nrrd");
    for (size_t length = 0; length < whole.size(); ++length) {
        CAPTURE(length);
        const auto path = folder.write("b.nrrd", whole.substr(0, length));
        const std::string told = error_of([&] { import_offsets(path, space_of(volume), volume.type); });
        CHECK(contains(told, "b.nrrd"));
        CHECK(!contains(told, "\n"));
    }
    folder.write(
        "huge.nrrd",
        "NRRD0004\ntype: float\ndimension: 3\nsizes: 1048576 1048576 1048576\nencoding: raw\nendian: little\n\n");
    for (const char* name : {"huge.nrrd", "none.tif"})
        CHECK(contains(error_of([&] { import_offsets(folder.path / name, space_of(volume), volume.type); }), name));
    CHECK(contains(error_of([&] { save_offsets_as(folder.path / "a.mhd", field, volume); }),
                   "has a format in which offsets are only read; expected .offset, .nrrd, .tif or .zarr"));
    CHECK(!std::filesystem::exists(folder.path / "a.mhd"));
}
