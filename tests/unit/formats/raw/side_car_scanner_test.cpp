// Headers of CT scanners next to raw voxels: found from either file, and refused with words.

#include <cstring>

#include <doctest/doctest.h>

#include "engine/formats/open_volume.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

namespace fs = std::filesystem;

/// 4 x 3 x 2 voxels of that type, 1 to 24.
template <class T>
std::string voxels(bool is_big = false)
{
    std::string bytes;
    for (int i = 1; i <= 24; ++i) {
        const T voxel = static_cast<T>(i);
        char each[sizeof(T)];
        std::memcpy(each, &voxel, sizeof(T));
        if (is_big) std::reverse(each, each + sizeof(T));
        bytes.append(each, sizeof(T));
    }
    return bytes;
}

constexpr const char* VGI =
    "{volume1}\n[representation]\nsize = 4 3 2\ndatatype = unsigned integer\nbitsperelement = 8\n[file1]\n"
    "RegionOfInterestStart = 0 0 0\nFileFormat = raw\nSize = 4 3 2\nName = scan.vol\nDatatype = float\n"
    "datarange = -1 1\nBitsPerElement = 32\n{volumeprimitive12}\n[geometry]\nresolution = 0.02 0.02 0.03\nunit = mm\n";
constexpr const char* XTEKCT =
    "[XTekCT]\nName=scan\nVoxelsX=4\nVoxelSizeX=0.025\nVoxelsY=3\nVoxelSizeY=0.025\nVoxelsZ=2\nVoxelSizeZ=0.025\n";
constexpr const char* INFO =
    "! PyHST_SLAVE VOLUME INFO FILE\nNUM_X =  4\nNUM_Y =  3\nNUM_Z =  2\nvoxelSize =  1.4\n"
    "BYTEORDER = HIGHBYTEFIRST\nValMin =  0\n";

std::string refusal(const fs::path& path)
{
    return error_of([&] { open_volume(path); });
}

}  // namespace

// Kind (Scanner headers): `.vgi` with several sections
TEST_CASE("a .vgi describes its voxels by the section of the file, from either file")
{
    const TemporaryFolder folder;
    const fs::path raw = folder.write("scan.vol", voxels<float>()), header = folder.write("scan.vgi", VGI);
    for (const fs::path& path : {raw, header}) {
        const auto source = open_volume(path);
        CHECK(source->info().size == Size3(4, 3, 2));
        CHECK(source->info().type == VoxelType::float32);
        CHECK(source->info().spacing == glm::dvec3(0.02, 0.02, 0.03));
        CHECK(source->info().unit == "mm");
        CHECK(source->info().warnings.empty());
        CHECK(voxels_of<float>(*source)[23] == 24.0f);
    }
    // Renamed together.
    fs::rename(raw, folder.path / "other.vol");
    fs::rename(header, folder.path / "other.vgi");
    CHECK(open_volume(folder.path / "other.vol")->info().type == VoxelType::float32);
}

// Kind (Scanner headers): `.xtekct`, which states no voxel type
TEST_CASE("a .xtekct describes voxels whose type the size of their file tells")
{
    const TemporaryFolder folder;
    const fs::path header = folder.write("scan.xtekct", XTEKCT);
    CHECK(contains(refusal(header), "is a Nikon header, and its voxels are missing; expected scan.vol next to it"));
    for (const VoxelType type : {VoxelType::float32, VoxelType::uint16, VoxelType::uint8}) {
        const fs::path raw = folder.write("scan.vol", type == VoxelType::float32  ? voxels<float>()
                                                      : type == VoxelType::uint16 ? voxels<uint16_t>()
                                                                                  : voxels<uint8_t>());
        for (const fs::path& path : {raw, header}) {
            const auto source = open_volume(path);
            CHECK(source->info().type == type);
            CHECK(source->info().spacing == glm::dvec3(0.025));
            CHECK(source->info().unit == "mm");
            CHECK(warns_of(*source, "no voxel type stated; "));
        }
    }
    folder.write("scan.vol", "cut");
    CHECK(contains(refusal(header), "holds 3 bytes; expected 1, 2 or 4 for each of the 24 voxels that scan.xtekct"));
}

// Kind (Scanner headers): `.vol.info` with byte order and micrometres
TEST_CASE("a .vol.info states size, byte order and micrometres")
{
    const TemporaryFolder folder;
    const fs::path raw = folder.write("scan.vol", voxels<float>(true)), header = folder.write("scan.vol.info", INFO);
    for (const fs::path& path : {raw, header}) {
        const auto source = open_volume(path);
        CHECK(source->info().size == Size3(4, 3, 2));
        CHECK(source->info().spacing == glm::dvec3(1.4));
        CHECK(source->info().unit == "um");
        CHECK(voxels_of<float>(*source)[6] == 7.0f);
    }
    CHECK(contains(refusal(folder.write("scan.vol.info", "NUM_X = 4\nNUM_Y = 3\n")), "NUM_Z"));
    folder.write("scan.vol.info", std::string(INFO) + "x");
    CHECK(contains(refusal(folder.write("scan.vol.info", "NUM_X = 4\nNUM_Y = 3\nNUM_Z = 2\nBYTEORDER = odd\n")),
                   "BYTEORDER is \"odd\"; expected LOWBYTEFIRST or HIGHBYTEFIRST"));
}

TEST_CASE("broken headers of scanners are refused with the field, and their names state a size")
{
    const TemporaryFolder folder;
    folder.write("scan.vol", voxels<float>());
    const auto with = [&](std::string_view field, std::string_view value) {
        std::string text = VGI;
        const size_t at = text.find(field, text.find("[file1]"));
        text.replace(at, text.find('\n', at) - at, std::string(field) + " = " + std::string(value));
        return refusal(folder.write("scan.vgi", text));
    };
    CHECK(contains(with("Datatype", "complex"), "Datatype is \"complex\"; expected unsigned integer, signed integer"));
    CHECK(contains(with("BitsPerElement", "16"), "BitsPerElement is \"16\"; expected 8, 16 or 32"));
    CHECK(contains(with("Size", "4 3"), "Size is \"4 3\"; expected "));
    CHECK(contains(with("Size", "4 3 9"), "; expected "));
    CHECK(contains(with("FileFormat", "tiff"), "FileFormat is \"tiff\"; expected raw"));
    CHECK(contains(refusal(folder.write("scan.vgi", std::string(VGI) + "[file2]\nName = b.vol\n")),
                   "describes voxels in several files"));
    for (const char* name : {"a.vgi", "A.XTEKCT", "a.vol.info"}) CHECK(name_states_size(name));
    CHECK_FALSE(name_states_size("a.vol"));
}
